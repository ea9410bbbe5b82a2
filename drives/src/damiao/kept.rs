//! Registers that are no settings of the drive: kept as they were written.

use super::command::Mode;
use super::mit::Ranges;
use super::register::Register;

/// Registers that are kept without an effect, and their first values. The documents give none; chosen.
const KEPT: [(Register, f32); 8] = [
    (Register::TorqueCoefficient, 0.0),
    (Register::CurrentBandwidth, 1000.0),
    (Register::PositionIntegral, 0.0),
    (Register::GearEfficiency, 1.0),
    (Register::DampingFactor, 4.0),
    (Register::FilterBandwidth, 40.0),
    (Register::CurrentEnhancement, 1000.0),
    (Register::VelocityEnhancement, 1.0),
];

/// Registers that are no settings of the drive.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    pub(super) mode: Mode,
    pub(super) ranges: Ranges,
    /// Acceleration of profiles [rad/s^2].
    pub(super) acceleration: f32,
    /// Deceleration of profiles, negative [rad/s^2].
    pub(super) deceleration: f32,
    pub(super) bit_rate: u32,
    pub(super) floats: [f32; KEPT.len()],
}

impl Kept {
    /// First values.
    pub(super) fn new(ranges: Ranges) -> Self {
        Self {
            mode: Mode::Impedance,
            ranges,
            // The documents give none; chosen so that a profile over a tenth of a turn takes half a second.
            acceleration: 10.0,
            deceleration: -10.0,
            bit_rate: 4,
            floats: KEPT.map(|(_, value)| value),
        }
    }

    /// Acceleration of a profile that keeps both limits [rad/s^2].
    pub(super) fn profile_acceleration(&self) -> f32 {
        self.acceleration.min(-self.deceleration)
    }

    /// Place of a register among the kept ones.
    pub(super) fn slot(register: Register) -> Option<usize> {
        KEPT.iter().position(|(kept, _)| *kept == register)
    }
}
