//! Everything between the tick and idle: single-producer queues and a few counters that either side may read at any time.

use link::messages::{MemoryOutcome, MemoryState, RunMode, RunSettings, Trip};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use crate::protocol::Protocol;
use crate::shared::{AtomicBool, AtomicU32, Consumer, Producer, Queue};
use crate::sized_queue::{SizedConsumer, SizedProducer};
use crate::timing_monitor::Monitor;

/// Places for commands; one is lost to telling full from empty.
const COMMANDS: usize = 128;
/// Places for samples.
const SAMPLES: usize = 16;
/// Places for orders and for events: at most one order is under way at a time.
const NOTES: usize = 4;

/// Places for what was learnt: one, and one that is lost.
const LEARNT: usize = 2;

/// Most commands that can wait for their tick.
pub const COMMAND_CAPACITY: u16 = COMMANDS as u16 - 1;

/// Settings before the first reset.
pub const BEFORE_ANY_RUN: RunSettings =
    RunSettings { mode: RunMode::Lockstep, decimation: 1, command_timeout: 1, from_memory: false };

/// From idle to the tick, handled at the start of the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Back to rest at tick 0; answered by [`Event::ResetDone`] or [`Event::Refused`].
    Reset {
        /// How the run goes.
        settings: RunSettings,
        /// Stops that came before it: one that has come since overtakes it.
        stops: u32,
    },
    /// Enable off, no further torque sent; answered by [`Event::Stopped`].
    Stop,
    /// Safe state for a reason that idle has found; answered by [`Event::Stopped`].
    Trip(Trip),
    /// Copy what has been learnt; answered by [`Event::MemoryReady`].
    SaveMemory,
    /// Check the memory in its queue and take it as the one at hand; answered by [`Event::MemoryChecked`].
    LoadMemory,
    /// Discard the memory at hand; answered by [`Event::MemoryDiscarded`].
    DiscardMemory,
    /// A fault between joint and controller; answered by [`Event::FaultTaken`].
    Fault(Fault<FixedPoint<f32>>),
    /// A copy of the timing monitor as [`Event::Timing`].
    Report {
        /// Then start it afresh.
        reset: bool,
    },
}

/// From the tick to idle.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no allocator to box with")]
pub enum Event {
    /// Everything is at rest, the command queue is empty.
    ResetDone,
    /// The run has ended.
    Stopped,
    /// There is no reset out of this trip.
    Refused(Trip),
    /// The tick itself has found a reason for the safe state: the only event that is no answer to an order.
    Tripped(Trip),
    /// A copy of what has been learnt is in its queue, or why there is none.
    MemoryReady(Result<(), MemoryOutcome>),
    /// Validity of a memory that was loaded.
    MemoryChecked(MemoryState),
    /// The memory at hand is discarded.
    MemoryDiscarded,
    /// Whether a fault between joint and controller was taken.
    FaultTaken {
        /// It was.
        taken: bool,
    },
    /// A copy of the timing monitor.
    Timing(Monitor),
}

/// Counters that both sides see.
#[derive(Debug, Default)]
pub struct Progress {
    /// Everything before this tick is known; written by idle after the commands are in the queue, and put back to 0 by the
    /// tick with a reset, while idle waits for that.
    pub horizon: AtomicU32,
    /// Steps done since the reset; written by the tick.
    pub steps: AtomicU32,
    /// Ticks since power-up, steps or not; written by the tick.
    pub ticks: AtomicU32,
    /// The run goes on; written by the tick.
    pub running: AtomicBool,
    /// The safe state has been entered; written by the tick.
    pub tripped: AtomicBool,
}

/// The queues themselves.
pub struct Queues<W: Protocol> {
    commands: Queue<W::Command, COMMANDS>,
    orders: Queue<Order, NOTES>,
    samples: Queue<W::Sample, SAMPLES>,
    events: Queue<Event, NOTES>,
    learnt: Queue<W::Learnt, LEARNT>,
    remembered: Queue<W::Learnt, LEARNT>,
    progress: Progress,
}

/// The tick's ends.
pub struct TickEnd<'a, W: Protocol> {
    /// What is to come.
    pub commands: SizedConsumer<'a, W::Command, COMMANDS>,
    /// What idle wants.
    pub orders: SizedConsumer<'a, Order, NOTES>,
    /// What is to be reported.
    pub samples: SizedProducer<'a, W::Sample, SAMPLES>,
    /// What has happened.
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

/// Idle's ends.
pub struct IdleEnd<'a, W: Protocol> {
    /// What is to come.
    pub commands: Producer<'a, W::Command>,
    /// What idle wants.
    pub orders: Producer<'a, Order>,
    /// What is to be reported.
    pub samples: Consumer<'a, W::Sample>,
    /// What has happened.
    pub events: Events<'a>,
    /// Memories to be saved.
    pub learnt: Consumer<'a, W::Learnt>,
    /// Memories to be checked.
    pub remembered: Producer<'a, W::Learnt>,
    /// Shared counters.
    pub progress: &'a Progress,
}

impl<W: Protocol> Queues<W> {
    /// Empty.
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

    /// Hands each side its ends.
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
