//! Joints of the recordings beside those of the best point: a table, and the first recording as a picture.

use rayon::prelude::*;

use crate::plot::{Caption, JointPanel, JointPlot};
use crate::results::table::CsvTable;
use realgap_core::error::Result;
use realgap_core::statistics::percentile_interval;
use realgap_lab::calibration::{Answer, Study};
use realgap_optimization::Ending;
use realgap_path::comparison::{JointSamples, joint_samples};

/// The largest number of recordings: more would hardly change the spread of a joint, and each costs a simulation.
const RECORDINGS: usize = 12;
/// Samples of one joint of one recording; more of them are thinned.
const SAMPLES: usize = 300;
/// The share of residuals beyond each end of a spread.
const TAIL: f64 = 0.05;

/// One sample of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointSample {
    pub recording: String,
    pub joint: String,
    pub time_s: f64,
    pub recorded_rad: f64,
    pub simulated_rad: f64,
}

/// Whether only joints were recorded: then there are no paths to show.
pub(in crate::results) fn is_of_joints(study: &Study) -> bool {
    let mut targets = study.cases().iter().flat_map(|case| &case.targets);
    targets.all(|target| target.motion.is_of_joints())
}

/// `joints.csv`: recorded and simulated angles at the best point; without rows where no recording has joints of the robot.
///
/// # Errors
/// A best point that cannot be simulated again.
pub(super) fn table(study: &Study, answer: &Answer) -> Result<CsvTable> {
    let best = answer.scores.best.map(|best| &answer.scores.points[best]);
    // A user who interrupts the run does not want to wait for more simulations.
    let best = best.filter(|_| answer.ending == Ending::Complete);
    let mut rows = best.map_or(Ok(Vec::new()), |best| compared(study, &best.values))?;
    if panels(&rows).is_none() {
        rows.clear();
    }
    let cells = rows.iter().map(|row| {
        let numbers = [row.time_s, row.recorded_rad, row.simulated_rad];
        let numbers = numbers.map(|v| format!("{v:.6}"));
        [&[row.recording.clone(), row.joint.clone()][..], &numbers].concat()
    });
    let header = ["recording", "joint", "t_s", "recorded_rad", "simulated_rad"];
    Ok(CsvTable::new(&header, cells))
}

/// The samples in that table.
pub(super) fn samples(table: &CsvTable) -> Vec<JointSample> {
    let (recordings, names) = (table.texts("recording"), table.texts("joint"));
    let numbers = ["t_s", "recorded_rad", "simulated_rad"].map(|name| table.numbers(name));
    let sample = |row: usize| {
        let [time_s, recorded_rad, simulated_rad] =
            numbers.each_ref().map(|column| column.get(row).copied());
        Some(JointSample {
            recording: (*recordings.get(row)?).to_owned(),
            joint: (*names.get(row)?).to_owned(),
            time_s: time_s?,
            recorded_rad: recorded_rad?,
            simulated_rad: simulated_rad?,
        })
    };
    (0..recordings.len()).filter_map(sample).collect()
}

/// The picture of the joints of the first recording; `None` where there is none.
pub(super) fn plot(study: &Study, samples: &[JointSample]) -> Option<JointPlot> {
    let (recording, joints) = panels(samples)?;
    let definition = study.definition();
    let title = format!("{}: joints over time at the best point", definition.name);
    let subtitle = format!("{}: {recording}", definition.morphology.name());
    Some(JointPlot {
        caption: Caption::new(title, subtitle),
        joints,
        reality_label: definition.source().reality_label().to_owned(),
    })
}

/// The samples of the first recordings, each simulated once more with these values.
fn compared(study: &Study, values: &[f64]) -> Result<Vec<JointSample>> {
    let cases: Vec<usize> = (0..study.cases().len().min(RECORDINGS)).collect();
    let of_case = |case: &usize| -> Result<Vec<JointSample>> {
        let targets = &study.cases()[*case].targets;
        let mut motions = targets.iter().map(|target| &target.motion);
        if motions.all(|motion| motion.joints().is_empty()) {
            return Ok(Vec::new());
        }
        let run = realgap_simulation::run(&study.experiment(*case, values)?)?;
        let Some(simulated) = run.outcome.get() else {
            return Ok(Vec::new());
        };
        let rows = targets.iter().flat_map(|target| {
            let recording = &study.definition().recordings[target.recording].name;
            let joints = joint_samples(&target.motion, simulated).into_iter();
            joints.flat_map(|joint| thinned(recording, joint))
        });
        Ok(rows.collect())
    };
    let all: Vec<Vec<JointSample>> = cases.par_iter().map(of_case).collect::<Result<_>>()?;
    Ok(all.into_iter().flatten().collect())
}

fn thinned(recording: &str, joint: JointSamples) -> Vec<JointSample> {
    let every = joint.times_s.len().div_ceil(SAMPLES).max(1);
    let samples = (0..joint.times_s.len()).step_by(every);
    let row = |k: usize| JointSample {
        recording: recording.to_owned(),
        joint: joint.name.clone(),
        time_s: joint.times_s[k],
        recorded_rad: joint.recorded_rad[k],
        simulated_rad: joint.simulated_rad[k],
    };
    samples.map(row).collect()
}

/// The joints of the first recording, each with the spread over all of them; `None` where there is none.
pub(crate) fn panels(rows: &[JointSample]) -> Option<(String, Vec<JointPanel>)> {
    let recording = &rows.first()?.recording;
    let mut joints: Vec<JointPanel> = Vec::new();
    for row in rows.iter().filter(|row| row.recording == *recording) {
        if joints.last().is_none_or(|joint| joint.name != row.joint) {
            let of_joint = rows.iter().filter(|other| other.joint == row.joint);
            let off = of_joint.map(|other| other.simulated_rad - other.recorded_rad);
            let off: Vec<f64> = off.collect();
            let (low, high) = percentile_interval(&off, TAIL)?;
            joints.push(JointPanel {
                name: row.joint.clone(),
                times_s: Vec::new(),
                recorded_rad: Vec::new(),
                simulated_rad: Vec::new(),
                spread_rad: [low, high],
            });
        }
        let joint = joints.last_mut()?;
        joint.times_s.push(row.time_s);
        joint.recorded_rad.push(row.recorded_rad);
        joint.simulated_rad.push(row.simulated_rad);
    }
    joints.retain(|joint| joint.times_s.len() > 1);
    (!joints.is_empty()).then(|| (recording.clone(), joints))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_recording_is_shown_with_the_spread_of_all() {
        let row = |recording: &str, joint: &str, time_s: f64, off: f64| JointSample {
            recording: recording.to_owned(),
            joint: joint.to_owned(),
            time_s,
            recorded_rad: time_s,
            simulated_rad: time_s + off,
        };
        let mut rows = Vec::new();
        for (recording, off) in [("a", 0.1), ("b", -0.3)] {
            for joint in ["pan", "lift"] {
                rows.extend((0..50).map(|k| row(recording, joint, f64::from(k), off)));
            }
        }
        let (recording, joints) = panels(&rows).unwrap();
        assert_eq!((recording.as_str(), joints.len()), ("a", 2));
        for joint in &joints {
            assert_eq!(joint.times_s.len(), 50);
            assert!(joint.residuals_rad().all(|off| (off - 0.1).abs() < 1e-9));
            let off = joint.spread_rad.iter().zip([-0.3, 0.1]);
            assert!(
                off.into_iter().all(|(a, b)| (a - b).abs() < 1e-9),
                "{joint:?}"
            );
        }
        assert!(panels(&[]).is_none());
    }
}
