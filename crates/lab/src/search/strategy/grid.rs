//! Every combination of chosen values of chosen genes.

use serde::{Deserialize, Serialize};

use super::{Evaluated, Space, Strategy, StrategySettings, within};
use realgap_core::{Error, Result};
use realgap_robot::genome::{Gene, Genome, Locus};

/// Values of one number of a gene, in one module or in all modules alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GeneValues {
    /// Which module, counted from 0; left out: all modules get the same value.
    #[serde(default)]
    pub module: Option<usize>,
    /// Name of the number, e.g. `amplitude`.
    pub gene: String,
    /// The values, each from 0 to 1.
    pub values: Vec<f64>,
}

/// A grid as a file names it: around the genome or the robot that the search starts from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GridSettings {
    /// The varied numbers; the first one changes slowest.
    pub genes: Vec<GeneValues>,
}

impl StrategySettings for GridSettings {
    fn strategy(&self, space: &Space) -> Result<Box<dyn Strategy>> {
        let named = self.genes.iter();
        let named: Vec<Locus> = named.filter_map(|g| Locus::named(&g.gene).ok()).collect();
        let base = space.base(&named)?;
        space.must_leave_the_body(&named)?;
        let axes = self.genes.clone();
        let grid = Grid { base, axes };
        grid.check().map_err(|e| within("strategy", e))?;
        Ok(Box::new(grid))
    }
}

/// A grid around one genome: all genes that are not named stay as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The genome in the middle.
    pub base: Genome,
    /// The varied numbers; the first one changes slowest.
    pub axes: Vec<GeneValues>,
}

/// Most robots of one grid.
const ROBOTS_AT_MOST: usize = 1_000_000;

impl Grid {
    /// Checks every axis.
    ///
    /// # Errors
    /// No axis, an unknown gene or module, no values or values out of bounds, too many combinations.
    pub fn check(&self) -> Result<()> {
        if self.axes.is_empty() {
            return Err(Error::invalid("a grid without genes")
                .field("genes")
                .allowed("at least one gene with its values"));
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let at = format!("genes[{index}]");
            let locus = Locus::named(&axis.gene).map_err(|e| e.field(format!("{at}.gene")))?;
            if axis.module.is_some_and(|m| m >= self.base.len()) {
                return Err(Error::invalid("there is no such module")
                    .field(format!("{at}.module"))
                    .found(axis.module.unwrap_or_default())
                    .allowed(format!("0 to {}", self.base.len() - 1)));
            }
            let bad = axis.values.iter().find(|v| !(0.0..=1.0).contains(*v));
            if bad.is_some() || axis.values.is_empty() {
                return Err(Error::invalid("not usable values of a gene")
                    .field(format!("{at}.values"))
                    .found(bad.map_or("none".to_owned(), f64::to_string))
                    .allowed(format!(
                        "one or more from 0 to 1 (this is `{}`)",
                        locus.name()
                    )));
            }
        }
        self.axes
            .iter()
            .try_fold(1_usize, |all, axis| all.checked_mul(axis.values.len()))
            .filter(|all| *all <= ROBOTS_AT_MOST)
            .map(|_| ())
            .ok_or_else(|| {
                Error::invalid("too many combinations")
                    .field("genes")
                    .allowed(format!("at most {ROBOTS_AT_MOST}"))
            })
    }

    fn at(&self, index: usize) -> Result<Genome> {
        let mut genes: Vec<[f64; Gene::LEN]> =
            self.base.genes().iter().map(|g| *g.values()).collect();
        let mut rest = index;
        for axis in self.axes.iter().rev() {
            let value = axis.values[rest % axis.values.len()];
            rest /= axis.values.len();
            let locus = Locus::named(&axis.gene)?.index();
            for (module, gene) in genes.iter_mut().enumerate() {
                if axis.module.is_none_or(|chosen| chosen == module) {
                    gene[locus] = value;
                }
            }
        }
        Genome::try_from(genes)
    }
}

impl Strategy for Grid {
    fn name(&self) -> &'static str {
        "grid"
    }

    fn budget(&self) -> usize {
        let counts = self.axes.iter().map(|axis| axis.values.len());
        counts.fold(1, usize::saturating_mul)
    }

    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        self.check()?;
        (history.len()..self.budget()).map(|i| self.at(i)).collect()
    }
}
