#!/usr/bin/env bash
# Makes every picture of docs/gallery.md and README.md: about 5 CPU minutes.
#
#   tools/gallery.sh [REALGAP [FOLDER]]
#
# REALGAP is the binary (default target/release/realgap), FOLDER keeps the results (default
# results/gallery); a step whose picture is there already is not run again. The pictures go to
# docs/images with a palette of 256 colours (tools/shrink_png.py, needs numpy).
set -euo pipefail
cd "$(dirname "$0")/.."
realgap=${1:-target/release/realgap}
work=${2:-results/gallery}
python=${PYTHON:-python3}
images=docs/images
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

keep() {
    "$python" tools/shrink_png.py "$work/$1" "$images/$2"
}

best=(--parameters "$work/sweep/best.ron")
recordings=(real_trajectories/tripod_mujoco/run_0[0-4].csv)

once sweep/heatmap.png "$realgap" sweep sweeps/tripod_floor.ron -o "$work/sweep"
once tune/convergence.png "$realgap" tune sweeps/tripod_floor.ron --budget 100 -o "$work/tune"
once sensitivity.png "$realgap" sensitivity sweeps/tripod_floor.ron "${best[@]}" \
    --plot "$work/sensitivity.png"
once compare.png "$realgap" compare "${recordings[@]}" --metric rms --plot "$work/compare.png"
once ensemble/ensemble.png "$realgap" ensemble sweeps/tripod_floor.ron "${best[@]}" \
    --repeats 100 --model-error off -o "$work/ensemble"
once gap/confidence.png "$realgap" gap sweeps/tripod_floor.ron "${best[@]}" \
    --repeats 100 -o "$work/gap"
once robot.png "$realgap" check morphologies/tripod.ron --plot "$work/robot.png"
once search/gallery.png "$realgap" search sweeps/best_robot.ron -o "$work/search"

keep sweep/heatmap.png heatmap.png
keep sweep/trajectories.png trajectories.png
keep sweep/profile_floor_friction.png profile.png
keep tune/convergence.png convergence.png
keep sensitivity.png sensitivity.png
keep compare.png compare.png
keep ensemble/ensemble.png ensemble.png
keep gap/confidence.png confidence.png
keep robot.png robot.png
keep search/gallery.png gallery.png
keep search/fitness.png fitness.png
keep search/paths.png paths.png
du -cb "$images"/*.png | tail -1
