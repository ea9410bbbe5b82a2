//! Linear joint in the form of eq. 20: v' = H v + f with v = (X, Y), Y = X' + C X / 2 (unit mass matrix). The reduced K is
//! not symmetric, so H is not Hamiltonian in the strict sense; exp(H t) is nevertheless the exact linear flow.
//!
//! Equations: (P12) in docs/theory/paper.md.
//! Equations: (S7) in docs/theory/step.md.

use nalgebra::DMatrix;

use crate::gears::design::dynamics::Dynamics;

/// Returns H = [-C/2, I; C^2/4 - K, -C/2].
pub fn matrix(dynamics: &Dynamics) -> DMatrix<f64> {
    let size = dynamics.coordinates();
    let half = &dynamics.damping * 0.5;
    let mut matrix = DMatrix::zeros(2 * size, 2 * size);
    matrix.view_mut((0, 0), (size, size)).copy_from(&-&half);
    matrix.view_mut((0, size), (size, size)).copy_from(&DMatrix::identity(size, size));
    matrix.view_mut((size, 0), (size, size)).copy_from(&(&half * &half - &dynamics.stiffness));
    matrix.view_mut((size, size), (size, size)).copy_from(&-&half);
    matrix
}

/// Returns the transformation (X, X') -> (X, Y) and its inverse.
pub fn from_rates(dynamics: &Dynamics) -> (DMatrix<f64>, DMatrix<f64>) {
    let size = dynamics.coordinates();
    let half = &dynamics.damping * 0.5;
    let mut forward = DMatrix::identity(2 * size, 2 * size);
    forward.view_mut((size, 0), (size, size)).copy_from(&half);
    let mut backward = DMatrix::identity(2 * size, 2 * size);
    backward.view_mut((size, 0), (size, size)).copy_from(&-half);
    (forward, backward)
}
