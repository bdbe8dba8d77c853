"""MuJoCo as the simulator of a study: fields by name, commands, starts, and a fit that recovers them."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import realgap

pytest.importorskip("mujoco", reason="SKIPPED: MuJoCo is not installed")

from realgap.mujoco import MujocoModel  # noqa: E402

ARM = """<mujoco>
  <option timestep="0.002" gravity="0 0 -9.81"/>
  <default><joint axis="0 1 0" damping="0.02"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1" pos="0 0 -1"/>
    <body name="upper">
      <joint name="hip"/><geom name="rod" type="capsule" size=".01" fromto="0 0 0 0 0 -.3" contype="0" conaffinity="0"/>
      <body name="lower" pos="0 0 -.3">
        <joint name="knee"/><geom type="capsule" size=".01" fromto="0 0 0 0 0 -.2" contype="0" conaffinity="0"/>
        <site name="foot" pos="0 0 -.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="hip_servo" joint="hip" kp="2" kv="0.1"/><motor name="knee_motor" joint="knee" gear="2"/></actuator>
  <sensor><jointpos name="hip_sensor" joint="hip"/></sensor>
</mujoco>"""

TIMES_S = [0.01 * k for k in range(101)]


@pytest.fixture
def arm(tmp_path: Path) -> str:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    return str(path)


def asked(parameters: dict, **more: object) -> realgap.Question:
    start = {"hip_rad": 0.4, "knee_rad": -0.2}
    return realgap.Question(parameters=parameters, times_s=TIMES_S, duration_s=1.0, start=start, **more)


def test_fields_have_the_model_s_names_units_and_values(arm: str):
    declared = MujocoModel(arm, ["joint.*.damping", "body.lower.mass", "geom.floor.friction[1]"]).declares()
    assert list(declared) == ["joint.*.damping", "body.lower.mass", "geom.floor.friction[1]"]
    assert declared["joint.*.damping"]["default"] == 0.02
    assert declared["joint.*.damping"]["unit"] == "N m s/rad"
    assert declared["geom.floor.friction[1]"]["default"] == 0.005
    assert len(MujocoModel(arm).declares()) > 30


def test_a_name_that_does_not_exist_is_an_error_with_suggestions(arm: str):
    with pytest.raises(SystemExit, match="joint.knee.damping"):
        MujocoModel(arm, ["joint.kneee.damping"])
    words = [sys.executable, "-m", "realgap.mujoco", arm, "--parameter", "joint.kneee.damping"]
    ended = subprocess.run(words, input="", capture_output=True, text=True)
    assert ended.returncode != 0 and "joint.knee.damping" in ended.stderr


def test_runs_start_from_recordings_and_repeat_their_bits(arm: str):
    model = MujocoModel(arm, ["joint.*.damping"], track="foot")
    first, again = model(asked({"joint.*.damping": 0.05})), model(asked({"joint.*.damping": 0.05}))
    assert first == again
    assert first["hip_rad"][0] == 0.4 and first["hip_sensor"][0] == 0.4
    assert first["x_m"][0] == pytest.approx(-0.3 * math.sin(0.4) - 0.2 * math.sin(0.2))
    other = model(asked({"joint.*.damping": 0.1}))
    assert other["hip_rad"][-1] != first["hip_rad"][-1]
    assert model(asked({"joint.*.damping": 0.05})) == first


def test_an_encoder_s_zero_moves_what_is_read_and_what_is_commanded(arm: str):
    model = MujocoModel(arm, ["joint.hip.zero"])
    commands = {"commands": {"hip_command_rad": [0.5]}, "command_times_s": [0.0]}
    moved = asked({"joint.hip.zero": 0.1}, **commands)
    moved.start["hip_rad"] = 0.5
    moved.commands["hip_command_rad"] = [0.6]
    still = model(asked({"joint.hip.zero": 0.0}, **{"commands": {"hip_command_rad": [0.5]}, "command_times_s": [0.0]}))
    shifted = model(moved)
    assert np.allclose(np.array(shifted["hip_rad"]) - 0.1, still["hip_rad"], atol=1e-12)


def test_motors_follow_angles_through_a_controller_and_say_so_without_one(arm: str):
    commands = {"commands": {"knee_command_rad": [0.3], "hip_command_rad": [0.0]}, "command_times_s": [0.0]}
    with pytest.raises(ValueError, match="--pd"):
        MujocoModel(arm, ["body.lower.mass"])(asked({}, **commands))
    model = MujocoModel(arm, ["pd.kp"], pd=(3.0, 0.1))
    knee = model(asked({"pd.kp": 30.0}, **commands))["knee_rad"]
    assert abs(knee[-1] - 0.3) < 0.02
    with pytest.raises(ValueError, match="hip_servo"):
        model(asked({}, commands={"hip_serv_command_rad": [0.0]}, command_times_s=[0.0]))


def test_a_parameter_that_changes_nothing_is_found_by_the_first_question(arm: str):
    model = MujocoModel(arm, ["joint.hip.damping", "geom.floor.friction"])
    with pytest.raises(ValueError, match="geom.floor.friction: another value changes no channel"):
        model(asked({}, id=1))
    model(asked({}, id=2))
    MujocoModel(arm, ["geom.floor.friction"], probe=False)(asked({}, id=1))


def test_a_study_names_a_model_and_recovers_a_damping_and_a_mass(arm: str, tmp_path: Path):
    run = MujocoModel(arm, ["joint.*.damping", "body.lower.mass"])(
        asked({"joint.*.damping": 0.03, "body.lower.mass": 0.1})
    )
    random = np.random.default_rng(1)
    noisy = [np.array(run[name]) + random.normal(0.0, 1e-3, len(TIMES_S)) for name in ("hip_rad", "knee_rad")]
    table = np.column_stack([TIMES_S, *noisy])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header="t_s,hip_rad,knee_rad", comments="")
    python = '"' + sys.executable.replace("\\", "\\\\") + '"'
    (tmp_path / "study.ron").write_text(f"""(
        simulator: MujocoModel(model: "arm.xml", python: {python}),
        recordings: ["run.csv"],
        start: FromRecording,
        metric: "joints",
        parameters: [
            (name: "joint.*.damping", from: 0.01, to: 0.06, points: 6),
            (name: "body.lower.mass", from: 0.05, to: 0.2, points: 7),
        ],
    )""")
    study = realgap.Study.read(tmp_path / "study.ron", allow_command=True)
    best = study.sweep().best
    assert abs(best["sim.joint.*.damping"] - 0.03) < 0.011
    assert abs(best["sim.body.lower.mass"] - 0.1) < 0.026
    (tmp_path / "study.ron").write_text((tmp_path / "study.ron").read_text().replace("lower", "lowr"))
    with pytest.raises(realgap.InvalidError, match="body.lower.mass"):
        realgap.Study.read(tmp_path / "study.ron", allow_command=True)


CUBE = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
  <body name="cube" pos="0 0 1"><freejoint/><geom name="box" type="box" size=".05 .05 .05" mass=".4"/></body>
</worldbody></mujoco>"""


def test_a_centre_of_mass_and_an_inertia_that_the_model_leaves_simple_change_the_run(tmp_path: Path):
    (tmp_path / "cube.xml").write_text(CUBE)
    names = ["body.cube.inertia*", "body.cube.ipos[2]", "body.cube.mass", "geom.*.friction"]
    model = MujocoModel(str(tmp_path / "cube.xml"), names)
    # A tie of three equal moments; the mass is set before them, whatever the order of the names.
    moment = 0.4 * 0.1**2 / 6
    own = {"body.cube.inertia*": moment, "body.cube.ipos[2]": 0.0, "body.cube.mass": 0.4, "geom.*.friction": 1.0}
    assert model.declares()["body.cube.inertia*"]["default"] == pytest.approx(moment)
    assert model.body_length_m() == pytest.approx(0.1)
    start = {"z_m": 0.5, "qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0, "wx_rad_s": 3.0}

    def run(**changed: float) -> dict:
        values = {**own, **changed}
        return model(realgap.Question(parameters=values, times_s=[0.0, 0.1, 0.2], duration_s=0.2, start=start, id=2))

    middle = run()
    # Free fall: the middle of a cube that turns about itself falls as a stone does, and one whose centre is off it does not.
    fall_m = 0.5 * 9.81 * 0.2**2
    assert middle["z_m"][-1] == pytest.approx(0.5 - fall_m, abs=3e-3)
    # The middle turns about a centre 2 cm above it, which moves at w times that arm: for small angles y = a (w t - sin w t).
    moved = run(**{"body.cube.ipos[2]": 0.02})
    assert abs(moved["y_m"][-1] - middle["y_m"][-1]) == pytest.approx(0.02 * (0.6 - math.sin(0.6)), rel=0.05)
    again = run(**{"body.cube.mass": 0.8})
    # Without contact neither mass nor inertia changes a fall; the stated inertia holds beside another mass.
    assert again["z_m"][-1] == pytest.approx(middle["z_m"][-1], abs=1e-9)
    assert float(model.model.body_inertia[1][0]) == pytest.approx(moment)


def test_a_delay_shorter_than_a_step_moves_a_command_by_its_share(arm: str):
    model = MujocoModel(arm, ["command.delay"])
    commands = {"knee_command_nm": [0.0] * 20 + [0.01] * 81}

    def end(delay_s: float) -> float:
        question = asked({"command.delay": delay_s}, commands=commands, command_times_s=TIMES_S, setting={"timestep": 0.002}, id=2)
        return model(question)["knee_rad"][25]

    none, half, whole = end(0.0), end(0.001), end(0.002)
    assert none != half != whole
    assert half == pytest.approx(0.5 * (none + whole), abs=0.02 * abs(none - whole))


def test_a_description_names_joints_actuators_and_keyframes(arm: str):
    said = MujocoModel(arm).describe()
    assert [joint["name"] for joint in said["joints"]] == ["hip", "knee"]
    assert [joint["drive"] for joint in said["joints"]] == ["position", "motor"]
    assert said["joints"][1]["actuator"] == "knee_motor" and said["joints"][1]["limit"] is None
    assert said["free_joints"] == 0 and said["keyframes"] == []
    assert said["fields"]["joint.hip.damping"] == {"value": 0.02, "unit": "N m s/rad"}
