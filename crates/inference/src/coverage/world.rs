//! Black boxes that are formulas.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use realgap_core::quantity::{Quantity, Scale};
use realgap_core::random::Generator;
use realgap_core::unit::Unit;
use realgap_optimization::{Grid, Range};

/// Numbers of an output.
const OUTPUTS: usize = 12;

/// A black box whose output has a closed form: the first parameter bends it, the second changes it by `second` times as much.
pub struct World {
    pub second: f64,
    /// Standard deviations of the deviations of a setting, a run and an observation, as shares of the output.
    pub setting: f64,
    pub run: f64,
    pub observation: f64,
    /// Standard deviation of either of two variants from their mean; reality is like one of them. 0 where there is one variant.
    pub variant: f64,
    pub shape: Shape,
}

/// How the output depends on the parameters.
#[derive(Clone, Copy, PartialEq)]
pub enum Shape {
    /// The first parameter bends the output, the second one changes it.
    Bent,
    /// Linear in the first parameter, so that the distance to reality has a kink.
    Straight,
    /// Linear in the distance of the first parameter from the middle, so that two values, on both sides of the middle, give the same
    /// output; both valleys of the score are narrow beside a coarse grid.
    TwoModes,
    /// Both parameters act through their sum alone.
    Ridge,
}

pub type Output = [f64; OUTPUTS];

pub fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}

fn noise(rng: &mut Generator, size: f64) -> Output {
    std::array::from_fn(|k| size * normal(rng) / (k + 1) as f64)
}

impl World {
    fn output(&self, at: &[f64]) -> Output {
        let line =
            |at: f64| std::array::from_fn(|k| at * ((k + 1) as f64 / OUTPUTS as f64).powi(2));
        match self.shape {
            Shape::Bent => {}
            Shape::Straight => return line(at[0]),
            Shape::TwoModes => return line(4.0 * (at[0] - 0.5).abs()),
            Shape::Ridge => return line(0.5 * (at[0] + at[1])),
        }
        std::array::from_fn(|k| {
            let bend = libm::sin(3.0 * at[0] * (1.0 + 0.2 * k as f64) + 0.3 * k as f64);
            let other = libm::cos(2.0 * at[1] + k as f64);
            (bend + self.second * other) / (1.0 + 0.3 * k as f64)
        })
    }

    /// A run with the setting and the variants of these numbers; the third number, 1 or −1, says which variant is run.
    pub fn run(
        &self,
        at: &[f64],
        (setting, variants, variant): (u64, u64, f64),
        rng: &mut Generator,
        size: f64,
    ) -> Output {
        let (output, rest) = (self.output(at), noise(rng, size));
        let own = deviation(setting, at, self.setting);
        let half_difference = deviation(variants, at, self.variant);
        std::array::from_fn(|k| output[k] + own[k] + rest[k] + variant * half_difference[k])
    }
}

/// Deviation of the setting or the variant with this number; it changes smoothly with the parameters.
fn deviation(number: u64, at: &[f64], size: f64) -> Output {
    let mut rng = Generator::seed_from_u64(number);
    let (a, b) = (noise(&mut rng, size), noise(&mut rng, size));
    std::array::from_fn(|k| a[k] + b[k] * libm::sin(2.0 * at[0]))
}

/// Two parameters from 0 to 1, each with so many values.
pub fn grid(points: usize) -> Grid {
    let range = |name| {
        let parameter = Quantity {
            name,
            unit: Unit::One,
            bounds: (0.0, 1.0),
            whole: false,
            scale: Scale::Linear,
        };
        Range::new(parameter, 0.0, 1.0, points).unwrap()
    };
    Grid::new(vec![range("first"), range("second")]).unwrap()
}
