//! Encoders so coarse that the gap is hardly wider than a count.

use scenario::controller::ControllerName::NoPreview;

use super::{on_core, run_in, shipped};

/// Shafts that stand still are known to half a count only, which is more than the half-gap of a narrow gap under an output encoder of
/// 12 bits. Of a link that rests between its flanks by that, nothing is wrong with the encoder.
#[test]
fn a_sound_output_encoder_is_not_given_up_however_coarse() {
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

/// A lost motion of 1.49 mrad under counts of 1.53 mrad.
#[test]
fn a_gap_narrower_than_a_count_is_not_valid() {
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
