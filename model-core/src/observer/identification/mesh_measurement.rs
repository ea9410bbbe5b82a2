//! Motor and load side combined in one control period (O7, O9), before any decision.
//! [`ParameterEstimator::measure_mesh`] makes it.
//!
//! [`ParameterEstimator::measure_mesh`]: super::ParameterEstimator::measure_mesh

use crate::numbers::Real;

/// Combined measurement of one period.
#[derive(Debug, Clone, Copy)]
pub struct MeshMeasurement<T: Real> {
    /// Shift of both flanks by the transmission error now [m].
    pub flank_shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    pub raw_deflection: T,
    /// Measured deflection less offset, skew and error maps; wind-up is included [m].
    pub deflection: T,
    /// Rate of the deflection [m/s].
    pub rate: T,
    /// Travel of the deflection during the lag of the measurement, where it exceeds noise [m].
    pub travel: T,
    /// Force lost at the motor, friction and bias included [N].
    pub motor_force: T,
    /// Direction of the motor's dry friction, from -1 to 1.
    pub direction: T,
    /// Mesh force from the motor side [N].
    pub force: T,
}

impl<T: Real> MeshMeasurement<T> {
    /// Deflection of the teeth including wind-up; zero in the middle of the gap [m].
    pub fn tooth_deflection(&self) -> T {
        self.deflection - self.flank_shift
    }
}
