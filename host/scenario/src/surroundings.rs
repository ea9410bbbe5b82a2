//! The drive train of a joint file's surroundings, with the encoders' error phases drawn for a seed.

use parameters::Surroundings;
use reference::drive_train::{DriveTrainParameters, ErrorPhases};

use super::random::RandomStream;

/// The drive train of a joint file's surroundings. How an encoder is mounted is unknown: every seed draws the phases of its errors.
pub fn train(surroundings: &Surroundings, seed: u64) -> DriveTrainParameters {
    let phases = |name: &str| {
        let mut stream = RandomStream::new(seed, &format!("encoder {name}"));
        let mut phase = || std::f64::consts::TAU * stream.uniform();
        ErrorPhases { once_per_turn: phase(), twice_per_turn: phase() }
    };
    DriveTrainParameters {
        motor_error_phases: phases("motor"),
        output_error_phases: phases("output"),
        ..DriveTrainParameters::from(*surroundings)
    }
}
