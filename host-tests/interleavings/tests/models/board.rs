//! Board of the firmware's own tick, serial interrupt and idle, each to be run by a thread of a model. Its role is minimal: a step uses the
//! last commanded number, and a sample is the number of steps.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::SeqCst;
use std::sync::{Arc, Mutex};

use embedded_hal::digital::{ErrorType, OutputPin};
use heapless::{String, Vec as List};
use interleavings::conversation::{Conversation, LogEnd};
use interleavings::protocol::{Batch, Protocol, Timed};
use interleavings::queues::{Progress, Queues};
use interleavings::serial::{Heard, Line, LineEnd, Serial, Uart};
use interleavings::shared::Queue;
use interleavings::tick_handler::TickHandler;
use interleavings::timing_monitor::TickTimer;
use interleavings::timing_report::Resources;
use interleavings::work::Work;
use link::framing::{Receiver, encode};
use link::messages::{
    Clock, ClockSource, Command, FromBoard, Hello, Log, MemoryState, Role, RunMode, RunSettings, Schedule, ToBoard,
};
use loom::model::Builder;
use loom::sync::atomic::Ordering::Relaxed;

/// Settings of a run without a command timeout.
pub const SETTINGS: RunSettings =
    RunSettings { mode: RunMode::Lockstep, decimation: 1, command_timeout: u32::MAX, from_memory: false };

/// Explores all interleavings of a model with at most `switches` forced switches.
pub fn explore(switches: usize, model: impl Fn() + Send + Sync + 'static) {
    let mut builder = Builder::new();
    builder.preemption_bound = Some(switches);
    builder.max_branches = 100_000;
    builder.check(model);
}

/// Protocol of the role.
pub struct TestProtocol;

/// Command of the role.
#[derive(Clone)]
pub struct TestCommand(pub Command);

impl Timed for TestCommand {
    fn tick(&self) -> u32 {
        self.0.tick
    }
    fn is_sound(&self) -> bool {
        true
    }
}

impl Protocol for TestProtocol {
    const ROLE: Role = Role::Plant;
    type Command = TestCommand;
    type Timetable = Schedule<TestCommand>;
    type Sample = u32;
    type Batch = SampleBatch;
    type Learnt = Infallible;

    fn timetable(message: ToBoard) -> Option<Schedule<TestCommand>> {
        let ToBoard::Schedule(Schedule { sequence, horizon, commands }) = message else { return None };
        Some(Schedule { sequence, horizon, commands: commands.into_iter().map(TestCommand).collect() })
    }
}

/// Batch of samples, sent as a log of bytes.
#[derive(Default)]
pub struct SampleBatch(List<u8, 4>);

impl Batch for SampleBatch {
    type Sample = u32;

    fn add(&mut self, sample: &u32) {
        let _ = self.0.push(*sample as u8);
    }
    fn is_full(&self) -> bool {
        self.0.is_full()
    }
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
    fn take(&mut self) -> FromBoard {
        let bytes = std::mem::take(&mut self.0);
        FromBoard::Log(Log { sequence: 0, bytes: bytes.into_iter().collect() })
    }
}

/// Work of the role.
pub struct TestWork {
    number: f32,
    /// Number used by every step; a step that uses 13 becomes non-finite.
    pub used: Arc<Mutex<Vec<f32>>>,
}

impl Work for TestWork {
    type Protocol = TestProtocol;
    const FREE_RUNNING: bool = true;

    fn is_sound(&self) -> bool {
        true
    }
    fn reset(&mut self, _: bool) {
        self.number = 0.0;
    }
    fn take(&mut self, command: TestCommand) {
        self.number = command.0.drive_torque;
    }
    fn step(&mut self) {
        self.used.lock().unwrap().push(self.number);
    }
    fn is_finite(&self) -> bool {
        self.number != 13.0
    }
    fn sample(&self, steps: u32, _: u16) -> u32 {
        steps
    }
}

/// UART lines filled and read by a test.
#[derive(Default)]
struct UartLines {
    incoming: VecDeque<u8>,
    outgoing: Vec<u8>,
    /// Closed while threads run: messages then wait in their queue.
    open: bool,
}

struct UartEnd(Arc<Mutex<UartLines>>);

impl Uart for UartEnd {
    fn read(&mut self) -> Option<u8> {
        self.0.lock().unwrap().incoming.pop_front()
    }
    fn overran(&mut self) -> bool {
        false
    }
    fn can_write(&self) -> bool {
        self.0.lock().unwrap().open
    }
    fn write(&mut self, byte: u8) {
        self.0.lock().unwrap().outgoing.push(byte);
    }
    fn interrupt_on_write(&mut self, _: bool) {}
    fn interrupt_again(&mut self) {}
}

/// The enable output.
pub struct Enable(Arc<AtomicBool>);

impl ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.store(false, SeqCst);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.store(true, SeqCst);
        Ok(())
    }
}

struct NoTimer;

impl TickTimer for NoTimer {
    fn since_expiry(&self) -> u32 {
        0
    }
}

/// State of the tick.
pub struct Tick {
    handler: TickHandler<'static, Enable, TestWork>,
    pub heard: &'static Heard,
    pub enable: Arc<AtomicBool>,
    pub used: Arc<Mutex<Vec<f32>>>,
}

impl Tick {
    pub fn tick(&mut self) {
        self.handler.tick(&NoTimer);
    }

    pub fn is_on(&self) -> bool {
        self.enable.load(SeqCst)
    }
}

/// State of idle.
pub struct Idle(Conversation<'static, TestProtocol>);

impl Idle {
    pub fn poll(&mut self) {
        self.0.poll(&mut |_| Resources::default());
    }
}

/// State of the serial interrupt.
pub struct Interrupt {
    serial: Serial<'static, UartEnd>,
    uart_lines: Arc<Mutex<UartLines>>,
}

impl Interrupt {
    /// Feeds received bytes to the interrupt.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.uart_lines.lock().unwrap().incoming.extend(bytes);
        while !self.uart_lines.lock().unwrap().incoming.is_empty() {
            self.serial.service();
        }
    }

    pub fn receive_message(&mut self, message: &ToBoard) {
        self.receive(&frame(message));
    }

    /// Messages sent by the board so far.
    pub fn sent_messages(&mut self) -> Vec<FromBoard> {
        self.uart_lines.lock().unwrap().open = true;
        let mut length = usize::MAX;
        while std::mem::replace(&mut length, self.uart_lines.lock().unwrap().outgoing.len()) != length {
            self.serial.service();
        }
        self.uart_lines.lock().unwrap().open = false;
        let mut receiver = Receiver::new();
        let bytes = std::mem::take(&mut self.uart_lines.lock().unwrap().outgoing);
        bytes.into_iter().filter_map(|byte| receiver.push(byte)).collect()
    }
}

/// Message as a frame of the line.
pub fn frame(message: &ToBoard) -> Vec<u8> {
    encode(message).expect("a short message").to_vec()
}

/// The serial line alone: the interrupt's end and idle's.
pub fn line() -> (Interrupt, LineEnd<'static>) {
    let uart_lines = Arc::new(Mutex::new(UartLines::default()));
    let line: &'static mut Line = Box::leak(Box::default());
    let (serial, end) = line.split(UartEnd(uart_lines.clone()), || {});
    let _ = (end.heard().frames(), end.heard().stops(), end.heard().lost());
    (Interrupt { serial, uart_lines }, end)
}

/// Interrupt, tick and idle of a board, with every atomic accessed once before any thread begins. Shared state is leaked, since threads of
/// a model cannot borrow.
pub fn board() -> (Interrupt, Tick, Idle) {
    let queues: &'static mut Queues<TestProtocol> = Box::leak(Box::default());
    let (tick_end, idle_end) = queues.split();
    let (interrupt, line_end) = line();
    let log: &'static mut Queue<u8, 4> = Box::leak(Box::default());
    let (heard, progress) = (line_end.heard(), idle_end.progress);
    access_all(progress);
    let (enable, used) = (Arc::new(AtomicBool::new(true)), Arc::new(Mutex::new(Vec::new())));
    let work = TestWork { number: 0.0, used: used.clone() };
    let handler = TickHandler::new(work, Enable(enable.clone()), 1000, tick_end, heard);
    let conversation =
        Conversation::new(hello(), 1000, idle_end, line_end, LogEnd { bytes: log.split().1, lost: || 0 });
    (interrupt, Tick { handler, heard, enable, used }, Idle(conversation))
}

fn access_all(progress: &Progress) {
    let Progress { horizon, steps, ticks, running, tripped } = progress;
    let _ = (horizon.load(Relaxed), steps.load(Relaxed), ticks.load(Relaxed));
    let _ = (running.load(Relaxed), tripped.load(Relaxed));
}

/// Board in a run that has not made a step yet.
pub fn running() -> (Interrupt, Tick, Idle) {
    let (mut interrupt, mut tick, mut idle) = board();
    interrupt.receive_message(&ToBoard::Reset(SETTINGS));
    idle.poll();
    tick.tick();
    idle.poll();
    assert!(tick.is_on() && matches!(interrupt.sent_messages()[..], [FromBoard::Hello(_)]));
    (interrupt, tick, idle)
}

/// Commands one tick apart from tick `first` on, each with a number of its own.
pub fn schedule(sequence: u16, first: u32, numbers: &[f32]) -> ToBoard {
    let command = |(tick, &number)| Command { tick, drive_torque: number, load_torque: 0.0 };
    let commands = (first..).zip(numbers).map(command).collect();
    ToBoard::Schedule(Schedule { sequence, horizon: first + numbers.len() as u32, commands })
}

fn hello() -> Hello {
    Hello {
        protocol: link::PROTOCOL_VERSION,
        firmware_version: [0; 3],
        role: Role::Plant,
        board: String::new(),
        joint: String::new(),
        joint_digest: 0,
        digest_good: true,
        tick_rate: 1,
        timer_rate: 1,
        clock: Clock::of(ClockSource::NotModelled),
        planets: 3,
        queue_capacity: 127,
        last_panic: None,
        watchdog_reset: false,
        control_digest: None,
        memory: MemoryState::Nothing,
        forced: false,
    }
}
