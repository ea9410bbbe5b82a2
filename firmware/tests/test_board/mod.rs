//! Firmware without a board: tick, idle and serial interrupt are called in turn; a wire of two queues and a settable
//! timer replace the hardware. Time passes only at a test's command.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;
use std::sync::{Arc, Mutex, MutexGuard};

use embedded_hal::digital::{ErrorType, OutputPin};
use firmware::conversation::{Conversation, LogEnd};
use firmware::identity::{StartUp, hello};
use firmware::kept_memory::{KeptMemory, RECORD_BYTES, Record, Slot, Slots};
use firmware::plant::Plant;
use firmware::protocol::Protocol;
use firmware::queues::{Progress, Queues};
use firmware::serial::{Heard, Line, Serial, Uart};
use firmware::tables::{PLANETS, TABLES};
use firmware::tick_handler::TickHandler;
use firmware::timing_monitor::TickTimer;
use firmware::timing_report::Resources;
use firmware::work::Work;
use heapless::spsc::Queue;
use link::framing::{Receiver, encode};
use link::messages::{Clock, ClockSource, Command, FromBoard, MemoryState, RunMode, RunSettings, Schedule, ToBoard};
use model_core::gears::Tables;
use model_core::observer::Memory;

/// Timer counts between two ticks.
pub const PERIOD: u32 = 8400;

/// Timeout that never expires, for tests in which the host is silent for a long time.
pub const NO_TIMEOUT: u32 = u32::MAX;

/// Both directions of the line.
#[derive(Default)]
pub struct Wire {
    to_board: VecDeque<u8>,
    from_board: VecDeque<u8>,
    /// The host does not read.
    pub blocked: bool,
}

struct WireEnd(Rc<RefCell<Wire>>);

impl Uart for WireEnd {
    fn read(&mut self) -> Option<u8> {
        self.0.borrow_mut().to_board.pop_front()
    }
    fn overran(&mut self) -> bool {
        false
    }
    fn can_write(&self) -> bool {
        !self.0.borrow().blocked
    }
    fn write(&mut self, byte: u8) {
        self.0.borrow_mut().from_board.push_back(byte);
    }
    fn interrupt_on_write(&mut self, _: bool) {}
    fn interrupt_again(&mut self) {}
}

/// Enable output with the number of times that it was switched on.
struct Enable(Rc<Cell<bool>>, Rc<Cell<u32>>);

impl ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        self.1.set(self.1.get() + 1);
        Ok(())
    }
}

/// Timer that advances by a fixed amount per read.
pub struct Timer {
    now: Cell<u32>,
    by: u32,
}

impl Timer {
    pub fn new(start: u32, by: u32) -> Self {
        Self { now: Cell::new(start), by }
    }
}

impl TickTimer for Timer {
    fn since_expiry(&self) -> u32 {
        self.now.replace(self.now.get() + self.by)
    }
}

/// Flash that accepts writes or does not; clones share their content. Power can be cut at any operation: an erase, or
/// the write of a word.
#[derive(Clone)]
pub struct Flash(Arc<Mutex<Cells>>);

pub struct Cells {
    pub slots: [Option<Record>; 2],
    pub works: bool,
    /// The supply is too low to write.
    pub is_starved: bool,
    /// Number of erases.
    pub erased: u32,
    /// Remaining operations until power is cut.
    pub until_cut: Option<u32>,
    /// A word interrupted by a power cut is unreadable; otherwise half of it is written.
    pub has_check_bits: bool,
}

impl Flash {
    /// Bytes that flash takes at a time.
    const WORD: usize = 8;

    pub fn with(slots: [Option<Record>; 2]) -> Self {
        let cells = Cells { slots, works: true, is_starved: false, erased: 0, until_cut: None, has_check_bits: true };
        Self(Arc::new(Mutex::new(cells)))
    }

    pub fn empty() -> Self {
        Self::with([Some([0xff; RECORD_BYTES]); 2])
    }

    /// Flash with a stored memory.
    pub fn holding(memory: &Memory) -> Self {
        let flash = Self::empty();
        KeptMemory::open(flash.clone()).store(memory);
        flash.cells().erased = 0;
        flash
    }

    pub fn cells(&self) -> MutexGuard<'_, Cells> {
        self.0.lock().expect("no test panics in between")
    }

    /// Memory that a board would find.
    pub fn kept(&self) -> Option<Memory> {
        KeptMemory::open(self.clone()).load()
    }
}

impl Cells {
    /// Returns `Some(true)` if an operation is complete, `Some(false)` if it is cut midway, `None` if it does not
    /// begin.
    fn begin(&mut self) -> Option<bool> {
        let Some(left) = &mut self.until_cut else { return Some(true) };
        let now = *left;
        *left = left.saturating_sub(1);
        match now {
            0 => None,
            left => Some(left > 1),
        }
    }
}

impl Slots for Flash {
    fn read(&mut self, slot: Slot) -> Option<Record> {
        self.cells().slots[slot.index()]
    }

    fn erase(&mut self, slot: Slot) {
        let mut cells = self.cells();
        cells.erased += 1;
        let (whole, place) = (cells.begin(), slot.index());
        let empty = [0xff; RECORD_BYTES];
        match whole.filter(|_| cells.works) {
            Some(true) => cells.slots[place] = Some(empty),
            Some(false) => {
                let half =
                    cells.slots[place].map(|old| std::array::from_fn(|at| if at % 3 == 0 { old[at] } else { 0xff }));
                cells.slots[place] = half.filter(|_| !cells.has_check_bits);
            }
            None => {}
        }
    }

    fn write(&mut self, slot: Slot, record: &Record) {
        let mut cells = self.cells();
        for (at, bytes) in (0..).step_by(Self::WORD).zip(record.chunks(Self::WORD)) {
            let whole = cells.begin().filter(|_| cells.works);
            let has_check_bits = cells.has_check_bits;
            let place = &mut cells.slots[slot.index()];
            let Some(cell) = place else { continue };
            match whole {
                Some(true) => cell[at..at + bytes.len()].copy_from_slice(bytes),
                Some(false) if has_check_bits => *place = None,
                Some(false) => cell[at..at + 3].copy_from_slice(&bytes[..3]),
                None => {}
            }
        }
    }

    fn has_supply(&mut self) -> bool {
        !self.cells().is_starved
    }
}

/// A board without hardware.
pub struct TestBoard<W: Work = Plant<'static, PLANETS>>
where
    W::Protocol: Protocol<Command: 'static, Sample: 'static> + 'static,
{
    control: TickHandler<'static, Enable, W>,
    conversation: Conversation<'static, W::Protocol>,
    serial: Serial<'static, WireEnd>,
    receiver: Receiver,
    pub wire: Rc<RefCell<Wire>>,
    pub enable: Rc<Cell<bool>>,
    /// Number of times that the output was switched on.
    pub switched_on: Rc<Cell<u32>>,
    pub flash: Flash,
    pub kept: KeptMemory<Flash>,
    /// Counters shared by tick and idle.
    pub progress: &'static Progress,
    /// Counts of the line's interrupt.
    pub heard: &'static Heard,
    /// First timer value in a tick, and increment per read.
    pub timing: (u32, u32),
}

impl TestBoard {
    pub fn new() -> Self {
        Self::with_tables(&TABLES)
    }

    pub fn with_tables(tables: &'static Tables<f32, PLANETS>) -> Self {
        Self::with(Plant::new(tables))
    }

    pub fn schedule(&self, sequence: u16, horizon: u32, commands: &[(u32, f32, f32)]) {
        let command = |&(tick, drive_torque, load_torque)| Command { tick, drive_torque, load_torque };
        let commands = commands.iter().map(command).collect();
        self.send(&ToBoard::Schedule(Schedule { sequence, horizon, commands }));
    }
}

impl<W: Work> TestBoard<W>
where
    W::Protocol: Protocol<Command: 'static, Sample: 'static> + 'static,
{
    /// Board with a role's work.
    pub fn with(work: W) -> Self {
        Self::with_flash(work, Flash::empty())
    }

    /// Board with a role's work and this flash.
    pub fn with_flash(work: W, flash: Flash) -> Self {
        let wire = Rc::new(RefCell::new(Wire::default()));
        let (enable, switched_on) = (Rc::new(Cell::new(true)), Rc::new(Cell::new(0)));
        let (tick_end, idle_end) = Box::leak(Box::new(Queues::new())).split();
        let (serial, line) = Box::leak(Box::new(Line::new())).split(WireEnd(wire.clone()), || {});
        let (_, bytes) = Box::leak(Box::new(Queue::<u8, 16>::new())).split();
        let mut kept = KeptMemory::open(flash.clone());
        let start_up = StartUp {
            board: "bench",
            timer_rate: 168_000_000,
            clock: Clock::of(ClockSource::NotModelled),
            last_panic: None,
            watchdog_reset: false,
            memory: if kept.is_damaged() { MemoryState::Damaged } else { MemoryState::Nothing },
        };
        let (progress, heard) = (idle_end.progress, line.heard());
        Self {
            control: TickHandler::new(work, Enable(enable.clone(), switched_on.clone()), PERIOD, tick_end, heard),
            conversation: Conversation::new(
                hello::<W::Protocol>(start_up, None),
                PERIOD,
                idle_end,
                line,
                LogEnd { bytes, lost: || 0 },
            ),
            serial,
            receiver: Receiver::new(),
            wire,
            enable,
            switched_on,
            kept,
            flash,
            progress,
            heard,
            timing: (20, 100),
        }
    }

    /// Puts bytes on the line to the board.
    pub fn send_bytes(&self, bytes: &[u8]) {
        self.wire.borrow_mut().to_board.extend(bytes);
    }

    pub fn send(&self, message: &ToBoard) {
        self.send_bytes(&encode(message).unwrap());
    }

    /// Runs idle and serial line until neither has work.
    pub fn settle(&mut self) {
        let mut nothing_to_do = 0;
        while nothing_to_do < 200 {
            self.serial.service();
            let busy = self.conversation.poll(&mut |_| Resources::default());
            self.conversation.serve_flash(&mut self.kept, |write| {
                assert!(!self.enable.get(), "flash is written with the output on");
                write()
            });
            nothing_to_do = if busy { 0 } else { nothing_to_do + 1 };
        }
    }

    /// Runs the serial interrupt until the UART is empty, without idle.
    pub fn hear(&mut self) {
        while !self.wire.borrow().to_board.is_empty() {
            self.serial.service();
        }
    }

    pub fn tick(&mut self) {
        self.control.tick(&Timer::new(self.timing.0, self.timing.1));
    }

    /// Runs ticks, with idle in between.
    pub fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.settle();
            self.tick();
        }
        self.settle();
    }

    /// Returns the board's messages since the last call.
    pub fn said(&mut self) -> Vec<FromBoard> {
        let bytes: Vec<u8> = self.wire.borrow_mut().from_board.drain(..).collect();
        bytes.into_iter().filter_map(|byte| self.receiver.push(byte)).collect()
    }

    /// Starts a run from rest and takes the answering hello.
    pub fn start(&mut self, mode: RunMode, decimation: u16, command_timeout: u32) {
        self.send(&ToBoard::Reset(RunSettings { mode, decimation, command_timeout, from_memory: false }));
        self.run(2);
        assert!(matches!(self.said()[..], [FromBoard::Hello(_)]));
    }
}
