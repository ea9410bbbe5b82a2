//! A board behind a bad line: a run while it is disturbed, the link afterwards, and a run on the line that is good again.
//!
//! Neither the emulated board nor one in a thread keeps the time of the day, so nothing is judged by a clock. How soon the
//! link is back is judged in frames: the very first ones after the disturbance are heard and answered. They are 40 bytes one
//! way and less than 200 the other, 11 ms on a real line of 230400 baud, behind what the board had still to say.

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
/// A busy machine is given time: nothing is judged by it.
const LIVENESS: Duration = Duration::from_secs(60);
/// A line on which nothing has come for so long has nothing more to bring.
const QUIET: Duration = Duration::from_millis(150);

/// So many seeds, or as many as `PROXY_SEEDS` says.
pub fn seeds(usual: u64) -> Range<u64> {
    0..std::env::var("PROXY_SEEDS").map_or(usual, |count| count.parse().expect("a number of seeds"))
}

struct Nobody;

impl Supervisor for Nobody {
    fn interrupted(&self) -> bool {
        false
    }
}

/// A board behind a proxy, and what it does when nothing disturbs it.
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
    /// Joint Q1 as a plant on a board.
    pub fn of(board: UnixStream, command_timeout: u32) -> Self {
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
        trial.undisturbed = trial.good_run();
        trial
    }

    /// What a seed does, and how the run ends that it disturbs.
    pub fn seed(&self, seed: u64) {
        let trouble = self.proxy.disturb(seed);
        let (outcome, recording) = self.run();
        self.proxy.calm();
        let end = outcome.as_ref().map_or_else(Failure::to_string, |()| "comes to its end".into());
        println!("seed {seed}: {trouble}: {end}");
        self.judge(&outcome, &recording);
        self.answers_at_once();
        self.good_run();
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
        // How long a step took depends on what came over the line meanwhile.
        recording.samples.iter_mut().for_each(|sample| sample.computation = 0);
        (outcome, recording)
    }

    /// A run on a good line: every check of its report holds, and it is the same as ever.
    fn good_run(&self) -> Recording {
        let (outcome, recording) = self.run();
        outcome.and_then(|()| self.report(&recording)).expect("the line is good");
        assert!(self.undisturbed.samples.is_empty() || recording.samples == self.undisturbed.samples);
        recording
    }

    /// The verdict of the run's report.
    fn report(&self, recording: &Recording) -> Outcome<()> {
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

    /// The run ends with an error that says what to do, or its report says what was lost, or nothing was; no sample is
    /// wrong or there twice, and no tick came late.
    fn judge(&self, outcome: &Outcome<()>, recording: &Recording) {
        assert!(recording.statistics.as_ref().is_none_or(|statistics| statistics.overruns == 0), "overruns");
        assert!(recording.samples.is_sorted_by(|one, next| one.tick < next.tick), "samples twice or out of order");
        let right = recording.samples.iter().all(|sample| self.undisturbed.samples.contains(sample));
        assert!(right, "a sample that no undisturbed run has");
        match outcome {
            Err(failure) => assert!(failure.help().is_some(), "{failure}"),
            Ok(()) => match self.report(recording) {
                Err(failure) => println!("    reported: {failure}"),
                Ok(()) => assert_eq!(recording.samples, self.undisturbed.samples, "a loss that no check tells"),
            },
        }
    }

    /// The first stop on the good line is heard, and the first hello answered, whatever hangs in the board's receiver. A
    /// schedule between them asks whether a run goes on.
    fn answers_at_once(&self) {
        let mut line = self.line();
        receive_until(&mut line, QUIET, |_| false);
        let empty = Schedule { sequence: 0, horizon: 0, commands: heapless::Vec::new() };
        let questions = [ToBoard::Stop, ToBoard::Schedule(empty), ToBoard::Hello { protocol: PROTOCOL_VERSION }];
        for question in questions {
            // As a session sends: a zero byte keeps it apart from what came before.
            line.send(&[&[0], &encode(&question).expect("a short message")[..]].concat()).expect("the line is there");
        }
        let is_stopped = |message: &FromBoard| *message == FromBoard::Tripped(Trip::NotRunning);
        // Answers to a flood of hellos may still be under way on a busy machine: they come before that of the stop.
        let since_stop = |said: &[FromBoard]| said.iter().skip_while(|message| !is_stopped(message)).count();
        let said = receive_until(&mut line, LIVENESS, |said| since_stop(said) > 1);
        assert!(since_stop(&said) > 0, "the first stop on a good line is not heard: {said:?}");
        let is_hello = matches!(said.last(), Some(FromBoard::Hello(_)));
        assert!(is_hello, "the first hello on a good line is not answered: {said:?}");
    }
}

/// What comes until all is found, or nothing more comes.
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
