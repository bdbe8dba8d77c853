//! Shadowing: the part of a strength that depends on the position and is correlated between near positions.

use rand::RngExt;
use rand_distr::StandardNormal;

use realgap_core::random::Numbered;

/// Number of waves of a field. With 256 waves, the covariance of a single field has an error of 0.04 at any distance, which is as much
/// as the information of all its places about the parameters of a model: the 90 % intervals of the parameters then contained the truth
/// in 84 % of fits, even with the known covariance.
const WAVES: usize = 2048;

/// A random field over pairs of places with covariance exp(−h/L) and variance 1, the same in both directions of a link.
///
/// It is a sum of cosines whose frequencies are drawn from the field's spectrum (Rahimi & Recht 2007; the spectrum of exp(−h/L) is a
/// multivariate Cauchy distribution), so that it can be evaluated at any positions in any order.
#[derive(Debug, Clone)]
pub struct ShadowField {
    waves: Vec<([f64; 4], f64)>,
}

impl ShadowField {
    /// The field of a seed with this correlation distance in metres.
    pub fn new(seed: u64, distance_m: f64) -> Self {
        let mut rng = Numbered::Shadowing.generator(seed, 0);
        let waves = (0..WAVES)
            .map(|_| {
                let normal = [(); 4].map(|()| rng.sample::<f64, _>(StandardNormal));
                let width = rng.sample::<f64, _>(StandardNormal).abs().max(1e-9);
                let phase = std::f64::consts::TAU * rng.random::<f64>();
                (normal.map(|n| n / (width * distance_m)), phase)
            })
            .collect();
        Self { waves }
    }

    /// The value of the field for a link between two positions.
    pub fn at(&self, from_m: [f64; 2], to_m: [f64; 2]) -> f64 {
        let one_way = |a: [f64; 2], b: [f64; 2]| {
            self.waves
                .iter()
                .map(|(wave, phase)| {
                    libm::cos(
                        wave[0] * a[0] + wave[1] * a[1] + wave[2] * b[0] + wave[3] * b[1] + phase,
                    )
                })
                .sum::<f64>()
        };
        // The sum over both directions is symmetric; each direction contributes half of the variance.
        (one_way(from_m, to_m) + one_way(to_m, from_m)) / (WAVES as f64).sqrt()
    }
}
