//! Torques scaled to a joint.

use model_core::gears::{Tables, Torques};

use crate::random::Random;

/// Deflection of the sun-planet meshes at rest under a strong torque [b_c]: several times a joint's rating.
const DEFLECTION: f32 = 1.0;

/// Zero torques.
pub const NONE: Torques<f32> = Torques { drive: 0.0, load: 0.0 };

/// Magnitudes of a joint's torques [N m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueScale {
    /// A strong drive torque.
    pub drive: f32,
    /// Load torque that balances `drive`.
    pub load: f32,
}

impl TorqueScale {
    /// Returns the magnitudes for the joint of these tables.
    pub fn of<const N: usize>(tables: &Tables<f32, N>) -> Self {
        let force = N as f32 * tables.springs[0].stiffness * DEFLECTION;
        let drive = tables.mobility.sun * force / tables.units.drive;
        Self { drive, load: drive * tables.rigid.drive / tables.rigid.load }
    }

    /// Returns a random torque up to `drive` in either direction, with a load of half to one and a half times the
    /// balancing torque.
    pub fn any(&self, random: &mut Random) -> Torques<f32> {
        let part = random.signed();
        Torques { drive: self.drive * part, load: self.load * part * (1.0 + 0.5 * random.signed()) }
    }
}
