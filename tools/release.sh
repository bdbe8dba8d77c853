#!/usr/bin/env bash
# Builds everything that is released, in one folder with check sums: the command as one static file, a container image with it, the
# wheel, the library's source, and the documentation as a static site. Each is tested as a user would use it.
#
#   tools/release.sh [FOLDER]        # target/handout unless named
#
# Needs Rust, Python and, for the static file, musl's C compiler (Debian: musl-tools). Parts that cannot be built here print SKIPPED.
set -euo pipefail
cd "$(dirname "$0")/.."
folder="$(realpath -m "${1:-target/handout}")"
version="$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -n 1)"
machine="$(uname -m)"
target="$machine-unknown-linux-musl"
build="${CARGO_TARGET_DIR:-target}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
rm -rf "$folder"
mkdir -p "$folder"
say() { printf '== %s\n' "$*"; }

say "licences, sources, advisories"
if command -v cargo-deny >/dev/null || cargo install --quiet --locked --debug --root target/tools cargo-deny; then
    PATH="$PWD/target/tools/bin:$PATH" tools/dependencies.sh
else
    echo "SKIPPED cargo-deny: it is not here and cannot be installed"
fi

# The files that a user of the command needs in addition: robots, studies and the recordings that they read.
shipped=(README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT arenas morphologies real_trajectories scenes sensors sweeps vehicles)
name="realgap-$version-$machine-linux"

say "the command, without any library of this machine"
if command -v musl-gcc >/dev/null && rustup target add "$target" >/dev/null 2>&1; then
    cargo build --profile dist --locked --bin realgap --target "$target"
    mkdir "$work/$name"
    cp "$build/$target/dist/realgap" "$work/$name/"
    git archive HEAD -- "${shipped[@]}" | tar -x -C "$work/$name"
    tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct)" -cf - "$name" \
        | gzip -n -9 >"$folder/$name.tar.gz"
    # The main job is tested in a folder that contains nothing else.
    mkdir -p "$work/$name/tmp"
    if [ "$(id -u)" = 0 ]; then
        chroot "$work/$name" /realgap sweep sweeps/cube_toss.ron --points 3 -o /tmp/out
    else
        unshare --map-root-user chroot "$work/$name" /realgap sweep sweeps/cube_toss.ron --points 3 -o /tmp/out
    fi
    test -s "$work/$name/tmp/out/report.html"
    rm -rf "$work/$name/tmp"

    say "the container image"
    cat >"$work/Containerfile" <<END
FROM scratch
COPY $name /opt/realgap
ENV PATH=/opt/realgap
WORKDIR /opt/realgap
VOLUME /data
ENTRYPOINT ["/opt/realgap/realgap"]
CMD ["--help"]
END
    image="$folder/realgap-$version-$machine-image.tar"
    if command -v buildah >/dev/null; then
        export BUILDAH_ISOLATION=chroot STORAGE_DRIVER=vfs
        buildah build --quiet --file "$work/Containerfile" --tag "realgap:$version" "$work" >/dev/null
        container="$(buildah from "realgap:$version")"
        buildah run "$container" -- /opt/realgap/realgap sweep sweeps/cube_toss.ron --points 3 -o /data/out
        buildah rm "$container" >/dev/null
        buildah push --quiet "realgap:$version" "oci-archive:$image:realgap:$version" >/dev/null
    elif docker info >/dev/null 2>&1; then
        docker build --quiet --file "$work/Containerfile" --tag "realgap:$version" "$work" >/dev/null
        docker run --rm "realgap:$version" sweep sweeps/cube_toss.ron --points 3 -o /data/out
        docker save "realgap:$version" -o "$image"
    else
        echo "SKIPPED the container image: neither buildah nor a Docker engine is here"
    fi
else
    echo "SKIPPED the static command and its container: no musl-gcc, or no Rust for $target"
fi

say "the wheel, with the command in it"
# Zig links for the C library of older systems (RHEL 8, Debian 10, Ubuntu 20.04), whichever this machine has.
python3 -m venv "$work/maker"
"$work/maker/bin/pip" install --quiet 'maturin[zig]>=1.9,<2'
PATH="$work/maker/bin:$PATH" "$work/maker/bin/maturin" build --profile dist --locked --zig --compatibility manylinux_2_28 \
    -m python/Cargo.toml --out "$folder"
python3 -m venv "$work/user"
"$work/user/bin/pip" install --quiet "$folder"/*.whl
"$work/user/bin/realgap" sweep sweeps/cube_toss.ron --points 3 -o "$work/wheel"
"$work/user/bin/python" -c 'import realgap; print(realgap.__version__)'

say "the source"
git archive --format=tar.gz --prefix="realgap-$version/" -o "$folder/realgap-$version.tar.gz" HEAD

say "the site of the documentation"
bash tools/site.sh "$work/realgap-$version-site"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -cf - "realgap-$version-site" | gzip -n -9 >"$folder/realgap-$version-site.tar.gz"

cd "$folder"
sha256sum -- * >SHA256SUMS
say "in $folder"
du -h -- *
