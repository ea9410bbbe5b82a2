//! State of observer and compensation as words: objects that are written and read anew in every control period compute the
//! bits of objects that are not.

use model_core::compensation::{Command, Compensation, ImpedancePoint, Motion, Position, Stage};
use model_core::numbers::state_words::{Reader, Writer};
use model_core::observer::{MAPPED, Observer, PLAIN, Reading, Samples, Source};
use model_core::{ControllerDesign, VirtualJointDesign};

const RATE: u32 = 10_000;

/// Set-point of a period: position control with and without preview, then impedance control.
fn command(period: u32) -> Command {
    let motion = |time: f32| {
        let (sine, cosine) = (9.0 * time).sin_cos();
        let position = Position { turns: 0, fraction: 0.02 * sine };
        Motion { position, speed: 0.02 * 6.283_185_5 * 9.0 * cosine, acceleration: -0.02 * 6.283_185_5 * 81.0 * sine }
    };
    let time = period as f32 / RATE as f32;
    match period {
        0..12_000 => Command::Position { now: motion(time), ahead: Some(motion(time + 0.01)) },
        12_000..16_000 => Command::Position { now: motion(time), ahead: None },
        _ => {
            let Motion { position, speed, .. } = motion(time);
            Command::Impedance(ImpedancePoint { position, speed, torque: 0.0, stiffness: 200.0, damping: 5.0 })
        }
    }
}

/// Samples with faults: no output encoder for a while, a motor reading that jumps, a late motor reading.
fn faulty(mut samples: Samples, period: u32) -> Samples {
    if (5_000..9_000).contains(&period) {
        samples.output = None;
    }
    if (10_000..10_300).contains(&period) {
        samples.motor.counts ^= 0x155;
    }
    if (14_000..14_050).contains(&period) {
        samples.motor = Reading { time: samples.motor.time.wrapping_sub(40_000), ..samples.motor };
    }
    samples
}

fn objects_read_anew_have_equal_bits<const P: usize>() {
    let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
    let (design, plant) = (ControllerDesign::new(&q1, RATE).unwrap(), VirtualJointDesign::<3>::new(&q1, RATE).unwrap());
    let mut joint = plant.joint();
    let new = || (Observer::<f32, P>::new(&design.observer), Compensation::new(&design.compensation));
    let ((mut observer, mut compensation), (mut other, mut other_compensation)) = (new(), new());
    let mut seen = [false; 4];
    let mut words = vec![0; Observer::<f32, P>::STATE_LAYOUT.words + Compensation::<f32>::STATE_LAYOUT.words];
    let mut other_words = words.clone();
    for period in 0..20_000 {
        let (samples, command) = (faulty(joint.samples(), period), command(period));
        let output = compensation.step(observer.step(&samples), &command);
        let other_output = other_compensation.step(other.step(&samples), &command);
        let context = format!("period {period}: {:?}", observer.estimates());
        assert_eq!(observer.estimates(), other.estimates(), "{context}");
        assert_eq!(output.torque.to_bits(), other_output.torque.to_bits(), "{context}");
        for (observer, compensation, words) in
            [(&observer, &compensation, &mut words), (&other, &other_compensation, &mut other_words)]
        {
            let mut to = Writer::new(words);
            observer.write_state(&mut to);
            compensation.write_state(&mut to);
        }
        assert_eq!(words, other_words, "{context}");
        (other, other_compensation) = new();
        let mut from = Reader::new(&words);
        other.read_state(&mut from);
        other_compensation.read_state(&mut from);
        let source = observer.estimates().source;
        seen[0] |= matches!(source, Source::MotorOnly(_));
        seen[1] |= period > 9_000 && matches!(source, Source::Nothing(_));
        seen[2] |= output.stage == Stage::Crossing;
        seen[3] |= output.trust == 1.0;
        joint.advance(output.torque, 0.0);
    }
    assert_eq!(seen, [true; 4], "the run has an excluded output encoder, an excluded motor encoder, a crossing, trust");
}

#[test]
fn read_state_has_equal_bits_with_maps() {
    objects_read_anew_have_equal_bits::<MAPPED>();
}

#[test]
fn read_state_has_equal_bits_without_maps() {
    objects_read_anew_have_equal_bits::<PLAIN>();
}
