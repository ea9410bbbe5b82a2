//! A board in a thread: the real step behind the real messages, on any byte stream, which misbehaves on demand. Timing
//! is made up; queues and buffers are as generous as the messages state.

use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::thread::JoinHandle;

use board::twin;
use link::framing::{Receiver, encode};
use link::messages::{
    Accepted, Clock, Command, FromBoard, HISTOGRAM_BINS, Hello, Role, RunMode, RunSettings, SAMPLES_PER_BATCH, Sample,
    SampleBatch, Schedule, Statistics, Timing, ToBoard, Trip,
};
use model_core::gears::{Model, Tables, Torques};
use model_core::numbers::digest;
use parameters::JointParameters;

/// Fixed steps a second [Hz].
pub const TICK_RATE: u32 = 20_000;

/// What the board does wrong.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Misbehaviour {
    /// Nothing.
    #[default]
    None,
    /// Hangs up at a tick.
    HangsUpAt(u32),
    /// Says nothing more from a tick on, but keeps the line.
    FallsSilentAt(u32),
    /// Garbage before its first word, half a frame in mid-run at a tick.
    HalfFrameAt(u32),
    /// Sends random bytes only.
    OnlyGarbage,
    /// Keeps every answer to itself.
    Mute,
    /// States this protocol version.
    Protocol(u16),
    /// States a role that this host does not know.
    AnotherRole,
    /// States another digest.
    AnotherDigest,
    /// Leaves out the batch with this number.
    LosesBatch(u16),
    /// Applies every torque a tick late.
    LateTorques,
    /// Reports a fault at a tick.
    TripAt(u32, Trip),
    /// Ignores the schedule with this number.
    LosesSchedule(u16),
    /// States overruns.
    Overruns(u32),
}

/// The default joint.
pub fn joint() -> JointParameters {
    joint_file::read(joint_file::preset("q1").expect("the default preset")).expect("a good preset").parameters
}

/// Starts a board on a stream; it ends when the stream does. The stream must have a short read timeout.
pub fn start<S: Read + Write + Send + 'static>(stream: S, misbehaviour: Misbehaviour) -> JoinHandle<()> {
    std::thread::spawn(move || {
        let tables = model_core::gears::design::design(&joint(), TICK_RATE).expect("a good joint");
        Board::new(stream, &tables, misbehaviour).run();
    })
}

/// The line is gone, or the board hangs up.
struct Gone;

struct Board<'t, S> {
    stream: S,
    misbehaviour: Misbehaviour,
    tables: &'t Tables<f32, 3>,
    model: Model<'t, f32, 3>,
    receiver: Receiver,
    settings: Option<RunSettings>,
    queue: VecDeque<Command>,
    torques: Torques<f32>,
    tick: u32,
    horizon: u32,
    next_schedule: u16,
    lost_schedules: u32,
    running: u64,
    samples: Vec<Sample>,
    next_batch: u16,
}

const QUEUE_CAPACITY: usize = 64;

impl<'t, S: Read + Write> Board<'t, S> {
    fn new(stream: S, tables: &'t Tables<f32, 3>, misbehaviour: Misbehaviour) -> Self {
        Self {
            stream,
            misbehaviour,
            tables,
            model: Model::new(tables),
            receiver: Receiver::new(),
            settings: None,
            queue: VecDeque::new(),
            torques: Torques { drive: 0.0, load: 0.0 },
            tick: 0,
            horizon: 0,
            next_schedule: 0,
            lost_schedules: 0,
            running: digest::START,
            samples: Vec::new(),
            next_batch: 0,
        }
    }

    fn run(mut self) {
        if matches!(self.misbehaviour, Misbehaviour::HalfFrameAt(_)) {
            let _ = self.stream.write_all(&[0x55, 0xaa, 0x01, 0x00, 0x13, 0x37]);
        }
        while self.listen().is_ok() {}
    }

    fn listen(&mut self) -> Result<(), Gone> {
        let mut buffer = [0; 512];
        let count = match self.stream.read(&mut buffer) {
            Ok(0) => return Err(Gone),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return Err(Gone),
        };
        for &byte in &buffer[..count] {
            if let Some(message) = self.receiver.push(byte) {
                self.answer(message)?;
            }
        }
        self.simulate()
    }

    fn answer(&mut self, message: ToBoard) -> Result<(), Gone> {
        match message {
            ToBoard::Hello { .. } => self.say_hello(),
            ToBoard::Reset(settings) => {
                let board = Self::new_state(self.tables);
                (self.model, self.torques, self.running) = board;
                self.settings = Some(settings);
                self.queue.clear();
                self.samples.clear();
                (self.tick, self.horizon, self.next_schedule, self.next_batch) = (0, 0, 0, 0);
                self.say_hello()
            }
            ToBoard::Schedule(schedule) => self.take(schedule),
            ToBoard::Exchanges(_) | ToBoard::Course(_) | ToBoard::Fault(_) | ToBoard::Memory(_) => {
                self.say(&FromBoard::Tripped(Trip::WrongRole))
            }
            ToBoard::Statistics { .. } => {
                let statistics = self.statistics();
                self.say(&FromBoard::Statistics(statistics))
            }
            ToBoard::Stop => {
                self.settings = None;
                Ok(())
            }
        }
    }

    fn new_state(tables: &'t Tables<f32, 3>) -> (Model<'t, f32, 3>, Torques<f32>, u64) {
        (Model::new(tables), Torques { drive: 0.0, load: 0.0 }, digest::START)
    }

    fn take(&mut self, schedule: Schedule) -> Result<(), Gone> {
        if self.misbehaviour == Misbehaviour::LosesSchedule(schedule.sequence) {
            return Ok(());
        }
        self.lost_schedules += u32::from(schedule.sequence.wrapping_sub(self.next_schedule));
        self.next_schedule = schedule.sequence.wrapping_add(1);
        if self.settings.is_none() {
            return self.say(&FromBoard::Tripped(Trip::NotRunning));
        }
        if self.queue.len() + schedule.commands.len() > QUEUE_CAPACITY {
            return self.say(&FromBoard::Tripped(Trip::QueueFull));
        }
        self.queue.extend(schedule.commands);
        self.horizon = schedule.horizon;
        let queue_free = (QUEUE_CAPACITY - self.queue.len()) as u16;
        self.say(&FromBoard::Accepted(Accepted { sequence: schedule.sequence, queue_free, tick: self.tick }))
    }

    fn simulate(&mut self) -> Result<(), Gone> {
        let Some(settings) = self.settings else { return Ok(()) };
        let end = match settings.mode {
            RunMode::Lockstep => self.horizon,
            RunMode::Realtime => self.horizon.min(self.tick + 200),
        };
        while self.tick < end {
            self.misbehave()?;
            let late = u32::from(self.misbehaviour == Misbehaviour::LateTorques);
            while let Some(command) = self.queue.pop_front_if(|command| command.tick + late <= self.tick) {
                self.torques = Torques { drive: command.drive_torque, load: command.load_torque };
            }
            self.model.step(self.torques);
            self.running = digest::chain(self.running, self.model.state_digest());
            self.tick += 1;
            if self.tick.is_multiple_of(settings.decimation.into()) {
                self.samples.push(twin::sample(&self.model, self.tick, self.running, 1000));
            }
            if self.samples.len() == SAMPLES_PER_BATCH {
                self.say_samples()?;
            }
        }
        if self.samples.is_empty() { Ok(()) } else { self.say_samples() }
    }

    fn misbehave(&mut self) -> Result<(), Gone> {
        match self.misbehaviour.clone() {
            Misbehaviour::HangsUpAt(tick) if self.tick >= tick => Err(Gone),
            Misbehaviour::FallsSilentAt(tick) if self.tick >= tick => {
                self.misbehaviour = Misbehaviour::Mute;
                Ok(())
            }
            Misbehaviour::HalfFrameAt(tick) if self.tick == tick => {
                let frame = encode(&FromBoard::Tripped(Trip::BadDigest)).map_err(|_| Gone)?;
                let mut half = frame[..frame.len() / 2].to_vec();
                half.push(0);
                self.stream.write_all(&half).map_err(|_| Gone)
            }
            Misbehaviour::TripAt(tick, trip) if self.tick == tick => {
                self.settings = None;
                self.say(&FromBoard::Tripped(trip))?;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn say_samples(&mut self) -> Result<(), Gone> {
        let samples = heapless::Vec::from_slice(&std::mem::take(&mut self.samples)).map_err(|_| Gone)?;
        let sequence = self.next_batch;
        self.next_batch = sequence.wrapping_add(1);
        if self.misbehaviour == Misbehaviour::LosesBatch(sequence) {
            return Ok(());
        }
        self.say(&FromBoard::Samples(SampleBatch { sequence, samples }))
    }

    fn say_hello(&mut self) -> Result<(), Gone> {
        if self.misbehaviour == Misbehaviour::AnotherRole {
            return self.say(&(0u32, link::PROTOCOL_VERSION, [0u8, 1, 0], 9u32, "cook", 0u64));
        }
        let digest = self.tables.digest;
        let another = self.misbehaviour == Misbehaviour::AnotherDigest;
        let protocol = match self.misbehaviour {
            Misbehaviour::Protocol(version) => version,
            _ => link::PROTOCOL_VERSION,
        };
        self.say(&FromBoard::Hello(Hello {
            protocol,
            firmware_version: [0, 1, 0],
            role: Role::Plant,
            board: heapless::String::try_from("fake").unwrap_or_default(),
            joint: heapless::String::try_from("Q1").unwrap_or_default(),
            joint_digest: if another { !digest } else { digest },
            digest_good: true,
            tick_rate: TICK_RATE,
            timer_rate: 168_000_000,
            clock: Clock::External,
            planets: 3,
            queue_capacity: QUEUE_CAPACITY as u16,
            last_panic: None,
            watchdog_reset: false,
            control_digest: None,
            remembered: link::messages::Remembered::Nothing,
        }))
    }

    fn statistics(&self) -> Statistics {
        let timing = Timing { min: 900, mean: 1000, max: 1100 };
        let mut histogram = [0; HISTOGRAM_BINS];
        histogram[3] = self.tick;
        Statistics {
            ticks: self.tick,
            computation: timing,
            lateness: Timing { min: 10, mean: 12, max: 15 },
            histogram,
            bin_width: 262,
            period: 8400,
            idle_permille: 800,
            overruns: if let Misbehaviour::Overruns(count) = self.misbehaviour { count } else { 0 },
            starved: 0,
            waited: 0,
            queue_low: 0,
            lost_schedules: self.lost_schedules,
            bad_frames: 0,
            lost_bytes: 0,
            lost_samples: 0,
            lost_log_bytes: 0,
            static_ram: 8000,
            stack_used: 900,
        }
    }

    fn say<M: serde::Serialize>(&mut self, message: &M) -> Result<(), Gone> {
        match self.misbehaviour {
            Misbehaviour::Mute => Ok(()),
            Misbehaviour::OnlyGarbage => self.stream.write_all(&[0xa5, 0x5a, 0x11, 0x00, 0x22]).map_err(|_| Gone),
            _ => self.stream.write_all(&encode(message).map_err(|_| Gone)?).map_err(|_| Gone),
        }
    }
}
