//! Eq. 20, v' = H v + f with v = (X, Y) and Y = X' + C X / 2: H and the force gains come from the design, all nonlinear terms are in f. X
//! contains the imposed errors, as in the core, so that e'' does not appear.

use model_core::gears::Scales;
use model_core::gears::design::dynamics::Dynamics;
use model_core::gears::design::hamiltonian;
use nalgebra::{DMatrix, DVector};
use parameters::{JointParameters, MAX_PLANETS};
use reference::integrator::{Entries, MAX_ENTRIES};

use super::joint::{Formulation, Joint, MeshMotion};

/// State: v.
pub struct Equation20 {
    dynamics: Dynamics,
    hamiltonian: DMatrix<f64>,
    /// Factor omega_n^2 / K_m that makes forces dimensionless.
    force: f64,
}

impl Equation20 {
    pub fn new(parameters: &JointParameters) -> Self {
        let scales = Scales::new(parameters);
        let dynamics = Dynamics::new(parameters, &scales);
        let hamiltonian = hamiltonian::matrix(&dynamics);
        Self { dynamics, hamiltonian, force: scales.frequency.powi(2) / scales.stiffness }
    }

    /// X and X' = Y - C X / 2.
    fn motion(&self, joint: &Joint, state: &Entries) -> (DVector<f64>, DVector<f64>) {
        let size = joint.planets + 1;
        let positions = DVector::from_column_slice(&state[..size]);
        let rates = DVector::from_column_slice(&state[size..2 * size]) - 0.5 * &self.dynamics.damping * &positions;
        (positions, rates)
    }
}

impl Formulation for Equation20 {
    /// Start with zero deflections and rates on the sun side, and zero gap.
    fn start(&self, joint: &Joint) -> Entries {
        let n = joint.planets;
        let errors = |order: usize| {
            let row = |i| if i < n { joint.error(0, i, 0.0)[order] } else { 0.0 };
            DVector::from_fn(n + 1, |i, _| row(i))
        };
        let mut state = [0.0; MAX_ENTRIES];
        let other = errors(1) + 0.5 * &self.dynamics.damping * errors(0);
        state[..=n].copy_from_slice(errors(0).as_slice());
        state[n + 1..2 * n + 2].copy_from_slice(other.as_slice());
        state
    }

    fn meshes(&self, joint: &Joint, time: f64, state: &Entries) -> [[MeshMotion; MAX_PLANETS]; 2] {
        let (positions, rates) = self.motion(joint, state);
        let mut meshes = [[MeshMotion::default(); MAX_PLANETS]; 2];
        for (kind, i) in joint.mesh_indices() {
            let across = |values: &DVector<f64>| match kind {
                0 => values[i],
                _ => values[joint.planets] - values[i],
            };
            let [error, error_rate, _] = joint.error(kind, i, time);
            meshes[kind][i] = MeshMotion { deflection: across(&positions) - error, rate: across(&rates) - error_rate };
        }
        meshes
    }

    fn derivative(&self, joint: &Joint, time: f64, state: &Entries, rates: &mut Entries) {
        let n = joint.planets;
        let meshes = self.meshes(joint, time, state);
        // Excess of the linear part: its own force of each mesh less the true force.
        let mut excess = DVector::zeros(2 * n);
        for (kind, i) in joint.mesh_indices() {
            let mesh = &joint.meshes[kind][i];
            let [error, error_rate, _] = joint.error(kind, i, time);
            let MeshMotion { deflection, rate } = meshes[kind][i];
            let linear = mesh.stiffness * (deflection + error) + mesh.damping * (rate + error_rate);
            let true_force = joint.elastic(kind, i, time, deflection) + mesh.damping * rate;
            excess[kind * n + i] = self.force * (linear - true_force);
        }
        let torques = DVector::from_column_slice(&[joint.drive, -joint.load, 0.0]);
        let other = &self.dynamics.mesh_gain * excess + &self.dynamics.torque_gain * torques;
        let linear = &self.hamiltonian * DVector::from_column_slice(&state[..2 * n + 2]);
        rates[..2 * n + 2].copy_from_slice(linear.as_slice());
        for (rate, force) in rates[n + 1..].iter_mut().zip(other.iter()) {
            *rate += force;
        }
    }
}
