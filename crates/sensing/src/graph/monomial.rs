//! Monomials in the coordinates of a position. A term of a sensorgraph's polynomial is a coefficient times a monomial.

/// The powers of x and y in a term.
pub type Powers = [u32; 2];

/// The value of a monomial at a position.
pub fn monomial([px, py]: Powers, [x, y]: [f64; 2]) -> f64 {
    x.powi(px as i32) * y.powi(py as i32)
}
