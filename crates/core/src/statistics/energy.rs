//! The energy test of Székely & Rizzo: do two samples come from one distribution? It needs only the distances of pairs.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::random::Once;

/// The number of random permutations for a p value; together with the observed order there are 2000, so the smallest p value is 0.0005.
pub const PERMUTATIONS: usize = 1999;
/// Relative tolerance, so that statistics that differ only by rounding count as equal.
const ROUNDING: f64 = 1e-12;

/// The energy distance of two samples, and the probability of a distance at least as large if both come from one distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnergyTest {
    /// ℰ = 2 E‖X − Y‖ − E‖X − X′‖ − E‖Y − Y′‖ over all pairs, including each member with itself (Székely & Rizzo 2013, section 6), in
    /// the unit of the distances; 0 if the samples are equal.
    pub distance: f64,
    /// Mean distance between the samples, divided by the mean of the two mean distances within the samples (pairs of different members): near
    /// 1 if both come from one distribution, for any sample sizes; `None` if no members within the samples differ.
    pub ratio: Option<f64>,
    /// Share of permutations of all members, the observed order included, with an ℰ at least as large. It is valid for any distance; for
    /// a distance of negative type (such as all Euclidean ones) it is small for every kind of difference if the samples are large enough.
    pub p_value: f64,
    /// The number of random permutations.
    pub permutations: usize,
}

/// Tests whether the first `first` members come from the same distribution as the others.
///
/// `distances` holds the distances of all pairs of members in the order (0, 1), (0, 2), …, (1, 2), ….
///
/// ```
/// use realgap_core::statistics::energy_test;
///
/// // 0, 1, 2 against 0.5, 1.5: |x − y| of all pairs.
/// let values: [f64; 5] = [0.0, 1.0, 2.0, 0.5, 1.5];
/// let pairs = (0..5).flat_map(|i| (i + 1..5).map(move |j| (values[i] - values[j]).abs()));
/// let test = energy_test(&pairs.collect::<Vec<_>>(), 3, 1)?;
/// // 2 · 5/6 − 8/9 − 1/2
/// assert!((test.distance - 5.0 / 18.0).abs() < 1e-12);
/// assert!(test.p_value > 0.5);
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// A number of distances that differs from the number of pairs, an empty sample, distances that are negative or not finite.
pub fn energy_test(distances: &[f64], first: usize, seed: u64) -> Result<EnergyTest> {
    let members = members_of(distances.len()).filter(|members| (1..*members).contains(&first));
    let Some(members) = members else {
        return Err(Error::invalid("not the distances of two samples")
            .found(format!(
                "{} distances, {first} members in the first",
                distances.len()
            ))
            .allowed("the distances of all pairs, and at least one member in each sample"));
    };
    if let Some(wrong) = distances.iter().find(|d| !(d.is_finite() && **d >= 0.0)) {
        return Err(Error::invalid("not a distance")
            .found(wrong)
            .allowed("0 or more"));
    }
    let table = Table::new(distances, members);
    let observed = table.sums(&(0..first).collect::<Vec<_>>());
    let distance = observed.energy();
    let mut rng = Once::Permutation.generator(seed);
    let mut order: Vec<usize> = (0..members).collect();
    let mut as_large = 1;
    for _ in 0..PERMUTATIONS {
        // The first steps of a Fisher-Yates shuffle draw `first` members.
        for place in 0..first {
            order.swap(place, rng.random_range(place..members));
        }
        let drawn = table.sums(&order[..first]).energy();
        as_large += usize::from(drawn >= distance - ROUNDING * table.largest);
    }
    Ok(EnergyTest {
        distance,
        ratio: observed.ratio(),
        p_value: as_large as f64 / (PERMUTATIONS + 1) as f64,
        permutations: PERMUTATIONS,
    })
}

/// The number of members that have this number of pairs; `None` if no number does.
fn members_of(pairs: usize) -> Option<usize> {
    let members = (0.5 + (0.25 + 2.0 * pairs as f64).sqrt()).round() as usize;
    (members * (members - 1) / 2 == pairs).then_some(members)
}

/// The distances of all pairs, with the sums that every permutation needs.
struct Table {
    members: usize,
    /// The full symmetric matrix of distances, row by row.
    distances: Vec<f64>,
    row_sums: Vec<f64>,
    total: f64,
    largest: f64,
}

impl Table {
    fn new(pairs: &[f64], members: usize) -> Self {
        let mut distances = vec![0.0; members * members];
        let all = (0..members).flat_map(|i| (i + 1..members).map(move |j| (i, j)));
        for ((i, j), distance) in all.zip(pairs) {
            distances[i * members + j] = *distance;
            distances[j * members + i] = *distance;
        }
        let row_sums: Vec<f64> = distances
            .chunks(members)
            .map(|row| row.iter().sum())
            .collect();
        Self {
            members,
            total: pairs.iter().sum(),
            largest: pairs.iter().fold(0.0, |a, b| a.max(*b)),
            distances,
            row_sums,
        }
    }

    /// Sums of the distances within and between the samples, if the members `chosen` are the first sample.
    fn sums(&self, chosen: &[usize]) -> Sums {
        let (mut within, mut rows) = (0.0, 0.0);
        for (index, &i) in chosen.iter().enumerate() {
            rows += self.row_sums[i];
            let row = &self.distances[i * self.members..][..self.members];
            within += chosen[..index].iter().map(|&j| row[j]).sum::<f64>();
        }
        let between = rows - 2.0 * within;
        Sums {
            sizes: [chosen.len(), self.members - chosen.len()].map(|n| n as f64),
            within: [within, self.total - within - between],
            between,
        }
    }
}

/// Sums over pairs; each pair is counted once.
struct Sums {
    sizes: [f64; 2],
    within: [f64; 2],
    between: f64,
}

impl Sums {
    fn energy(&self) -> f64 {
        let [n, m] = self.sizes;
        let [x, y] = self.within;
        (2.0 * self.between / (n * m) - 2.0 * x / (n * n) - 2.0 * y / (m * m)).max(0.0)
    }

    fn ratio(&self) -> Option<f64> {
        let [n, m] = self.sizes;
        let [x, y] = self.within;
        if n < 2.0 || m < 2.0 {
            return None;
        }
        let within = x / (n * (n - 1.0)) + y / (m * (m - 1.0));
        (within > 0.0).then(|| self.between / (n * m) / within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_that_do_not_describe_two_samples_are_refused() {
        for (distances, first) in [
            (vec![], 0),
            (vec![1.0], 0),
            (vec![1.0], 2),
            (vec![1.0, 2.0], 1),
            (vec![1.0, f64::NAN, 1.0], 1),
            (vec![1.0, -1.0, 1.0], 1),
        ] {
            assert!(energy_test(&distances, first, 1).is_err(), "{distances:?}");
        }
    }

    #[test]
    fn equal_samples_of_one_value_have_distance_zero_and_no_ratio() {
        let test = energy_test(&[0.0; 15], 3, 1).unwrap();
        assert_eq!((test.distance, test.ratio, test.p_value), (0.0, None, 1.0));
    }

    #[test]
    fn the_same_seed_gives_the_same_permutations() {
        let distances: Vec<f64> = (0..45).map(|k| f64::from(k * 7 % 11)).collect();
        let of = |seed| energy_test(&distances, 4, seed).unwrap();
        assert_eq!(of(1), of(1));
        assert_ne!(of(1).p_value, of(2).p_value);
        assert_eq!(of(1).distance, of(2).distance);
    }
}
