//! Tests of servos with motor and gear against closed-form solutions, with both formulations of joints.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::TAU;

use realgap_core::file::Source;
use realgap_path::trajectory::JointTrack;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, JointFormulation, Sampling};

use crate::change::{Change as _, film};

const KINDS: [JointFormulation; 2] = [JointFormulation::Multibody, JointFormulation::Impulse];
const G: f64 = 9.81;
/// A weight of half a kilogram on an arm of ten centimetres.
const MASS_KG: f64 = 0.5;
const ARM_M: f64 = 0.1;
const SIDE_M: f64 = 0.04;
const INERTIA_KG_M2: f64 = MASS_KG * (ARM_M * ARM_M + SIDE_M * SIDE_M / 6.0);
const KT: f64 = 0.4;
const OHM: f64 = 3.2;
const VOLT: f64 = 7.2;
/// kt V / R, N m.
const STALL_NM: f64 = KT * VOLT / OHM;

/// The pendulum with a motor; `rest` states additional fields of its law.
fn pendulum(rest: &str) -> Experiment {
    let text = format!(
        r#"(
        name: "pendulum",
        mount_m: (0, 0, 1),
        modules: [
            (name: "stand", kind: Passive(side_m: 0.05, mass_kg: 1)),
            (name: "weight", kind: Passive(side_m: {SIDE_M}, mass_kg: {MASS_KG})),
        ],
        hinges: [(name: "shaft", parent: "stand", child: "weight", anchor_m: (0, 0.05, 0), child_anchor_m: (0, 0, {ARM_M}),
            axis: (0, 1, 0), servo: (max_torque_nm: 10, law: Motor(position_gain: 800, duty_1_rad: 0.003, supply_v: {VOLT},
                torque_constant_nm_a: {KT}, resistance_ohm: {OHM}{rest})))],
    )"#
    );
    let robot =
        Morphology::parse(&Source::new("pendulum.ron", text)).unwrap_or_else(|e| panic!("{e}"));
    // A written robot is read back to an equal value.
    let again = Morphology::parse(&Source::new("again.ron", robot.to_ron().unwrap()));
    assert_eq!(again.unwrap(), robot);
    let mut experiment = Experiment::new(robot.assemble());
    experiment.sampling = Sampling::Rate(1000.0);
    experiment.duration_s = 1.0;
    experiment
}

fn speeds(track: &JointTrack) -> &[f64] {
    track.speeds_rad_s.as_deref().unwrap()
}

fn close(measured: f64, expected: f64, share: f64, what: &str) {
    let error = (measured / expected - 1.0).abs();
    assert!(error < share, "{what}: {measured} is not {expected}");
}

#[test]
fn at_full_duty_the_arm_rises_until_its_weight_balances_the_stall_torque() {
    for kind in KINDS {
        // The supply is so weak that the motor cannot lift the arm all the way.
        let (volt, viscous) = (2.0, 0.05);
        let robot = pendulum(&format!(", friction: (viscous_nm_s_rad: {viscous})"))
            .with_commands(&[0.0], &[5.0], None)
            .from(0.0, 0.0)
            .set("servo.supply_v", volt)
            .joined(kind)
            .lasting(4.0);
        let (_, joint) = film(&robot);
        let expected = (KT * volt / OHM / (MASS_KG * G * ARM_M)).asin();
        close(
            *joint.angles_rad.last().unwrap(),
            expected,
            1e-3,
            &format!("{kind:?}"),
        );
    }
}

#[test]
fn without_load_the_speed_follows_from_supply_back_emf_and_friction() {
    for kind in KINDS {
        for dry in [0.0, 0.1] {
            let robot = pendulum(&format!(", friction: (dry_nm: {dry})"))
                .weightless()
                .with_commands(&[0.0, 1.0], &[1.0, 1000.0], None)
                .from(0.0, 0.0)
                .joined(kind)
                .lasting(1.0);
            let (_, joint) = film(&robot);
            let expected = (VOLT - dry * OHM / KT) / KT;
            close(
                *speeds(&joint).last().unwrap(),
                expected,
                2e-3,
                &format!("{kind:?} {dry}"),
            );
        }
    }
}

#[test]
fn a_switched_off_servo_slows_down_by_coulomb_and_viscous_friction() {
    let speed = 10.0;
    for kind in KINDS {
        let dry = 0.05;
        let robot = pendulum(&format!(
            ", armature_kg_m2: 0.002, friction: (dry_nm: {dry})"
        ))
        .weightless()
        .off()
        .from(0.0, speed)
        .joined(kind)
        .lasting(3.0);
        let (times, joint) = film(&robot);
        let inertia = INERTIA_KG_M2 + 0.002;
        let still = speeds(&joint).iter().position(|w| w.abs() < 1e-2).unwrap();
        close(
            times[still],
            inertia * speed / dry,
            5e-3,
            &format!("{kind:?} time"),
        );
        let turned = inertia * speed * speed / (2.0 * dry);
        close(
            *joint.angles_rad.last().unwrap(),
            turned,
            5e-3,
            &format!("{kind:?} angle"),
        );

        let viscous = 0.02;
        let robot = pendulum(&format!(", friction: (viscous_nm_s_rad: {viscous})"))
            .weightless()
            .off()
            .from(0.0, speed)
            .joined(kind)
            .lasting(0.5);
        let (times, joint) = film(&robot);
        for (time, measured) in times.iter().zip(speeds(&joint)) {
            let expected = speed * (-viscous * time / INERTIA_KG_M2).exp();
            assert!(
                (measured - expected).abs() < 0.01 * speed,
                "{kind:?} {time}: {measured}, {expected}"
            );
        }
    }
}

#[test]
fn the_armature_lengthens_the_period_of_the_free_swing() {
    for kind in KINDS {
        for armature in [0.0, 0.001, 0.003] {
            let amplitude: f64 = 0.1;
            let robot = pendulum(&format!(", armature_kg_m2: {armature}"))
                .off()
                .from(amplitude, 0.0)
                .joined(kind)
                .lasting(4.0);
            let (times, joint) = film(&robot);
            let downs: Vec<f64> = (1..times.len())
                .filter(|&k| joint.angles_rad[k - 1] > 0.0 && joint.angles_rad[k] <= 0.0)
                .map(|k| {
                    let (a, b) = (joint.angles_rad[k - 1], joint.angles_rad[k]);
                    times[k - 1] + a / (a - b) * (times[k] - times[k - 1])
                })
                .collect();
            let measured = (downs[4] - downs[0]) / 4.0;
            let small = TAU * ((INERTIA_KG_M2 + armature) / (MASS_KG * G * ARM_M)).sqrt();
            let expected = small * (1.0 + amplitude * amplitude / 16.0);
            close(measured, expected, 2e-3, &format!("{kind:?} {armature}"));
        }
    }
}

#[test]
fn a_dead_time_shifts_the_response_and_changes_nothing_else() {
    let times: Vec<f64> = (0..=200).map(|k| f64::from(k) * 0.01).collect();
    let angles: Vec<f64> = times
        .iter()
        .map(|t| 0.5 * (1.0 - (4.0 * t).cos()))
        .collect();
    for kind in KINDS {
        let robot = |dead: f64| {
            // The dead time is a whole number of steps, so that the shift is a whole number of samples.
            pendulum(", friction: (viscous_nm_s_rad: 0.02)")
                .weightless()
                .with_commands(&times, &angles, None)
                .from(0.0, 0.0)
                .set("servo.latency_s", dead)
                .set("timestep_s", 0.001)
                .joined(kind)
                .lasting(1.5)
        };
        let (_, prompt) = film(&robot(0.0));
        let (_, late) = film(&robot(0.02));
        for k in 100..1400 {
            let shift = (late.angles_rad[k + 20] - prompt.angles_rad[k]).abs();
            assert!(shift < 1e-3, "{kind:?} {k}: {shift}");
        }
    }
}

#[test]
fn within_the_backlash_no_torque_is_transmitted_and_the_arm_rests_at_its_edge() {
    for kind in KINDS {
        let robot = pendulum(", friction: (viscous_nm_s_rad: 0.3)")
            .weightless()
            .with_commands(&[0.0], &[0.3], None)
            .from(0.0, 0.0)
            .set("servo.backlash_rad", 0.1)
            .joined(kind)
            .lasting(2.0);
        let (_, joint) = film(&robot);
        let end = *joint.angles_rad.last().unwrap();
        assert!((end - 0.25).abs() < 1e-3, "{kind:?}: {end}");
    }
}

#[test]
fn a_gear_with_load_dependent_friction_lifts_less_and_holds_more() {
    let m: f64 = 0.3;
    let friction = format!(
        ", friction: (dry_nm: 0.001, motor_load: {m}, output_load: {m}, viscous_nm_s_rad: 0.05)"
    );
    // The error is so large that the duty saturates; it rises slowly because of the slew limit.
    let volt = 2.0;
    let torque = KT * volt / OHM;
    let weight = |angle: f64| MASS_KG * G * ARM_M * angle.sin();
    for kind in KINDS {
        let slow = pendulum(&friction)
            .with_commands(&[0.0], &[5.0], None)
            .set("servo.supply_v", volt)
            .set("servo.slew_1_s", 0.2)
            .joined(kind);
        let (_, joint) = film(&slow.clone().from(0.0, 0.0).lasting(6.0));
        let lifted = weight(*joint.angles_rad.last().unwrap());
        close(
            lifted,
            (torque * (1.0 - m) - 0.001) / (1.0 + m),
            0.03,
            &format!("{kind:?} lifts"),
        );
        // From above, the arm sinks until its weight is no more than motor torque and friction can hold.
        let held = slow.set("servo.slew_1_s", 1e6).from(1.5, 0.0).lasting(6.0);
        let (_, joint) = film(&held);
        let sunk = weight(*joint.angles_rad.last().unwrap());
        close(
            sunk,
            (torque * (1.0 + m) + 0.001) / (1.0 - m),
            0.03,
            &format!("{kind:?} holds"),
        );
    }
}

#[test]
fn a_slew_limit_spreads_the_impulse_of_a_step_over_time() {
    for kind in KINDS {
        let robot = pendulum(", slew_1_s: 10")
            .weightless()
            .with_commands(&[0.0], &[100.0], None)
            .from(0.0, 0.0)
            .set("timestep_s", 0.0005)
            .joined(kind)
            .lasting(0.05);
        let (_, joint) = film(&robot);
        // I w' = S r t - d w, so w = S r / d (t - T (1 - exp(-t / T))) with T = I / d.
        let (rise, lost) = (STALL_NM * 10.0, KT * KT / OHM);
        let (time, lag) = (0.05, INERTIA_KG_M2 / lost);
        let expected = rise / lost * (time - lag * (1.0 - (-time / lag).exp()));
        close(
            *speeds(&joint).last().unwrap(),
            expected,
            0.02,
            &format!("{kind:?}"),
        );
    }
}
