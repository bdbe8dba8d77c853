//! Monomials of a place: what the terms of a sensorgraph's polynomials are made of.

/// The powers of x and y in a term.
pub type Powers = [u32; 2];

/// A monomial at a place.
pub fn monomial([px, py]: Powers, [x, y]: [f64; 2]) -> f64 {
    x.powi(px as i32) * y.powi(py as i32)
}
