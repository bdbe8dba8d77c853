//! The shipped examples, inside of the program: who has installed it needs no copy of the repository.

/// A file by its folder and name, with what is in it.
type Shipped = (&'static str, &'static str, &'static [u8]);

macro_rules! shipped {
    ($($folder:literal: $($name:literal)*;)*) => {
        &[$($(($folder, $name, include_bytes!(concat!("../../", $folder, "/", $name)).as_slice()),)*)*]
    };
}

/// By path; a test holds the list to what is there. Of the recordings those of the first commands, to keep the program small; the
/// others stay in the repository.
const SHIPPED: &[Shipped] = shipped![
    "arenas": "cartons.ron" "flat.ron" "paper000.ron" "pen.ron";
    "controllers": "tripod_avoid.ron" "two_tripods.ron";
    "morphologies": "chain3.ron" "chain30.ron" "chain5.ron" "cube.ron" "double_pendulum.ron" "elbow.ron" "push_cube.ron" "servo_pendulum.ron"
        "so101_arm.ron" "so101_feetech.ron" "spider8.ron" "tripod.ron" "turtlebot3_burger.ron" "two_module.ron" "unitree_a1.ron";
    "radios": "paper002.ron";
    "real_trajectories/cube_tosses": "README.md" "meta.ron" "toss_003.csv" "toss_015.csv" "toss_026.csv" "toss_037.csv"
        "toss_051.csv" "toss_063.csv" "toss_074.csv" "toss_086.csv" "toss_101.csv" "toss_112.csv" "toss_133.csv"
        "toss_147.csv" "toss_161.csv" "toss_175.csv" "toss_190.csv" "toss_205.csv" "toss_217.csv" "toss_231.csv"
        "toss_247.csv" "toss_257.csv" "toss_278.csv" "toss_288.csv" "toss_306.csv" "toss_318.csv" "toss_333.csv"
        "toss_347.csv" "toss_361.csv" "toss_381.csv" "toss_396.csv" "toss_408.csv" "toss_419.csv" "toss_433.csv"
        "toss_450.csv" "toss_465.csv" "toss_478.csv" "toss_496.csv" "toss_511.csv" "toss_530.csv" "toss_544.csv"
        "toss_554.csv";
    "real_trajectories/so101_arm_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "real_trajectories/tripod_mujoco": "README.md" "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv" "run_03.csv" "run_04.csv"
        "run_05.csv" "run_06.csv" "run_07.csv" "run_08.csv" "run_09.csv";
    "real_trajectories/tripod_standin": "README.md" "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv" "run_03.csv"
        "run_04.csv" "run_05.csv" "run_06.csv" "run_07.csv" "run_08.csv" "run_09.csv";
    "real_trajectories/turtlebot3_burger_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "real_trajectories/two_wheel_runs": "README.md" "meta.ron" "runs.csv";
    "real_trajectories/unitree_a1_standin": "meta.ron" "run_00.csv" "run_01.csv" "run_02.csv";
    "scenes": "pen.ron" "room.ron";
    "sensors": "infrared.ron" "infrared_maker.ron" "laser.ron" "ultrasonic.ron";
    "sweeps": "best_robot.ron" "best_tripod_gait.ron" "cube_push_best.ron" "cube_push_fit.ron" "cube_toss.ron"
        "cube_toss_best.ron" "cube_toss_fit.ron" "double_pendulum_best.ron" "double_pendulum_fit.ron" "elbow_toss_best.ron" "elbow_toss_fit.ron" "fleet_floor.ron" "servo_xl330_best.ron"
        "servo_xl330_fit.ron" "so101_arm.ron" "so101_best.ron" "so101_fit.ron" "tripod_floor.ron" "tripod_self.ron" "turtlebot3_burger.ron" "two_wheel_ir.ron" "two_wheel_ir_bayesian.ron"
        "two_wheel_sensor.ron" "two_wheel_us1.ron" "two_wheel_us_bayesian.ron" "unitree_a1.ron";
    "vehicles": "two_wheel.ron";
];

/// Every file by its path.
pub fn files() -> impl Iterator<Item = (String, &'static [u8])> {
    let path = |folder, name| format!("{folder}/{name}");
    let all = SHIPPED.iter();
    all.map(move |(folder, name, bytes)| (path(folder, name), *bytes))
}
