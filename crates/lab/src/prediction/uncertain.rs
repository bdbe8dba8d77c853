//! Parameters whose values tuning left open: every repeat draws other values.

use std::path::Path;

use rand::RngExt as _;
use serde::{Deserialize, Serialize};

use realgap_core::file::{Seal, read_limited};
use realgap_core::random::Numbered;
use realgap_core::statistics::median;
use realgap_core::{Advice, Code, Error, Result, Warning};
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{Assignment, ParameterSet, by_name};
use realgap_store::FolderLock;

/// A parameter of which only a range is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Uncertain")]
pub struct UncertainRange {
    /// Name, as `realgap study parameters` lists it.
    pub name: String,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Parameters whose values differ from repeat to repeat because they are not known exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UncertainParameters {
    ranges: Vec<UncertainRange>,
    groups: Vec<Vec<ParameterSet>>,
}

impl UncertainParameters {
    /// From ranges, in which values are drawn evenly, and from groups of points; every repeat gets one point of each group.
    /// Ranges take precedence over points.
    ///
    /// # Errors
    /// Unknown parameters, ends out of bounds or in the wrong order.
    pub fn new(ranges: Vec<UncertainRange>, groups: Vec<Vec<ParameterSet>>) -> Result<Self> {
        for (index, range) in ranges.iter().enumerate() {
            let at = |error: Error| error.field(format!("parameters[{index}]"));
            let parameter = by_name(&range.name).map_err(at)?;
            parameter.check(range.low).map_err(at)?;
            parameter.check(range.high).map_err(at)?;
            if range.low > range.high {
                return Err(at(Error::invalid("the ends are in the wrong order")
                    .found(format!("{} to {}", range.low, range.high))
                    .allowed("low not above high")));
            }
        }
        let of_draws = Self::of_draws(&groups);
        Ok(Self { ranges, ..of_draws })
    }

    /// Groups of points alone.
    pub fn of_draws(groups: &[Vec<ParameterSet>]) -> Self {
        let groups = groups.iter().filter(|group| !group.is_empty());
        Self {
            ranges: Vec::new(),
            groups: groups.cloned().collect(),
        }
    }

    /// The middle of what is drawn: the median of each parameter over the points, and the middle of each range. A run without noise has
    /// these values.
    ///
    /// # Errors
    /// None for what [`UncertainParameters::new`] has checked.
    pub fn centre(&self) -> Result<ParameterSet> {
        let mut set = ParameterSet::new();
        for group in &self.groups {
            for first in group.first().into_iter().flat_map(ParameterSet::iter) {
                let name = first.parameter.name;
                let values: Vec<f64> = group.iter().filter_map(|set| set.value(name)).collect();
                set = set.with(Assignment::new(name, median(&values))?);
            }
        }
        for range in &self.ranges {
            set = set.with(Assignment::new(
                &range.name,
                0.5 * (range.low + range.high),
            )?);
        }
        Ok(set)
    }

    /// The ranges in which values are drawn evenly.
    pub fn ranges(&self) -> &[UncertainRange] {
        &self.ranges
    }

    /// The experiment of one repeat before its noise.
    ///
    /// # Errors
    /// As [`UncertainParameters::draw`].
    pub fn apply(&self, experiment: &Experiment, seed: u64, repeat: u64) -> Result<Experiment> {
        Ok(self.draw(seed, repeat)?.apply(experiment))
    }

    /// A warning where repeats differ in parameters.
    pub fn warning(&self) -> Option<Warning> {
        (!self.is_empty()).then(|| {
            Code::UncertainParameters.warning(
                "repeats differ in the parameters that tuning left open, too; the run without noise has the fixed values",
            )
        })
    }

    /// Whether every repeat has the same values.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty() && self.groups.is_empty()
    }

    /// Values of one repeat; they depend on the seed and the repeat alone.
    ///
    /// # Errors
    /// None for what [`UncertainParameters::new`] has checked.
    pub fn draw(&self, seed: u64, repeat: u64) -> Result<ParameterSet> {
        let mut rng = Numbered::UncertainParameter.generator(seed, repeat);
        let mut set = ParameterSet::new();
        for group in &self.groups {
            set = set.with_all(&group[rng.random_range(0..group.len())]);
        }
        for range in &self.ranges {
            let share: f64 = rng.random();
            let value = range.low * (1.0 - share) + range.high * share;
            set = set.with(Assignment::new(&range.name, value)?);
        }
        Ok(set)
    }
}

/// File of a results folder with the points of the confidence set.
const INDISTINGUISHABLE_FILE: &str = "indistinguishable.csv";

/// The points of the confidence set in a results folder.
///
/// # Errors
/// No such file, unknown parameters, values that are not numbers or out of bounds, no point at all.
pub fn read_posterior(folder: &Path) -> Result<Vec<ParameterSet>> {
    let path = folder.join(INDISTINGUISHABLE_FILE);
    let limit = 1 << 30;
    let bytes = read_limited(&path, limit, "indistinguishable points")
        .map_err(|e| e.or_hint("name a folder that a sweep or tuning has written"))?;
    // A folder of points that was put together by hand has no checksums.
    let is_sealed = Seal::read(folder)?.is_some_and(|seal| seal.has(INDISTINGUISHABLE_FILE));
    if !is_sealed && FolderLock::was_used(folder) {
        return Err(
            Error::conflict("nothing says that these points are what was written")
                .at_file(&path)
                .hint("run the sweep or tuning that writes the folder to its end")
                .advise(Advice::AcceptFiles),
        );
    }
    let torn =
        |e: csv::Error| Error::invalid(format!("cannot read the points: {e}")).at_file(&path);
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().map_err(torn)?.clone();
    let mut points = Vec::new();
    for row in reader.records() {
        let row = row.map_err(torn)?;
        let values = header.iter().zip(row.iter()).map(|(name, text)| {
            let value = text
                .parse()
                .map_err(|_| Error::invalid("not a number").field(name).found(text))?;
            Assignment::new(name, value)
        });
        let point: Result<ParameterSet> = values.collect();
        points.push(point.map_err(|e| e.at_file(&path))?);
    }
    if points.is_empty() {
        return Err(
            Error::invalid("no point is indistinguishable from the best")
                .at_file(&path)
                .hint("the study found no best point"),
        );
    }
    Ok(points)
}
