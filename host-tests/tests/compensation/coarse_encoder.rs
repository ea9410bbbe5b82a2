//! Output encoders so coarse that the gap is hardly wider than a count.

use scenario::controller::ControllerName::NoPreview;

use super::{on_core, run_in, shipped};

/// Angles of resting shafts are known to half a count only. With a 12-bit output encoder that is more than half of a narrow gap, so a link
/// that rests between its flanks is no reason to exclude the encoder.
#[test]
fn coarse_sound_encoder_is_kept() {
    let test = shipped("never-worse");
    for seed in [5071, 5095, 5123, 5233] {
        let case = test.case(seed).expect("a case of the test");
        let spec = on_core(NoPreview);
        let history = run_in(&test, &case, seed, spec);
        let given_up =
            history.observer_outputs.windows(2).filter(|pair| pair[0].both_encoders && !pair[1].both_encoders).count();
        assert_eq!(given_up, 0, "seed {seed}: {:?}", case.truth.surroundings.output_encoder);
    }
}

/// Lost motion of 1.49 mrad with counts of 1.53 mrad.
#[test]
fn gap_below_one_count_is_invalid() {
    let test = shipped("never-worse");
    let seed = 5663;
    let case = test.case(seed).expect("a case of the test");
    let spec = on_core(NoPreview);
    let history = run_in(&test, &case, seed, spec);
    let outputs = &history.observer_outputs;
    let settled = &outputs[outputs.len() / 3..];
    let valid = settled.iter().filter(|output| output.both_encoders && output.valid).count();
    assert_eq!(valid, 0, "of {} periods", settled.len());
}
