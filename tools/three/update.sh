#!/bin/sh
# Makes crates/page/src/report/document/asset/three.min.js: the parts of three.js that the replay uses, in one minified script.
# Needs npm. Versions are pinned here; change them, run this, run `cargo test --test page replay`, and look at a replay.
set -eu
THREE=0.170.0
ESBUILD=0.25.0
here=$(cd "$(dirname "$0")" && pwd)
page="$here/../../crates/page/src/report/document/asset"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/entry.js" "$work"
cd "$work"
npm install --silent --no-audit --no-fund "three@$THREE" "esbuild@$ESBUILD"
npx esbuild entry.js --bundle --minify --format=iife --legal-comments=none --outfile=three.min.js
{
    echo "/*! three.js $THREE, bundled by tools/three/update.sh (esbuild $ESBUILD)"
    echo
    cat node_modules/three/LICENSE
    echo "*/"
    cat three.min.js
} > "$page/three.min.js"
wc -c "$page/three.min.js"
