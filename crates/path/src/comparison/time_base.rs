//! The time by which two trajectories are compared.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use realgap_core::error::{Error, Result};
use realgap_core::file::look_up;

/// Which moments of two trajectories belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum TimeBase {
    /// Moments with the same stamp: both files have stamps of one clock.
    #[default]
    Clock,
    /// Moments at the same time after each trajectory's own start.
    Start,
    /// Moments at the same fraction of each trajectory's own duration.
    Fraction,
}

impl TimeBase {
    /// All time bases; the first is the default.
    pub const ALL: [Self; 3] = [Self::Clock, Self::Start, Self::Fraction];

    /// The name in options and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clock => "clock",
            Self::Start => "start",
            Self::Fraction => "fraction",
        }
    }

    /// The meaning, for a list of choices.
    pub fn about(self) -> &'static str {
        match self {
            Self::Clock => "Stamps as they are, in the time that both files have in common",
            Self::Start => "Times since each recording's own start",
            Self::Fraction => "Equal fractions of the durations",
        }
    }

    /// The name that now stands for a word of earlier versions.
    pub fn renamed(word: &str) -> Option<Self> {
        match word {
            "absolute" => Some(Self::Start),
            "relative" => Some(Self::Fraction),
            _ => None,
        }
    }
}

impl fmt::Display for TimeBase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for TimeBase {
    type Err = Error;

    fn from_str(word: &str) -> Result<Self> {
        if let Some(now) = Self::renamed(word) {
            return Err(Error::usage("this time base has another name")
                .field("time")
                .found(format!("`{word}`"))
                .allowed("clock, start, fraction")
                .hint(format!("`{word}` is now called `{now}`")));
        }
        look_up("time base", word, Self::ALL, |base| base.name())
            .map_err(|error| error.into_usage().field("time"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back_and_old_words_name_the_new_ones() {
        for base in TimeBase::ALL {
            assert_eq!(base.name().parse::<TimeBase>().unwrap(), base);
            assert_eq!(
                serde_json::to_value(base).unwrap(),
                serde_json::json!(base.name())
            );
        }
        for (old, new) in [("absolute", "start"), ("relative", "fraction")] {
            let error = old.parse::<TimeBase>().unwrap_err().to_string();
            assert!(error.contains(&format!("now called `{new}`")), "{error}");
        }
        let error = "clok".parse::<TimeBase>().unwrap_err().to_string();
        assert!(error.contains("clock"), "{error}");
    }
}
