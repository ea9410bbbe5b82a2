//! Teeth that change while the joint moves: backlash that has grown, a mesh whose stiffness has fallen. Between changes the
//! equations are those of any joint.

use super::reference::Reference;
use crate::integrator::SwitchedSystem;

impl Reference {
    /// From now on every mesh has this half-backlash [m].
    pub fn set_half_backlash(&mut self, half_backlash: f64) {
        for mesh in self.equations.meshes.iter_mut().flatten() {
            mesh.half_backlash = half_backlash;
        }
        self.select_mode_again();
    }

    /// From now on the sun-planet mesh of one planet has this mean stiffness [N/m].
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
