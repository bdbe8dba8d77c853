#!/usr/bin/env bash
# Renders README, changelog and docs as a static site whose pages open from the disk, too. A link to a page, a heading or a picture that
# is not there is an error.
#
#   tools/site.sh [FOLDER]        # target/site unless named
#
# Needs Python; MkDocs is installed in an environment of its own, target/mkdocs.
set -euo pipefail
cd "$(dirname "$0")/.."
folder="$(realpath -m "${1:-target/site}")"
version="$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -n 1)"
environment="$PWD/target/mkdocs"
python3 -m venv "$environment"
"$environment/bin/pip" install --quiet 'mkdocs>=1.6,<2'
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# In the repository the README stands above docs/; on the site it is the first of the pages.
pages="$work/docs"
cp -r docs "$pages"
from_docs() { sed 's#](docs/#](#g; s#\(src\|href\)="docs/#\1="#g; s#^\(\[[^]]*\]: \)docs/#\1#' "$1"; }
from_docs README.md >"$pages/index.md"
from_docs CONTRIBUTING.md >"$pages/CONTRIBUTING.md"
cp CHANGELOG.md "$pages/changelog.md"
# Files of the repository that pages name are part of the site.
cp CITATION.cff LICENSE-APACHE LICENSE-MIT "$pages/"
for part in morphologies sweeps; do
    mkdir -p "$pages/$part"
    cp "$part"/*.ron "$pages/$part/"
done

cat >"$work/mkdocs.yml" <<END
site_name: realgap $version
site_description: How far a simulated robot is from the real one, what closes the gap, and how sure one may be.
docs_dir: docs
site_dir: $folder
use_directory_urls: false
theme:
  name: readthedocs
  # Nothing is loaded from elsewhere.
  highlightjs: false
plugins: [search]
markdown_extensions:
  - toc:
      permalink: true
  - tables
  - fenced_code
validation:
  nav:
    omitted_files: ignore
  links:
    not_found: warn
    anchors: warn
    absolute_links: warn
    unrecognized_links: warn
nav:
  - Read me: index.md
  - First steps: [start.md, concepts.md, results.md, gallery.md]
  - Your own data:
      [recordings.md, robots.md, control.md, simulator.md, simulator_examples.md, scale.md, python.md]
  - Reference: [cli.md, files.md]
  - What it is worth: [validation.md, compare.md, limits.md$(
    for page in docs/validation/*.md; do printf ', validation/%s' "$(basename "$page")"; done
)]
  - How it is made: [design.md, bibliography.md$(
    for page in docs/upstream/*.md; do printf ', upstream/%s' "$(basename "$page")"; done
), changelog.md]
END
# Quietly it would take warnings for nothing, so what it says is shown only where it fails.
if ! "$environment/bin/mkdocs" build --strict --config-file "$work/mkdocs.yml" >"$work/said" 2>&1; then
    grep -v '^INFO' "$work/said" >&2
    exit 1
fi
echo "$(find "$folder" -name '*.html' | wc -l) pages in $folder: open index.html"
