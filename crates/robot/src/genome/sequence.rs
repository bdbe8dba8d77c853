//! Genes and genomes: lists of numbers from 0 to 1, one gene per module.

use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use super::locus::Locus;
use crate::morphology::Morphology;
use realgap_core::{Error, Result};

/// The ten numbers of one module, each from 0 to 1; [`Locus`] says what they mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gene([f64; Gene::LEN]);

impl Gene {
    /// Numbers of one gene (paper 003, section 2.1).
    pub const LEN: usize = Locus::ALL.len();

    /// A gene of these numbers, in the order of [`Locus::ALL`].
    ///
    /// # Errors
    /// A number that is not from 0 to 1.
    pub fn new(values: [f64; Self::LEN]) -> Result<Self> {
        for (locus, value) in Locus::ALL.into_iter().zip(values) {
            check_value(locus, value).map_err(|error| error.field(locus.name()))?;
        }
        Ok(Self(values))
    }

    /// A gene of any numbers: numbers outside 0 to 1 are moved to the nearer end, and NaN becomes 0.
    pub fn clamped(values: [f64; Self::LEN]) -> Self {
        let inside = |value: f64| {
            if value.is_nan() {
                0.0
            } else {
                // Adding 0 turns -0 into 0.
                value.clamp(0.0, 1.0) + 0.0
            }
        };
        Self(values.map(inside))
    }

    /// A gene whose numbers are drawn from the uniform distribution over 0 to 1.
    pub fn random(rng: &mut (impl Rng + ?Sized)) -> Self {
        Self(std::array::from_fn(|_| rng.random::<f64>()))
    }

    /// The number at a locus, from 0 to 1.
    pub fn get(&self, locus: Locus) -> f64 {
        self.0[locus.index()]
    }

    /// All numbers, in the order of [`Locus::ALL`].
    pub fn values(&self) -> &[f64; Self::LEN] {
        &self.0
    }

    /// The number at a locus as one of `count` choices of equal width, 0 to `count` − 1.
    pub fn choice(&self, locus: Locus, count: usize) -> usize {
        let chosen = (self.get(locus) * count as f64).floor() as usize;
        chosen.min(count.saturating_sub(1))
    }

    /// The number at a locus as a value of a range.
    pub fn within(&self, locus: Locus, (low, high): (f64, f64)) -> f64 {
        let share = self.get(locus);
        // This form is exact at both ends of the range.
        low * (1.0 - share) + high * share
    }
}

pub(super) fn check_value(locus: Locus, value: f64) -> Result<()> {
    if (0.0..=1.0).contains(&value) {
        return Ok(());
    }
    let problem = if value.is_finite() {
        "out of bounds"
    } else {
        "not a finite number"
    };
    Err(Error::invalid(problem)
        .found(value)
        .allowed(format!("0 to 1 (this is `{}`)", locus.name())))
}

/// The genes of one robot, one per module, in the order in which the robot is built.
///
/// ```
/// use realgap_robot::genome::{Gene, Genome};
///
/// let genome = Genome::new(vec![Gene::clamped([0.5; 10]); 3])?;
/// assert_eq!(genome.len(), 3);
/// assert!(Genome::new(Vec::new()).is_err());
/// # Ok::<(), realgap_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "Vec<[f64; Gene::LEN]>", into = "Vec<[f64; Gene::LEN]>")]
pub struct Genome(Vec<Gene>);

/// Conversion from a list of lists of numbers, for stores and tables; the result is checked like any other genome.
impl TryFrom<Vec<[f64; Gene::LEN]>> for Genome {
    type Error = Error;

    fn try_from(genes: Vec<[f64; Gene::LEN]>) -> Result<Self> {
        let genes: Result<Vec<Gene>> = genes.into_iter().map(Gene::new).collect();
        Self::new(genes?)
    }
}

impl From<Genome> for Vec<[f64; Gene::LEN]> {
    fn from(genome: Genome) -> Self {
        genome.0.into_iter().map(|gene| gene.0).collect()
    }
}

impl Genome {
    /// Largest number of modules of any genome; [`Development::max_modules`](super::Development::max_modules) is usually smaller.
    pub const MAX_MODULES: usize = Morphology::MAX_MODULES;

    /// A genome of these genes.
    ///
    /// # Errors
    /// An empty list of genes, or more genes than [`Genome::MAX_MODULES`].
    pub fn new(genes: Vec<Gene>) -> Result<Self> {
        check_count(genes.len())?;
        Ok(Self(genes))
    }

    /// A genome of `modules` genes whose numbers are drawn from the uniform distribution over 0 to 1.
    ///
    /// # Errors
    /// As [`Genome::new`].
    pub fn random(modules: usize, rng: &mut (impl Rng + ?Sized)) -> Result<Self> {
        check_count(modules)?;
        Ok(Self((0..modules).map(|_| Gene::random(rng)).collect()))
    }

    /// The genes, in the order in which the robot is built.
    pub fn genes(&self) -> &[Gene] {
        &self.0
    }

    /// Number of modules; never 0.
    #[allow(
        clippy::len_without_is_empty,
        reason = "a genome is never empty, so `is_empty` would always return false"
    )]
    pub fn len(&self) -> usize {
        self.0.len()
    }
}

fn check_count(modules: usize) -> Result<()> {
    if (1..=Genome::MAX_MODULES).contains(&modules) {
        return Ok(());
    }
    let problem = if modules == 0 {
        "a genome without modules"
    } else {
        "too many modules"
    };
    Err(Error::invalid(problem)
        .field("modules")
        .found(modules)
        .allowed(format!("1 to {}", Genome::MAX_MODULES)))
}
