//! `realgap robot genome`: genomes to start from.

use std::collections::BTreeMap;

use realgap::robot::genome::{Genome, Individual, Locus};
use realgap::search::generator;

use super::kit::*;

commands! {
    /// Make genomes: ten numbers per module, from which `realgap robot develop` builds a robot
    GenomeCommand:
    Random(Random),
}

/// A drawn genome.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GenomeReport {
    /// Name of the robot.
    name: String,
    /// Number of modules.
    modules: usize,
    /// What it was drawn from.
    seed: u64,
    /// The numbers of each module, by name.
    genes: Vec<BTreeMap<&'static str, f64>>,
    /// Whether it develops.
    develops: bool,
    /// Why it does not develop.
    reason: Option<&'static str>,
    /// The file that it was written to.
    output: Option<PathBuf>,
}

/// The numbers of each module, by name.
pub fn named(genome: &Genome) -> Vec<BTreeMap<&'static str, f64>> {
    let genes = genome.genes().iter();
    genes
        .map(|gene| Locus::ALL.map(|l| (l.name(), gene.get(l))).into())
        .collect()
}

/// Draw a random genome; every number is uniformly distributed
///
/// Use it to get a genome for `realgap robot develop`, or robots to test other commands with.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap robot genome random --modules 3 --seed 1 -o genome.ron")]
pub struct Random {
    /// Number of modules
    #[arg(long, value_name = "N", default_value_t = 3)]
    modules: usize,
    /// Seed of the draw: the same seed gives the same genome
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Name of the robot [default: random_<modules>_<seed>]
    #[arg(long)]
    name: Option<String>,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to print; a file is always RON, which is what `realgap robot develop` reads
    #[arg(long, value_enum, default_value_t)]
    format: GenomeFormat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum GenomeFormat {
    /// A genome file
    #[default]
    Ron,
    /// JSON for machines
    Json,
}

impl Random {
    pub fn run(self) -> Result<()> {
        let genome = Genome::random(self.modules, &mut generator(self.seed, 0))
            .map_err(Error::into_usage)?;
        let name = self
            .name
            .unwrap_or_else(|| format!("random_{}_{}", self.modules, self.seed));
        Morphology::check_name(&name).map_err(Error::into_usage)?;
        let mut individual = Individual::new(name, genome);
        let usual = individual.development.max_modules;
        individual.development.max_modules = usual.max(self.modules);
        let misfit = individual.develop().err();
        if let Some(misfit) = &misfit {
            terminal::note(format!(
                "note: this genome does not develop: {misfit} [{}]",
                misfit.code()
            ));
        }
        let text = individual.to_ron()?;
        match &self.output {
            Some(path) => output::write_ron(path, &text)?,
            None if self.format == GenomeFormat::Json => {}
            None => terminal::print(text.trim_end()),
        }
        if self.format == GenomeFormat::Json {
            terminal::print_answer(&GenomeReport {
                genes: named(&individual.genome),
                modules: individual.genome.len(),
                name: individual.name,
                seed: self.seed,
                develops: misfit.is_none(),
                reason: misfit.map(|misfit| misfit.code()),
                output: self.output,
            })?;
        }
        Ok(())
    }
}
