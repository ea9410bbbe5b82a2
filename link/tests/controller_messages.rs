//! Samples, set-points, answers and motions keep their values in wire form, and their longest forms fit into a frame.
//! Framing has tests of its own.

use link::controller::{Answered, EXCHANGES_PER_SCHEDULE, Exchange, WireEstimates, WireProbed};
use link::framing::{Receiver, encode};
use link::messages::{FromBoard, Schedule, ToBoard};
use link::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, LOOP_SAMPLES_PER_BATCH, LoopBatch, LoopSample, WireTrajectory};
use model_core::compensation::{Command, ControlOutput, ImpedancePoint, Motion, Position, Stage};
use model_core::controller::Answer;
use model_core::controller::trajectory::{Segment, Trajectory};
use model_core::gears::Flank;
use model_core::observer::{
    Estimate, Estimates, MotorFault, Notices, OutputFault, Reading, Samples, Shaft, Source, TorqueResponse,
};
use model_core::width_probe::{ProbeProgress, ProbeRefusal};
use parameters::ContactState;

const MOTION: Motion<f32> =
    Motion { position: Position { turns: i32::MIN, fraction: 0.3 }, speed: -1.5, acceleration: f32::MAX };

const IMPEDANCE: ImpedancePoint<f32> = ImpedancePoint {
    position: Position { turns: -7, fraction: 0.9 },
    speed: 2.0,
    torque: -3.0,
    stiffness: 100.0,
    damping: 3.0,
};

fn samples() -> Samples<f32> {
    let reading = |counts| Reading { counts, time: u32::MAX };
    Samples { time: u32::MAX, motor: reading(u32::MAX), output: Some(reading(5)), torque: 0.7 }
}

fn estimates() -> Estimates<f32> {
    let estimate = |value: f32| Estimate { value, variance: value * value, valid: value > 3.0 };
    Estimates {
        source: Source::MotorOnly(OutputFault::Frozen),
        notices: Notices { torque_unknown: true, out_of_time: false, motor_implausible: true, motor_jumped: false },
        torque_response: TorqueResponse::Reversed,
        gap: estimate(1.0),
        gap_rate: 2.0,
        flank_shift: 2.25,
        flank_shift_slope: 2.5,
        contact: ContactState::BackSide,
        reported_contact: ContactState::DriveSide,
        contact_valid: true,
        settled: false,
        mesh_torque: estimate(3.0),
        load_torque: estimate(4.0),
        half_backlash: estimate(5.0),
        half_backlash_usable: false,
        encoder_offset: estimate(6.0),
        compliance: estimate(7.0),
        skew: estimate(8.0),
        torque_bias: estimate(9.0),
        motor_friction: estimate(10.0),
        cogging: [0.0; 2],
        motor_lead: 0.0,
        link_inertia_ratio: estimate(11.0),
        motor: Shaft { turns: i32::MIN, fraction: 0.1, speed: 11.0 },
        link: Shaft { turns: i32::MAX, fraction: 0.2, speed: 12.0 },
    }
}

#[test]
fn samples_and_set_points_round_trip() {
    let commands = [
        Command::Position { now: MOTION, ahead: None },
        Command::Position { now: MOTION, ahead: Some(Motion { speed: 9.0, ..MOTION }) },
        Command::Impedance(IMPEDANCE),
    ];
    for command in commands {
        for output in [samples().output, None] {
            let samples = Samples { output, ..samples() };
            let exchange = Exchange::new(7, &samples, &command);
            assert_eq!((exchange.tick, exchange.samples(), exchange.command()), (7, samples, Some(command)));
            let probing = Exchange::probing(7, &samples);
            assert_eq!((probing.tick, probing.samples(), probing.command()), (7, samples, None));
        }
    }
}

/// No probe, and all results of a probe.
fn probes() -> Vec<Option<ProbeProgress<f32>>> {
    use ProbeRefusal::*;
    let refused = [NotAtRest, Loaded, NotHeld, Stuck, Unsteady, BadSamples].map(ProbeProgress::Refused);
    let done = ProbeProgress::Done(Estimate { value: 40e-6, variance: 1e-12, valid: true });
    [ProbeProgress::Running, done].into_iter().chain(refused).map(Some).chain([None]).collect()
}

#[test]
fn answers_round_trip() {
    for stage in [Stage::Touching, Stage::Crossing, Stage::Landing, Stage::Plain, Stage::Off, Stage::Reversed] {
        let shaped = ControlOutput {
            torque: 1.0,
            stage,
            flank: Some(Flank::Back),
            demand: 2.0,
            load: [3.0, 4.0],
            trust: 0.5,
            short_of_torque: true,
            stepped_back: true,
        };
        for probed in probes() {
            let answer = Answer { estimates: estimates(), shaped, probed };
            let wire = Answered {
                tick: 1,
                digest: 2,
                shaped: (&shaped).into(),
                estimates: Some((&answer.estimates).into()),
                probed: probed.map(Into::into),
                computation: 3,
            };
            assert_eq!(wire.answer(), Some(answer));
        }
    }
    use OutputFault::{Absent, OutOfRange};
    let alone =
        [Absent, OutputFault::Unheard, OutputFault::Silent, OutputFault::Frozen, OutOfRange].map(Source::MotorOnly);
    let none = [MotorFault::Silent, MotorFault::Late, MotorFault::Frozen, MotorFault::Jumped].map(Source::Nothing);
    for source in alone.into_iter().chain(none).chain([Source::Both]) {
        let one = Estimates { source, ..estimates() };
        assert_eq!(Estimates::from(WireEstimates::from(&one)), one);
    }
}

#[test]
fn motions_round_trip() {
    let segment = Segment { turns: -3, powers: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6] };
    let trajectories = [
        Trajectory::Position { now: segment, ahead: None },
        Trajectory::Position { now: segment, ahead: Some(Segment { turns: 4, ..segment }) },
        Trajectory::Impedance(IMPEDANCE),
    ];
    for trajectory in trajectories {
        assert_eq!(Trajectory::from(WireTrajectory::from(&trajectory)), trajectory);
    }
}

#[test]
fn non_finite_knot_is_reported() {
    let segment = Segment { turns: 0, powers: [0.0; 6] };
    let good = Knot { tick: 0, load_torque: 0.0, trajectory: WireTrajectory::Position((0, segment.powers), None) };
    assert!(good.is_finite());
    assert!(!Knot { load_torque: f32::NAN, ..good }.is_finite());
    let mut powers = segment.powers;
    powers[5] = f32::INFINITY;
    assert!(!Knot { trajectory: WireTrajectory::Position((0, powers), None), ..good }.is_finite());
    assert!(!Knot { trajectory: WireTrajectory::Position((0, segment.powers), Some((0, powers))), ..good }.is_finite());
    let soft = ImpedancePoint { damping: f32::NAN, ..IMPEDANCE };
    assert!(!Knot { trajectory: WireTrajectory::Impedance(soft.into()), ..good }.is_finite());
}

#[test]
fn longest_forms_fit_into_a_frame() {
    let exchange = Exchange {
        tick: u32::MAX,
        ..Exchange::new(0, &samples(), &Command::Position { now: MOTION, ahead: Some(MOTION) })
    };
    let commands = std::iter::repeat_n(exchange, EXCHANGES_PER_SCHEDULE).collect();
    let exchanges = ToBoard::Exchanges(Schedule { sequence: u16::MAX, horizon: u32::MAX, commands });
    let far = (i32::MIN, [f32::MAX; 6]);
    let knot = Knot { tick: u32::MAX, load_torque: 1.0, trajectory: WireTrajectory::Position(far, Some(far)) };
    let commands = std::iter::repeat_n(knot, KNOTS_PER_SCHEDULE).collect();
    let trajectory = ToBoard::Trajectory(Schedule { sequence: u16::MAX, horizon: u32::MAX, commands });
    for message in [exchanges, trajectory] {
        let mut receiver = Receiver::new();
        assert_eq!(encode(&message).unwrap().iter().find_map(|&byte| receiver.push(byte)), Some(message));
    }
    let answer = FromBoard::Answer(Answered {
        tick: u32::MAX,
        digest: u64::MAX,
        shaped: (&ControlOutput::default()).into(),
        estimates: Some((&estimates()).into()),
        probed: Some(WireProbed::Done((1.0, 1.0, true))),
        computation: u16::MAX,
    });
    let sample = LoopSample {
        tick: u32::MAX,
        digest: u64::MAX,
        carrier: (i32::MIN, u32::MAX),
        link_offset: 1.0,
        gaps: (1.0, 1.0),
        gap_valid: true,
        half_backlash: 1.0,
        torque: 1.0,
        loads: (1.0, 1.0),
        trust: 1.0,
        computation: u16::MAX,
    };
    let samples = std::iter::repeat_n(sample, LOOP_SAMPLES_PER_BATCH).collect();
    for message in [answer, FromBoard::Loop(LoopBatch { sequence: u16::MAX, samples })] {
        let mut receiver = Receiver::new();
        assert_eq!(encode(&message).unwrap().iter().find_map(|&byte| receiver.push(byte)), Some(message));
    }
}
