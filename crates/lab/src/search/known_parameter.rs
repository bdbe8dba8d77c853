//! What a search knows of its floor and its other parameters, and how much of a prediction's width comes from not knowing them better.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{Finalist, Search};
use crate::prediction::UncertainParameters;
use realgap_core::Result;
use realgap_core::statistics::{mean, median, quantile};
use realgap_optimization::RunOptions;
use realgap_simulation::parameter::{ParameterSet, by_name};

/// Draws from which the quantiles of a parameter are computed.
const DRAWS: u64 = 400;
/// A variance of fewer repeats says nothing.
const FEWEST: usize = 8;

/// A parameter whose value the search states or draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KnownParameter {
    /// Its name.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Median of the values that repeats get.
    pub median: f64,
    /// 5 % and 95 % quantile of them; both are the value of a parameter that is fixed.
    pub q05_q95: [f64; 2],
    /// Where the values come from.
    pub from: String,
}

/// How much of the width of a robot's predicted displacement comes from the values that differ between repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterShare {
    /// Share of the variance of the displacement that disappears where every repeat has the medians, 0 to 1.
    pub share: f64,
    /// Standard deviation of the displacement with the values drawn, metres.
    pub sd_m: f64,
    /// Standard deviation with the medians, metres.
    pub fixed_sd_m: f64,
    /// Repeats of each kind.
    pub repeats: usize,
}

impl Search {
    /// The parameters that are fixed or drawn, by name.
    ///
    /// # Errors
    /// None for a search that was built.
    pub fn known_parameters(&self) -> Result<Vec<KnownParameter>> {
        let draws = (0..DRAWS).map(|repeat| self.uncertain.draw(self.seed(), repeat));
        let draws = draws.collect::<Result<Vec<ParameterSet>>>()?;
        let drawn = draws.first().into_iter().flat_map(ParameterSet::iter);
        let drawn: BTreeSet<&str> = drawn.map(|value| value.parameter.name).collect();
        let mut known = Vec::new();
        for name in &drawn {
            let values: Vec<f64> = draws.iter().filter_map(|set| set.value(name)).collect();
            let end = |share: f64| quantile(&values, share);
            known.push(KnownParameter {
                parameter: (*name).to_owned(),
                unit: by_name(name)?.unit.label().to_owned(),
                median: median(&values),
                q05_q95: [end(0.05), end(0.95)],
                from: self.origin_of(name),
            });
        }
        for fixed in self
            .set
            .iter()
            .filter(|fixed| !drawn.contains(fixed.parameter.name))
        {
            known.push(KnownParameter {
                parameter: fixed.parameter.name.to_owned(),
                unit: fixed.parameter.unit.label().to_owned(),
                median: fixed.value,
                q05_q95: [fixed.value; 2],
                from: "fixed".to_owned(),
            });
        }
        known.sort_by(|a, b| a.parameter.cmp(&b.parameter));
        Ok(known)
    }

    /// Where drawn values of a parameter come from.
    fn origin_of(&self, name: &str) -> String {
        let range = self
            .uncertain
            .ranges()
            .iter()
            .find(|range| range.name == name);
        match (range, &self.posterior_from) {
            (Some(range), _) => format!("drawn evenly from {} to {}", range.low, range.high),
            (None, Some(folder)) => format!("posterior draws of {folder}"),
            (None, None) => "posterior draws of the named files".to_owned(),
        }
    }

    /// Repeats a finalist with the medians of all drawn values, and compares the variance of its displacement; `None` where nothing is
    /// drawn, or where there are too few repeats.
    ///
    /// # Errors
    /// Interrupted; settings that cannot be simulated.
    pub fn parameter_share(
        &self,
        finalist: &Finalist,
        options: &RunOptions<'_>,
    ) -> Result<Option<ParameterShare>> {
        if self.uncertain.is_empty() || self.finals().repeats < FEWEST {
            return Ok(None);
        }
        let fixed = Self {
            uncertain: UncertainParameters::default(),
            ..self.clone()
        };
        let variance = |far_m: &[f64]| {
            let middle = mean(far_m);
            let squares = far_m.iter().map(|m| (m - middle).powi(2));
            squares.sum::<f64>() / (far_m.len() as f64 - 1.0)
        };
        let again = fixed.repeat_again(&finalist.robot, options)?;
        let far = |ensemble: &crate::prediction::ensemble::Ensemble| -> Vec<f64> {
            let motions = ensemble.motions();
            motions
                .map(|(_, motion)| motion.path.net_displacement_m())
                .collect()
        };
        let (drawn, fixed) = (far(&finalist.ensemble), far(&again));
        if drawn.len() < FEWEST || fixed.len() < FEWEST {
            return Ok(None);
        }
        let (all, rest) = (variance(&drawn), variance(&fixed));
        Ok((all > 0.0).then(|| ParameterShare {
            share: (1.0 - rest / all).clamp(0.0, 1.0),
            sd_m: all.sqrt(),
            fixed_sd_m: rest.sqrt(),
            repeats: drawn.len(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::Overrides;
    use realgap_core::file::Source;

    const SEARCH: &str = "Search(
        strategy: CmaEs(evaluations: 8, genes: [\"amplitude\"]),
        start: Morphology(\"worm4.ron\"),
        duration_s: 1.0,
        parameters: [
            (name: \"floor.friction\", low: 0.2, high: 1.0),
            (name: \"floor.restitution\", low: 0.0, high: 0.4),
        ],
    )";

    #[test]
    fn a_named_posterior_replaces_the_ranges_of_the_file_and_is_named_as_the_origin() {
        let folder = tempfile::tempdir().unwrap();
        let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../../morphologies");
        let path = std::path::Path::new(robots).join("search.ron");
        let source = Source::new(&path, SEARCH);
        let known = |overrides: &Overrides| {
            let search = Search::parse(&source, overrides).unwrap();
            (search.known_parameters().unwrap(), search)
        };
        let (own, _) = known(&Overrides::default());
        let friction = |all: &[KnownParameter]| {
            let found = all.iter().find(|known| known.parameter == "floor.friction");
            found.unwrap().clone()
        };
        assert!(friction(&own).q05_q95[1] > 0.9 && friction(&own).from.contains("evenly"));
        let rows = (0..21).map(|k| format!("{}\n", 0.50 + 0.001 * f64::from(k)));
        let draws = format!("floor.friction\n{}", rows.collect::<String>());
        std::fs::write(folder.path().join("indistinguishable.csv"), draws).unwrap();
        let (told, search) = known(&Overrides {
            indistinguishable: Some(folder.path().to_owned()),
            ..Overrides::default()
        });
        let [low, high] = friction(&told).q05_q95;
        assert!(low >= 0.5 && high <= 0.52, "{low} to {high}");
        assert!(
            friction(&told)
                .from
                .contains(&folder.path().display().to_string())
        );
        // What the posterior does not name is drawn as the file says; a run without noise has the middle of both.
        let restitution = told
            .iter()
            .find(|known| known.parameter == "floor.restitution");
        assert!(restitution.unwrap().from.contains("evenly"));
        let robot = realgap_robot::morphology::Morphology::read(
            std::path::Path::new(robots).join("worm4.ron"),
        );
        let floor = search.experiment(&robot.unwrap()).floor;
        assert!((floor.friction - 0.51).abs() < 1e-9 && (floor.restitution - 0.2).abs() < 1e-9);
    }
}
