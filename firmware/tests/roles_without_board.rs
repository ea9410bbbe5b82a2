//! Tests of the roles that control, without a board: answers equal those of direct calls of observer and compensation
//! in every bit, and a host that errs or falls silent leads to the specified state. Other tests cover the quality of
//! the answers.

#[allow(dead_code, reason = "shared with the tests of the plant")]
mod test_board;
#[allow(dead_code, reason = "shared with the tests of the enable output")]
mod test_roles;

use firmware::tables::TABLES;
use link::controller::{Answered, Exchange};
use link::messages::{FromBoard, RunMode, RunSettings, Schedule, ToBoard, Trip};
use link::virtual_joint::{Knot, LoopSample};
use model_core::compensation::Command;
use model_core::controller::trajectory::Trajectory;
use model_core::numbers::digest;
use model_core::virtual_joint::VirtualJoint;
use model_core::virtual_joint::fault::{EncoderShaft, Fault, FaultKind};
use model_core::virtual_joint::fault_injector::MAX_FAULTS;
use test_board::TestBoard;
use test_roles::{LoopWork, ObserverWork, TestRole, control, controller, knot};

fn observer() -> TestBoard<ObserverWork> {
    TestBoard::with(ObserverWork::work())
}

fn whole_loop() -> TestBoard<LoopWork> {
    TestBoard::with(LoopWork::work())
}

fn exchange(
    tick: u32,
    joint: &VirtualJoint<'_, f32, { firmware::tables::PLANETS }>,
    command: &Command<f32>,
) -> ToBoard {
    let commands = [Exchange::new(tick, &joint.samples(), command)].into_iter().collect();
    ToBoard::Exchanges(Schedule { sequence: tick as u16, horizon: tick + 1, commands })
}

fn answers(said: Vec<FromBoard>) -> Vec<Answered> {
    let answer = |message| if let FromBoard::Answer(answered) = message { Some(answered) } else { None };
    said.into_iter().filter_map(answer).collect()
}

fn samples(said: Vec<FromBoard>) -> Vec<LoopSample> {
    let batch = |message| if let FromBoard::Loop(batch) = message { Some(batch.samples) } else { None };
    said.into_iter().filter_map(batch).flatten().collect()
}

fn trips(said: &[FromBoard]) -> Vec<Trip> {
    let fault = |message: &FromBoard| if let FromBoard::Tripped(fault) = message { Some(*fault) } else { None };
    said.iter().filter_map(fault).collect()
}

#[test]
fn line_observer_bit_identical_to_call() {
    let mut board = observer();
    board.start(RunMode::Lockstep, 1, 1000);
    let mut joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
    let (mut own, mut running) = (controller(), digest::START);
    for tick in 0..300 {
        let command = Trajectory::from(knot(0).trajectory).at(1e-4 * tick as f32, control::SURROUNDINGS.turn);
        board.send(&exchange(tick, &joint, &command));
        board.run(2);
        let expected = own.step(&joint.samples(), &command);
        running = expected.digest(running);
        let said = answers(board.said());
        let [answered] = &said[..] else { panic!("{said:?}") };
        // The motor's lead is not sent.
        let mut sent = expected;
        sent.estimates.motor_lead = 0.0;
        assert_eq!((answered.tick, answered.digest, answered.answer()), (tick + 1, running, Some(sent)));
        joint.advance(expected.shaped.torque, 0.0);
    }
}

#[test]
fn unrequested_estimates_in_digest_only() {
    let mut board = observer();
    board.start(RunMode::Lockstep, 1, 1000);
    let (joint, command) = (VirtualJoint::new(&TABLES, &control::SURROUNDINGS), Trajectory::HOLD.at(0.0, 1.0));
    let expected = controller().step(&joint.samples(), &command);
    let commands = [Exchange::new(0, &joint.samples(), &command).without_estimates()].into_iter().collect();
    board.send(&ToBoard::Exchanges(Schedule { sequence: 0, horizon: 1, commands }));
    board.run(2);
    let said = answers(board.said());
    let [answered] = &said[..] else { panic!("{said:?}") };
    assert_eq!((answered.estimates, answered.digest), (None, expected.digest(digest::START)));
    assert_eq!(answered.shaped, (&expected.shaped).into());
}

#[test]
fn silent_controller_ends_safe() {
    let mut board = observer();
    board.start(RunMode::Lockstep, 1, 50);
    let joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
    board.run(40);
    assert!(board.enable.get());
    board.send(&exchange(0, &joint, &Trajectory::HOLD.at(0.0, 1.0)));
    board.run(40);
    assert!(board.enable.get());
    board.run(40);
    assert!(!board.enable.get());
    assert_eq!(trips(&board.said()), [Trip::CommandLoss { tick: 1 }]);
}

#[test]
fn observer_needs_samples() {
    let mut board = observer();
    let settings = RunSettings { mode: RunMode::Realtime, decimation: 1, command_timeout: 100, from_memory: false };
    board.send(&ToBoard::Reset(settings));
    board.run(3);
    assert_eq!(trips(&board.said()), [Trip::BadSettings]);
}

/// The torque stays finite.
#[test]
fn nan_samples_flagged() {
    let mut board = observer();
    board.start(RunMode::Lockstep, 1, 1000);
    let joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
    let command = Trajectory::HOLD.at(0.0, 1.0);
    for tick in 0..10 {
        let mut samples = joint.samples();
        samples.time = tick * control::SURROUNDINGS.clock_ticks;
        samples.torque = if tick > 5 { f32::NAN } else { 0.0 };
        let commands = [Exchange::new(tick, &samples, &command)].into_iter().collect();
        board.send(&ToBoard::Exchanges(Schedule { sequence: tick as u16, horizon: tick + 1, commands }));
        board.run(2);
        let answer = answers(board.said())[0].answer().expect("estimates");
        assert_eq!(answer.estimates.notices.torque_unknown, tick > 5);
        assert!(answer.shaped.torque.is_finite());
    }
    assert!(board.enable.get());
}

/// In both modes.
#[test]
fn whole_loop_bit_identical_to_parts() {
    for mode in [RunMode::Lockstep, RunMode::Realtime] {
        let mut board = whole_loop();
        board.start(mode, 7, 1000);
        let knots: Vec<Knot> = (0..6).map(|index| knot(50 * index)).collect();
        let commands = knots.iter().copied().collect();
        board.send(&ToBoard::Trajectory(Schedule { sequence: 0, horizon: 300, commands }));
        board.run(301);
        let samples: Vec<LoopSample> = samples(board.said()).into_iter().filter(|sample| sample.tick <= 300).collect();
        assert_eq!(samples.len(), 300 / 7);
        let mut joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
        let (mut own, mut running, mut expected) = (controller(), digest::START, samples.iter());
        for tick in 0..300_u32 {
            let now = &knots[(tick / 50) as usize];
            let elapsed = control::SURROUNDINGS.period * (tick - now.tick) as f32;
            let command = Trajectory::from(now.trajectory).at(elapsed, control::SURROUNDINGS.turn);
            let answer = own.step(&joint.samples(), &command);
            joint.advance(answer.shaped.torque, now.load_torque);
            running = digest::chain(answer.digest(running), joint.model().state_digest());
            if (tick + 1) % 7 == 0 {
                let sample = expected.next().expect("a sample");
                assert_eq!((sample.tick, sample.digest), (tick + 1, running));
                assert_eq!(sample.torque.to_bits(), answer.shaped.torque.to_bits());
            }
        }
    }
}

/// No more faults than fit are accepted.
#[test]
fn loop_faults_accepted_before_start_only() {
    let mut board = whole_loop();
    let fault = |kind| ToBoard::Fault(Fault { start: 20, end: 40, seed: 1, kind });
    let taken = |said: Vec<FromBoard>| {
        let of = |message: &FromBoard| if let FromBoard::FaultTaken { taken } = message { Some(*taken) } else { None };
        said.iter().find_map(of).expect("an answer")
    };
    board.send(&fault(FaultKind::Saturation(0.0)));
    board.run(3);
    assert!(!taken(board.said()), "nothing runs yet");
    board.start(RunMode::Lockstep, 1, 1000);
    for number in 0..=MAX_FAULTS {
        board.send(&fault(if number == 0 {
            FaultKind::Frozen(EncoderShaft::Motor)
        } else {
            FaultKind::Saturation(0.01)
        }));
        board.run(3);
        assert_eq!(taken(board.said()), number < MAX_FAULTS);
    }
    let commands = [knot(0)].into_iter().collect();
    board.send(&ToBoard::Trajectory(Schedule { sequence: 0, horizon: 60, commands }));
    board.run(90);
    let said = samples(board.said());
    let mut joint = VirtualJoint::new(&TABLES, &control::SURROUNDINGS);
    let (mut own, mut running, mut held) = (controller(), digest::START, None);
    for (tick, sample) in (0..60_u32).zip(&said) {
        let command = Trajectory::from(knot(0).trajectory)
            .at(control::SURROUNDINGS.period * tick as f32, control::SURROUNDINGS.turn);
        let (mut samples, on) = (joint.samples(), (20..40).contains(&tick));
        held = if on { held.or(Some(samples.motor.counts)) } else { None };
        samples.motor.counts = held.unwrap_or(samples.motor.counts);
        samples.torque = own_torque(&said, tick);
        let torque = own.step(&samples, &command);
        let given = if on { torque.shaped.torque.clamp(-0.01, 0.01) } else { torque.shaped.torque };
        joint.advance(given, knot(0).load_torque);
        running = digest::chain(torque.digest(running), joint.model().state_digest());
        assert_eq!((sample.tick, sample.digest), (tick + 1, running));
    }
    assert_eq!(said.len(), 60);
    board.send(&fault(FaultKind::Saturation(0.0)));
    board.run(3);
    assert!(!taken(board.said()), "the run has begun");
}

/// Motor torque commanded in the last period.
fn own_torque(said: &[LoopSample], tick: u32) -> f32 {
    tick.checked_sub(1).map_or(0.0, |before| said[before as usize].torque)
}

/// They change nothing.
#[test]
fn messages_for_other_roles_rejected() {
    let mut board = whole_loop();
    board.start(RunMode::Lockstep, 1, 1000);
    board.send(&ToBoard::Schedule(Schedule { sequence: 0, horizon: 10, commands: heapless::Vec::new() }));
    board.run(5);
    let said = board.said();
    assert_eq!(trips(&said), [Trip::WrongRole]);
    assert!(samples(said).is_empty() && board.enable.get());
}

/// The motion is not followed.
#[test]
fn nan_motion_trips() {
    let mut board = whole_loop();
    board.start(RunMode::Lockstep, 1, 1000);
    let commands = [Knot { load_torque: f32::NAN, ..knot(3) }].into_iter().collect();
    board.send(&ToBoard::Trajectory(Schedule { sequence: 0, horizon: 10, commands }));
    board.run(20);
    let said = board.said();
    assert_eq!(trips(&said), [Trip::BadCommand { tick: 3 }]);
    assert!(samples(said).is_empty() && !board.enable.get());
}
