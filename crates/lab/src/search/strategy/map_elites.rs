//! MAP-Elites: the best robot of every kind of behaviour.
//!
//! J.-B. Mouret and J. Clune, "Illuminating search spaces by mapping elites", arXiv 1504.04909, 2015.

use rand::RngExt as _;
use realgap_core::random::Generator;
use serde::Deserialize;

use super::{
    Archive, Axis, Born, Evaluated, Space, Strategy, StrategySettings, Variation, generator,
    genomes, must_not_be_0, parents, selection_named, within,
};
use realgap_core::range::Range;
use realgap_core::{Error, Result};
use realgap_robot::genome::Genome;

/// Random robots first, then children of the elites of randomly chosen cells.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MapElites {
    /// The axes of the archive, at least one.
    pub axes: Vec<Axis>,
    /// Random robots at the beginning.
    pub initial: usize,
    /// Robots proposed at once after that.
    pub batch: usize,
    /// Robots of the whole search.
    pub evaluations: usize,
    /// Name of the selection of parents among the elites, one of the [`SELECTIONS`](crate::search::SELECTIONS); without it all
    /// elites have the same probability.
    pub selection: Option<String>,
    /// Share of children that are a copy of an elite, body and gait; where the search tunes gaits, the tuning continues from that
    /// gait.
    pub again: f64,
    /// How the other children are made.
    pub variation: Variation,
    /// Seed of every random choice; that of the search in place of it where the strategy is part of one.
    #[serde(skip)]
    pub seed: u64,
}

impl Default for MapElites {
    /// A hundred robots, ten at a time; without an axis, because only the user knows which descriptors matter.
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            initial: 10,
            batch: 10,
            evaluations: 100,
            selection: None,
            again: 0.0,
            variation: Variation::default(),
            seed: 1,
        }
    }
}

/// Most cells of one archive.
const CELLS_AT_MOST: usize = 1_000_000;

impl MapElites {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self) -> Result<()> {
        if self.axes.is_empty() {
            return Err(Error::invalid("an archive without descriptors")
                .field("axes")
                .allowed("at least one axis")
                .hint(
                    "name what tells robots apart, e.g. the number of modules and of driven faces",
                ));
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let span = axis.to - axis.from;
            if !(span.is_finite() && span > 0.0) || axis.cells == 0 {
                return Err(Error::invalid("not a usable axis")
                    .field(format!("axes[{index}]"))
                    .found(format!(
                        "{} cells from {} to {}",
                        axis.cells, axis.from, axis.to
                    ))
                    .allowed("at least one cell, `from` below `to`, both finite"));
            }
        }
        let mut cells = self.axes.iter().map(|axis| axis.cells);
        let cells = cells.try_fold(1_usize, usize::checked_mul);
        if cells.is_none_or(|cells| cells > CELLS_AT_MOST) {
            return Err(Error::invalid("too many cells")
                .field("axes")
                .allowed(format!("at most {CELLS_AT_MOST} in all")));
        }
        must_not_be_0("initial", self.initial)?;
        must_not_be_0("batch", self.batch)?;
        must_not_be_0("evaluations", self.evaluations)?;
        if let Some(name) = &self.selection {
            selection_named(name)?;
        }
        Range::within(0.0, 1.0, "").check(self.again, "again")?;
        self.variation.check()
    }
}

impl StrategySettings for MapElites {
    fn strategy(&self, space: &Space) -> Result<Box<dyn Strategy>> {
        space.must_be_free()?;
        self.check().map_err(|e| within("strategy", e))?;
        space.must_hold(&self.variation)?;
        let seed = space.seed();
        Ok(Box::new(Self {
            seed,
            ..self.clone()
        }))
    }
}

impl Strategy for MapElites {
    fn name(&self) -> &'static str {
        "map-elites"
    }

    fn budget(&self) -> usize {
        self.evaluations
    }

    fn descriptors(&self) -> Vec<&str> {
        self.axes.iter().map(|axis| axis.name.as_str()).collect()
    }

    fn archive(&self, history: &[Evaluated]) -> Result<Option<Archive>> {
        self.check()?;
        Ok(Some(Archive::new(&self.axes, history)))
    }

    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        Ok(genomes(self.born(history)?))
    }

    fn parents(&self, history: &[Evaluated]) -> Result<Vec<Vec<usize>>> {
        Ok(parents(self.born(history)?))
    }
}

impl MapElites {
    fn born(&self, history: &[Evaluated]) -> Result<Vec<Born>> {
        self.check()?;
        if history.len() >= self.evaluations {
            return Ok(Vec::new());
        }
        let (step, done, size) = match history.len().checked_sub(self.initial) {
            None => (0, history.len(), self.initial),
            Some(later) => (1 + later / self.batch, later % self.batch, self.batch),
        };
        let mut rng = generator(self.seed, step as u64);
        // Only robots before the current batch count, however much of the batch is done.
        let known = &history[..history.len() - done];
        let archive = Archive::new(&self.axes, known);
        let elites: Vec<usize> = archive.cells().iter().filter_map(|cell| *cell).collect();
        let fitness: Vec<f64> = elites.iter().map(|&e| known[e].comparable()).collect();
        let selection = self.selection.as_deref().map(selection_named).transpose()?;
        let parent = |rng: &mut Generator| match selection {
            None => elites[rng.random_range(0..elites.len())],
            Some(selection) => elites[selection.pick(&fitness, rng)],
        };
        let mut batch = Vec::with_capacity(size);
        for _ in 0..size {
            // As long as every robot fails, random robots are proposed.
            batch.push(if elites.is_empty() {
                (self.variation.random(&mut rng)?, Vec::new())
            } else {
                let (first, second) = (parent(&mut rng), parent(&mut rng));
                let (one, other) = (&known[first].genome, &known[second].genome);
                // No random number is drawn where the share is 0, so that the results of older searches stay the same.
                if self.again > 0.0 && rng.random_bool(self.again) {
                    (one.clone(), vec![first])
                } else {
                    let child = self.variation.child(one, other, &mut rng)?;
                    (child, vec![first, second])
                }
            });
        }
        let left = self.evaluations - known.len();
        batch.truncate(left);
        Ok(batch.split_off(done))
    }
}
