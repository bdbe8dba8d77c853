//! The shipped examples, compiled into the program, so that users need no copy of the repository.

/// A file by its folder and name, with what is in it.
type Shipped = (&'static str, &'static str, &'static [u8]);

macro_rules! shipped {
    ($($folder:literal: $($name:literal)*;)*) => {
        &[$($(($folder, $name, include_bytes!(concat!("../../", $folder, "/", $name)).as_slice()),)*)*]
    };
}

/// The files by folder. A test checks that the list is complete: all files of these folders, and all recordings that a shipped study
/// or a command in the docs reads.
const SHIPPED: &[Shipped] = shipped![
    "arenas": "bumps.csv" "bumps.ron" "cartons.ron" "flat.ron" "paper000.ron" "pen.ron" "step.ron";
    "controllers": "tripod_avoid.ron" "two_tripods.ron";
    "genomes": "three_modules.ron";
    "morphologies": "chain3.ron" "chain30.ron" "chain5.ron" "cube.ron" "dart_car.ron" "double_pendulum.ron" "elbow.ron" "push_cube.ron" "servo_pendulum.ron"
        "so101_arm.ron" "so101_feetech.ron" "spider8.ron" "tripod.ron" "turtlebot3_burger.ron" "two_module.ron" "unitree_a1.ron" "unitree_go2.ron"
        "worm4.ron";
    "radios": "paper002.ron";
    "real_trajectories/cube_pushes": "README.md" "meta.ron" "push_01.csv" "push_02.csv" "push_04.csv" "push_06.csv"
        "push_09.csv" "push_12.csv" "push_13.csv" "push_14.csv" "push_16.csv" "push_17.csv" "push_18.csv"
        "push_19.csv";
    "real_trajectories/cube_tosses": "README.md" "meta.ron" "toss_003.csv" "toss_015.csv" "toss_026.csv" "toss_037.csv"
        "toss_051.csv" "toss_063.csv" "toss_074.csv" "toss_086.csv" "toss_101.csv" "toss_112.csv" "toss_133.csv"
        "toss_147.csv" "toss_161.csv" "toss_175.csv" "toss_190.csv" "toss_205.csv" "toss_217.csv" "toss_231.csv"
        "toss_247.csv" "toss_257.csv" "toss_278.csv" "toss_288.csv" "toss_306.csv" "toss_318.csv" "toss_333.csv"
        "toss_347.csv" "toss_361.csv" "toss_381.csv" "toss_396.csv" "toss_408.csv" "toss_419.csv" "toss_433.csv"
        "toss_450.csv" "toss_465.csv" "toss_478.csv" "toss_496.csv" "toss_511.csv" "toss_530.csv" "toss_544.csv"
        "toss_554.csv";
    "real_trajectories/dart_car": "README.md" "meta.ron" "rubber_free_02.csv" "rubber_free_03.csv" "rubber_ramps_03.csv"
        "rubber_ramps_06.csv" "tiles_circles_01.csv";
    "real_trajectories/double_pendulum": "README.md" "acrobot_ilqr_tvlqr_lqr_01.csv" "meta.ron"
        "pendubot_ilqr_tvlqr_lqr_01.csv";
    "real_trajectories/elbow_tosses": "README.md" "meta.ron" "toss_002.csv" "toss_022.csv" "toss_041.csv"
        "toss_074.csv" "toss_101.csv" "toss_122.csv" "toss_143.csv" "toss_173.csv" "toss_192.csv" "toss_214.csv"
        "toss_235.csv" "toss_259.csv" "toss_299.csv" "toss_333.csv" "toss_376.csv" "toss_401.csv" "toss_425.csv"
        "toss_455.csv" "toss_479.csv" "toss_506.csv";
    "real_trajectories/fleet_mujoco": "README.md";
    "real_trajectories/fleet_mujoco/random_0005": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0009": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0014": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0022": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0030": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0041": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0046": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0050": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0058": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0065": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0068": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0072": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0089": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0091": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0107": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0108": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0119": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0120": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0135": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0153": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0157": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0159": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0186": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0197": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0210": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0211": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0216": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0217": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0218": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/fleet_mujoco/random_0224": "meta.ron" "robot.ron" "run_00.csv" "run_01.csv";
    "real_trajectories/radio_flat": "README.md" "poses.csv" "scans.csv";
    "real_trajectories/servo_pendulum": "README.md" "kp100_lift_and_drop.csv" "kp100_sin_time_square.csv"
        "kp200_lift_and_drop.csv" "kp200_sin_time_square.csv" "kp800_lift_and_drop.csv" "kp800_sin_time_square.csv"
        "meta.ron";
    "real_trajectories/so101_arm": "README.md" "meta.ron" "ramp_motion.csv" "random_waypoints.csv"
        "slow_precision.csv" "staircase_motion.csv";
    "real_trajectories/so101_arm_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "real_trajectories/tripod_mujoco": "README.md" "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv" "run_03.csv" "run_04.csv"
        "run_05.csv" "run_06.csv" "run_07.csv" "run_08.csv" "run_09.csv";
    "real_trajectories/tripod_standin": "README.md" "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv" "run_03.csv"
        "run_04.csv" "run_05.csv" "run_06.csv" "run_07.csv" "run_08.csv" "run_09.csv";
    "real_trajectories/turtlebot3_burger_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "real_trajectories/two_wheel_runs": "README.md" "meta.ron" "runs.csv";
    "real_trajectories/unitree_a1_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "real_trajectories/unitree_go2": "LICENSE" "README.md" "chirp_early.csv" "chirp_late.csv" "meta.ron";
    "real_trajectories/worm4_mujoco": "README.md" "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv" "run_03.csv"
        "run_04.csv" "run_05.csv" "run_06.csv" "run_07.csv" "run_08.csv" "run_09.csv";
    "scenes": "pen.ron" "room.ron";
    "sensors": "infrared.ron" "infrared_maker.ron" "laser.ron" "ultrasonic.ron";
    "sweeps": "best_robot.ron" "best_tripod_gait.ron" "best_worm.ron" "cube_push_best.ron" "cube_push_fit.ron"
        "cube_toss.ron" "cube_toss_best.ron" "cube_toss_fit.ron" "dart_car_best.ron" "dart_car_fit.ron" "double_pendulum_best.ron" "double_pendulum_fit.ron"
        "elbow_toss_best.ron" "elbow_toss_fit.ron" "fleet_floor.ron" "go2_fit.ron" "robot_grid.ron" "servo_xl330_best.ron"
        "servo_xl330_fit.ron" "so101_arm.ron" "so101_best.ron" "so101_fit.ron" "tripod_floor.ron" "tripod_self.ron"
        "turtlebot3_burger.ron" "two_wheel_ir.ron" "two_wheel_ir_bayesian.ron" "two_wheel_sensor.ron"
        "two_wheel_us1.ron" "two_wheel_us_bayesian.ron" "unitree_a1.ron" "worm_slope.ron";
    "vehicles": "two_wheel.ron";
];

/// Every file by its path.
pub fn files() -> impl Iterator<Item = (String, &'static [u8])> {
    let path = |folder, name| format!("{folder}/{name}");
    let all = SHIPPED.iter();
    all.map(move |(folder, name, bytes)| (path(folder, name), *bytes))
}
