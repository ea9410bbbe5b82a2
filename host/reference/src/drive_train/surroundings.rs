//! A drive train's parameters as the core's designs know them: what observer and compensation are designed to. Phases of
//! encoder errors and parts of a period are left out: no design may know them.

use parameters::{AbsoluteEncoder, Friction, Surroundings};

use super::parameters::{DriveTrainParameters, EncoderParameters, FrictionParameters};

impl DriveTrainParameters {
    /// The same surroundings, as far as a data sheet tells them.
    pub fn surroundings(&self) -> Surroundings {
        let encoder = |encoder: &EncoderParameters| AbsoluteEncoder {
            bits: encoder.bits,
            once_per_turn_error: encoder.once_per_turn_error,
            twice_per_turn_error: encoder.twice_per_turn_error,
            skew: encoder.skew,
        };
        let friction = |friction: &FrictionParameters| Friction {
            coulomb: friction.coulomb,
            viscous: friction.viscous,
            stribeck_rise_ratio: friction.stribeck_rise_ratio,
            stribeck_speed: friction.stribeck_speed,
        };
        Surroundings {
            control_rate: self.control_rate as u32,
            delay: self.delay_periods,
            current_lag: self.motor.current_lag,
            torque_limit: self.motor.torque_limit,
            torque_noise_ratio: self.motor.torque_noise_ratio,
            torque_constant_error_ratio: self.motor.torque_constant_error_ratio,
            cogging_torque: self.motor.cogging_torque,
            cogging_periods_per_turn: self.motor.cogging_periods_per_turn,
            motor_friction: friction(&self.motor.friction),
            load_friction: friction(&self.load.friction),
            efficiency: self.efficiency,
            gravity_torque: self.load.gravity_torque,
            motor_encoder: encoder(&self.motor_encoder),
            output_encoder: encoder(&self.output_encoder),
        }
    }
}
