//! Changes of teeth and link during a run: growing or varying backlash, a mesh with reduced stiffness, a gripped
//! payload. Between changes the equations are those of any joint.
//!
//! Equations: (R3) in docs/theory/real-joints.md.

use parameters::JointParameters;

use super::hysteresis::Slip;
use super::reference::Reference;
use crate::integrator::SwitchedSystem;

/// Half-backlash of a joint, mean over the planets [m].
pub fn mean_half_backlash(joint: &JointParameters) -> f64 {
    joint.sun_planet.half_backlash.iter().sum::<f64>() / joint.geometry.planets as f64
}

impl Reference {
    /// Lets a share of the stiffness between carrier and link slip at a torque [N m]; without effect on a joint without
    /// compliance.
    pub fn with_hysteresis(mut self, stiffness_share: f64, torque: f64) -> Self {
        if let Some((stiffness, _)) = &mut self.equations.compliance
            && stiffness_share > 0.0
        {
            let slipping = stiffness_share * *stiffness;
            *stiffness -= slipping;
            let limit = torque / self.equations.carrier_lever / slipping;
            self.equations.hysteresis = Some(Slip { stiffness: slipping, limit });
        }
        self
    }

    /// Sets the half-backlash of every mesh [m].
    pub fn set_half_backlash(&mut self, half_backlash: f64) {
        for mesh in self.equations.meshes.iter_mut().flatten() {
            mesh.nominal_half_backlash = half_backlash;
            mesh.half_backlash = self.backlash_scale * half_backlash;
        }
        self.select_mode_again();
    }

    /// Multiplies the initial or last set half-backlash of each mesh by a factor.
    pub fn scale_half_backlash(&mut self, factor: f64) {
        self.backlash_scale = factor;
        for mesh in self.equations.meshes.iter_mut().flatten() {
            mesh.half_backlash = factor * mesh.nominal_half_backlash;
        }
        self.select_mode_again();
    }

    /// Sets the inertia of the link; a rigidly joined carrier keeps its own inertia [kg m^2]. Speeds and the damping
    /// between carrier and link stay.
    pub fn set_link_inertia(&mut self, link_inertia: f64) {
        let equations = &mut self.equations;
        let link = equations.link();
        let mass = link_inertia / equations.carrier_lever.powi(2);
        let before = equations.masses[link];
        equations.masses[link] = before + mass - equations.link_mass;
        equations.link_mass = mass;
        // By Weyl's inequality the largest squared frequency grows by at most the change of the last body's stiffness
        // over its mass.
        let lighter = (1.0 / equations.masses[link] - 1.0 / before).max(0.0);
        equations.highest_frequency = (equations.highest_frequency.powi(2) + equations.link_stiffness * lighter).sqrt();
        self.select_mode_again();
    }

    /// Sets the mean stiffness of the sun-planet mesh of one planet [N/m].
    pub fn set_sun_planet_stiffness(&mut self, planet: usize, mean_stiffness: f64) {
        if let Some(mesh) = self.equations.meshes[0].get_mut(planet) {
            mesh.mean_stiffness = mean_stiffness;
        }
        self.select_mode_again();
    }

    fn select_mode_again(&mut self) {
        let time = self.integrator.time();
        self.equations.select_mode(time, self.integrator.state());
    }
}
