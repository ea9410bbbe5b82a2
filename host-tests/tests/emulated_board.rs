//! The firmware on the emulated board, addressed in bare frames: its identity, and its f32 state, which equals the core's on this machine
//! in every bit of every step.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use board::device::board::Board;
use board::device::emulator;
use board::device::emulator::Emulator;
use board::device::image::{build_image, preset_file};
use board::device::toolchain::Toolchain;
use link::PROTOCOL_VERSION;
use link::framing::{Receiver, encode};
use link::messages::{
    Clock, ClockSource, Command, FromBoard, Hello, Role, RunMode, RunSettings, Sample, Schedule, ToBoard,
};
use model_core::gears::design::design;
use model_core::gears::{Model, Tables, Torques};
use model_core::numbers::digest::{self, chain};
use reference::scenarios;

const TICK_RATE: u32 = 20_000;
const TICKS: u32 = 4000;
/// Ticks between changes of the torques.
const HOLD: u32 = 100;
/// Timeout of an answer, long enough for a busy machine.
const TIMEOUT: Duration = Duration::from_secs(120);
/// Silence after which a message counts as lost and is sent again. A reply arrives in pieces, each a sign of life: repeating the request at
/// every piece would flood the board, and a flood loses frames.
const REPEAT_AFTER: Duration = Duration::from_secs(2);

/// Connection to the board, in messages.
struct Line {
    stream: UnixStream,
    receiver: Receiver,
}

impl Line {
    fn new(stream: UnixStream) -> Self {
        stream.set_read_timeout(Some(Duration::from_millis(50))).expect("a socket");
        Self { stream, receiver: Receiver::new() }
    }

    fn send(&mut self, message: &ToBoard) {
        let frame = encode(message).expect("a message that fits");
        self.stream.write_all(&frame).expect("the emulator listens");
    }

    /// Messages that have arrived within 50 ms.
    fn receive(&mut self) -> Vec<FromBoard> {
        let mut bytes = [0; 4096];
        let count = match self.stream.read(&mut bytes) {
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(error) => panic!("the line broke: {error}"),
        };
        bytes[..count].iter().filter_map(|byte| self.receiver.push(*byte)).collect()
    }

    /// Repeats a request until `answer` accepts a reply.
    fn ask<A>(&mut self, message: &ToBoard, answer: impl Fn(FromBoard) -> Option<A>) -> A {
        let start = Instant::now();
        let mut asked: Option<Instant> = None;
        while start.elapsed() < TIMEOUT {
            if asked.is_none_or(|time| time.elapsed() > REPEAT_AFTER) {
                self.send(message);
                asked = Some(Instant::now());
            }
            if let Some(found) = self.receive().into_iter().find_map(&answer) {
                return found;
            }
        }
        panic!("no answer to {message:?}");
    }

    /// Waits until the board is silent: a repeated request is answered repeatedly.
    fn drain(&mut self) {
        let mut heard = Instant::now();
        while heard.elapsed() < REPEAT_AFTER {
            if !self.receive().is_empty() {
                heard = Instant::now();
            }
        }
    }
}

fn hello(message: FromBoard) -> Option<Hello> {
    match message {
        FromBoard::Hello(hello) => Some(hello),
        _ => None,
    }
}

/// Torques that swing joint Q1 through its gap.
fn torques(tick: u32) -> (f32, f32) {
    let sign = if (tick / 800).is_multiple_of(2) { 1.0 } else { -1.0 };
    let part = 1.0 - 0.1 * (tick / HOLD % 8) as f32;
    (0.8 * sign * part, 4.0 * sign * part)
}

fn schedule(sequence: u16) -> ToBoard {
    let tick = u32::from(sequence) * HOLD;
    let (drive_torque, load_torque) = torques(tick);
    let commands = [Command { tick, drive_torque, load_torque }].into_iter().collect();
    ToBoard::Schedule(Schedule { sequence, horizon: tick + HOLD, commands })
}

/// Samples of a whole run, in order.
fn run(line: &mut Line) -> Vec<Sample> {
    // The emulated clock runs as fast as it can while this host is busy.
    let command_timeout = u32::MAX;
    let settings =
        RunSettings { mode: RunMode::Lockstep, decimation: HOLD as u16, command_timeout, from_memory: false };
    line.ask(&ToBoard::Reset(settings), hello);
    // A repeated reset that arrives late would end the run.
    line.drain();
    let (mut samples, mut next) = (Vec::new(), 0);
    let start = Instant::now();
    line.send(&schedule(0));
    while samples.len() < (TICKS / HOLD) as usize {
        assert!(start.elapsed() < TIMEOUT, "{} samples in all that time", samples.len());
        for message in line.receive() {
            match message {
                FromBoard::Accepted(accepted) if accepted.sequence == next => {
                    next += 1;
                    if u32::from(next) * HOLD < TICKS {
                        line.send(&schedule(next));
                    }
                }
                FromBoard::Samples(batch) => samples.extend(batch.samples),
                FromBoard::Tripped(fault) => panic!("{fault:?}"),
                _ => {}
            }
        }
    }
    samples
}

/// State digests and outputs of the board equal the core's at every sample.
#[test]
#[ignore = "needs the emulated board: run by `cargo joint hil --check`"]
fn board_state_equals_core_in_every_bit() {
    let say = |line: &str| println!("{line}");
    let toolchain = Toolchain::prepare(&say).expect("a toolchain for the board");
    emulator::ensure(&say).expect("an emulator");
    let file = preset_file("q1");
    let image =
        build_image(&toolchain, &file, &Board::emulated(), Role::Plant, TICK_RATE, false, &say).expect("an image");
    let (mut emulator, stream) = Emulator::start(&image.elf).expect("a board");
    let mut line = Line::new(stream);

    let text = std::fs::read_to_string(&file).expect("the preset");
    let joint = joint_file::read(&text).expect("a sound joint").parameters;
    let tables: Tables<f32, 3> = design(&joint, TICK_RATE).expect("a sound joint");
    let board = line.ask(&ToBoard::Hello { protocol: PROTOCOL_VERSION }, hello);
    assert_eq!((board.protocol, board.role, board.planets), (PROTOCOL_VERSION, Role::Plant, 3));
    assert_eq!((board.tick_rate, board.clock), (TICK_RATE, Clock::of(ClockSource::NotModelled)));
    assert_eq!((board.joint_digest, board.digest_good), (tables.digest, true));

    let samples = run(&mut line);
    emulator.check().expect("the board still runs");
    let mut model = Model::new(&tables);
    let (mut running, mut expected) = (digest::START, Vec::new());
    for tick in 0..TICKS {
        let (drive, load) = torques(tick / HOLD * HOLD);
        model.step(Torques { drive, load });
        running = chain(running, model.state_digest());
        if (tick + 1).is_multiple_of(HOLD) {
            let outputs = model.outputs();
            expected.push((tick + 1, running, outputs.gap.to_bits(), outputs.link_offset.to_bits()));
        }
    }
    let found: Vec<_> = samples
        .iter()
        .map(|sample| (sample.tick, sample.state_digest, sample.gap.to_bits(), sample.link_offset.to_bits()))
        .collect();
    assert_eq!(found, expected);
    // The run is only meaningful if the joint crossed its gap.
    let gaps = samples.iter().map(|sample| f64::from(sample.gap));
    let (least, greatest) =
        gaps.fold((f64::MAX, f64::MIN), |(least, greatest), gap| (gap.min(least), gap.max(greatest)));
    let half_backlash = scenarios::q1().sun_planet.half_backlash[0];
    assert!(least < -2.0 * half_backlash && greatest > 2.0 * half_backlash, "gap from {least:e} to {greatest:e} m");
}
