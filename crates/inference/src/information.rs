//! How much information each group of errors adds to the others: D-optimality (Atkinson & Donev 1992).

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Information that one group of errors adds to prior knowledge and all other groups that are fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedInformation {
    /// Half of the increase of log2 of the determinant of the information matrix: one bit halves the volume of the confidence region.
    pub bits: f64,
    /// The same for each parameter by itself: one bit halves the length of its interval.
    pub parameters: Vec<f64>,
}

/// The information that each group adds; `None` where an information matrix is singular.
///
/// `groups` holds one information matrix per group of errors and whether the group is fitted; `prior` is the information of prior
/// knowledge.
pub fn added_information(
    groups: &[(DMatrix<f64>, bool)],
    prior: &DMatrix<f64>,
) -> Vec<Option<AddedInformation>> {
    let added = |number: usize| {
        let others = (0..groups.len()).filter(|other| *other != number && groups[*other].1);
        let others = others.fold(prior.clone(), |sum, other| sum + &groups[other].0);
        let with = (&others + &groups[number].0).cholesky()?;
        Some(gained(&others.cholesky()?, &with))
    };
    (0..groups.len()).map(added).collect()
}

/// By how much the second information matrix exceeds the first.
fn gained(without: &Cholesky<f64, Dyn>, with: &Cholesky<f64, Dyn>) -> AddedInformation {
    let half_log_determinant = |of: &Cholesky<f64, Dyn>| -> f64 {
        let diagonal = of.l_dirty().diagonal();
        diagonal.iter().map(|d| libm::log2(*d)).sum()
    };
    let (before, after) = (without.inverse(), with.inverse());
    let ratios = before.diagonal().component_div(&after.diagonal());
    let each = ratios.iter().map(|ratio| 0.5 * libm::log2(*ratio));
    AddedInformation {
        bits: half_log_determinant(with) - half_log_determinant(without),
        parameters: each.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_equal_group_halves_the_variance_which_is_half_a_bit_a_parameter() {
        let unit = DMatrix::<f64>::identity(2, 2);
        let groups = [
            (unit.clone(), true),
            (unit.clone(), true),
            (unit * 3.0, false),
        ];
        let added = added_information(&groups, &DMatrix::zeros(2, 2));
        let first = added[0].as_ref().unwrap();
        assert!((first.bits - 1.0).abs() < 1e-12, "{first:?}");
        assert!((first.parameters[0] - 0.5).abs() < 1e-12, "{first:?}");
        // A group that is not fitted adds to all that are.
        let other = added[2].as_ref().unwrap();
        assert!((other.bits - libm::log2(2.5)).abs() < 1e-12, "{other:?}");
        // Without the only group that is fitted nothing is known.
        let alone = [(DMatrix::<f64>::identity(2, 2), true)];
        assert_eq!(added_information(&alone, &DMatrix::zeros(2, 2)), [None]);
    }
}
