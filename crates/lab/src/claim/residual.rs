//! Whether the residuals of runs that start from recordings are noise.

use super::{About, Claim, Conclusion, SIGNIFICANT};
use crate::calibration::{ChannelFit, NoiseSource, Pattern, ResidualFit, ResidualMisfit};
use realgap_core::unit::{Unit, counted, number, quantity};

/// The sentence for recordings whose noise nothing tells.
pub(super) fn unknown(recordings: usize) -> Claim {
    let text = "fits within repeatability: cannot be judged, because no recording was repeated, and neither the study's `noise` nor the recordings tell by how much a right model would differ from them; record repeats, or add `noise` to the study";
    Claim::new(
        About::Model,
        Conclusion::Inconclusive,
        "cannot be judged",
        text.to_owned(),
    )
    .resting_on(recordings, &[])
}

/// The sentence for recordings whose noise is known.
pub(super) fn residuals(fit: &ResidualFit, recordings: usize) -> Claim {
    let largest = fit.channels.iter();
    let largest = largest.max_by(|a, b| a.systematic.total_cmp(&b.systematic));
    let worst = fit.misfit.as_ref().and_then(|misfit| {
        let channel = fit.channels.get(misfit.channel)?;
        Some((channel, misfit))
    });
    let rank = format!(
        "p = {}, by {} of the recordings",
        number(fit.p_value),
        counted(fit.imitations, "imitation")
    );
    let (says, word, text) = match (worst, largest) {
        (Some((channel, misfit)), _) => (
            Conclusion::Rejected,
            "NOT explained",
            format!(
                "No parameters of this model explain these recordings near the best point ({rank}), so intervals hold only for a model that does. Misfit in {}: {}",
                channel.channel,
                looks(channel, misfit)
            ),
        ),
        (None, Some(channel)) => (
            Conclusion::Supported,
            "explained",
            format!(
                "fits within the noise of the recordings: yes{}. The systematic part of the residuals is largest in {}: {} of its noise of {} ({}; {rank})",
                match fit.p_value < SIGNIFICANT {
                    true => ", though not by chance: what remains is too small to matter",
                    false => "",
                },
                channel.channel,
                number(channel.systematic),
                quantity(channel.noise, channel.unit),
                source(channel.noise_source)
            ),
        ),
        (None, None) => return unknown(recordings),
    };
    let shown = worst.map(|(channel, _)| channel).or(largest);
    let numbers = [
        ("p_value", fit.p_value),
        ("noise", shown.map_or(f64::NAN, |channel| channel.noise)),
        (
            "systematic_deviations",
            shown.map_or(f64::NAN, |channel| channel.systematic),
        ),
    ];
    Claim::new(About::Model, says, word, text).resting_on(recordings, &numbers)
}

fn source(source: NoiseSource) -> &'static str {
    match source {
        NoiseSource::HighFrequencies => "seen in its high frequencies",
        NoiseSource::Resolution => "from the steps of its resolution",
        NoiseSource::Stated => "from the study's `noise`",
    }
}

/// Where the misfit is, and how large.
pub(super) fn differs(channel: &ChannelFit, misfit: &ResidualMisfit) -> String {
    let systematic = quantity(channel.systematic * channel.noise, channel.unit);
    format!(
        "In {}, runs differ systematically by {systematic}, most from {} to {} s, where noise is {} ({})",
        channel.channel,
        number(misfit.from_s),
        number(misfit.to_s),
        quantity(channel.noise, channel.unit),
        source(channel.noise_source)
    )
}

/// A share by which a run goes too far or too short; of a run that moves less than that, no share is said.
const MOST_SHARE: f64 = 3.0;

/// What the misfit looks like, and what to check.
fn looks(channel: &ChannelFit, misfit: &ResidualMisfit) -> String {
    let size = quantity(misfit.size.abs(), channel.unit);
    let seconds = quantity(misfit.size.abs(), Unit::Second);
    let is_more = misfit.size > 0.0;
    let found = match misfit.pattern {
        Pattern::Lag if is_more => format!(
            "it follows the velocity, as if the recordings came {seconds} late: check delays and the lag of servos"
        ),
        Pattern::Lag => format!(
            "it follows the velocity, as if the recordings came {seconds} early: check delays and clocks"
        ),
        Pattern::Offset => format!("it is an offset of {size}: check zeros and frames"),
        Pattern::Position if misfit.size.abs() > MOST_SHARE => {
            "the run hardly moves where the recording does: check commands, loads and play of the joints".to_owned()
        }
        Pattern::Position => format!(
            "it follows the position, as if the run went {} % too {}: check loads, play of the joints, and scales",
            number(100.0 * misfit.size.abs()),
            if is_more { "far" } else { "short" }
        ),
        Pattern::Load => {
            "it follows the acceleration: check masses, loads, play of the joints, and forces that the model lacks, such as drag".to_owned()
        }
        Pattern::Growth => {
            format!("it grows with time to {size}: check forces that the model lacks, such as drag")
        }
        Pattern::Drift => format!(
            "it drifts by {size} from one recording to the next: check what warms up, wears or runs down"
        ),
        Pattern::Scatter => {
            return "the recordings differ from each other without an order, so no single values explain all of them: check them one by one, or state how runs differ, e.g. noise: Noise(friction_run_relative: LogNormal(0.05))".to_owned();
        }
        Pattern::Other => {
            return "it is neither a delay nor an offset, and follows neither position, acceleration nor time: check the robot and its contacts".to_owned();
        }
    };
    format!("{found} ({} % of it)", number(100.0 * misfit.share))
}
