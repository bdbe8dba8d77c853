#!/usr/bin/env bash
# Checks the licences, sources and advisories of all dependencies with cargo-deny.
#
#   tools/dependencies.sh
#
# Advisories are checked where their database can be fetched, or where a copy of it is no older than the last change of the lock file;
# elsewhere this prints SKIPPED.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo deny check licenses bans sources
# A copy will do that is no older than the last change of the lock file, and so than its newest crate.
copy="$(ls -d "${CARGO_HOME:-$HOME/.cargo}"/advisory-db*/*/ 2>/dev/null | head -n 1 || true)"
if cargo deny fetch db >/dev/null 2>&1; then
    cargo deny check advisories
elif [ -n "$copy" ] && [ "$(git -C "$copy" log -1 --format=%ct)" -ge "$(git log -1 --format=%ct -- Cargo.lock)" ]; then
    cargo deny check --disable-fetch advisories
else
    echo "SKIPPED advisories: their database cannot be fetched, and no copy is new enough"
fi
