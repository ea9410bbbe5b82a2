//! The joints of the presets with their drive trains, as the plant takes them. Phases of encoder errors are by the seed.

use std::f64::consts::TAU;

use parameters::JointParameters;
use reference::drive_train::{
    DriveTrainParameters, EncoderParameters, FrictionParameters, LoadParameters, MotorParameters,
};
use reference::scenarios::same;

use crate::motion::uniform;

/// A preset, with its ripple and transmission error, and its drive train.
pub fn preset(name: &str, seed: u64) -> (JointParameters, DriveTrainParameters) {
    let file = joint_file::read(joint_file::preset(name).expect("a preset")).expect("a good preset");
    let train = file.drive_train.unwrap_or_default();
    let mut uniform = uniform(seed ^ 0x5eed);
    let mut encoder = |encoder: joint_file::Encoder| EncoderParameters {
        bits: encoder.bits,
        once_per_turn_error: encoder.once_per_turn_error,
        once_per_turn_phase: TAU * uniform(),
        twice_per_turn_error: encoder.twice_per_turn_error,
        twice_per_turn_phase: TAU * uniform(),
        skew: encoder.skew,
    };
    let parameters = DriveTrainParameters {
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
        motor_encoder: encoder(train.motor_encoder),
        output_encoder: encoder(train.output_encoder),
        control_rate: train.control_rate,
        delay_periods: train.control_delay_periods,
        parts_per_period: 10,
    };
    (file.parameters, parameters)
}

/// The same joint with another half-backlash [m].
pub fn with_backlash(joint: &JointParameters, half_backlash: f64) -> JointParameters {
    let mut joint = joint.clone();
    let planets = joint.geometry.planets;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.half_backlash = same(planets, half_backlash);
    }
    joint
}
