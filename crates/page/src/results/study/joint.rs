//! Joints of the recordings, or scored channels, beside those of the best point: a table, and the first recording as a picture.

use rayon::prelude::*;

use crate::plot::{Caption, JointPanel, JointPlot};
use crate::results::table::CsvTable;
use realgap_core::error::Result;
use realgap_core::statistics::percentile_interval;
use realgap_lab::calibration::{Answer, Study};
use realgap_optimization::Ending;
use realgap_path::comparison::{self, ChannelSamples, JointSamples};

/// The largest number of recordings: more would hardly change the spread of a joint, and each costs a simulation.
const RECORDINGS: usize = 12;
/// Samples of one joint of one recording; more of them are thinned.
const SAMPLES: usize = 300;
/// The share of residuals beyond each end of a spread.
const TAIL: f64 = 0.05;

/// One sample of one joint, or of one scored channel.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSample {
    /// Name of the recording.
    pub recording: String,
    /// Name of the joint, or of the channel's column.
    pub joint: String,
    /// What is shown, and its unit: an angle in radians where the study scores no channels.
    pub quantity: (String, String),
    /// Time since the start of the recording, seconds.
    pub time_s: f64,
    /// What was recorded.
    pub recorded: f64,
    /// The same in the run at the best point.
    pub simulated: f64,
}

/// Recorded and simulated joints at the best point, or the channels that the study scores, of the first recordings; empty where
/// no recording has joints of the robot.
///
/// # Errors
/// A best point that cannot be simulated again.
pub fn joint_samples(study: &Study, answer: &Answer) -> Result<Vec<JointSample>> {
    let best = answer.scores.best.map(|best| &answer.scores.points[best]);
    // A user who interrupts the run does not want to wait for more simulations.
    let best = best.filter(|_| answer.ending == Ending::Complete);
    let mut rows = best.map_or(Ok(Vec::new()), |best| compared(study, &best.values))?;
    if panels(&rows).is_none() {
        rows.clear();
    }
    Ok(rows)
}

/// What is shown of a joint where no channels are scored.
fn angle() -> (String, String) {
    ("angle".to_owned(), "rad".to_owned())
}

/// Whether only joints were recorded: then there are no paths to show.
pub(in crate::results) fn is_of_joints(study: &Study) -> bool {
    let mut targets = study.cases().iter().flat_map(|case| &case.targets);
    targets.all(|target| target.motion.is_of_joints())
}

/// `joints.csv`: recorded and simulated angles at the best point, or the channels that the study scores; without rows where no
/// recording has joints of the robot.
///
/// # Errors
/// A best point that cannot be simulated again.
pub(super) fn table(study: &Study, answer: &Answer) -> Result<CsvTable> {
    let rows = joint_samples(study, answer)?;
    let has_channels = !study.definition().channels.all().is_empty();
    let cells = rows.iter().map(|row| {
        let numbers = [row.time_s, row.recorded, row.simulated];
        let numbers = numbers.map(|v| format!("{v:.6}"));
        let mut texts = vec![row.recording.clone(), row.joint.clone()];
        if has_channels {
            texts.extend([row.quantity.0.clone(), row.quantity.1.clone()]);
        }
        [&texts[..], &numbers].concat()
    });
    let header: &[&str] = match has_channels {
        true => &[
            "recording",
            "channel",
            "quantity",
            "unit",
            "t_s",
            "recorded",
            "simulated",
        ],
        false => &["recording", "joint", "t_s", "recorded_rad", "simulated_rad"],
    };
    Ok(CsvTable::new(header, cells))
}

/// The samples in that table.
pub(super) fn samples(table: &CsvTable) -> Vec<JointSample> {
    let has_channels = table.column("channel").is_some();
    let [joint, recorded, simulated] = match has_channels {
        true => ["channel", "recorded", "simulated"],
        false => ["joint", "recorded_rad", "simulated_rad"],
    };
    let (recordings, names) = (table.texts("recording"), table.texts(joint));
    let (quantities, units) = (table.texts("quantity"), table.texts("unit"));
    let numbers = ["t_s", recorded, simulated].map(|name| table.numbers(name));
    let sample = |row: usize| {
        let [time_s, recorded, simulated] =
            numbers.each_ref().map(|column| column.get(row).copied());
        let quantity = match has_channels {
            true => (
                (*quantities.get(row)?).to_owned(),
                (*units.get(row)?).to_owned(),
            ),
            false => angle(),
        };
        Some(JointSample {
            recording: (*recordings.get(row)?).to_owned(),
            joint: (*names.get(row)?).to_owned(),
            quantity,
            time_s: time_s?,
            recorded: recorded?,
            simulated: simulated?,
        })
    };
    (0..recordings.len()).filter_map(sample).collect()
}

/// The picture of the joints of the first recording; `None` where there is none.
pub(super) fn plot(study: &Study, samples: &[JointSample]) -> Option<JointPlot> {
    let (recording, joints) = panels(samples)?;
    let definition = study.definition();
    let what = match definition.channels.all().is_empty() {
        true => "joints",
        false => "channels",
    };
    let title = format!("{}: {what} over time at the best point", definition.name);
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
        let channels = &study.definition().channels;
        let mut rows = Vec::new();
        for target in targets {
            let recording = &study.definition().recordings[target.recording].name;
            if channels.all().is_empty() {
                let joints = comparison::joint_samples(&target.motion, simulated).into_iter();
                rows.extend(joints.flat_map(|joint| thinned(recording, series_of(joint))));
            } else {
                let all = channels.samples(&target.motion, simulated)?.into_iter();
                rows.extend(all.flat_map(|channel| thinned(recording, channel_series(channel))));
            }
        }
        Ok(rows)
    };
    let all: Vec<Vec<JointSample>> = cases.par_iter().map(of_case).collect::<Result<_>>()?;
    Ok(all.into_iter().flatten().collect())
}

/// What is shown of one joint or channel of one recording.
struct Shown {
    name: String,
    quantity: (String, String),
    times_s: Vec<f64>,
    recorded: Vec<f64>,
    simulated: Vec<f64>,
}

fn series_of(joint: JointSamples) -> Shown {
    Shown {
        name: joint.name,
        quantity: angle(),
        times_s: joint.times_s,
        recorded: joint.recorded_rad,
        simulated: joint.simulated_rad,
    }
}

fn channel_series(samples: ChannelSamples) -> Shown {
    let ChannelSamples {
        channel,
        times_s,
        recorded,
        simulated,
    } = samples;
    let (word, unit) = (channel.quantity.word(), channel.quantity.unit());
    Shown {
        name: channel.column,
        quantity: (word.to_owned(), unit.to_owned()),
        times_s,
        recorded,
        simulated,
    }
}

fn thinned(recording: &str, shown: Shown) -> Vec<JointSample> {
    let every = shown.times_s.len().div_ceil(SAMPLES).max(1);
    let samples = (0..shown.times_s.len()).step_by(every);
    let row = |k: usize| JointSample {
        recording: recording.to_owned(),
        joint: shown.name.clone(),
        quantity: shown.quantity.clone(),
        time_s: shown.times_s[k],
        recorded: shown.recorded[k],
        simulated: shown.simulated[k],
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
            let off = of_joint.map(|other| other.simulated - other.recorded);
            let off: Vec<f64> = off.collect();
            let (low, high) = percentile_interval(&off, TAIL)?;
            joints.push(JointPanel {
                name: row.joint.clone(),
                quantity: row.quantity.clone(),
                times_s: Vec::new(),
                recorded: Vec::new(),
                simulated: Vec::new(),
                spread: [low, high],
            });
        }
        let joint = joints.last_mut()?;
        joint.times_s.push(row.time_s);
        joint.recorded.push(row.recorded);
        joint.simulated.push(row.simulated);
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
            quantity: angle(),
            time_s,
            recorded: time_s,
            simulated: time_s + off,
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
            assert!(joint.residuals().all(|off| (off - 0.1).abs() < 1e-9));
            let off = joint.spread.iter().zip([-0.3, 0.1]);
            assert!(
                off.into_iter().all(|(a, b)| (a - b).abs() < 1e-9),
                "{joint:?}"
            );
        }
        assert!(panels(&[]).is_none());
    }
}
