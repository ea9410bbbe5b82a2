//! Natural frequencies of the joint with all meshes closed, undamped, at mean stiffness, for step-size selection and tests.
//! Computed in absolute coordinates, in which mass and stiffness matrices are symmetric.

use nalgebra::{DMatrix, DVector};
use std::vec;
use std::vec::Vec;

use crate::gears::design::dynamics::MovingMasses;
use crate::gears::kinematics::Kinematics;
use crate::gears::scales::Scales;
use parameters::JointParameters;

/// Returns the natural frequencies in ascending order, starting with the zero of the rigid body [rad/s].
pub fn natural_frequencies(parameters: &JointParameters) -> Vec<f64> {
    if parameters.equivalent_gear().is_some() {
        return vec![0.0, Scales::new(parameters).frequency];
    }
    let planets = parameters.geometry.planets;
    let masses = MovingMasses::new(parameters);
    let size = planets + 2 + usize::from(masses.link.is_some());
    let (sun, carrier, link) = (0, planets + 1, planets + 2);
    let mut inverse_root = DVector::from_element(size, 1.0 / libm::sqrt(masses.planet));
    inverse_root[sun] = 1.0 / libm::sqrt(masses.sun);
    inverse_root[carrier] = 1.0 / libm::sqrt(masses.carrier);
    if let Some(mass) = masses.link {
        inverse_root[link] = 1.0 / libm::sqrt(mass);
    }
    let mut stiffness = DMatrix::zeros(size, size);
    let mut spring = |elongation: &[(usize, f64)], constant: f64| {
        for (row, left) in elongation {
            for (column, right) in elongation {
                stiffness[(*row, *column)] += constant * left * right;
            }
        }
    };
    for planet in 1..=planets {
        spring(&[(sun, 1.0), (planet, -1.0), (carrier, -1.0)], parameters.sun_planet.mean_stiffness);
        spring(&[(planet, 1.0), (carrier, -1.0)], parameters.ring_planet.mean_stiffness);
    }
    if let Some(compliance) = &parameters.compliance {
        let lever = parameters.geometry.carrier_base_radius();
        spring(&[(carrier, 1.0), (link, -1.0)], compliance.stiffness / (lever * lever));
    }
    let roots = DMatrix::from_diagonal(&inverse_root);
    let symmetric = &roots * stiffness * &roots;
    let mut squares: Vec<f64> = symmetric.symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    // The square of the rigid body is zero within rounding, of either sign.
    squares.into_iter().enumerate().map(|(i, square)| if i == 0 { 0.0 } else { libm::sqrt(square.max(0.0)) }).collect()
}
