#!/usr/bin/env bash
# Makes every picture of docs/gallery.md and README.md from the files of this repository, and writes down what the pictures say.
#
#   tools/gallery.sh [REALGAP [FOLDER]]            # all of them: about 5 CPU minutes
#   tools/gallery.sh --check [REALGAP [FOLDER]]    # makes those that take under a minute each, and compares what they say
#
# REALGAP is the program (default target/release/realgap), FOLDER keeps the results (default results/gallery); a step whose picture is
# there already is not run again. The pictures go to docs/images with a palette of 256 colours (tools/shrink_png.py, needs numpy), the
# texts in them (title, best point, legend, axes) to docs/images/captions.txt. With --check nothing in docs/ is written: it fails where
# a picture made now says anything else than docs/images/captions.txt.
set -euo pipefail
cd "$(dirname "$0")/.."
check=
if [ "${1:-}" = --check ]; then
    check=yes
    shift
fi
realgap=${1:-target/release/realgap}
work=${2:-results/gallery}
python=${PYTHON:-python3}
images=docs/images
captions="$images/captions.txt"
mkdir -p "$work" "$images"

# once PICTURE COMMAND...: runs the command unless its picture exists.
once() {
    local picture=$1
    shift
    if [ ! -e "$work/$picture" ]; then
        printf '== %s\n' "$*"
        "$@"
    fi
}

# long PICTURE COMMAND...: the same for what takes over a minute, or draws photographs without text; --check leaves it out.
long() {
    [ -n "$check" ] || once "$@"
}

# both PICTURE COMMAND...: the same, and once more as SVG for the texts, where a command draws one picture only.
both() {
    once "$@"
    local picture=$1
    shift
    once "${picture%.png}.svg" "${@//.png/.svg}" >/dev/null
}

# shrink PICTURE NAME [LEVELS]: puts it into docs/images.
shrink() {
    "$python" tools/shrink_png.py "$work/$1" "$images/$2" "${@:3}"
}

# keep PICTURE NAME: the same, and its texts, from its twin in SVG, into the list.
keep() {
    [ -n "$check" ] || shrink "$@"
    printf '%s\n' "$2" >>"$work/captions.txt"
    if [ -e "$work/${1%.png}.svg" ]; then
        tr -d '\n' <"$work/${1%.png}.svg" | grep -o '<text[^>]*>[^<]*' | sed 's/<text[^>]*>/    /' >>"$work/captions.txt"
    fi
}

best=(--parameters "$work/sweep/best.ron")
recordings=(real_trajectories/tripod_mujoco/run_0[0-4].csv)

once tosses/heatmap.png "$realgap" sweep sweeps/cube_toss.ron -o "$work/tosses"
once sweep/heatmap.png "$realgap" sweep sweeps/tripod_floor.ron -o "$work/sweep"
long tune/convergence.png "$realgap" tune sweeps/tripod_floor.ron --budget 100 -o "$work/tune"
long sensitivity.png "$realgap" study sensitivity sweeps/tripod_floor.ron "${best[@]}" \
    --plot "$work/sensitivity.png"
both compare.png "$realgap" compare "${recordings[@]}" --metric rms --plot "$work/compare.png"
long ensemble/ensemble.png "$realgap" ensemble sweeps/tripod_floor.ron "${best[@]}" \
    --repeats 100 --model-error off -o "$work/ensemble"
long gap/confidence.png "$realgap" gap sweeps/tripod_floor.ron "${best[@]}" \
    --repeats 100 -o "$work/gap"
both time.png "$realgap" compare "${recordings[@]}" --metric rms --over-time "$work/time.png"
once walk.csv "$realgap" sense graph log arenas/cartons.ron --samples 1400 -o "$work/walk.csv"
both visits.png "$realgap" sense graph fit "$work/walk.csv" --stop terms --visits "$work/visits.png"
once readings.csv "$realgap" sense draw ultrasonic -o "$work/readings.csv"
both sensor.png "$realgap" sense fit "$work/readings.csv" --plot "$work/sensor.png" \
    --histograms "$work/histograms.png"
both robot.png "$realgap" check morphologies/tripod.ron --plot "$work/robot.png"
for robot in turtlebot3_burger unitree_a1 unitree_go2 so101_arm; do
    both "$robot.png" "$realgap" check "morphologies/$robot.ron" --plot "$work/$robot.png"
done
# ALOHA is a file of the Python package gym_aloha.
aloha="import importlib.util as u, pathlib as p; f = u.find_spec('gym_aloha'); print(p.Path(f.origin).parent / 'assets' if f else '')"
aloha="$("$python" -c "$aloha" || true)"
if [ -n "$aloha" ]; then
    long aloha.png "$realgap" replay "$aloha/bimanual_viperx_transfer_cube.xml" --duration 2 -o "$work/aloha.png"
elif [ -z "$check" ]; then
    echo "SKIPPED aloha.png: gym_aloha is not installed"
fi
long arm/joints.png "$realgap" tune sweeps/so101_fit.ron --optimizer gauss-newton --budget 200 \
    -o "$work/arm"
long search/gallery.png "$realgap" search sweeps/best_robot.ron -o "$work/search"

# Stand-ins: a camera with other, hidden settings.
long simulated/door.png "$realgap" sense picture scenes/room.ron -o "$work/simulated"
long real/door_1.png "$realgap" sense picture scenes/room.ron --camera standin --repeats 2 --seed 2 \
    -o "$work/real"
long real_dark/door.png "$realgap" sense picture scenes/room.ron --camera standin --light badly \
    --seed 3 -o "$work/real_dark"
long vision/template.png "$realgap" sense vision compare "$work/simulated" "$work/real" \
    --badly-lit "$work/real_dark" --relative-to view -o "$work/vision"
long steps.png "$realgap" sense vision extract "$work/simulated/door.png" "$work/real/door_1.png" \
    --extractor contour -o "$work/steps.png"
long run.csv "$realgap" simulate morphologies/tripod.ron --duration 20 -o "$work/run.csv"
long ride/t_005.000.png "$realgap" sense picture scenes/room.ron --ride tripod --run "$work/run.csv" \
    --every 5 -o "$work/ride"
long parts.csv "$realgap" simulate morphologies/chain5.ron --duration 10 --parts "$work/parts.csv"
long watched/side_t_005.000.png "$realgap" sense picture scenes/pen.ron --watch snake --view side \
    --run "$work/parts.csv" --robot morphologies/chain5.ron --every 5 -o "$work/watched"
long seen/t_006.800.png "$realgap" sense picture scenes/pen.ron --ride snake \
    --run "$work/parts.csv" --robot morphologies/chain5.ron --every 3.4 -o "$work/seen"

# The fit of docs/validation/radio.md, whose whole recordings are not part of this repository.
cat > "$work/radio.ron" <<'RON'
(
    description: "docs/validation/radio.md", propagation: "thickness",
    values: [-43.9, 1.56, 7.63, 5.38], cap: 1, robot_height_m: 0.3,
)
RON
both map.png "$realgap" sense radio map --arena arenas/flat.ron --parameters "$work/radio.ron" \
    --anchor 6 --plot "$work/map.png"

# Trials of one robot on its way to a place, behind those of others: LOG ROBOT PLACE TRAJECTORY...
trials() {
    local log=$1 robot=$2 place=$3 first=1
    shift 3
    [ ! -s "$log" ] || first=2
    "$realgap" sense tasks time "$@" --reach="$place" --within 0.3 --condition "robot=$robot" \
        | tail -n "+$first" >> "$log"
}

if [ ! -e "$work/simulated.csv" ]; then
    rm -f "$work/real.csv" "$work/simulated.csv"
    for task in tripod:-0.2,-0.45 two_module:-0.5,0.1 chain5:-1.0,0.0; do
        robot=${task%%:*}
        runs=()
        for friction in 0.3 0.4 0.5 0.6 0.7; do
            runs+=("$work/${robot}_$friction.csv")
            "$realgap" simulate "morphologies/$robot.ron" --duration 20 \
                --set "floor.friction=$friction" -o "${runs[-1]}" > "$work/simulate.txt"
        done
        trials "$work/real.csv" "$robot" "${task#*:}" "real_trajectories/${robot}_mujoco"/*.csv
        trials "$work/simulated.csv" "$robot" "${task#*:}" "${runs[@]}"
    done
fi
both times.png "$realgap" sense tasks compare "$work/real.csv" "$work/simulated.csv" \
    --plot "$work/times.png" --curves "$work/curves.png"

# Photographs, robots drawn from them and animations have no texts.
if [ -z "$check" ]; then
    shrink vision/template.png template.png
    shrink steps.png steps.png
    [ ! -e "$work/aloha.png" ] || cp "$work/aloha.png" "$images/aloha.png"
    shrink ride/t_005.000.png ride.png
    shrink watched/side_t_005.000.png watched.png 6
    shrink seen/t_006.800.png seen.png 6
fi
: >"$work/captions.txt"
keep map.png map.png
keep times.png times.png
keep curves.png curves.png
keep tosses/verdict.png verdict.png
keep tosses/heatmap.png tosses.png
keep tosses/corner.png corner.png
keep sweep/heatmap.png heatmap.png
keep sweep/trajectories.png trajectories.png
keep sweep/profile_floor_friction.png profile.png
keep compare.png compare.png
keep time.png time.png
keep visits.png visits.png
keep sensor.png sensor.png
keep histograms.png histograms.png
keep robot.png robot.png
keep turtlebot3_burger.png turtlebot3_burger.png
keep unitree_a1.png unitree_a1.png
keep unitree_go2.png unitree_go2.png
keep so101_arm.png so101_arm.png
if [ -n "$check" ]; then
    # The pictures that were made now stand first in the committed list, in the same order.
    if ! diff <(head -n "$(wc -l <"$work/captions.txt")" "$captions") "$work/captions.txt"; then
        echo "the pictures of docs/images say something else than the program does today: run tools/gallery.sh and commit" >&2
        exit 1
    fi
    echo "$(grep -c '^[^ ]' "$work/captions.txt") pictures say what the program says today"
    exit 0
fi
keep arm/joints.png joints.png
keep tune/convergence.png convergence.png
keep sensitivity.png sensitivity.png
keep ensemble/ensemble.png ensemble.png
keep gap/confidence.png confidence.png
keep search/gallery.png gallery.png
keep search/fitness.png fitness.png
keep search/paths.png paths.png
mv "$work/captions.txt" "$captions"
du -cb "$images"/*.png | tail -1
