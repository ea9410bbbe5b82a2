//! Phases of every planet's meshes, given or derived from tooth counts.

use parameters::{JointParameters, MeshKind, MeshPhases};

/// Phases of the meshes of a joint.
pub trait MeshPhasing {
    /// Phase of the stiffness ripple of a planet's mesh [rad].
    fn stiffness_phase(&self, kind: MeshKind, planet: usize) -> f64;

    /// Phase of the transmission error of a planet's mesh [rad].
    fn error_phase(&self, kind: MeshKind, planet: usize) -> f64;
}

impl MeshPhasing for JointParameters {
    fn stiffness_phase(&self, kind: MeshKind, planet: usize) -> f64 {
        match &self.mesh(kind).phases {
            MeshPhases::Given { stiffness, .. } => stiffness[planet],
            MeshPhases::FromTeeth { stiffness, .. } => stiffness + tooth_phase(self, kind, planet),
        }
    }

    fn error_phase(&self, kind: MeshKind, planet: usize) -> f64 {
        match &self.mesh(kind).phases {
            MeshPhases::Given { error, .. } => error[planet],
            MeshPhases::FromTeeth { error, .. } => error + tooth_phase(self, kind, planet),
        }
    }
}

/// Phase 2 pi gamma with gamma_si = Zs psi_i / 2 pi, gamma_ri = -Zr psi_i / 2 pi, psi_i = 2 pi i / n [rad]. Integers reduce
/// the phase to one turn, so that meshes in phase are exactly in phase.
fn tooth_phase(joint: &JointParameters, kind: MeshKind, planet: usize) -> f64 {
    let planets = joint.geometry.planets as u64;
    let turns = |teeth: u32| (u64::from(teeth) * planet as u64) % planets;
    let numerator = match kind {
        MeshKind::SunPlanet => turns(joint.geometry.sun_teeth),
        MeshKind::RingPlanet => (planets - turns(joint.geometry.ring_teeth)) % planets,
    };
    core::f64::consts::TAU * numerator as f64 / planets as f64
}
