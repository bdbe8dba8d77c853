//! The verdict on an answer, in three claims: how far the simulation is from reality, what the recordings say about the parameters
//! (`parameter.rs` makes that one), and how far both may be trusted.

use super::residual::differs;
use super::{About, Claim, Conclusion, SIGNIFICANT};
use crate::calibration::{Fit, PoseErrors, Validation};
use realgap_core::unit::{Unit, counted, number, quantity};

/// How far the simulation is from `reality` at the best point, by its score, the difference of net displacements where the robot goes
/// anywhere, and the errors of poses: in units that people use, and in noise floors where there are repeats.
pub(crate) fn gap(
    (score, displacement_error_m, pose): (f64, Option<f64>, Option<&PoseErrors>),
    (metric, unit): (&str, Unit),
    noise_floors: Option<f64>,
    (reality, recordings): (&str, usize),
) -> Claim {
    let (distance, text) = match (pose, displacement_error_m) {
        (Some(pose), _) => {
            let distance = format!(
                "{} % of the body length and {} deg",
                number(pose.position_percent),
                number(pose.rotation_deg)
            );
            let text = format!("The simulation is {distance} away from {reality}");
            (distance, text)
        }
        (None, Some(error_m)) => {
            let distance = quantity(error_m, Unit::Metre);
            let text = format!(
                "The net displacements of the simulation and of {reality} differ by {distance}"
            );
            (distance, text)
        }
        (None, _) => {
            let distance = quantity(score, unit);
            let text = match unit {
                Unit::One => {
                    format!(
                        "The simulation is {distance} away from {reality} by the metric {metric}"
                    )
                }
                _ => format!("The simulation is {distance} away from {reality}"),
            };
            (distance, text)
        }
    };
    let floors = noise_floors.map_or_else(String::new, |floors| {
        format!(
            ", and {} noise floors (1: as far as repeats are from each other)",
            number(floors)
        )
    });
    let text = format!(
        "{text}, on average over {}{floors}.",
        counted(recordings, "recording")
    );
    let numbers = [
        ("score", score),
        (
            "position_percent",
            pose.map_or(f64::NAN, |pose| pose.position_percent),
        ),
        (
            "rotation_deg",
            pose.map_or(f64::NAN, |pose| pose.rotation_deg),
        ),
        (
            "displacement_error_m",
            displacement_error_m.unwrap_or(f64::NAN),
        ),
        ("noise_floors", noise_floors.unwrap_or(f64::NAN)),
    ];
    Claim::new(About::Gap, Conclusion::Supported, distance, text)
        .of(metric)
        .resting_on(recordings, &numbers)
}

/// What is known about an answer that decides whether it may be trusted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground<'a> {
    /// Whether the run came to its end.
    pub complete: bool,
    /// Whether the fit ended where its method would have ended by itself.
    pub has_converged: bool,
    /// Whether anything looked for misfit.
    pub is_audited: bool,
    /// Whether the model explains the fitted recordings.
    pub fit: Option<&'a Fit>,
    /// How the fit does on recordings that it has not seen.
    pub validation: Option<&'a Validation>,
    /// Fitted recordings.
    pub recordings: usize,
}

/// Whether the answer may be trusted: it holds on recordings that the fit has not seen; it fits, and was not tested on others; the
/// model does not explain the recordings; or nothing tells.
pub(crate) fn trust(ground: &Ground<'_>) -> Claim {
    let Ground {
        complete,
        has_converged,
        is_audited,
        fit,
        validation,
        recordings,
    } = *ground;
    let carries_over = validation.map(|held| (held, held.warning().is_none()));
    let (says, word, text) = match (fit, carries_over) {
        _ if !complete => cannot("the run is unfinished; finish it"),
        (Some(fit), _) if !fit.explains => (
            Conclusion::Rejected,
            "does not explain the recordings",
            format!(
                "The model does not explain the recordings{}{}.",
                somewhere(fit),
                carries_over.map_or("", |(_, holds)| match holds {
                    true => "; on recordings that the fit has not seen it does no worse",
                    false => "; on recordings that the fit has not seen it does worse still",
                })
            ),
        ),
        (_, Some((held, false))) => (
            Conclusion::Rejected,
            "does not explain the recordings",
            format!(
                "The fit does not carry over: on {} that it has not seen, the score is {} times that on the fitted ones.",
                counted(held.held_out_recordings, "recording"),
                number(held.held_out_score / held.fit_score)
            ),
        ),
        (_, None) if !has_converged => cannot(
            "the fit has not converged, so other values may explain the recordings better; give it a larger budget",
        ),
        (_, Some((held, true))) => (
            Conclusion::Supported,
            "holds on others",
            format!(
                "The answer holds on {} that the fit has not seen.",
                counted(held.held_out_recordings, "recording")
            ),
        ),
        (Some(fit), None) if fit.judged => (
            Conclusion::Supported,
            "fits, not yet tested on others",
            "The model fits the recordings within their noise; it is not yet tested on recordings that the fit has not seen: hold some of them out."
                .to_owned(),
        ),
        (Some(_), None) => cannot(
            "no recording was repeated, and nothing states how repeats differ; record repeats, add `noise` to the study, or hold recordings out of the fit",
        ),
        (None, None) if !is_audited => cannot("the answer is not audited; audit it"),
        (None, None) => cannot(
            "nothing shows how far a right model would be from the recordings; record repeats, or hold recordings out of the fit",
        ),
    };
    let numbers = [
        (
            "p_value",
            fit.and_then(|fit| fit.p_value).unwrap_or(f64::NAN),
        ),
        ("significant_below", SIGNIFICANT),
        (
            "held_out_score",
            validation.map_or(f64::NAN, |held| held.held_out_score),
        ),
    ];
    Claim::new(About::Trust, says, word, text).resting_on(recordings, &numbers)
}

/// The claim of an answer of which nothing tells whether it may be trusted, with what would tell.
pub(super) fn cannot(why: &str) -> (Conclusion, &'static str, String) {
    (
        Conclusion::Inconclusive,
        "cannot be told",
        format!("Whether to trust this cannot be told: {why}."),
    )
}

/// Where the recordings differ from the model, as the continuation of a sentence.
fn somewhere(fit: &Fit) -> String {
    let of_residuals = fit.residuals.as_ref().and_then(|found| {
        let misfit = found.misfit.as_ref()?;
        Some(differs(found.channels.get(misfit.channel)?, misfit))
    });
    let of_runs = fit.misfit.as_ref().map(|misfit| {
        format!(
            "the nearest run deviates most from {} to {} s",
            number(misfit.from_s),
            number(misfit.to_s)
        )
    });
    match of_residuals.or(of_runs) {
        Some(place) => {
            let mut letters = place.chars();
            let first = letters.next().map(|c| c.to_lowercase().to_string());
            format!(": {}{}", first.unwrap_or_default(), letters.as_str())
        }
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(judged: bool, explains: bool) -> Fit {
        Fit {
            judged,
            noise_floors: judged.then_some(1.2),
            p_value: judged.then_some(0.4),
            neighbours_p_value: None,
            explains,
            discrepancy: 0.0,
            engine: None,
            misfit: None,
            residuals: None,
        }
    }

    fn held_out(score: f64) -> Validation {
        Validation {
            split: "2 of 8".to_owned(),
            fit_score: 1.0,
            held_out_score: score,
            difference_standard_error: 0.1,
            held_out_recordings: 2,
            folds: Vec::new(),
            bands: None,
        }
    }

    fn words(fit: Option<&Fit>, validation: Option<&Validation>, complete: bool) -> String {
        let ground = Ground {
            complete,
            has_converged: true,
            is_audited: true,
            fit,
            validation,
            recordings: 8,
        };
        trust(&ground).word
    }

    #[test]
    fn trust_is_one_of_four_and_misfit_outweighs_everything() {
        let (right, wrong, unknown) = (fit(true, true), fit(true, false), fit(false, true));
        let (as_well, worse) = (held_out(1.05), held_out(3.0));
        let cases = [
            (Some(&right), None, "fits, not yet tested on others"),
            (Some(&right), Some(&as_well), "holds on others"),
            (Some(&unknown), Some(&as_well), "holds on others"),
            (None, Some(&as_well), "holds on others"),
            (
                Some(&right),
                Some(&worse),
                "does not explain the recordings",
            ),
            (
                Some(&wrong),
                Some(&as_well),
                "does not explain the recordings",
            ),
            (Some(&wrong), None, "does not explain the recordings"),
            (Some(&unknown), None, "cannot be told"),
            (None, None, "cannot be told"),
        ];
        for (fit, validation, expected) in cases {
            assert_eq!(words(fit, validation, true), expected);
            assert_eq!(words(fit, validation, false), "cannot be told");
        }
    }

    #[test]
    fn what_cannot_be_told_says_what_would_tell() {
        let ground = Ground {
            complete: true,
            has_converged: true,
            is_audited: false,
            fit: None,
            validation: None,
            recordings: 1,
        };
        assert!(trust(&ground).text.contains("audit it"));
        let unfinished = Ground {
            has_converged: false,
            ..ground
        };
        assert!(trust(&unfinished).text.contains("larger budget"));
        let text = trust(&Ground {
            fit: Some(&fit(false, true)),
            is_audited: true,
            ..ground
        })
        .text;
        assert!(
            text.contains("record repeats") && text.contains("`noise`"),
            "{text}"
        );
    }

    #[test]
    fn the_gap_has_the_unit_that_people_use() {
        let pose = PoseErrors {
            position_percent: 12.7,
            rotation_deg: 14.88,
        };
        let of = |(score, displacement_m), pose, unit, floors| {
            let distances = (score, displacement_m, pose);
            gap(distances, ("metric", unit), floors, ("reality", 40)).text
        };
        let text = of((0.37, Some(0.1)), Some(&pose), Unit::One, None);
        assert!(
            text.contains("12.7 % of the body length and 14.9 deg"),
            "{text}"
        );
        let text = of((0.0042, None), None, Unit::Radian, None);
        assert!(
            text.contains("4.20 mrad") && !text.contains("floors"),
            "{text}"
        );
        let text = of((0.2, Some(0.032)), None, Unit::One, Some(0.73));
        assert!(
            text.contains("32.0 mm") || text.contains("3.20 cm"),
            "{text}"
        );
        assert!(text.contains("0.730 noise floors"), "{text}");
    }
}
