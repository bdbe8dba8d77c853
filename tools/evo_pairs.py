"""Compares `ape`, `rpe` and `rotation` with evo's on evo's own test files and on synthetic pairs, without and with alignment.

    pip install evo==1.38.1
    python tools/evo_pairs.py --realgap target/release/realgap [--folder DIR] [--synthetic]

evo's test files are in its source package, which pip downloads into DIR, or into a temporary folder; they are GPL and stay there.
Where evo is not installed, or its package cannot be downloaded, this is said as SKIPPED. The exit code is 1 where a difference is above
1e-6 (relative, or in the metric's unit where the value is below 1), and 0 otherwise.

evo's `rotation` is the mean of `evo_ape -r angle_deg`; `ape` and `rpe` are the RMSE of the translation part (delta 1 frame, consecutive
pairs). Samples whose stamp repeats an earlier one are left out of both programs, because realgap reads strictly increasing times.
"""

import argparse
import copy
import json
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

LARGEST = 1e-6
ALIGNMENTS = {"none": (False, False), "se3": (True, False), "sim3": (True, True)}
METRICS = {"ape": "ape_rmse_m", "rpe": "rpe_rmse_m", "rotation": "rotation_deg"}
# Reference, other, form of the files, options of realgap.
PAIRS = [
    ("KITTI_00_gt.txt", "KITTI_00_ORB.txt", "kitti", ["--rate-hz", "10", "--axes", "world"]),
    ("KITTI_00_gt.txt", "KITTI_00_SPTAM.txt", "kitti", ["--rate-hz", "10", "--axes", "world"]),
    ("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam.txt", "tum", []),
    ("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam_drift.txt", "tum", []),
    ("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam_drift_short.txt", "tum", []),
    ("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-ORB_kf_mono.txt", "tum", []),
    ("fr2_desk_groundtruth.txt", "fr2_desk_ORB.txt", "tum", ["--sort-samples"]),
    ("fr2_desk_groundtruth.txt", "fr2_desk_ORB_kf_mono.txt", "tum", ["--sort-samples"]),
    ("V102_groundtruth.csv", "V102.txt", "euroc", ["--sort-samples"]),
    ("nav2_turtlebot.mcap", "nav2_turtlebot.mcap", "/amcl_pose /odom", ["--topic", "/amcl_pose", "--topic", "/odom"]),
]


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(0)


def test_files(folder, version):
    """The folder test/data of evo's source package."""
    found = next(folder.glob("evo-*/test/data"), None)
    if found is None:
        done = subprocess.run([sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:",
                               f"evo=={version}", "-d", str(folder)], capture_output=True, text=True)
        package = next(folder.glob("evo-*.tar.gz"), None)
        if done.returncode or package is None:
            skip(f"evo's source package cannot be downloaded: {done.stderr.strip()[-200:]}")
        with tarfile.open(package) as archive:
            archive.extractall(folder, filter="data")
        found = next(folder.glob("evo-*/test/data"))
    return found


def without_repeats(trajectory):
    """The trajectory without samples whose stamp does not increase."""
    kept = [0]
    for index, stamp in enumerate(trajectory.timestamps):
        if stamp > trajectory.timestamps[kept[-1]]:
            kept.append(index)
    left_out = trajectory.num_poses - len(kept)
    trajectory.reduce_to_ids(kept)
    return left_out


def read_pair(first, second, form):
    """Both trajectories as evo associates them, and the number of samples that were left out."""
    from evo.core import sync
    from evo.tools import file_interface
    if form == "kitti":
        return [file_interface.read_kitti_poses_file(path) for path in (first, second)], 0
    if form.startswith("/"):
        from rosbags.rosbag2 import Reader
        with Reader(first) as reader:
            both = [file_interface.read_bag_trajectory(reader, topic) for topic in form.split()]
    else:
        read = file_interface.read_euroc_csv_trajectory if form == "euroc" else file_interface.read_tum_trajectory_file
        both = [read(first), file_interface.read_tum_trajectory_file(second)]
    left_out = sum(without_repeats(trajectory) for trajectory in both)
    return sync.associate_trajectories(*both), left_out


def by_evo(pair, metric, alignment):
    from evo import main_ape, main_rpe
    from evo.core.metrics import PoseRelation, Unit
    align, scale = ALIGNMENTS[alignment]
    first, second = (copy.deepcopy(trajectory) for trajectory in pair)
    if metric == "rpe":
        result = main_rpe.rpe(first, second, pose_relation=PoseRelation.translation_part, delta=1.0, delta_unit=Unit.frames, align=align, correct_scale=scale)
    else:
        part = PoseRelation.translation_part if metric == "ape" else PoseRelation.rotation_angle_deg
        result = main_ape.ape(first, second, pose_relation=part, align=align, correct_scale=scale)
    return float(result.stats["mean" if metric == "rotation" else "rmse"])


def by_realgap(realgap, first, second, metric, alignment, options):
    done = subprocess.run([realgap, "compare", str(first), str(second), "--metric", metric, "--align", alignment, "--format", "json",
                           *options], capture_output=True, text=True)
    if done.returncode:
        return None, done.stderr.strip()
    row = json.loads(done.stdout)[0]
    return row, row[METRICS[metric]]


def synthetic(folder):
    """Pairs that start apart, with different rates, in other frames, with another scale, with epochs and with gaps."""
    import numpy as np
    random = np.random.default_rng(51)

    def write(name, stamps, position, yaw):
        rows = [[t, *position(t), 0.0, 0.0, np.sin(yaw(t) / 2), np.cos(yaw(t) / 2)] for t in stamps]
        np.savetxt(folder / name, np.array(rows), fmt="%.9f")

    def place(t):
        t = t % 1000.0
        return [0.4 * t + 0.3 * np.sin(0.9 * t), np.sin(0.5 * t), 0.1 * np.cos(1.3 * t)]

    def turned(t):
        x, y, z = place(t)
        return [2.0 - 0.5 * y + 0.02 * np.sin(3 * t), 0.5 * x, 0.5 * z - 1.0]

    start = 1_700_000_000.0
    gaps = np.array([t for t in np.arange(3.0, 25.0, 0.033) if not 9.0 < t < 12.0])
    late = gaps + 0.004
    jitter = np.sort(np.arange(0.0, 20.0, 0.05) + random.uniform(0.0, 0.02, 400))
    write("whole.tum", start + np.arange(0.0, 20.0, 0.02), place, np.sin)
    write("later.tum", start + np.arange(7.0, 30.0, 0.033), turned, lambda t: 0.3 + np.sin(t))
    write("gaps.tum", start + gaps, turned, np.cos)
    write("late.tum", start + late, place, np.sin)
    write("jitter.tum", start + jitter, turned, lambda t: 1.2 * np.sin(t))
    write("equal.tum", start + np.arange(0.0, 20.0, 0.02) + 0.0099, place, np.cos)
    names = ["later", "gaps", "late", "jitter", "equal"]
    pairs = [("whole.tum", f"{name}.tum", "tum", []) for name in names]
    return pairs + [("later.tum", "jitter.tum", "tum", []), ("gaps.tum", "whole.tum", "tum", [])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--realgap", default="realgap")
    parser.add_argument("--folder", type=Path, help="where evo's source package is, or is downloaded to")
    parser.add_argument("--synthetic", action="store_true", help="only the synthetic pairs, without a download")
    asked = parser.parse_args()
    try:
        import evo
    except ImportError:
        skip("evo is not installed (pip install evo)")
    worst, pairs = 0.0, []
    with tempfile.TemporaryDirectory() as temporary:
        made = Path(temporary)
        pairs += [(made / first, made / second, *rest) for first, second, *rest in synthetic(made)]
        if not asked.synthetic:
            if asked.folder:
                asked.folder.mkdir(parents=True, exist_ok=True)
            data = test_files(asked.folder or made, evo.__version__.lstrip("v"))
            pairs += [(data / first, data / second, *rest) for first, second, *rest in PAIRS]
        print(f"{'reference':30} {'other':38} {'metric':9} {'align':5} {'evo':>16} {'realgap':>16} {'difference':>10}")
        for first, second, form, options in pairs:
            try:
                pair, left_out = read_pair(str(first), str(second), form)
            except Exception as error:  # A file that this evo cannot read is said, and is no difference.
                print(f"SKIPPED {first.name} {second.name}: evo says {error}")
                continue
            for metric in METRICS:
                for alignment in ALIGNMENTS:
                    theirs = by_evo(pair, metric, alignment)
                    row, ours = by_realgap(asked.realgap, first, second, metric, alignment, options)
                    if row is None:
                        print(f"{first.name:30} {second.name:38} {metric:9} {alignment:5} {theirs:16.9f} refused: {ours}")
                        worst = float("inf")
                        continue
                    difference = abs(ours - theirs) / max(1.0, abs(theirs))
                    worst = max(worst, difference)
                    note = f"  ({left_out} repeated stamps left out)" if left_out else ""
                    note += "" if row["matched"] == pair[0].num_poses else f"  {row['matched']} of {pair[0].num_poses} matched"
                    print(f"{first.name:30} {second.name:38} {metric:9} {alignment:5} {theirs:16.9f} {ours:16.9f} {difference:10.1e}{note}")
    print(f"evo {evo.__version__}: {len(pairs)} pairs, largest difference {worst:.1e} (allowed {LARGEST:.0e})")
    sys.exit(worst > LARGEST)


if __name__ == "__main__":
    main()
