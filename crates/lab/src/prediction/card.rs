//! The prediction card: what one robot will do before it is built, with probabilities and what they rest on.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Serialize, Serializer};

use super::ensemble::{Ensemble, Forecast, Motion, percent};
use super::model::{self};
use super::{CostOfTransport, DivergenceRate, ModelError, SuccessRange};
use crate::calibration::by_name;
use crate::claim::{self, Claim};
use realgap_core::statistics::Proportion;
use realgap_core::unit::{Unit, quantity};
use realgap_core::{Code, Error, Result, Warning};
use realgap_simulation::parameter::ParameterSet;

/// A robot that moves less far than this share of its body length without noise goes nowhere.
const NOWHERE_BODY_LENGTHS: f64 = 0.1;

/// Sources of error that no number of a card contains.
const NOT_COVERED: [&str; 4] = [
    "a robot that differs from its description",
    "a floor that differs from the stated one or wears",
    "flexible parts, cables and batteries",
    "disturbances that the noise settings do not contain",
];

/// Which net displacement counts as success.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SuccessRule {
    /// Half of the displacement of the run without noise.
    HalfOfNoiseFree,
    /// At least this displacement, metres.
    AtLeast(f64),
}

impl SuccessRule {
    /// A short description for readers.
    pub fn label(self) -> &'static str {
        match self {
            Self::HalfOfNoiseFree => "half of the run without noise",
            Self::AtLeast(_) => "as asked",
        }
    }
}

impl Serialize for SuccessRule {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_str(self.label())
    }
}

/// The probability that a robot moves far enough.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Success {
    /// The displacement that counts as success, metres.
    pub least_displacement_m: f64,
    /// The rule by which that displacement was chosen.
    pub rule: SuccessRule,
    /// The probability, with its sampling error; diverged repeats are failures.
    pub probability: Proportion,
    /// The range over other models; `None` where no other models were simulated.
    pub range: Option<SuccessRange>,
}

impl Success {
    /// The success probability of an ensemble; `None` where the rule is half of a run without noise that diverged or moved less
    /// than a tenth of a body length.
    ///
    /// # Errors
    /// A distance that is not above 0.
    pub fn new(ensemble: &Ensemble, rule: SuccessRule) -> Result<Option<Self>> {
        let least_displacement_m = match rule {
            SuccessRule::AtLeast(least_m) if least_m.is_finite() && least_m > 0.0 => least_m,
            SuccessRule::AtLeast(least_m) => {
                return Err(Error::invalid("success must be a distance")
                    .found(least_m)
                    .allowed("more than 0 m"));
            }
            SuccessRule::HalfOfNoiseFree => {
                let nowhere_m = NOWHERE_BODY_LENGTHS * ensemble.body_length_m;
                let far_m = ensemble.noise_free.get().map(Motion::net_displacement_m);
                match far_m.filter(|far_m| *far_m >= nowhere_m) {
                    Some(far_m) => 0.5 * far_m,
                    None => return Ok(None),
                }
            }
        };
        Ok(Some(Self {
            least_displacement_m,
            rule,
            probability: ensemble.success(least_displacement_m),
            range: None,
        }))
    }
}

/// A robot under other solver settings, with the random draws by which it was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rerun {
    /// What was changed.
    pub settings: &'static str,
    /// Mean net displacement, metres; `None` where it failed.
    pub mean_displacement_m: Option<f64>,
    /// Change of the mean displacement as a share of that under the usual settings.
    pub change: Option<f64>,
    /// Why it failed.
    pub failure: Option<String>,
    /// Whether the change is within the tolerance.
    pub survives: bool,
}

/// The result of a robot among the finalists of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finals {
    /// Ranks begin at 1, and survivors come first.
    pub rank: usize,
    /// Whether every rerun is within the tolerance.
    pub survives: bool,
    /// The objective of the search.
    pub objective: String,
    /// Unit of both fitnesses.
    pub unit: Unit,
    /// Fitness with the draws of the search: it is the fitness of a winner and therefore too high.
    pub search_fitness: Option<f64>,
    /// Fitness with fresh seeds; `None` where a repeat diverged.
    pub fitness: Option<f64>,
    /// Cost of transport with fresh seeds; `None` where the robot goes nowhere or no servo gives energy.
    pub economy: Option<CostOfTransport>,
    /// The robot under other solver settings.
    pub reruns: Vec<Rerun>,
}

/// What one robot will do.
///
/// ```
/// use realgap_optimization::RunOptions;
/// use realgap_lab::prediction::{Card, SuccessRule, ensemble};
/// use realgap_robot::morphology::Morphology;
/// use realgap_simulation::{Experiment, Noise};
///
/// let robot = Morphology::read("../../morphologies/tripod.ron")?;
/// let mut experiment = Experiment::new(robot.assemble());
/// experiment.duration_s = 1.0;
/// let noise = Noise::unmeasured_robot();
/// let repeats = ensemble::run(&experiment, &noise, 1, 4, &RunOptions::default())?;
///
/// let card = Card::new(robot.name(), &repeats, SuccessRule::AtLeast(0.01))?;
/// assert!(card.success.as_ref().is_some_and(|success| success.probability.trials == 4));
/// assert!(card.to_string().contains("net displacement"));
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Card {
    /// The robot's name.
    pub robot: String,
    /// Its result among the finalists of a search; `None` for a robot that is not from a search.
    #[serde(flatten)]
    pub finals: Option<Finals>,
    /// The probability that it moves far enough; `None` where no displacement counts as success.
    pub success: Option<Success>,
    /// Fixed values of parameters.
    pub parameters: BTreeMap<String, f64>,
    /// The source of the noise, e.g. a file; `None` where it is not stated.
    pub noise_from: Option<String>,
    /// The engine and its precision.
    pub engine: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// How fast a small difference grows; `None` where it was not computed.
    pub growth: Option<DivergenceRate>,
    /// The forecast of the repeats.
    pub prediction: Forecast,
    /// How far models that are as valid differ; `None` where they were not simulated.
    pub model: Option<ModelError>,
    /// Every claim of the card about reality, as far as the model is right.
    pub claims: Vec<Claim>,
    /// Sources of error that no number here contains.
    pub not_covered: [&'static str; 4],
    /// Warnings for the reader, those of the prediction included.
    pub warnings: Vec<Warning>,
}

impl Card {
    /// The card of an ensemble of this robot.
    ///
    /// # Errors
    /// As [`Success::new`].
    pub fn new(robot: impl Into<String>, ensemble: &Ensemble, rule: SuccessRule) -> Result<Self> {
        let prediction = Forecast::new(ensemble)?;
        let success = Success::new(ensemble, rule)?;
        let mut warnings = prediction.warnings.clone();
        if success.is_none() {
            warnings.push(Code::NoSuccessRule.warning(
                "without noise the robot goes nowhere (or diverges), so half of that is no success; say which net displacement is one",
            ));
        }
        let card = Self {
            robot: robot.into(),
            finals: None,
            success,
            parameters: BTreeMap::new(),
            noise_from: None,
            engine: ensemble.engine,
            version: env!("CARGO_PKG_VERSION"),
            growth: None,
            prediction,
            model: None,
            claims: Vec::new(),
            not_covered: NOT_COVERED,
            warnings,
        };
        Ok(card.with_claims())
    }

    /// The card with the claims that follow from its numbers.
    fn with_claims(mut self) -> Self {
        let reach = claim::reach(&self.prediction);
        let success = self.success.as_ref().map(claim::success);
        let trust = claim::trust_of(&claim::Comparison {
            complete: self.prediction.repeats >= self.prediction.repeats_asked,
            against: Vec::new(),
            tested: None,
            would_tell: "it is compared with no recording; build the robot and record it"
                .to_owned(),
            seen_by_fit: None,
            recordings: 0,
        });
        self.claims = reach.into_iter().chain(success).chain([trust]).collect();
        self
    }

    /// The card with the fixed values that the experiment had.
    #[must_use]
    pub fn with_parameters(mut self, set: &ParameterSet) -> Self {
        self.parameters = by_name(set);
        self
    }

    /// The card with the source of the noise.
    #[must_use]
    pub fn with_noise_from(mut self, source: impl Into<String>) -> Self {
        self.noise_from = Some(source.into());
        self
    }

    /// The card with the growth of small differences, and the warning that belongs to it.
    #[must_use]
    pub fn with_growth(mut self, growth: Option<DivergenceRate>) -> Self {
        self.warnings.extend(growth.and_then(|g| g.warning()));
        self.growth = growth;
        self
    }

    /// The card with the differences of other models from this ensemble.
    #[must_use]
    pub fn with_model(mut self, ensemble: &Ensemble, model: Option<ModelError>) -> Self {
        if let (Some(success), Some(model)) = (&mut self.success, &model) {
            success.range = model.success(ensemble, success.least_displacement_m);
        }
        self.model = model;
        self.with_claims()
    }

    /// The card with more warnings for the reader, before its own.
    #[must_use]
    pub fn with_warnings(mut self, mut warnings: Vec<Warning>) -> Self {
        warnings.append(&mut self.warnings);
        self.warnings = warnings;
        self
    }
}

impl fmt::Display for Card {
    /// Writes the verdict, then a line for each statement of the card.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&claim::verdict_lines(&self.claims))?;
        let metres = |m: f64| quantity(m, Unit::Metre);
        let prediction = &self.prediction;
        write!(
            f,
            "{}: {} repeats of {} s under noise",
            self.robot, prediction.repeats, prediction.duration_s
        )?;
        if let Some(source) = &self.noise_from {
            write!(f, " ({source})")?;
        }
        if let Some(success) = &self.success {
            write!(
                f,
                "\n  P(success)        {}: net displacement of at least {} ({})",
                percent(&success.probability),
                metres(success.least_displacement_m),
                success.rule.label()
            )?;
        }
        if let Some(range) = self.success.as_ref().and_then(|success| success.range) {
            write!(
                f,
                "\n    other models    {}; with another engine {:.0} %",
                model::percent(&range.models),
                100.0 * range.other_engine
            )?;
        }
        f.write_str(&prediction.numbers())?;
        if let Some(model) = &self.model {
            write!(f, "{model}")?;
        }
        if let Some(speed) = &prediction.speed_m_s {
            let [mean, sd] = [speed.mean, speed.standard_deviation].map(|m_s| 1e3 * m_s);
            write!(
                f,
                "\n  speed             {mean:.1} mm/s, standard deviation {sd:.1} mm/s (net displacement per time)"
            )?;
        }
        if let Some(growth) = &self.growth {
            write!(
                f,
                "\n  small differences grow by a factor of {:.1} per second",
                growth.factor_per_s()
            )?;
        }
        let over_models = self.model.as_ref().map(ModelError::behaviour_shares);
        write!(
            f,
            "\n  not covered       {}\n{}",
            self.not_covered.join("; "),
            prediction.behaviour_table(None, over_models.as_deref())
        )?;
        match &self.finals {
            Some(finals) => write!(f, "\n{finals}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Finals {
    /// Writes rank, fitness and the effect of other settings.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fitness = |value: Option<f64>| {
            value.map_or("none".to_owned(), |value| quantity(value, self.unit))
        };
        write!(
            f,
            "  rank              {}, {}: {} in the search, {} with fresh seeds",
            self.rank,
            self.objective,
            fitness(self.search_fitness),
            fitness(self.fitness)
        )?;
        if let Some(economy) = &self.economy {
            write!(f, "\n  energy            {economy}")?;
        }
        for rerun in &self.reruns {
            let what = match (rerun.change, &rerun.failure) {
                (_, Some(failure)) => format!("fails: {failure}"),
                (Some(change), None) => format!("changes by {:.0} %", 100.0 * change),
                (None, None) => "has nothing to be compared with".to_owned(),
            };
            let verdict = if rerun.survives {
                "survives"
            } else {
                "does NOT survive"
            };
            write!(f, "\n    {:<17} {what}, {verdict}", rerun.settings)?;
        }
        Ok(())
    }
}

#[cfg(feature = "schema")]
realgap_core::string_schema! {
    SuccessRule, "SuccessRule", "Who said what far enough is, in words.";
}
