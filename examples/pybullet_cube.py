"""A cube in PyBullet as the simulator of a study, e.g. of the tosses in real_trajectories/cube_tosses (docs/simulator.md)."""

import pybullet as bullet
import realgap

SIDE_M, MASS_KG, STEP_S = 0.1048, 0.37, 1.0 / 592.0
DECLARES = {
    "friction": (0.0, 1.0, 0.3, "1"),
    "restitution": (0.0, 1.0, 0.1, "1"),
}


def toss(question):
    """One run: the cube starts as it was recorded, and is let go."""
    values, start = question.parameters, question.start
    step_s = STEP_S * question.setting["share"]
    bullet.resetSimulation()
    bullet.setGravity(0, 0, -9.81)
    bullet.setTimeStep(step_s)
    bullet.setPhysicsEngineParameter(deterministicOverlappingPairs=1)
    floor = bullet.createMultiBody(0, bullet.createCollisionShape(bullet.GEOM_PLANE))
    shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[SIDE_M / 2] * 3)
    turn = [start[name] for name in ("qx", "qy", "qz", "qw")]
    cube = bullet.createMultiBody(MASS_KG, shape, -1, [start[f"{axis}_m"] for axis in "xyz"], turn)
    for body in (floor, cube):
        # PyBullet multiplies the values of both bodies.
        bullet.changeDynamics(body, -1, lateralFriction=values["friction"] ** 0.5, restitution=values["restitution"] ** 0.5)
        bullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
    # Recorded angular velocities are in the body's frame, and PyBullet's are in the world's.
    spin = bullet.rotateVector(turn, [start[f"w{axis}_rad_s"] for axis in "xyz"])
    bullet.resetBaseVelocity(cube, [start[f"v{axis}_m_s"] for axis in "xyz"], spin)
    rows, time_s = [], 0.0
    while True:
        place, (qx, qy, qz, qw) = bullet.getBasePositionAndOrientation(cube)
        rows.append((time_s, *place, qw, qx, qy, qz))
        if time_s >= question.times_s[-1]:
            names = ("t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
            return dict(zip(names, zip(*rows)))
        bullet.stepSimulation()
        time_s += step_s


if __name__ == "__main__":
    bullet.connect(bullet.DIRECT)
    realgap.serve(
        toss,
        DECLARES,
        # Settings that may be exchanged: the timestep, a half and a quarter of it.
        settings=[{"share": 1.0}, {"share": 0.5}, {"share": 0.25}],
        name="pybullet",
        version=str(bullet.getAPIVersion()),
        body_length_m=SIDE_M,
    )
