//! `realgap evaluate --odds`: probabilities of the final poses of recordings.

use realgap::calibration::{Study, read_noise};
use realgap::optimization::RunOptions;
use realgap::prediction::{Odds, OddsOptions};
use realgap::results;
use realgap::simulation::parameter::ParameterSet;

use super::kit::*;

/// Options of the odds.
#[derive(Debug, Args)]
pub struct OddsOption {
    /// Simulate every recording that ends at rest N times under noise and other numerical settings, and score the odds of its final
    /// pose
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "64", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    odds: Option<u32>,
    /// Noise of the odds from this file in place of the study's
    #[arg(long, value_name = "FILE", requires = "odds")]
    noise: Option<PathBuf>,
    /// Seed of the odds' draws
    #[arg(long, value_name = "SEED", default_value_t = 1, requires = "odds")]
    seed: u64,
    /// Draw the reliability diagram of the odds into this file (.png or .svg)
    #[arg(long, value_name = "FILE", requires = "odds")]
    plot: Option<PathBuf>,
}

impl OddsOption {
    /// The file of the reliability diagram.
    pub fn plot(&self) -> Option<&PathBuf> {
        self.plot.as_ref()
    }

    /// The odds, with their diagram where `--plot` is given; `None` without `--odds`.
    pub fn odds(&self, study: &Study, file: &Path, run: RunOptions<'_>) -> Result<Option<Odds>> {
        let Some(runs) = self.odds else {
            return Ok(None);
        };
        let noise = match (&self.noise, study.definition().noise) {
            (Some(file), _) => read_noise(file)?,
            (None, Some(noise)) => noise,
            (None, None) => {
                return Err(Error::invalid("odds need noise, and the study has none")
                    .at_file(file)
                    .field("noise")
                    .hint("add e.g. noise: (start_velocity_m_s: Normal(0.02), start_spin_rad_s: Normal(0.3)), or name a file with --noise"));
            }
        };
        output::check_pictures(&self.plot)?;
        let options = OddsOptions {
            noise,
            runs: runs as usize,
            seed: self.seed,
        };
        let total = study.cases().len();
        let odds = progress::during(total, "odds", run, |run| {
            // The study already holds all values.
            Odds::new(study, &ParameterSet::new(), &options, run)
        })?;
        terminal::print_warnings(&odds.warnings[study.warnings().len()..]);
        if let Some(plot) = &self.plot {
            results::draw_odds(&odds, &study.definition().name, plot)?;
        }
        Ok(Some(odds))
    }
}
