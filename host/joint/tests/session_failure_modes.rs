//! A session with a board in a thread, in normal operation and in its failure modes: messages, saved recordings,
//! outcome.

#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod thread_board;

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use board::device::board::Chip;
use board::profile::TorqueProfile;
use board::recording::Recording;
use board::session::{BoardHelp, Expected, Session, Supervisor};
use board::transport::Socket;
use board::twin::{self, Agreement};
use link::framing::{Receiver, encode};
use link::messages::{Role, RunMode, RunSettings, ToBoard, Trip};
use report::failure::{Failure, Outcome};
use thread_board::{Misbehaviour, TICK_RATE, joint};

/// Messages are due within 2 s by design; a busy machine gets ten times as long.
const LIVENESS: Duration = Duration::from_secs(20);
const TIMEOUT: Duration = Duration::from_secs(2);

/// A user who may press Ctrl-C at a given time.
struct User(Option<Instant>);

impl Supervisor for User {
    fn interrupted(&self) -> bool {
        self.0.is_some_and(|at| Instant::now() > at)
    }
}

fn expected() -> Expected {
    Expected {
        joint: "Q1".into(),
        digest: twin::tables_digest(&joint(), Chip::Stm32f405, TICK_RATE).expect("a good joint"),
        tick_rate: TICK_RATE,
        planets: 3,
        role: Role::Plant,
        control_digest: None,
        help: BoardHelp::Flash("cargo joint flash q1".into()),
    }
}

fn profile() -> TorqueProfile {
    TorqueProfile::load("reversals", &joint(), TICK_RATE, Some(1.0)).expect("built in")
}

fn run_with(misbehaviour: Misbehaviour, mode: RunMode, user: User) -> (Outcome<()>, Recording) {
    let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
    theirs.set_read_timeout(Some(Duration::from_millis(2))).expect("an option");
    let board = thread_board::start(theirs, misbehaviour);
    let line = Socket::new(ours, "the board in a thread").expect("options");
    let mut session = Session::new(Box::new(line), Box::new(user));
    let start = Instant::now();
    let settings = RunSettings { mode, decimation: 50, command_timeout: TICK_RATE, from_memory: false };
    let outcome = session
        .connect(&expected(), TIMEOUT)
        .and_then(|_| session.reset(settings))
        .and_then(|()| session.stream(&profile(), &mut |_| {}))
        .and_then(|()| session.finish(TICK_RATE));
    if outcome.is_err() {
        session.abandon();
    }
    assert!(start.elapsed() < LIVENESS, "it took {:?}", start.elapsed());
    let recording = std::mem::take(&mut session.recording);
    drop(session);
    board.join().expect("the board does not panic");
    (outcome, recording)
}

fn run(misbehaviour: Misbehaviour) -> (Outcome<()>, Recording) {
    run_with(misbehaviour, RunMode::Lockstep, User(None))
}

fn failure(misbehaviour: Misbehaviour) -> (Failure, Recording) {
    let (outcome, recording) = run(misbehaviour);
    let failure = outcome.expect_err("a failure mode");
    assert!(failure.help().is_some(), "{failure}");
    (failure, recording)
}

/// Comparison of the recorded run with the run computed on the host.
fn agreement(recording: &Recording) -> Agreement {
    let Recording { accepted, samples, .. } = recording;
    twin::compare(&joint(), Chip::Stm32f405, TICK_RATE, accepted, samples).expect("designed")
}

#[test]
fn good_run_is_complete_and_equals_twin() {
    for mode in [RunMode::Lockstep, RunMode::Realtime] {
        let (outcome, recording) = run_with(Misbehaviour::None, mode, User(None));
        outcome.expect("normal operation");
        assert_eq!(recording.samples.len(), 400, "{mode:?}");
        assert_eq!(recording.accepted, profile().commands, "{mode:?}");
        assert_eq!(recording.traffic.bad_frames + recording.traffic.lost_batches, 0);
        let agreement = agreement(&recording);
        assert_eq!((agreement.steps, agreement.different), (TICK_RATE, 0), "{mode:?}: {:?}", agreement.first);
        assert!(recording.statistics.is_some_and(|statistics| statistics.ticks >= TICK_RATE));
    }
}

#[test]
fn late_torques_break_agreement() {
    let (outcome, recording) = run(Misbehaviour::LateTorques);
    outcome.expect("the line itself is good");
    assert!(agreement(&recording).different > 0);
}

#[test]
fn hang_up_keeps_recording() {
    let (failure, recording) = failure(Misbehaviour::HangsUpAt(10_000));
    assert!(failure.message().contains("the board in a thread"), "{failure}");
    assert!(recording.samples.len() >= 100, "{} samples kept", recording.samples.len());
    assert_eq!(agreement(&recording).different, 0, "what was kept is still good");
}

#[test]
fn silent_board_names_tick() {
    let (failure, recording) = failure(Misbehaviour::FallsSilentAt(5_000));
    assert!(failure.message().contains("fallen silent at tick"), "{failure}");
    assert!(!recording.samples.is_empty());
}

#[test]
fn half_frame_counted_run_continues() {
    let (outcome, recording) = run(Misbehaviour::HalfFrameAt(8_000));
    outcome.expect("a half frame costs nothing but itself");
    assert_eq!(recording.traffic.bad_frames, 1, "only the one in the run counts");
    assert_eq!(recording.samples.len(), 400);
}

#[test]
fn garbage_distinguished_from_dead_line() {
    let (garbage, _) = failure(Misbehaviour::OnlyGarbage);
    assert!(garbage.message().contains("no valid frame"), "{garbage}");
    assert!(garbage.help().is_some_and(|help| help.contains("--baud")), "{garbage}");
    let (dead, _) = failure(Misbehaviour::Mute);
    assert!(dead.message().contains("nothing came"), "{dead}");
}

#[test]
fn wrong_role_version_or_joint_rejected() {
    let (version, _) = failure(Misbehaviour::Protocol(99));
    assert!(version.message().contains("version 99"), "{version}");
    let (role, _) = failure(Misbehaviour::AnotherRole);
    assert!(role.message().contains("role"), "{role}");
    let (digest, _) = failure(Misbehaviour::AnotherDigest);
    assert!(digest.message().contains("another joint"), "{digest}");
    for failure in [version, role, digest] {
        assert!(failure.help().is_some_and(|help| help.contains("cargo joint flash q1")), "{failure}");
        assert_eq!(failure.exit_code(), 2);
    }
}

#[test]
fn lost_batch_is_counted() {
    let (outcome, recording) = run(Misbehaviour::LosesBatch(20));
    outcome.expect("the run goes on");
    assert_eq!(recording.traffic.lost_batches, 1);
    assert!(recording.samples.len() < 400);
}

#[test]
fn lost_schedule_is_not_a_good_run() {
    let (outcome, recording) = run(Misbehaviour::LosesSchedule(0));
    let lost = recording.statistics.as_ref().map_or(0, |statistics| statistics.lost_schedules);
    assert!(outcome.is_err() || lost == 1, "{outcome:?}");
}

#[test]
fn trip_ends_run_with_message() {
    let (failure, recording) = failure(Misbehaviour::TripAt(4_000, Trip::NotFinite { tick: 4_000 }));
    assert!(failure.message().contains("no longer finite"), "{failure}");
    assert!(failure.message().contains("tick 4000"), "{failure}");
    assert_eq!(recording.trips, [Trip::NotFinite { tick: 4_000 }]);
    assert_eq!(failure.exit_code(), 1);
}

#[test]
fn pending_half_frame_does_not_hide_stop() {
    let (ours, mut theirs) = UnixStream::pair().expect("a pair of sockets");
    (&ours).write_all(&encode(&ToBoard::Statistics { reset: true }).expect("short")[..3]).expect("the line is there");
    let line = Socket::new(ours, "half a frame").expect("options");
    Session::new(Box::new(line), Box::new(User(None))).abandon();
    let (mut bytes, mut receiver) = (Vec::new(), Receiver::new());
    theirs.read_to_end(&mut bytes).expect("the line is there");
    let heard = bytes.into_iter().find_map(|byte| receiver.push::<ToBoard>(byte));
    assert_eq!(heard, Some(ToBoard::Stop));
}

#[test]
fn ctrl_c_ends_wait_for_board() {
    let user = User(Some(Instant::now() + Duration::from_millis(50)));
    let (outcome, _) = run_with(Misbehaviour::Mute, RunMode::Lockstep, user);
    assert_eq!(outcome.expect_err("interrupted").exit_code(), 130);
}
