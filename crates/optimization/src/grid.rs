//! Grids: every combination of evenly spaced values of some parameters.

use realgap_core::error::{Advice, Error, Result};
use realgap_core::quantity::{Quantity, Scale};

/// Evenly spaced values of one parameter, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The parameter that varies.
    pub parameter: Quantity,
    /// First value.
    pub from: f64,
    /// Last value, greater than the first.
    pub to: f64,
    /// Number of values, at least 2.
    pub points: usize,
}

/// Largest number of points along one parameter.
pub const MAX_POINTS: usize = 10_001;
/// Largest number of points of a whole grid.
pub const MAX_GRID: usize = 10_000_000;

impl Range {
    /// A checked range.
    ///
    /// # Errors
    /// Values out of the parameter's bounds, `from` not below `to`, fewer than 2 or too many points.
    pub fn new(parameter: impl Into<Quantity>, from: f64, to: f64, points: usize) -> Result<Self> {
        let parameter = parameter.into();
        for value in [from, to] {
            // Only the ends are checked to be whole numbers here; the spacing of a whole-number parameter is checked below.
            parameter.check(value)?;
        }
        if from >= to {
            return Err(Error::invalid("an empty range")
                .field(parameter.name)
                .found(format!("from {from} to {to}"))
                .allowed("from below to"));
        }
        if !(2..=MAX_POINTS).contains(&points) {
            return Err(Error::invalid("wrong number of points")
                .field(parameter.name)
                .found(points)
                .allowed(format!("2 to {MAX_POINTS}"))
                .hint("to keep a parameter at one value, put it under `set`"));
        }
        if parameter.whole && ((to - from) / (points - 1) as f64).fract() != 0.0 {
            return Err(
                Error::invalid("the points of a whole-number parameter must be whole")
                    .field(parameter.name)
                    .found(format!("{points} points from {from} to {to}"))
                    .allowed(format!(
                        "a number of points that divides the range, e.g. {}",
                        to - from + 1.0
                    )),
            );
        }
        Ok(Self {
            parameter,
            from,
            to,
            points,
        })
    }

    /// Value number `index`. Both ends are exact; values between them are rounded to 12 significant digits, so that
    /// the value is, for example, 0.405 instead of 0.40499999999999997.
    pub fn value(&self, index: usize) -> f64 {
        if index == 0 {
            return self.from;
        }
        if index + 1 == self.points {
            return self.to;
        }
        let exact = self.from + (self.to - self.from) * index as f64 / (self.points - 1) as f64;
        format!("{exact:.11e}").parse().unwrap_or(exact)
    }

    /// The value at a coordinate from 0 (`from`) to 1 (`to`), which is linear on the parameter's own scale. Both ends are
    /// exact; values of whole-number parameters are rounded.
    pub fn at(&self, coordinate: f64) -> f64 {
        let share = coordinate.clamp(0.0, 1.0);
        if share == 0.0 {
            return self.from;
        }
        if share == 1.0 {
            return self.to;
        }
        let value = if self.parameter.scale == Scale::Log && self.from > 0.0 {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        };
        let value = if self.parameter.whole {
            value.round()
        } else {
            value
        };
        value.clamp(self.from, self.to)
    }

    /// The coordinate from 0 to 1 at which [`Range::at`] has this value.
    pub fn coordinate(&self, value: f64) -> f64 {
        let share = if self.parameter.scale == Scale::Log && self.from > 0.0 {
            libm::log(value / self.from) / libm::log(self.to / self.from)
        } else {
            (value - self.from) / (self.to - self.from)
        };
        share.clamp(0.0, 1.0)
    }

    /// All values, increasing.
    pub fn values(&self) -> Vec<f64> {
        (0..self.points).map(|index| self.value(index)).collect()
    }

    /// Index of the value nearest to `value`.
    pub fn nearest(&self, value: f64) -> usize {
        let place = (value - self.from) / self.step();
        (place.round().max(0.0) as usize).min(self.points - 1)
    }

    /// Distance between neighbouring values.
    pub fn step(&self) -> f64 {
        (self.to - self.from) / (self.points - 1) as f64
    }
}

/// Every combination of the values of some ranges; the last range varies fastest. The default grid has no ranges.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    ranges: Vec<Range>,
}

impl Grid {
    /// A grid over at least one range.
    ///
    /// # Errors
    /// No range, or a parameter twice.
    pub fn new(ranges: Vec<Range>) -> Result<Self> {
        if ranges.is_empty() {
            return Err(Error::invalid("nothing to vary")
                .field("parameters")
                .allowed("at least one parameter with from, to and points"));
        }
        for (index, range) in ranges.iter().enumerate() {
            if ranges[..index]
                .iter()
                .any(|other| other.parameter.name == range.parameter.name)
            {
                return Err(Error::invalid("a parameter is listed twice")
                    .field("parameters")
                    .found(range.parameter.name));
            }
        }
        Ok(Self { ranges })
    }

    /// Refuses a grid that has too many points to evaluate all of them. Optimizers evaluate only some points and do not need
    /// this check.
    ///
    /// # Errors
    /// More than ten million points.
    pub fn check_size(&self) -> Result<()> {
        if self.len() <= MAX_GRID {
            return Ok(());
        }
        Err(Error::invalid("too many combinations")
            .field("parameters")
            .allowed(format!("at most {MAX_GRID} points in all"))
            .hint("take fewer points per parameter")
            .advise(Advice::LetOptimizerChoose))
    }

    /// The ranges, in order.
    pub fn ranges(&self) -> &[Range] {
        &self.ranges
    }

    /// Number of points, at most `usize::MAX`.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.ranges
            .iter()
            .fold(1, |size: usize, range| size.saturating_mul(range.points))
    }

    /// Index along each range of point number `index`.
    pub fn coordinates(&self, index: usize) -> Vec<usize> {
        let mut rest = index;
        let mut coordinates = vec![0; self.ranges.len()];
        for (coordinate, range) in coordinates.iter_mut().zip(&self.ranges).rev() {
            *coordinate = rest % range.points;
            rest /= range.points;
        }
        coordinates
    }

    /// Number of the point with these indices along the ranges.
    pub fn index(&self, coordinates: &[usize]) -> usize {
        self.ranges
            .iter()
            .zip(coordinates)
            .fold(0, |index, (range, c)| index * range.points + c)
    }

    /// Index along each range of the point nearest to these values.
    pub fn nearest(&self, values: &[f64]) -> Vec<usize> {
        let axes = self.ranges.iter().zip(values);
        axes.map(|(range, value)| range.nearest(*value)).collect()
    }

    /// Parameter values at a point that is given by one coordinate from 0 to 1 for each range, as in [`Range::at`].
    pub fn values_at(&self, place: &[f64]) -> Vec<f64> {
        let axes = self.ranges.iter().zip(place);
        axes.map(|(range, coordinate)| range.at(*coordinate))
            .collect()
    }

    /// The coordinates at which [`Grid::values_at`] has these values.
    pub fn place_of(&self, values: &[f64]) -> Vec<f64> {
        let axes = self.ranges.iter().zip(values);
        axes.map(|(range, value)| range.coordinate(*value))
            .collect()
    }

    /// Parameter values of point number `index`.
    pub fn values(&self, index: usize) -> Vec<f64> {
        self.coordinates(index)
            .iter()
            .zip(&self.ranges)
            .map(|(c, range)| range.value(*c))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::unit::Unit;

    const FRICTION: Quantity = Quantity {
        name: "friction",
        unit: Unit::One,
        bounds: (0.0, 10.0),
        whole: false,
        scale: Scale::Linear,
    };
    const RESTITUTION: Quantity = Quantity {
        name: "restitution",
        bounds: (0.0, 1.0),
        ..FRICTION
    };
    const COUNT: Quantity = Quantity {
        name: "count",
        bounds: (1.0, 256.0),
        whole: true,
        ..FRICTION
    };

    fn range(quantity: Quantity, from: f64, to: f64, points: usize) -> Range {
        Range::new(quantity, from, to, points).unwrap()
    }

    #[test]
    fn both_ends_are_exact_and_the_last_range_varies_fastest() {
        let grid = Grid::new(vec![
            range(FRICTION, 0.05, 1.0, 21),
            range(RESTITUTION, 0.0, 0.9, 21),
        ])
        .unwrap();
        assert_eq!(grid.len(), 441);
        assert_eq!(grid.values(0), [0.05, 0.0]);
        assert_eq!(grid.values(1), [0.05, 0.045]);
        assert_eq!(grid.values(440), [1.0, 0.9]);
        assert_eq!(grid.values(9), [0.05, 0.405]);
        for index in 0..441 {
            assert_eq!(grid.index(&grid.coordinates(index)), index);
        }
    }

    #[test]
    fn senseless_ranges_are_refused() {
        assert!(Range::new(FRICTION, 0.5, 0.5, 3).is_err());
        assert!(Range::new(FRICTION, -0.1, 0.5, 3).is_err());
        assert!(Range::new(FRICTION, 0.1, f64::NAN, 3).is_err());
        assert!(Range::new(FRICTION, 0.1, 0.5, 1).is_err());
        assert!(Range::new(COUNT, 1.0, 4.0, 3).is_err());
        assert!(Grid::new(vec![]).is_err());
        let twice = range(FRICTION, 0.0, 1.0, 3);
        assert!(Grid::new(vec![twice, twice]).is_err());
    }
}
