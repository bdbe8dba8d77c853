//! Runs as rows of a store, with all of their bits, so that several workers can simulate the repeats of an ensemble.

use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use realgap_core::{Error, Result};
use realgap_path::trajectory::{JointTrack, Trajectory};
use realgap_simulation::{Divergence, EnergyBalance, Outcome, Run};
use realgap_store::{Fingerprint, RunRow, Store};

/// The parts of a run that are not numbers.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Words {
    /// Why the run was stopped as diverged.
    diverged: Option<String>,
    /// Names of the joints, and whether their speeds are known.
    joints: Vec<(String, bool)>,
    has_orientations: bool,
    has_velocities: bool,
    is_planar: bool,
    has_energy: bool,
}

/// The row of a run, without its CPU time and its warnings.
///
/// # Errors
/// None for runs of this workspace.
pub(super) fn row_of(index: usize, run: &Run) -> Result<RunRow> {
    let mut numbers = vec![run.steps as f64, run.settle_steps as f64, run.servo_rms_rad];
    if let Some(mut energy) = run.energy {
        numbers.extend(ENERGIES.map(|of| *of(&mut energy)));
    }
    let mut words = Words {
        diverged: None,
        joints: Vec::new(),
        has_orientations: false,
        has_velocities: false,
        is_planar: false,
        has_energy: run.energy.is_some(),
    };
    match &run.outcome {
        Outcome::Diverged(divergence) => {
            numbers.push(divergence.at_s);
            words.diverged = Some(divergence.why.clone());
        }
        Outcome::Completed(motion) => {
            numbers.push(motion.len() as f64);
            numbers.extend(motion.times_s());
            let mut vectors = |all: &[Vector3<f64>]| {
                numbers.extend(all.iter().flat_map(|v| [v.x, v.y, v.z]));
            };
            vectors(motion.positions_world_m());
            if let (Some(linear), Some(angular)) = (
                motion.velocities_world_m_s(),
                motion.angular_velocities_body_rad_s(),
            ) {
                vectors(linear);
                vectors(angular);
                words.has_velocities = true;
            }
            if let Some(orientations) = motion.orientations_world_from_body() {
                numbers.extend(orientations.iter().flat_map(|q| [q.i, q.j, q.k, q.w]));
                words.has_orientations = true;
            }
            for joint in motion.joints() {
                numbers.extend(&joint.angles_rad);
                numbers.extend(joint.speeds_rad_s.iter().flatten());
                words
                    .joints
                    .push((joint.name.clone(), joint.speeds_rad_s.is_some()));
            }
            words.is_planar = motion.is_planar();
        }
    }
    let words = serde_json::to_string(&words)
        .map_err(|e| Error::invalid(format!("cannot keep a run: {e}")))?;
    Ok(RunRow {
        index,
        numbers,
        words,
    })
}

/// The run of a row.
///
/// # Errors
/// A row that is not a row of a run.
pub(super) fn run_of(row: &RunRow) -> Result<Run> {
    let words: Words = serde_json::from_str(&row.words).map_err(|e| no_run(row, &e))?;
    let mut numbers = Numbers { row, from: 0 };
    let [steps, settle_steps, servo_rms_rad] = numbers.array()?;
    let energy = match words.has_energy {
        true => {
            let mut energy = EnergyBalance::default();
            for (of, joules) in ENERGIES.iter().zip(numbers.array::<9>()?) {
                *of(&mut energy) = joules;
            }
            Some(energy)
        }
        false => None,
    };
    let outcome = match words.diverged {
        Some(why) => {
            let [at_s] = numbers.array()?;
            Outcome::Diverged(Divergence { at_s, why })
        }
        None => {
            let [count] = numbers.array()?;
            let count = count as usize;
            let times_s = numbers.take(count)?.to_vec();
            let mut motion = Trajectory::new(times_s, numbers.vectors(count)?)?;
            if words.has_velocities {
                let linear = numbers.vectors(count)?;
                motion = motion.with_velocities(linear, numbers.vectors(count)?)?;
            }
            if words.has_orientations {
                let all = numbers.take(4 * count)?.as_chunks().0.iter();
                let all = all.map(|[i, j, k, w]| Quaternion::new(*w, *i, *j, *k));
                motion =
                    motion.with_orientations(all.map(UnitQuaternion::new_unchecked).collect())?;
            }
            let mut joints = Vec::new();
            for (name, has_speeds) in words.joints {
                joints.push(JointTrack {
                    name,
                    angles_rad: numbers.take(count)?.to_vec(),
                    speeds_rad_s: match has_speeds {
                        true => Some(numbers.take(count)?.to_vec()),
                        false => None,
                    },
                });
            }
            motion = motion.with_joints(joints)?;
            Outcome::Completed(if words.is_planar {
                motion.planar()
            } else {
                motion
            })
        }
    };
    Ok(Run {
        outcome,
        steps: steps as u64,
        settle_steps: settle_steps as u64,
        cpu: Duration::ZERO,
        servo_rms_rad,
        energy,
        warnings: Vec::new(),
    })
}

/// The runs of a store, which must have this fingerprint.
///
/// # Errors
/// No store there, a damaged store, or a store of other runs.
pub(super) fn runs_in(
    folder: &Path,
    fingerprint: &Fingerprint,
) -> Result<impl Fn(usize) -> Result<Option<Run>> + Sync + use<>> {
    let store = Store::<RunRow>::read(folder)?;
    fingerprint
        .must_equal(&store.fingerprint()?)
        .map_err(|error| error.at_file(folder))?;
    let store = Mutex::new(store);
    Ok(move |number| {
        let store = store.lock().unwrap_or_else(PoisonError::into_inner);
        let rows = store.rows_within(number..number + 1)?;
        rows.first().map(run_of).transpose()
    })
}

/// Reads the numbers of a row, one after the other.
struct Numbers<'a> {
    row: &'a RunRow,
    from: usize,
}

impl<'a> Numbers<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [f64]> {
        let some = self
            .row
            .numbers
            .get(self.from..self.from.saturating_add(count));
        self.from = self.from.saturating_add(count);
        some.ok_or_else(|| no_run(self.row, &"too few numbers"))
    }

    fn array<const N: usize>(&mut self) -> Result<[f64; N]> {
        let some = self.take(N)?;
        some.try_into().map_err(|e| no_run(self.row, &e))
    }

    fn vectors(&mut self, count: usize) -> Result<Vec<Vector3<f64>>> {
        let all = self.take(count.saturating_mul(3))?.as_chunks().0.iter();
        Ok(all.map(|[x, y, z]| Vector3::new(*x, *y, *z)).collect())
    }
}

fn no_run(row: &RunRow, why: &dyn std::fmt::Display) -> Error {
    Error::conflict("a row of the store is no run")
        .found(format!("run {}: {why}", row.index))
        .hint("remove the store, and make the runs again")
}

/// The numbers of an energy balance, in the order of rows.
const ENERGIES: [fn(&mut EnergyBalance) -> &mut f64; 9] = [
    |energy| &mut energy.servo_j,
    |energy| &mut energy.servo_positive_j,
    |energy| &mut energy.gravity_j,
    |energy| &mut energy.contact_j,
    |energy| &mut energy.friction_j,
    |energy| &mut energy.joint_j,
    |energy| &mut energy.slack_j,
    |energy| &mut energy.kinetic_j,
    |energy| &mut energy.residual_j,
];

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_robot::morphology::Morphology;
    use realgap_simulation::Experiment;

    #[test]
    fn a_run_comes_back_to_the_bit_and_half_a_row_is_an_error() {
        let morphology = Morphology::read("../../morphologies/tripod.ron").unwrap();
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = 0.3;
        experiment.energy_from_s = Some(0.0);
        let run = realgap_simulation::run(&experiment).unwrap();
        let row = row_of(7, &run).unwrap();
        let back = run_of(&row).unwrap();
        assert_eq!(back.outcome, run.outcome);
        assert_eq!(back.energy, run.energy);
        assert_eq!(
            (back.steps, back.servo_rms_rad),
            (run.steps, run.servo_rms_rad)
        );
        let half = RunRow {
            numbers: row.numbers[..row.numbers.len() / 2].to_vec(),
            ..row.clone()
        };
        assert!(run_of(&half).unwrap_err().to_string().contains("run 7"));

        let diverged = Run {
            outcome: Outcome::Diverged(Divergence {
                at_s: 0.1,
                why: "flying".to_owned(),
            }),
            energy: None,
            ..run
        };
        let back = run_of(&row_of(0, &diverged).unwrap()).unwrap();
        assert_eq!(back.outcome, diverged.outcome);
    }
}
