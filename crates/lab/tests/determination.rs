//! Which parameters recordings of joints determine, before anything is fitted.

use realgap_lab::calibration::{Determination, Overrides, Study};
use realgap_optimization::RunOptions;

use crate::joint_log::{SPRING, logged, robot, study};

/// What a log tells about these parameters; `sizes` multiply the commands of the joints.
fn told(sizes: [f64; 2], parameters: &str, jobs: usize) -> Determination {
    let folder = logged(&robot(SPRING), sizes);
    let more = format!("commands: Commands(), parameters: [{parameters}]");
    let study = Study::read(study(folder.path(), &more), &Overrides::default()).unwrap();
    let run = RunOptions {
        jobs,
        ..RunOptions::default()
    };
    study.determination(&run).unwrap()
}

const STIFFNESS: &str = r#"(name: "servo.pitch.stiffness_nm_rad", from: 4, to: 16),
    (name: "servo.elbow.stiffness_nm_rad", from: 4, to: 16),
    (name: "joint.pitch.zero_rad", from: -0.1, to: 0.1)"#;

#[test]
fn a_joint_that_rests_tells_less_of_its_servo_and_moving_it_farther_tells_more() {
    let both = told([1.0, 1.0], STIFFNESS, 1);
    assert!(
        both.parameters.iter().all(|one| one.is_determined),
        "{both:?}"
    );
    let half = |found: &Determination, name: &str| {
        let mut all = found.parameters.iter();
        let one = all.find(|one| one.parameter == name).unwrap();
        one.half_width
    };
    let elbow = "servo.elbow.stiffness_nm_rad";
    let resting = told([1.0, 0.0], STIFFNESS, 1);
    assert!(half(&resting, elbow) > 2.0 * half(&both, elbow));
    // The best known comes first.
    let shares: Vec<f64> = both
        .parameters
        .iter()
        .map(|one| one.share_of_range)
        .collect();
    assert!(shares.windows(2).all(|w| w[0] <= w[1]), "{shares:?}");
    let motion = |part: &str| {
        let mut all = both.further.iter();
        all.find(|motion| motion.motion.contains(part))
            .unwrap()
            .bits
    };
    assert!(
        motion("1.5 times") > motion("half as far"),
        "{:?}",
        both.further
    );
    assert!(motion("once more") > 0.0);
    assert_eq!(both, told([1.0, 1.0], STIFFNESS, 2));
}

#[test]
fn parameters_that_only_act_together_trade_and_are_named() {
    let all = r#"(name: "servo.pitch.stiffness_nm_rad", from: 4, to: 16),
        (name: "joint.pitch.delay_s", from: 0, to: 0.1),
        (name: "servo.*.damping_nm_s_rad", from: 0.1, to: 1),
        (name: "hinge.*.viscous_nm_s_rad", from: 0, to: 1)"#;
    let found = told([1.0, 1.0], all, 1);
    let of = |name: &str| {
        let mut all = found.parameters.iter();
        all.find(|one| one.parameter == name).unwrap()
    };
    let trade = of("hinge.*.viscous_nm_s_rad").trade.as_ref().unwrap();
    assert_eq!(trade.parameter, "servo.*.damping_nm_s_rad");
    assert!(trade.correlation < -0.8, "{trade:?}");
    let text = found.to_string();
    assert!(
        text.contains("what further recordings would tell"),
        "{text}"
    );
}
