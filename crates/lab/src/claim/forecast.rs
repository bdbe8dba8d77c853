//! Sentences about the repeats of a simulated run.

use super::{About, Claim, Conclusion};
use crate::prediction::ensemble::Forecast;
use crate::prediction::{Success, SuccessRange};
use realgap_core::statistics::Proportion;
use realgap_core::unit::{Unit, decimals, percent_range, quantity};

fn metres(m: f64) -> String {
    quantity(m, Unit::Metre)
}

fn whole(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// `62 % (95 %: 55 % to 68 %)`.
fn likely(p: &Proportion) -> String {
    format!(
        "{} (95 %: {} to {})",
        whole(p.share),
        whole(p.low),
        whole(p.high)
    )
}

/// How far the robot moves, and by which behaviour; `None` where every repeat diverged.
pub(crate) fn reach(forecast: &Forecast) -> Option<Claim> {
    let far = forecast.displacement_m.as_ref()?;
    let behaviours = &forecast.behaviours.list;
    let most =
        (behaviours.iter()).max_by(|a, b| a.probability.share.total_cmp(&b.probability.share));
    let most = most.map_or_else(String::new, |behaviour| {
        let which = match behaviours.len() {
            1 => "all repeats show one behaviour".to_owned(),
            many => format!("the most likely of {many} behaviours is"),
        };
        format!(
            "; {which} “{}” with a probability of {}",
            behaviour.name,
            likely(&behaviour.probability)
        )
    });
    let text = format!(
        "In {} s the robot moves {} to {} in nine of ten repeats, with a median of {}{most}.",
        decimals(forecast.duration_s, 1),
        metres(far.q05),
        metres(far.q95),
        metres(far.q50),
    );
    let numbers = [("q05_m", far.q05), ("q50_m", far.q50), ("q95_m", far.q95)];
    let claim = Claim::new(About::Reach, Conclusion::Supported, metres(far.q50), text);
    Some(claim.resting_on(forecast.repeats, &numbers).at_level(0.9))
}

/// How likely the robot moves far enough.
pub(crate) fn success(success: &Success) -> Claim {
    let p = &success.probability;
    let models = success
        .range
        .as_ref()
        .map_or_else(String::new, |range: &SuccessRange| {
            let (models, engine) = (range.models, range.other_engine);
            format!(
                "; {} over other models, {} with another engine",
                percent_range(models.low, models.high),
                whole(engine)
            )
        });
    let text = format!(
        "The robot moves at least {} with a probability of {} ({} to {} by sampling alone{models}).",
        metres(success.least_displacement_m),
        whole(p.share),
        whole(p.low),
        whole(p.high)
    );
    let numbers = [("probability", p.share), ("low", p.low), ("high", p.high)];
    Claim::new(About::Success, Conclusion::Supported, whole(p.share), text)
        .resting_on(p.trials, &numbers)
        .at_level(0.95)
}
