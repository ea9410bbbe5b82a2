//! Faults of a test file in the form for a board that runs the whole loop: applied between its virtual joint and its
//! controller, in control periods and fractions of a turn. Faults that a board cannot apply are rejected by name.

use std::f64::consts::TAU;

use model_core::virtual_joint::fault::{EncoderShaft, Fault, FaultKind, FixedPoint};
use model_core::virtual_joint::fault_injector::MAX_FAULTS;
use parameters::Surroundings;

use crate::encoder_zeros::EncoderZeros;
use crate::file;
use crate::file::{HostOnlyFault, Offset, fault_stream, fault_word};
use report::failure::{Failure, Outcome};

/// 2^32: one whole turn, or a share of one.
const WHOLE_TURN: f64 = 4_294_967_296.0;

/// Largest number of faults of a test: two entries of the board hold the encoder zeros.
const MAX_TEST_FAULTS: usize = MAX_FAULTS - 2;

/// Counts per turn of both encoders of a joint, motor first.
pub fn counts_per_turn(surroundings: &Surroundings) -> [i64; 2] {
    [surroundings.motor_encoder, surroundings.output_encoder].map(|encoder| encoder.counts_per_turn.cast_signed())
}

/// Least angle [2^-32 turns] at which an encoder has advanced by a number of counts. Added to another such angle it
/// reads the sum of both counts, since a count is 2^8 units at least.
fn angle_of_counts(counts: i64, turn: i64) -> i64 {
    let (counts, turn) = (i128::from(counts), i128::from(turn));
    -((-counts << 32).div_euclid(turn)) as i64
}

/// Angles at which both encoders of a joint read zero, motor first [2^-32 turns].
pub fn mounting_angles(zeros: &EncoderZeros, turns: [i64; 2]) -> [u32; 2] {
    let counts = zeros.counts(turns);
    [0, 1].map(|encoder| angle_of_counts(counts[encoder], turns[encoder]) as u32)
}

/// Zeros of both encoders as faults for the whole run: a board's virtual joint reads zero at angle zero.
pub fn mounting_faults(zeros: &EncoderZeros, turns: [i64; 2]) -> [Fault<FixedPoint<f32>>; 2] {
    let angles = mounting_angles(zeros, turns);
    [(EncoderShaft::Motor, 0), (EncoderShaft::Link, 1)].map(|(shaft, encoder)| {
        let kind = FaultKind::Offset(shaft, angles[encoder].cast_signed());
        Fault { start: 0, end: u32::MAX, seed: 0, kind }
    })
}

/// Faults of a test file as whole numbers, for a seed and the counts per turn of motor and link.
pub fn quantised_faults(
    faults: &[file::Fault],
    rate: f64,
    turns: [i64; 2],
    seed: u64,
) -> Outcome<Vec<Fault<FixedPoint<f32>>>> {
    if faults.len() > MAX_TEST_FAULTS {
        let message = format!("a board that runs the whole loop takes {MAX_TEST_FAULTS} faults, not {}", faults.len());
        return Err(Failure::new(message).with_help("run it with --role observer, or with --host"));
    }
    let one = |(index, fault): (usize, &file::Fault)| {
        let periods = |time: f64| (time * rate - 1e-6).ceil().clamp(0.0, f64::from(u32::MAX)) as u32;
        Ok(Fault {
            start: periods(fault.start),
            end: periods(fault.end),
            seed: fault_stream(fault, index, seed).word(),
            kind: quantised_kind(fault, turns)?,
        })
    };
    faults.iter().enumerate().map(one).collect()
}

fn quantised_kind(fault: &file::Fault, turns: [i64; 2]) -> Outcome<FaultKind<FixedPoint<f32>>> {
    let turn = |of: EncoderShaft| turns[usize::from(of == EncoderShaft::Link)];
    // Whole turns cancel.
    let angle = |parts: f64| parts.round() as i64;
    let share = |share: f64| (share * WHOLE_TURN).min(WHOLE_TURN - 1.0) as u32;
    Ok(match fault.kind {
        FaultKind::Frozen(of) => FaultKind::Frozen(of),
        FaultKind::Offset(of, Offset { counts, angle: offset }) => {
            let counts = angle_of_counts(counts.round() as i64, turn(of));
            FaultKind::Offset(of, counts.wrapping_add(angle(offset / TAU * WHOLE_TURN)) as u32 as i32)
        }
        FaultKind::Noise(of, counts) => {
            FaultKind::Noise(of, (counts * WHOLE_TURN / turn(of) as f64).min(WHOLE_TURN - 1.0) as u32)
        }
        FaultKind::MissingCounts(of, part) => FaultKind::MissingCounts(of, share(part)),
        FaultKind::Eccentric(of, error) => FaultKind::Eccentric(of, (error / TAU * WHOLE_TURN) as f32),
        FaultKind::LostReadings(of, part) => FaultKind::LostReadings(of, share(part)),
        FaultKind::TorqueBias(ratio, torque) => FaultKind::TorqueBias(ratio as f32, torque as f32),
        FaultKind::Saturation(torque) => FaultKind::Saturation(torque as f32),
        FaultKind::Other(other) => {
            let (why, plant) = match other {
                HostOnlyFault::LostSetPoints(_) | HostOnlyFault::LateSetPoints(_) => {
                    ("its motion comes in polynomials of some milliseconds, not in set-points", "")
                }
                HostOnlyFault::LateReadings(..) => ("it keeps no readings of the past", ""),
                HostOnlyFault::GrownBacklash(_) => ("its teeth are tables in flash", " --plant reference"),
                HostOnlyFault::BrokenTooth(_) => ("its planets share their stiffness", " --plant reference"),
            };
            let message = format!("the fault `{}` cannot be in a whole loop on a board: {why}", fault_word(fault));
            return Err(Failure::new(message).with_help(format!("run it with --role observer{plant}, or with --host")));
        }
    })
}

#[cfg(test)]
mod tests {
    use model_core::gears::Tables;
    use model_core::gears::design::design;
    use model_core::observer::{Reading, Samples};
    use model_core::virtual_joint::SurroundingsTable;
    use model_core::virtual_joint::design::design_surroundings;
    use model_core::virtual_joint::fault_injector::FaultInjector;

    use super::*;
    use crate::file::Si;

    const RATE: f64 = 10e3;
    const TURNS: [i64; 2] = [1 << 14, 1 << 17];

    fn table() -> SurroundingsTable<f32> {
        let file = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        let tables: Tables<f32, 3> = design(&file.parameters, RATE as u32).expect("tables");
        design_surroundings(&file.parameters, &file.surroundings, &tables).expect("surroundings")
    }

    /// Samples of a shaft that advances by `step` counts a period, and the motor's torque for a command of 1 N m.
    fn run(kind: FaultKind<Si>, periods: u32, step: u32) -> Vec<(Samples<f32>, f32)> {
        let fault = Fault { start: 0.01, end: 0.5, seed: (), kind };
        let mut faults = FaultInjector::default();
        assert!(quantised_faults(&[fault], RATE, TURNS, 5).expect("possible").iter().all(|fault| faults.add(*fault)));
        let table = table();
        let one = |period: u32| {
            let reading = |bits: u32| Reading { counts: (period * step) % (1 << bits), time: period };
            let samples = Samples { time: period, motor: reading(14), output: Some(reading(17)), torque: 9.0 };
            (faults.apply_to_samples(samples, &table), faults.apply_to_torque(1.0))
        };
        (0..periods).map(one).collect()
    }

    #[test]
    fn frozen_encoder_holds_until_end() {
        let seen = run(FaultKind::Frozen(EncoderShaft::Link), 6000, 3);
        let counts = |period: usize| seen[period].0.output.expect("a reading").counts;
        assert_eq!([counts(99), counts(100), counts(4999), counts(5000)], [297, 300, 300, 15_000]);
        assert!(seen.iter().zip(0..).all(|((samples, _), period)| samples.motor.counts == 3 * period % (1 << 14)));
    }

    #[test]
    fn offset_noise_missing_counts_values() {
        let output = EncoderShaft::Link;
        let off = |seen: &[(Samples<f32>, f32)], step: u32| -> Vec<i32> {
            let beside = |(samples, period): (&(Samples<f32>, f32), u32)| {
                let counts = samples.0.output.expect("a reading").counts;
                (counts.wrapping_sub(period * step) << 15) as i32 >> 15
            };
            seen.iter().zip(0..).map(beside).collect()
        };
        assert_eq!(
            off(&run(FaultKind::Offset(output, Offset { counts: -7.0, angle: 0.0 }), 200, 3), 3)[99..101],
            [0, -7]
        );
        let missing = off(&run(FaultKind::MissingCounts(output, 0.01), 6000, 100), 100);
        assert_eq!((missing[99], missing[5999]), (0, -4900));
        let scatter = off(&run(FaultKind::Noise(output, 3.0), 5000, 3), 3);
        let deviation = (scatter[100..].iter().map(|off| f64::from(off * off)).sum::<f64>() / 4900.0).sqrt();
        assert!((deviation - 3.0).abs() < 0.2, "{deviation}");
        let eccentric = off(&run(FaultKind::Eccentric(output, 0.1_f64.to_radians()), 5000, 40), 40);
        let largest = eccentric.iter().max().expect("some");
        assert!((f64::from(*largest) - 0.1 / 360.0 * 131_072.0).abs() < 1.0, "{largest}");
    }

    #[test]
    fn lost_readings_hold_last_motor_reading() {
        let lost = run(FaultKind::LostReadings(EncoderShaft::Link, 0.2), 5000, 3);
        let missing = lost.iter().filter(|(samples, _)| samples.output.is_none()).count();
        assert!((880..1080).contains(&missing), "{missing}");
        let motor = run(FaultKind::LostReadings(EncoderShaft::Motor, 1.0), 5000, 3);
        assert_eq!(motor[4000].0.motor, Reading { counts: 297, time: 99 });
    }

    #[test]
    fn torque_fault_hidden_from_samples() {
        for (kind, given) in [(FaultKind::TorqueBias(0.05, 0.2), 1.25), (FaultKind::Saturation(0.4), 0.4)] {
            let seen = run(kind, 200, 3);
            assert_eq!([seen[99].1, seen[100].1], [1.0, given]);
            assert!(seen[1..].iter().all(|(samples, _)| samples.torque == 1.0));
        }
    }

    #[test]
    fn host_only_fault_rejected_with_remedy() {
        for kind in [
            HostOnlyFault::LateReadings(EncoderShaft::Link, 0.001),
            HostOnlyFault::LostSetPoints(0.1),
            HostOnlyFault::LateSetPoints(0.001),
            HostOnlyFault::GrownBacklash(6e-5),
            HostOnlyFault::BrokenTooth(0.3),
        ] {
            let fault = Fault { start: 0.0, end: 1.0, seed: (), kind: FaultKind::Other(kind) };
            let name = format!("`{}` cannot be in a whole loop", fault_word(&fault));
            let failure = quantised_faults(&[fault], RATE, TURNS, 1).unwrap_err();
            assert!(failure.message().contains(&name) && failure.help().is_some(), "{failure}");
        }
        let kind = FaultKind::Frozen(EncoderShaft::Motor);
        let many = vec![Fault { start: 0.0, end: 1.0, seed: (), kind }; MAX_TEST_FAULTS + 1];
        assert!(quantised_faults(&many, RATE, TURNS, 1).is_err());
    }
}
