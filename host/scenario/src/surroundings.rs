//! The drive train that the reference runs in, for a seed.

use parameters::Surroundings;
use reference::drive_train::{DriveTrainParameters, ErrorPhases};

use super::draw::Stream;

/// The drive train of a joint file's surroundings. Nobody knows how an encoder was mounted: every seed turns its errors.
pub fn train(surroundings: &Surroundings, seed: u64) -> DriveTrainParameters {
    let phases = |name: &str| {
        let mut stream = Stream::new(seed, &format!("encoder {name}"));
        let mut phase = || std::f64::consts::TAU * stream.uniform();
        ErrorPhases { once_per_turn: phase(), twice_per_turn: phase() }
    };
    DriveTrainParameters {
        motor_error_phases: phases("motor"),
        output_error_phases: phases("output"),
        ..DriveTrainParameters::from(*surroundings)
    }
}
