//! Options that say which moments, and which samples, of trajectories belong together.

use clap::builder::{EnumValueParser, PossibleValue, TypedValueParser};
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Command};
use realgap::comparison::{Association, MAX_DIFFERENCE_S, Offset, TimeBase, Timing, Umeyama};

use super::kit::*;

/// The time base on the command line; words of earlier versions are refused with the new ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeOption(pub TimeBase);

impl ValueEnum for TimeOption {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Self(TimeBase::Clock),
            Self(TimeBase::Start),
            Self(TimeBase::Fraction),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.about()))
    }
}

/// Reads a [`TimeOption`].
#[derive(Debug, Clone, Copy)]
pub struct TimeParser;

impl TypedValueParser for TimeParser {
    type Value = TimeOption;

    fn parse_ref(
        &self,
        command: &Command,
        argument: Option<&Arg>,
        value: &std::ffi::OsStr,
    ) -> std::result::Result<TimeOption, clap::Error> {
        let parsed = EnumValueParser::<TimeOption>::new().parse_ref(command, argument, value);
        let renamed = value.to_str().and_then(TimeBase::renamed);
        parsed.map_err(|mut error| {
            if let Some(now) = renamed {
                let tip = format!("`{}` is now called `{now}`", value.display());
                error.remove(ContextKind::SuggestedValue);
                error.insert(
                    ContextKind::Suggested,
                    ContextValue::StyledStrs(vec![tip.into()]),
                );
            }
            error
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let all = TimeOption::value_variants().iter();
        Some(Box::new(all.filter_map(ValueEnum::to_possible_value)))
    }
}

/// Rules by which samples are matched.
const RULES: &[Choice<Rule>] = &[
    (
        "nearest",
        Rule::Nearest,
        "The nearest sample in time, as evo does it",
    ),
    (
        "interpolate",
        Rule::Interpolate,
        "The other trajectory at the stamps of the reference, between its samples",
    ),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    Nearest,
    Interpolate,
}

/// What is done to the matched samples of the other trajectory.
const ALIGNMENTS: &[Choice<Umeyama>] = &[of(Umeyama::None), of(Umeyama::Se3), of(Umeyama::Sim3)];

const fn of(alignment: Umeyama) -> Choice<Umeyama> {
    (alignment.name(), alignment, alignment.about())
}

/// Which moments and samples belong together.
#[derive(Debug, Clone, Args)]
pub struct TimingOptions {
    /// Which moments belong together
    #[arg(long, value_name = "TIME", value_parser = TimeParser, default_value = "clock")]
    time: TimeOption,
    /// Which samples belong together, for the metrics ape, umeyama-ape, rpe and rotation
    #[arg(long, value_name = "RULE", value_parser = choice(RULES), default_value = "nearest")]
    associate: Rule,
    /// Match samples up to this many seconds apart [default: 0.01]
    #[arg(long, value_name = "S", value_parser = parse_seconds)]
    max_difference: Option<f64>,
    /// What is done to matched samples before ape, rpe and rotation compare them (Umeyama 1991)
    #[arg(long, value_name = "ALIGNMENT", value_parser = choice(ALIGNMENTS), default_value = "none")]
    align: Umeyama,
    /// The trajectories' stamps are this many seconds later than the reference's for the same moment (evo's --t_offset with the
    /// other sign); auto finds it from the speeds, with its uncertainty [default: 0, and an offset that is visible is doubted]
    #[arg(long, value_name = "S|auto")]
    offset: Option<Offset>,
}

impl TimingOptions {
    pub fn timing(&self) -> Result<Timing> {
        let association = match (self.associate, self.max_difference) {
            (Rule::Interpolate, Some(_)) => {
                return Err(Error::usage(
                    "--max-difference belongs to --associate nearest",
                ));
            }
            (Rule::Interpolate, None) => Association::Interpolated,
            (Rule::Nearest, within_s) => Association::Nearest {
                max_difference_s: within_s.unwrap_or(MAX_DIFFERENCE_S),
            },
        };
        let timing = Timing {
            base: self.time.0,
            association,
            alignment: self.align,
            offset: self.offset.unwrap_or_default(),
        };
        timing.check()?;
        Ok(timing)
    }
}
