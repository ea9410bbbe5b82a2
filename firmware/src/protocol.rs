//! The messages of a role: commands in, samples out. Roles differ on the line in this only, so that queues, conversation and
//! tick are written once. The work of a role's tick is `work::Work`.

use heapless::Vec;
use link::messages::{FromBoard, Role, Schedule, ToBoard};

use crate::learnt::Learnt;

/// The messages of a role.
pub trait Protocol {
    /// Which role.
    const ROLE: Role;
    /// A command, which waits for its tick.
    type Command: Timed + Clone;
    /// Commands as they come over the line.
    type Timetable: Timetable<Command = Self::Command>;
    /// A sample, which the tick hands to idle to be sent.
    type Sample;
    /// Samples on their way to the line.
    type Batch: Batch<Sample = Self::Sample>;
    /// The memory of what it learns.
    type Learnt: Learnt;

    /// Commands in a message, if it is one for this role.
    fn timetable(message: ToBoard) -> Option<Self::Timetable>;
}

/// A command for a tick.
pub trait Timed {
    /// First tick that it is for.
    fn tick(&self) -> u32;
    /// Whether it may be executed: every number in it is finite.
    fn is_sound(&self) -> bool;
}

/// Commands in rising order, numbered, up to a horizon.
pub trait Timetable {
    /// What they are.
    type Command;
    /// Rises by one from schedule to schedule.
    fn sequence(&self) -> u16;
    /// Everything before this tick is known with it.
    fn horizon(&self) -> u32;
    /// The commands.
    fn commands(&self) -> &[Self::Command];
}

impl<C, const MOST: usize> Timetable for Schedule<C, MOST> {
    type Command = C;

    fn sequence(&self) -> u16 {
        self.sequence
    }

    fn horizon(&self) -> u32 {
        self.horizon
    }

    fn commands(&self) -> &[C] {
        &self.commands
    }
}

/// Collects samples into messages.
pub trait Batch: Default {
    /// What it collects.
    type Sample;
    /// Takes a sample unless it is full.
    fn add(&mut self, sample: &Self::Sample);
    /// Whether it is complete.
    fn is_full(&self) -> bool;
    /// Whether there is nothing to send.
    fn is_empty(&self) -> bool;
    /// The samples so far as a message; empty afterwards.
    fn take(&mut self) -> FromBoard;
}

/// The wire's form of batches of up to `MOST` samples, which differs from role to role.
pub trait WireForm<const MOST: usize> {
    /// A sample as the tick leaves it.
    type Raw;
    /// The same as it goes over the line.
    type Wire;

    /// From the one to the other.
    fn wire(raw: &Self::Raw) -> Self::Wire;
    /// The message that carries them.
    fn message(sequence: u16, samples: Vec<Self::Wire, MOST>) -> FromBoard;
}
