//! Drive train for a joint file's surroundings, with random phases of the encoder errors for a seed.

use parameters::Surroundings;
use reference::drive_train::{DriveTrainParameters, EffectPhases, ErrorPhases};

use super::random::RandomStream;

/// Drive train for a joint file's surroundings. The mounting angles of encoders and gears are unknown, so each seed
/// draws the phases of the encoder errors and of the variation of backlash over a turn.
pub fn train(surroundings: &Surroundings, seed: u64) -> DriveTrainParameters {
    let phases = |name: &str| {
        let mut stream = RandomStream::new(seed, &format!("encoder {name}"));
        let mut phase = || std::f64::consts::TAU * stream.uniform();
        ErrorPhases { once_per_turn: phase(), twice_per_turn: phase() }
    };
    let pair = |name: &str| {
        let mut stream = RandomStream::new(seed, name);
        [(); 2].map(|()| std::f64::consts::TAU * stream.uniform())
    };
    DriveTrainParameters {
        effect_phases: EffectPhases {
            motor_subdivision: pair("subdivision motor"),
            output_subdivision: pair("subdivision output"),
            width: pair("width around the turn"),
        },
        motor_error_phases: phases("motor"),
        output_error_phases: phases("output"),
        ..DriveTrainParameters::from(*surroundings)
    }
}
