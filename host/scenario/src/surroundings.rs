//! From what a joint file says of motor, load and sensors to the drive train that the reference runs in. What the file
//! leaves out is ideal.

use joint_file::{Encoder, JointFile};
use reference::drive_train::{
    DriveTrainParameters, EncoderParameters, FrictionParameters, LoadParameters, MotorParameters,
};

use super::draw::Stream;

/// The drive train of a joint file; encoder errors have their phases at zero.
pub fn train(file: &JointFile) -> DriveTrainParameters {
    let train = file.drive_train.unwrap_or_default();
    DriveTrainParameters {
        motor: MotorParameters {
            torque_limit: file.profile.motor_torque_limit,
            current_lag: train.current_lag,
            torque_constant_error_ratio: train.torque_constant_error_ratio,
            torque_noise_ratio: train.torque_noise_ratio,
            friction: FrictionParameters {
                coulomb: train.motor_coulomb_friction,
                viscous: train.motor_viscous_friction,
                ..FrictionParameters::default()
            },
            cogging_torque: train.cogging_torque,
            cogging_periods_per_turn: train.cogging_periods_per_turn,
        },
        load: LoadParameters {
            friction: FrictionParameters {
                coulomb: train.load_coulomb_friction,
                viscous: train.load_viscous_friction,
                stribeck_rise_ratio: train.load_stribeck_rise_ratio,
                stribeck_speed: train.load_stribeck_speed,
            },
            gravity_torque: train.gravity_torque,
        },
        efficiency: train.efficiency,
        motor_encoder: encoder(&train.motor_encoder),
        output_encoder: encoder(&train.output_encoder),
        control_rate: train.control_rate,
        delay_periods: train.control_delay_periods,
        ..DriveTrainParameters::ideal()
    }
}

fn encoder(file: &Encoder) -> EncoderParameters {
    EncoderParameters {
        once_per_turn_error: file.once_per_turn_error,
        twice_per_turn_error: file.twice_per_turn_error,
        skew: file.skew,
        ..EncoderParameters::ideal(file.bits)
    }
}

/// Nobody knows how an encoder was mounted: every seed turns its errors.
pub fn turn_encoders(train: &mut DriveTrainParameters, seed: u64) {
    for (encoder, name) in [(&mut train.motor_encoder, "motor"), (&mut train.output_encoder, "output")] {
        let mut stream = Stream::new(seed, &format!("encoder {name}"));
        encoder.once_per_turn_phase = std::f64::consts::TAU * stream.uniform();
        encoder.twice_per_turn_phase = std::f64::consts::TAU * stream.uniform();
    }
}
