//! Dots in the plane of two principal components.

use super::line::LinePlot;
use super::series::{Series, SeriesKind};
use crate::plot::layout::axis::AxisSpec;
use crate::plot::layout::heading::Caption;
use realgap_core::unit::Unit;

/// Dots of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    /// Text of the legend.
    pub label: String,
    /// Which of the colours.
    pub colour: usize,
    /// Coefficients of the two components, metres.
    pub points_m: Vec<(f64, f64)>,
}

/// The same unit on both axes, whatever the spread: areas are to be compared.
fn in_cm(points_m: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let points = points_m.iter();
    points.map(|(a, b)| (100.0 * a, 100.0 * b)).collect()
}

/// The plot of these clouds, later ones above earlier ones; `shares` are those of the two components in the variance, 0 to 1.
pub fn plane(caption: Caption, shares: [f64; 2], clouds: Vec<Cloud>) -> LinePlot {
    let label = |number: usize| {
        let share = 100.0 * shares[number - 1];
        format!("component {number}, {share:.0} % of the variance (cm)")
    };
    let clouds = clouds.into_iter();
    let series = clouds.filter(|cloud| !cloud.points_m.is_empty());
    let series = series.map(|cloud| {
        Series::new(cloud.label, SeriesKind::Dots, in_cm(&cloud.points_m)).colour(cloud.colour)
    });
    let x = AxisSpec::new(label(1), Unit::One);
    LinePlot::new(caption, x, (&label(2), Unit::One), series.collect())
}
