//! What a joint file says of everything around the gears, as the core's designs want it. What the file leaves out is
//! ideal.

use parameters::{AbsoluteEncoder, Friction, Surroundings};

use crate::drive_train::Encoder;
use crate::reader::JointFile;

impl JointFile {
    /// Puts another rate in place of the file's, for a controller that runs at it [Hz].
    pub fn set_control_rate(&mut self, rate: u32) {
        self.drive_train.get_or_insert_default().control_rate = rate.into();
    }

    /// What surrounds the gears.
    pub fn surroundings(&self) -> Surroundings {
        let train = self.drive_train.unwrap_or_default();
        let encoder = |encoder: &Encoder| AbsoluteEncoder {
            bits: encoder.bits,
            once_per_turn_error: encoder.once_per_turn_error,
            twice_per_turn_error: encoder.twice_per_turn_error,
            skew: encoder.skew,
        };
        Surroundings {
            control_rate: train.control_rate as u32,
            delay: train.control_delay_periods,
            current_lag: train.current_lag,
            torque_limit: self.profile.motor_torque_limit,
            torque_noise_ratio: train.torque_noise_ratio,
            torque_constant_error_ratio: train.torque_constant_error_ratio,
            cogging_torque: train.cogging_torque,
            cogging_periods_per_turn: train.cogging_periods_per_turn,
            motor_friction: Friction {
                coulomb: train.motor_coulomb_friction,
                viscous: train.motor_viscous_friction,
                ..Friction::default()
            },
            load_friction: Friction {
                coulomb: train.load_coulomb_friction,
                viscous: train.load_viscous_friction,
                stribeck_rise_ratio: train.load_stribeck_rise_ratio,
                stribeck_speed: train.load_stribeck_speed,
            },
            efficiency: train.efficiency,
            gravity_torque: train.gravity_torque,
            motor_encoder: encoder(&train.motor_encoder),
            output_encoder: encoder(&train.output_encoder),
        }
    }
}
