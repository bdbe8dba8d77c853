//! Runs from other starts than those that recordings state: a recorded angle is known to the noise of its sensor only.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use rand_distr::{Distribution, StandardNormal};

use crate::calibration::Study;
use crate::calibration::recording::start_speed::StartSpeed;
use crate::calibration::study::horizon::velocity_noise_1_s;
use realgap_core::Result;
use realgap_core::random::Numbered;
use realgap_identification::StartState;
use realgap_inference::rough_noise;
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{JointTrack, State, Trajectory, resolution};
use realgap_simulation::{Experiment, Start};

/// Other starts that are run.
const STARTS: u64 = 6;

impl Study {
    /// Single errors at these values from some other starts, each drawn from the noise of the recorded joints; empty where no run
    /// starts from recorded joints.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub(in crate::calibration) fn errors_of_other_starts(
        &self,
        values: &[f64],
        run: &RunOptions<'_>,
    ) -> Result<Vec<Vec<f64>>> {
        let mut all = Vec::new();
        let step = run.step("fitting from other starts", STARTS as usize);
        for number in 0..STARTS {
            let changed = self.simulate_changed_each(
                values,
                |case, experiment| {
                    let real = &self.cases()[case].targets[0].motion;
                    let seed = self.definition().seed.wrapping_add(case as u64);
                    // A start that was fitted to many samples is better known than a single sample.
                    let is_first_sample = self.definition().start_state == StartState::FirstSample;
                    disturb(experiment, real, is_first_sample, (seed, number));
                },
                true,
            )?;
            step.count();
            all.extend(self.errors_of(&changed).map(|(errors, _)| errors));
        }
        Ok(all)
    }
}

impl Study {
    /// Single errors at these values with each of the other settings that somebody else's simulator calls equally valid.
    ///
    /// # Errors
    /// Settings that cannot be simulated.
    pub(in crate::calibration) fn errors_of_other_settings(
        &self,
        values: &[f64],
        run: &RunOptions<'_>,
    ) -> Result<Vec<Vec<f64>>> {
        let simulator = self.simulator();
        let count = simulator.settings(1) as u64;
        let step = run.step("fitting with other settings", count as usize);
        let errors = (1..count).map(|number| {
            let other = |experiment: &mut Experiment| simulator.vary(experiment, number);
            let trial = self.simulate_changed(values, other, true)?;
            step.count();
            Ok(self.errors_of(&trial).map(|(errors, _)| errors))
        });
        let errors: Result<Vec<Option<Vec<f64>>>> = errors.collect();
        Ok(errors?.into_iter().flatten().collect())
    }
}

/// Moves the start of the body by the noise of its recorded path.
fn disturb_pose(state: &mut State, real: &Trajectory, normal: &mut impl FnMut() -> f64) {
    let Some(turns) = real.orientations_world_from_body() else {
        return;
    };
    let turned = turns
        .iter()
        .map(|turn| (turns[0].inverse() * turn).scaled_axis());
    let turned: Vec<Vector3<f64>> = turned.collect();
    let of = |vectors: &[Vector3<f64>]| -> Vector3<f64> {
        let axis = |k: usize| noise(&vectors.iter().map(|vector| vector[k]).collect::<Vec<_>>());
        Vector3::from_fn(|k, _| axis(k))
    };
    let (place_m, turn_rad) = (of(real.positions_world_m()), of(&turned));
    // Velocities that are differences of neighbouring samples are noisier than that of the start, which is a slope through several.
    let slope_1_s = velocity_noise_1_s(real.times_s());
    let [linear_m_s, angular_rad_s] = [
        (real.velocities_world_m_s(), place_m),
        (real.angular_velocities_body_rad_s(), turn_rad),
    ]
    .map(|(velocities, values)| {
        let own = velocities.map(of);
        Vector3::from_fn(|k, _| {
            own.map_or(f64::INFINITY, |own| own[k])
                .min(slope_1_s * values[k])
        })
    });
    let mut drawn = |sd: Vector3<f64>| sd.map(|sd| sd * normal());
    state.position_world_m += drawn(place_m);
    state.orientation_world_from_body *= UnitQuaternion::from_scaled_axis(drawn(turn_rad));
    state.velocity_world_m_s += drawn(linear_m_s);
    state.angular_velocity_body_rad_s += drawn(angular_rad_s);
}

/// Moves the start of each recorded joint by its noise, and that of a body that moves freely.
fn disturb(
    experiment: &mut Experiment,
    real: &Trajectory,
    is_first_sample: bool,
    (seed, number): (u64, u64),
) {
    let times_s = real.times_s();
    if times_s.len() < 3 {
        return;
    }
    let mut rng = Numbered::StartMotion.generator(seed, number);
    // What a simulator of somebody else is told of the start is moved in the same way; our own engines are told nothing.
    if !experiment.foreign.start.values.is_empty() {
        let told = &mut Arc::make_mut(&mut experiment.foreign.start).values;
        for joint in real.joints() {
            let mut move_by = |ending: &str, size: f64| {
                let name = format!("{}{ending}", joint.name);
                if let Some((_, value)) = told.iter_mut().find(|(told, _)| *told == name) {
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    *value += size * normal;
                }
            };
            let angle_rad = noise(&joint.angles_rad);
            move_by("_rad", angle_rad);
            move_by("_rad_s", speed_noise_rad_s(joint, angle_rad, times_s));
        }
    }
    if let Start::State(state) = &mut experiment.start
        && is_first_sample
    {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        disturb_pose(state, real, &mut normal);
    }
    for (hinge, start) in experiment
        .assembly
        .hinges
        .iter()
        .zip(&mut experiment.start_joints)
    {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let moves = (normal(), normal());
        let Some(joint) = real.joint(&hinge.name) else {
            continue;
        };
        let angle_rad = noise(&joint.angles_rad);
        start.angle_rad += angle_rad * moves.0;
        start.speed_rad_s += speed_noise_rad_s(joint, angle_rad, times_s) * moves.1;
    }
}

/// Standard deviation of the noise of a recorded start speed: its own, or that of the slope of its angles.
fn speed_noise_rad_s(joint: &JointTrack, angle_rad: f64, times_s: &[f64]) -> f64 {
    match &joint.speeds_rad_s {
        Some(speeds) => noise(speeds),
        None => StartSpeed::of(times_s, &joint.angles_rad).noise_1_s * angle_rad,
    }
}

/// Standard deviation of the noise of values that change smoothly, and at least that of rounding to the step of the sensor.
fn noise(values: &[f64]) -> f64 {
    let rough = rough_noise(values);
    let rough = if rough.is_finite() { rough } else { 0.0 };
    match resolution(values) {
        // Differences of rounded values that change slowly are mostly 0, or one step.
        Some(step) => rough.min(step).max(step / 12f64.sqrt()),
        None => rough,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use realgap_core::random::Generator;

    #[test]
    fn noise_is_told_from_a_smooth_signal_and_is_at_least_that_of_an_encoder() {
        let mut rng = Generator::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let smooth = |k: usize| libm::sin(0.14 * k as f64);
        let noisy: Vec<f64> = (0..400).map(|k| smooth(k) + 0.004 * normal()).collect();
        let found = noise(&noisy);
        assert!((0.0032..0.0048).contains(&found), "{found}");
        let clean: Vec<f64> = (0..400).map(smooth).collect();
        assert!(noise(&clean) < 1e-4, "{}", noise(&clean));
        let step = 0.0015;
        let read: Vec<f64> = clean.iter().map(|a| (a / step).round() * step).collect();
        let found = noise(&read);
        assert!(
            (0.99 * step / 12f64.sqrt()..=step).contains(&found),
            "{found}"
        );
        assert_eq!(noise(&[1.0, 1.0]), 0.0);
    }
}
