//! Queues and counters between the tick and idle: single-producer queues, and atomic counters that both sides may read
//! at any time.

use link::messages::{MemoryOutcome, MemoryState, RunMode, RunSettings, Trip};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use crate::protocol::Protocol;
use crate::shared::{AtomicBool, AtomicU32, Consumer, Producer, Queue};
use crate::sized_queue::{SizedConsumer, SizedProducer};
use crate::timing_monitor::Monitor;

/// Places for commands; one stays empty to tell a full queue from an empty one.
const COMMANDS: usize = 128;
/// Places for samples.
const SAMPLES: usize = 16;
/// Places for orders and for events: at most one order is pending.
const NOTES: usize = 4;

/// Places for memories (estimated parameters): one is usable.
const LEARNT: usize = 2;

/// Greatest number of commands that can wait for their tick.
pub const COMMAND_CAPACITY: u16 = COMMANDS as u16 - 1;

/// Settings before the first reset.
pub const BEFORE_ANY_RUN: RunSettings =
    RunSettings { mode: RunMode::Lockstep, decimation: 1, command_timeout: 1, from_memory: false };

/// Order from idle, handled at the start of the next tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Reset to rest at tick 0; answered by [`Event::ResetDone`] or [`Event::Refused`].
    Reset {
        /// Settings of the run.
        settings: RunSettings,
        /// Stops received before the reset; a later stop overtakes the reset.
        stops: u32,
    },
    /// Switch enable off and send no further torque; answered by [`Event::Stopped`].
    Stop,
    /// Enter the safe state for a reason found by idle; answered by [`Event::Stopped`].
    Trip(Trip),
    /// Copy the estimated parameters; answered by [`Event::MemoryReady`].
    SaveMemory,
    /// Check the queued memory and make it the memory at hand; answered by [`Event::MemoryChecked`].
    LoadMemory,
    /// Discard the memory at hand; answered by [`Event::MemoryDiscarded`].
    DiscardMemory,
    /// Inject a fault between joint and controller; answered by [`Event::FaultTaken`].
    Fault(Fault<FixedPoint<f32>>),
    /// Copy the timing monitor; answered by [`Event::Timing`].
    Report {
        /// Clear the monitor after the copy.
        reset: bool,
    },
}

/// Event from the tick to idle.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
pub enum Event {
    /// The role is at rest and the command queue is empty.
    ResetDone,
    /// The run has ended.
    Stopped,
    /// The reset was refused for this reason.
    Refused(Trip),
    /// The tick has tripped the safe state: the only event that answers no order.
    Tripped(Trip),
    /// A copy of the estimated parameters is queued, or the reason for its absence.
    MemoryReady(Result<(), MemoryOutcome>),
    /// Validity of a memory that was loaded.
    MemoryChecked(MemoryState),
    /// The memory at hand is discarded.
    MemoryDiscarded,
    /// Result of [`Order::Fault`].
    FaultTaken {
        /// The fault was accepted.
        taken: bool,
    },
    /// Copy of the timing monitor.
    Timing(Monitor),
}

/// Counters visible to both sides.
#[derive(Debug, Default)]
pub struct Progress {
    /// Tick up to which all commands are known. Written by idle once the commands are queued; set to 0 by the tick at a
    /// reset, while idle waits.
    pub horizon: AtomicU32,
    /// Steps done since the reset; written by the tick.
    pub steps: AtomicU32,
    /// Ticks since power-up, with or without a step; written by the tick.
    pub ticks: AtomicU32,
    /// A run goes on; written by the tick.
    pub running: AtomicBool,
    /// The board is in the safe state; written by the tick.
    pub tripped: AtomicBool,
}

/// Queues and counters.
pub struct Queues<W: Protocol> {
    commands: Queue<W::Command, COMMANDS>,
    orders: Queue<Order, NOTES>,
    samples: Queue<W::Sample, SAMPLES>,
    events: Queue<Event, NOTES>,
    learnt: Queue<W::Learnt, LEARNT>,
    remembered: Queue<W::Learnt, LEARNT>,
    progress: Progress,
}

/// Tick's ends of the queues.
pub struct TickEnd<'a, W: Protocol> {
    /// Commands.
    pub commands: SizedConsumer<'a, W::Command, COMMANDS>,
    /// Orders from idle.
    pub orders: SizedConsumer<'a, Order, NOTES>,
    /// Samples to send.
    pub samples: SizedProducer<'a, W::Sample, SAMPLES>,
    /// Events for idle.
    pub events: SizedProducer<'a, Event, NOTES>,
    /// Memories to be saved.
    pub learnt: SizedProducer<'a, W::Learnt, LEARNT>,
    /// Memories to be checked.
    pub remembered: SizedConsumer<'a, W::Learnt, LEARNT>,
    /// Shared counters.
    pub progress: &'a Progress,
}

/// Idle's end of the queue of events.
pub type Events<'a> = SizedConsumer<'a, Event, NOTES>;

/// Idle's ends of the queues.
pub struct IdleEnd<'a, W: Protocol> {
    /// Commands.
    pub commands: Producer<'a, W::Command>,
    /// Orders from idle.
    pub orders: Producer<'a, Order>,
    /// Samples to send.
    pub samples: Consumer<'a, W::Sample>,
    /// Events for idle.
    pub events: Events<'a>,
    /// Memories to be saved.
    pub learnt: Consumer<'a, W::Learnt>,
    /// Memories to be checked.
    pub remembered: Producer<'a, W::Learnt>,
    /// Shared counters.
    pub progress: &'a Progress,
}

impl<W: Protocol> Queues<W> {
    /// Empty queues, counters at zero.
    pub const fn new() -> Self {
        Self {
            commands: Queue::new(),
            orders: Queue::new(),
            samples: Queue::new(),
            events: Queue::new(),
            learnt: Queue::new(),
            remembered: Queue::new(),
            progress: Progress {
                horizon: AtomicU32::new(0),
                steps: AtomicU32::new(0),
                ticks: AtomicU32::new(0),
                running: AtomicBool::new(false),
                tripped: AtomicBool::new(false),
            },
        }
    }

    /// Splits into the ends of the tick and of idle.
    pub fn split(&mut self) -> (TickEnd<'_, W>, IdleEnd<'_, W>) {
        let (commands_in, commands) = self.commands.split();
        let (orders_in, orders) = self.orders.split();
        let (samples, samples_out) = self.samples.split();
        let (events, events_out) = self.events.split();
        let (learnt, learnt_out) = self.learnt.split();
        let (remembered_in, remembered) = self.remembered.split();
        let progress = &self.progress;
        let (commands, orders, remembered) =
            (SizedConsumer::new(commands), SizedConsumer::new(orders), SizedConsumer::new(remembered));
        let (samples, events, learnt) =
            (SizedProducer::new(samples), SizedProducer::new(events), SizedProducer::new(learnt));
        (
            TickEnd { commands, orders, samples, events, learnt, remembered, progress },
            IdleEnd {
                commands: commands_in,
                orders: orders_in,
                samples: samples_out,
                events: SizedConsumer::new(events_out),
                learnt: learnt_out,
                remembered: remembered_in,
                progress,
            },
        )
    }
}

impl<W: Protocol> Default for Queues<W> {
    fn default() -> Self {
        Self::new()
    }
}
