//! A board behind a bad line: a disturbed run, a check of the link afterwards, and a run on the undisturbed line.
//!
//! Neither the emulated board nor a board in a thread runs in real time, so no check uses a clock. Recovery of the link
//! is counted in frames: the first frames after the disturbance must be received and answered. Those are 40 bytes one
//! way and less than 200 the other, 11 ms on a real line of 230400 baud, after the board's pending output.

use std::ops::Range;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use board::device::board::Chip;
use board::profile::TorqueProfile;
use board::recording::Recording;
use board::session::{BoardHelp, Expected, Session, Supervisor};
use board::transport::{Line, Socket};
use board::twin;
use joint_run::checks::{Evidence, checks};
use link::PROTOCOL_VERSION;
use link::framing::{Receiver, encode};
use link::messages::{FromBoard, Role, RunMode, RunSettings, Schedule, ToBoard, Trip};
use parameters::JointParameters;
use report::checks::all_hold;
use report::failure::{Failure, Outcome};

use super::proxy::Proxy;

const TICK_RATE: u32 = 20_000;
/// Longest wait on a busy machine; no check depends on it.
const LIVENESS: Duration = Duration::from_secs(60);
/// Silence after which the line is considered empty.
const QUIET: Duration = Duration::from_millis(150);

/// Seeds to run: `PROXY_SEEDS` of the environment, or the default number.
pub fn seeds(default_count: u64) -> Range<u64> {
    0..std::env::var("PROXY_SEEDS").map_or(default_count, |count| count.parse().expect("a number of seeds"))
}

struct Nobody;

impl Supervisor for Nobody {
    fn interrupted(&self) -> bool {
        false
    }
}

/// A board behind a proxy, and its undisturbed run.
pub struct Trial {
    proxy: Proxy,
    host: UnixStream,
    joint: JointParameters,
    profile: TorqueProfile,
    settings: RunSettings,
    expected: Expected,
    undisturbed: Recording,
}

impl Trial {
    /// Starts joint Q1 as a plant on a board and records an undisturbed run.
    pub fn start(board: UnixStream, command_timeout: u32) -> Self {
        let text = joint_file::preset("q1").expect("the default preset");
        let joint = joint_file::read(text).expect("a good preset").parameters;
        let (proxy, host) = Proxy::before(board);
        let profile = TorqueProfile::load("reversals", &joint, TICK_RATE, Some(0.6)).expect("built in");
        let settings = RunSettings { mode: RunMode::Lockstep, decimation: 20, command_timeout, from_memory: false };
        let expected = Expected {
            joint: "Q1".into(),
            digest: twin::tables_digest(&joint, Chip::Stm32f405, TICK_RATE).expect("a good joint"),
            tick_rate: TICK_RATE,
            planets: 3,
            role: Role::Plant,
            control_digest: None,
            help: BoardHelp::Rebuild,
        };
        let mut trial = Self { proxy, host, joint, profile, settings, expected, undisturbed: Recording::default() };
        trial.undisturbed = trial.undisturbed_run();
        trial
    }

    /// Runs once with the disturbances of a seed, checks the outcome, then the recovery of the link and an undisturbed
    /// run.
    pub fn seed(&self, seed: u64) {
        let trouble = self.proxy.disturb(seed);
        let (outcome, recording) = self.run();
        self.proxy.end_disturbance();
        let end = outcome.as_ref().map_or_else(Failure::to_string, |()| "comes to its end".into());
        println!("seed {seed}: {trouble}: {end}");
        self.check_outcome(&outcome, &recording);
        self.check_recovery();
        self.undisturbed_run();
    }

    fn line(&self) -> Socket {
        Socket::new(self.host.try_clone().expect("a socket"), "the bad line").expect("options")
    }

    fn run(&self) -> (Outcome<()>, Recording) {
        let mut session = Session::new(Box::new(self.line()), Box::new(Nobody));
        let outcome = session
            .connect(&self.expected, LIVENESS)
            .and_then(|_| session.reset(self.settings))
            .and_then(|()| session.stream(&self.profile, &mut |_| {}))
            .and_then(|()| session.finish(self.profile.ticks));
        if outcome.is_err() {
            session.abandon();
        }
        let mut recording = std::mem::take(&mut session.recording);
        // The computation time of a step depends on the traffic.
        recording.samples.iter_mut().for_each(|sample| sample.computation = 0);
        (outcome, recording)
    }

    /// Runs on the undisturbed line: every check of the report holds, and the samples equal those of the first run.
    fn undisturbed_run(&self) -> Recording {
        let (outcome, recording) = self.run();
        outcome.and_then(|()| self.check_report(&recording)).expect("the line is good");
        assert!(self.undisturbed.samples.is_empty() || recording.samples == self.undisturbed.samples);
        recording
    }

    /// Verdict of the run's report.
    fn check_report(&self, recording: &Recording) -> Outcome<()> {
        let why = "not looked at";
        let agreement =
            twin::compare(&self.joint, Chip::Stm32f405, TICK_RATE, &recording.accepted, &recording.samples)?;
        let evidence = Evidence {
            recording,
            ticks: self.profile.ticks,
            agreement: &agreement,
            comparison: Err(why),
            log: Err(why),
            image: Err(why),
        };
        all_hold(&checks(&evidence), "see the report")
    }

    /// Checks a disturbed run: it ends with an error and its remedy, or the report states the loss, or nothing was
    /// lost. No sample is wrong or duplicated, and no tick was late.
    fn check_outcome(&self, outcome: &Outcome<()>, recording: &Recording) {
        assert!(recording.statistics.as_ref().is_none_or(|statistics| statistics.overruns == 0), "overruns");
        assert!(recording.samples.is_sorted_by(|one, next| one.tick < next.tick), "samples twice or out of order");
        let right = recording.samples.iter().all(|sample| self.undisturbed.samples.contains(sample));
        assert!(right, "a sample that no undisturbed run has");
        match outcome {
            Err(failure) => assert!(failure.help().is_some(), "{failure}"),
            Ok(()) => match self.check_report(recording) {
                Err(failure) => println!("    reported: {failure}"),
                Ok(()) => assert_eq!(recording.samples, self.undisturbed.samples, "a loss that no check tells"),
            },
        }
    }

    /// Checks the recovery of the link: the first stop and the first hello on the undisturbed line must be handled
    /// whatever the board's receiver holds. The schedule between them asks whether the run was stopped.
    fn check_recovery(&self) {
        let mut line = self.line();
        receive_until(&mut line, QUIET, |_| false);
        let empty = Schedule { sequence: 0, horizon: 0, commands: heapless::Vec::new() };
        let questions = [ToBoard::Stop, ToBoard::Schedule(empty), ToBoard::Hello { protocol: PROTOCOL_VERSION }];
        for question in questions {
            // A session also sends a zero byte first, which separates the frame from earlier bytes.
            line.send(&[&[0], &encode(&question).expect("a short message")[..]].concat()).expect("the line is there");
        }
        let is_stopped = |message: &FromBoard| *message == FromBoard::Tripped(Trip::NotRunning);
        // Answers to a flood of hellos may still arrive on a busy machine, before the answer to the stop.
        let since_stop = |said: &[FromBoard]| said.iter().skip_while(|message| !is_stopped(message)).count();
        let said = receive_until(&mut line, LIVENESS, |said| since_stop(said) > 1);
        assert!(since_stop(&said) > 0, "the first stop on a good line is not heard: {said:?}");
        let is_hello = matches!(said.last(), Some(FromBoard::Hello(_)));
        assert!(is_hello, "the first hello on a good line is not answered: {said:?}");
    }
}

/// Receives messages until `found` holds or the line is silent.
fn receive_until(line: &mut Socket, patience: Duration, found: impl Fn(&[FromBoard]) -> bool) -> Vec<FromBoard> {
    let (mut receiver, mut said, mut buffer) = (Receiver::new(), Vec::new(), [0; 4096]);
    let mut last = Instant::now();
    while last.elapsed() < patience && !found(&said) {
        let count = line.receive(&mut buffer).expect("the line is there");
        if count > 0 {
            last = Instant::now();
        }
        said.extend(buffer[..count].iter().filter_map(|&byte| receiver.push::<FromBoard>(byte)));
    }
    said
}
