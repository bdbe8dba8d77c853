//! The RON form of scored channels: which recorded columns a study compares, and how noisy each is.

use serde::Deserialize;

use crate::calibration::recording::file_pattern::name_matches;
use realgap_core::{Code, Error, Result, Warning};
use realgap_path::comparison::{Channel, ChannelQuantity, ChannelSet};
use realgap_path::trajectory::{MeasuredQuantity, Recording, Trajectory};
use realgap_simulation::{Experiment, Instrument};

/// Recorded columns that a study scores.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Scored")]
pub struct ScoredColumns {
    /// Names of columns: `NAME_rad`, `NAME_rad_s`, `NAME_torque_nm`, `NAME_current_a` of joints, `NAME_gyro_x_rad_s`,
    /// `NAME_accel_x_m_s2` of bodies or marks; `*` stands for any letters. The last entry that matches a column has priority.
    pub columns: String,
    /// Standard deviation of the sensor's noise, in the unit of these columns. Without it the noise is measured in the recordings,
    /// and least squares weigh each column by what the fit leaves of it.
    #[serde(default)]
    pub noise: Option<f64>,
}

/// What can be done about a channel that nothing has.
const COLUMNS: &str =
    "name a recorded column: `reading: (names: {\"theirs\": \"NAME_torque_nm\"})` renames one";

/// The names, or their forms, that state no quantity: such columns are channels of somebody else's simulator only.
pub(in crate::calibration) fn names_of_their_own(
    entries: &[ScoredColumns],
) -> impl Iterator<Item = String> {
    let names = entries.iter().map(|entry| &entry.columns);
    let states = |name: &str| {
        let is_of_joint = name.ends_with("_rad") || name.ends_with("_rad_s");
        is_of_joint || MeasuredQuantity::of_column(name).is_some()
    };
    names.filter(move |name| !states(name)).cloned()
}

/// The channels that these entries name in these recordings; columns with names of their own are among them where the study has its
/// own simulator.
///
/// # Errors
/// An entry that matches no column, or the errors of [`Channel::new`].
pub(in crate::calibration) fn channels(
    entries: &[ScoredColumns],
    recordings: &[Recording],
    has_own_simulator: bool,
) -> Result<ChannelSet> {
    let motions: Vec<&Trajectory> = recordings.iter().map(|r| &r.trajectory).collect();
    let mut columns: Vec<(String, ChannelQuantity)> = Vec::new();
    let known = motions
        .iter()
        .flat_map(|motion| Channel::columns_of(motion));
    // Only a simulator of somebody else may have channels of any name.
    let signals = motions.iter().filter(|_| has_own_simulator);
    let signals = signals.flat_map(|motion| Channel::signals_of(motion));
    for found in known.chain(signals) {
        if !columns.contains(&found) {
            columns.push(found);
        }
    }
    for (index, entry) in entries.iter().enumerate() {
        if !columns
            .iter()
            .any(|(name, _)| name_matches(&entry.columns, name))
        {
            let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
            return Err(
                Error::invalid("no recorded column of this name can be scored")
                    .field(format!("channels[{index}].columns"))
                    .found(format!("{:?}", entry.columns))
                    .allowed(names.join(", "))
                    .hint(COLUMNS),
            );
        }
    }
    let named = columns.iter().filter_map(|(name, quantity)| {
        let mut entries = entries.iter().rev();
        let entry = entries.find(|entry| name_matches(&entry.columns, name))?;
        Some(Channel::new((name, *quantity), entry.noise, &motions))
    });
    Ok(ChannelSet::new(named.collect::<Result<_>>()?))
}

/// Has the run record the sensors of the scored channels that this recording has.
///
/// # Errors
/// A channel of a joint or body that the robot does not have, or whose motor cannot have it.
pub(in crate::calibration) fn instruments(
    experiment: &mut Experiment,
    recording: &Recording,
    channels: &ChannelSet,
) -> Result<()> {
    let motion = &recording.trajectory;
    let of_sensors = channels.all().iter().filter(|channel| {
        matches!(channel.quantity, ChannelQuantity::Measured(_))
            && motion.signal(&channel.column).is_some()
    });
    let assembly = &experiment.assembly;
    let of_column = |channel: &Channel| {
        Instrument::of_column(&channel.column, assembly)
            .map_err(|error| error.at_file(&recording.path))
    };
    experiment.instruments = of_sensors.map(of_column).collect::<Result<_>>()?;
    Ok(())
}

/// A warning where a recording has measured columns that the study does not score.
pub(in crate::calibration) fn not_scored(
    recording: &Recording,
    channels: &ChannelSet,
) -> Option<Warning> {
    let signals = recording.trajectory.signals().iter();
    let names = signals.map(|signal| signal.name.as_str());
    let is_scored = |name: &str| channels.all().iter().any(|c| c.column == name);
    let names = names
        .filter(|name| MeasuredQuantity::of_column(name).is_some())
        .filter(|name| !is_scored(name));
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| {
        Code::ColumnsIgnored.warning(format!(
            "measured columns not used: {}; `channels: [(columns: \"*_rad\"), (columns: {:?})]` in the study would score them, too",
            names.join(", "),
            names[0]
        ))
    })
}
