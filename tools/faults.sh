#!/usr/bin/env bash
# Tests which faults the program survives: kills, full and read-only disks, damaged files, jumps of the clock, several writers. Prints one
# table; the exit code is 1 if any data were lost without an error message. `--short` runs a part of it that takes a minute, `--files` only
# the faults of files: pages and logs of the store, files of a finished folder.
#
#   cargo build --release && tools/faults.sh
#
# REALGAP names another program than target/release/realgap, SEED another seed than 1. Needs Linux; tests that need a permission or a compiler that
# is missing print SKIPPED.
set -uo pipefail
cd "$(dirname "$0")/.."
realgap=$(realpath "${REALGAP:-target/release/realgap}")
kills=50 early=30 second=20 pages=100 logs=40 seals=15 terms=5 grid=8
if [ "${1:-}" = --short ]; then
    kills=4 early=4 second=3 pages=20 logs=10 seals=3 terms=1
fi
files=0
[ "${1:-}" = --files ] && files=1
RANDOM=${SEED:-1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

table=""
row() { # fault, number of trials, outcome, exit code: 0 if the outcome is as promised
    local verdict=ok
    if [ "$4" != 0 ]; then
        verdict=FAILED
        failed=1
    fi
    table+="| $1 | $2 | $3 | $verdict |"$'\n'
    echo "$verdict: $1, $2: $3" >&2
}
skipped() { table+="| $1 | 0 | SKIPPED: $2 | - |"$'\n'; }
now_ms() { echo $(($(date +%s%N) / 1000000)); }
sleep_ms() { sleep "$(printf '%d.%03d' $(($1 / 1000)) $(($1 % 1000)))"; }

cat >"$work/study.ron" <<END
Study(
    morphology: "$PWD/morphologies/tripod.ron",
    recordings: ["$PWD/real_trajectories/tripod_standin/*.csv"],
    start: Settled,
    duration_s: 1.0,
    parameters: [
        (name: "floor.friction", from: 0.1, to: 0.9, points: $grid),
        (name: "floor.restitution", from: 0.0, to: 0.8, points: $grid),
    ],
)
END
sweep() { "$realgap" sweep "$work/study.ron" --jobs 1 "$@" >"$work/said" 2>&1; }
equal() { cmp -s "$work/whole/points.csv" "$1/points.csv" && cmp -s "$work/whole/summary.json" "$1/summary.json"; }

begun=$(now_ms)
sweep -o "$work/whole" || { cat "$work/said"; exit 1; }
whole_ms=$(($(now_ms) - begun))
"$realgap" study results "$work/whole" --format csv >"$work/whole.csv"

# Starts a sweep into $1 with the options after $2, and kills it after $2 milliseconds.
killed() {
    local out=$1 after=$2
    shift 2
    "$realgap" sweep "$work/study.ron" --jobs 1 -o "$out" "$@" >/dev/null 2>&1 &
    local process=$!
    sleep_ms "$after"
    kill -9 "$process" 2>/dev/null
    wait "$process" 2>/dev/null
}

if [ "$files" = 0 ]; then
# 1 A run is killed at a random moment, twice, then resumed.
different=0
for i in $(seq "$kills"); do
    out=$work/killed
    rm -rf "$out"
    killed "$out" $((RANDOM % whole_ms))
    [ -e "$out" ] && killed "$out" $((RANDOM % whole_ms)) --resume
    if [ -e "$out" ]; then sweep -o "$out" --resume; else sweep -o "$out"; fi
    equal "$out" || different=$((different + 1))
done
row "kill -9 twice at any moment, resumed" "$kills" "$different differ from a whole run" "$different"

# 2 A run is killed in the first 80 ms and started again.
refused=0
for i in $(seq "$early"); do
    out=$work/early
    rm -rf "$out"
    killed "$out" $((RANDOM % 80))
    sweep -o "$out" || sweep -o "$out" --resume || refused=$((refused + 1))
    equal "$out" || refused=$((refused + 1))
done
row "kill -9 in the first 80 ms, started or resumed" "$early" "$refused refused or different" "$refused"

# 3 A second run on complete results is killed at a random moment: every file must have its old bytes, which equal the new ones.
cp -r "$work/whole" "$work/before"
begun=$(now_ms)
sweep -o "$work/whole"
again_ms=$(($(now_ms) - begun))
lost=0
for i in $(seq "$second"); do
    killed "$work/whole" $((RANDOM % again_ms))
    "$realgap" study results "$work/whole" --format csv | cmp -s - "$work/whole.csv" || lost=$((lost + 1))
    for file in "$work/before"/*.*; do
        name=$(basename "$file")
        [ "$name" = timing.json ] || [ "$name" = results.sqlite ] || cmp -s "$file" "$work/whole/$name" || lost=$((lost + 1))
    done
done
row "kill -9 of a second run on complete results" "$second" "$lost results lost" "$lost"
sweep -o "$work/whole"

# 4 A full disk.
cat >"$work/full.sh" <<END
mount -t tmpfs -o size=\$1 none "$work/disk" || exit 77
"$realgap" sweep "$work/study.ron" --jobs 1 -o "$work/disk/out" >"$work/full.said" 2>&1
code=\$?
[ \$code = 1 ] && grep -q 'free some' "$work/full.said" || { echo "exit \$code"; cat "$work/full.said"; exit 1; }
[ "\$(grep -c '^error:' "$work/full.said")" = 1 ] || exit 1
mount -o remount,size=50m "$work/disk" || exit 77
"$realgap" sweep "$work/study.ron" --jobs 1 -o "$work/disk/out" --resume >/dev/null 2>&1 \
    || "$realgap" sweep "$work/study.ron" --jobs 1 -o "$work/disk/out" >/dev/null 2>&1 || exit 1
cmp "$work/whole/points.csv" "$work/disk/out/points.csv"
END
mkdir -p "$work/disk"
lost=0 count=0
for size in 4k 16k 64k 150k 300k; do
    unshare --mount --map-root-user bash "$work/full.sh" "$size" >"$work/said" 2>&1
    case $? in
        0) count=$((count + 1)) ;;
        77) count=-1; break ;;
        *) count=$((count + 1)) lost=$((lost + 1)); cat "$work/said" >&2 ;;
    esac
done
if [ "$count" -lt 0 ]; then
    skipped "full disk (tmpfs of 4 to 300 KiB), then room and resumed" "nothing can be mounted here"
else
    row "full disk (tmpfs of 4 to 300 KiB), then room and resumed" "$count" "$lost without one clear error, or different" "$lost"
fi

# 5 A disk that cannot be written.
cat >"$work/read_only.sh" <<END
mount --bind "$work/whole" "$work/whole" && mount -o remount,ro,bind "$work/whole" || exit 77
"$realgap" study results "$work/whole" --format csv | cmp - "$work/whole.csv" || exit 1
"$realgap" sweep "$work/study.ron" -o "$work/whole" >"$work/said" 2>&1
[ \$? = 1 ] || exit 1
END
unshare --mount --map-root-user bash "$work/read_only.sh" >/dev/null 2>&1
case $? in
    77) skipped "finished results on a read-only disk" "nothing can be mounted here" ;;
    0) row "finished results on a read-only disk" 1 "read as before; a new run is refused at once" 0 ;;
    *) row "finished results on a read-only disk" 1 "not readable, or not refused" 1 ;;
esac
fi

# 6 Damaged pages of the store.
damage() { # file, offset, bytes
    LC_ALL=C awk -v seed="$RANDOM" -v n="$3" 'BEGIN { srand(seed); for (i = 0; i < n; i++) printf "%c", int(256 * rand()) }' | dd of="$1" bs=1 seek="$2" conv=notrunc status=none
}
said=0 silent=0
mkdir -p "$work/damaged"
size=$(stat -c %s "$work/whole/results.sqlite")
for i in $(seq "$pages"); do
    cp "$work/whole/results.sqlite" "$work/damaged/results.sqlite"
    page=$(((RANDOM * 32768 + RANDOM) % (size / 4096)))
    case $((i % 3)) in
        0) damage "$work/damaged/results.sqlite" $((page * 4096)) 4096 ;;
        1) damage "$work/damaged/results.sqlite" $((page * 4096 + RANDOM % 4000)) 64 ;;
        2) damage "$work/damaged/results.sqlite" $((page * 4096 + RANDOM % 4096)) 1 ;;
    esac
    if ! "$realgap" study results "$work/damaged" --format csv >"$work/damaged.csv" 2>/dev/null; then
        said=$((said + 1))
    elif ! cmp -s "$work/damaged.csv" "$work/whole.csv"; then
        silent=$((silent + 1))
    fi
    rm -f "$work/damaged/"*
done
row "damaged pages of the store" "$pages" "$said errors, $((pages - said - silent)) the same answer, $silent silently another" "$silent"

# 7 The log of a killed run is damaged, cut off, deleted, or replaced by that of another run. If the program refuses the folder, resuming must repair
# it. Output is compared sorted by trial, because scores are written only at the end.
listed() { "$realgap" study results "$1" --format csv --sort trial 2>"$work/said"; }
stopped() { # folder, options behind it
    local folder=$1 share
    shift
    for share in 60 40 80 20 50 70 30; do
        rm -rf "$folder"
        killed "$folder" $((whole_ms * share / 100)) "$@"
        [ -s "$folder/results.sqlite-wal" ] && return 0
    done
    return 1
}
if stopped "$work/log" && stopped "$work/other" --points 7; then
    listed "$work/log" >"$work/log.csv"
    size=$(stat -c %s "$work/log/results.sqlite-wal")
    for fault in damaged cut missing foreign; do
        said=0 same=0 silent=0 lost=0 times=$logs
        [ "$fault" = missing ] || [ "$fault" = foreign ] && times=$((1 + logs / 10))
        for i in $(seq "$times"); do
            rm -rf "$work/damaged"
            cp -r "$work/log" "$work/damaged"
            log=$work/damaged/results.sqlite-wal
            at=$(((RANDOM * 32768 + RANDOM) % size))
            case $fault in
                damaged) damage "$log" "$at" 16 ;;
                cut) truncate -s "$at" "$log" ;;
                missing) rm "$log" ;;
                foreign) cp "$work/other/results.sqlite-wal" "$log" ;;
            esac
            if ! listed "$work/damaged" >"$work/damaged.csv"; then
                grep -q -e --resume "$work/said" || silent=$((silent + 1))
                said=$((said + 1))
            elif cmp -s "$work/damaged.csv" "$work/log.csv"; then
                same=$((same + 1))
            else
                silent=$((silent + 1))
            fi
            sweep -o "$work/damaged" --resume && equal "$work/damaged" || lost=$((lost + 1))
        done
        row "log of a killed run, $fault" "$times" "$said errors, $same the same answer, $silent silently another or without a cure, $lost not cured by --resume" $((silent + lost))
    done
else
    skipped "log of a killed run" "the kill left no log"
fi

# 13 Files of a finished folder are changed by one digit, or shortened by one line.
for fault in "digit page.json" "digit points.csv" "digit best.ron" "line points.csv" "line indistinguishable.csv" "line SHA256SUMS"; do
    read -r kind file <<<"$fault"
    said=0
    for i in $(seq "$seals"); do
        rm -rf "$work/damaged"
        cp -r "$work/whole" "$work/damaged"
        if [ "$kind" = line ]; then
            lines=$(wc -l <"$work/whole/$file")
            sed -i "$((1 + RANDOM % lines))d" "$work/damaged/$file"
        else
            at=$(grep -ob '[0-9]' "$work/whole/$file" | cut -d: -f1 | sed -n "$((1 + (RANDOM * 32768 + RANDOM) % $(grep -o '[0-9]' "$work/whole/$file" | wc -l)))p")
            digit=$(dd if="$work/whole/$file" bs=1 skip="$at" count=1 status=none)
            printf '%s' $(((digit + 1) % 10)) | dd of="$work/damaged/$file" bs=1 seek="$at" conv=notrunc status=none
        fi
        "$realgap" report "$work/damaged" -o "$work/page.html" >/dev/null 2>"$work/said" || {
            grep -q -e --accept "$work/said" && said=$((said + 1))
        }
    done
    row "finished folder, one $kind of $file changed or lost" "$seals" "$said errors" $((seals - said))
done

if [ "$files" = 0 ]; then
# 8 A clock that jumps.
cat >"$work/jump.c" <<'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>
static int (*real)(clockid_t, struct timespec *);
static int calls;
int clock_gettime(clockid_t id, struct timespec *ts) {
    if (!real) real = dlsym(RTLD_NEXT, "clock_gettime");
    int code = real(id, ts);
    // Hours back and forth; processors' own times stay.
    if (code == 0 && id == CLOCK_REALTIME) ts->tv_sec += (++calls % 7 - 3) * 36000;
    return code;
}
END
if command -v cc >/dev/null && cc -shared -fPIC -o "$work/jump.so" "$work/jump.c" -ldl 2>/dev/null; then
    LD_PRELOAD=$work/jump.so "$realgap" sweep "$work/study.ron" --jobs 1 -o "$work/clock" >/dev/null 2>&1
    equal "$work/clock"
    row "clock that jumps by hours at every look (LD_PRELOAD)" 1 "the same bytes" $?
else
    skipped "clock that jumps by hours at every look (LD_PRELOAD)" "no C compiler"
fi

# 9 Eight writers at once.
rm -rf "$work/shared"
processes=()
for i in $(seq 8); do
    "$realgap" sweep "$work/study.ron" --jobs 1 -o "$work/shared" >"$work/writer.$i" 2>&1 &
    processes+=($!)
done
won=0
for process in "${processes[@]}"; do
    wait "$process" && won=$((won + 1))
done
named=$(grep -l 'process [0-9]* (.* since 2' "$work"/writer.* | wc -l)
equal "$work/shared" && [ "$won" = 1 ] && [ "$named" = 7 ]
row "eight writers of one folder at once" 8 "$won wrote, $named were told who writes since when" $?

# 10 SIGTERM during a run of an hour; 11 removal of the folder of such a run.
long=(predict morphologies/tripod.ron --duration 3600 --set timestep_s=0.0001 --jobs 1)
slowest=0
for i in $(seq "$terms"); do
    "$realgap" "${long[@]}" -o "$work/term$i" >/dev/null 2>&1 &
    process=$!
    sleep 0.5
    begun=$(now_ms)
    kill -TERM "$process"
    wait "$process"
    took=$(($(now_ms) - begun))
    [ "$took" -gt "$slowest" ] && slowest=$took
done
[ "$slowest" -le 2000 ]
row "SIGTERM in the middle of a run of an hour" "$terms" "ended after $slowest ms at most" $?
"$realgap" "${long[@]}" -o "$work/gone" >"$work/said" 2>&1 &
process=$!
sleep 0.5
rm -rf "$work/gone"
begun=$(now_ms)
wait "$process"
code=$?
took=$(($(now_ms) - begun))
[ "$code" = 1 ] && grep -q 'removed during the run' "$work/said" && [ "$took" -le 5000 ]
row "results folder removed during a run of an hour" 1 "noticed after $took ms" $?

# 12 The folder of a run is made read-only, for a user without the right to override that.
mkdir "$work/user"
as_user=()
if [ "$(id -u)" = 0 ]; then
    chmod 777 "$work" "$work/user"
    as_user=(setpriv --reuid=65534 --regid=65534 --clear-groups)
fi
if "${as_user[@]}" mkdir "$work/user/out" 2>/dev/null && "${as_user[@]}" test -x "$realgap" -a -r morphologies/tripod.ron; then
    "${as_user[@]}" "$realgap" "${long[@]}" -o "$work/user/out" >"$work/user.said" 2>&1 &
    process=$!
    sleep 1
    "${as_user[@]}" chmod 555 "$work/user/out"
    begun=$(now_ms)
    wait "$process"
    code=$?
    took=$(($(now_ms) - begun))
    [ "$code" = 1 ] && grep -q 'check the permissions' "$work/user.said" && [ "$took" -le 5000 ]
    row "results folder made read-only during a run of an hour" 1 "noticed after $took ms" $?
    chmod 755 "$work/user/out"
else
    skipped "results folder made read-only during a run of an hour" "no other user can run the program here"
fi
fi

printf '\n| fault | times | outcome | |\n|---|---|---|---|\n%s' "$table"
exit $failed
