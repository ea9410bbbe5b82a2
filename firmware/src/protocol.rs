//! Messages of a role: commands in, samples out. Roles differ on the line only in these, so that queues, conversation
//! and tick exist once. The work of a tick is `work::Work`.

use heapless::Vec;
use link::messages::{FromBoard, Role, Schedule, ToBoard};

use crate::learnt::Learnt;

/// Messages of a role.
pub trait Protocol {
    /// Role.
    const ROLE: Role;
    /// Command that waits for its tick.
    type Command: Timed + Clone;
    /// Commands as received over the line.
    type Timetable: Timetable<Command = Self::Command>;
    /// Sample that the tick hands to idle for sending.
    type Sample;
    /// Batch of samples to send.
    type Batch: Batch<Sample = Self::Sample>;
    /// Memory of the estimated parameters.
    type Learnt: Learnt;

    /// Returns the commands in a message, if the message is for this role.
    fn timetable(message: ToBoard) -> Option<Self::Timetable>;
}

/// Command for a tick.
pub trait Timed {
    /// First tick of the command.
    fn tick(&self) -> u32;
    /// Returns `true` if the command may be executed: all its numbers are finite.
    fn is_sound(&self) -> bool;
}

/// Numbered list of commands in rising order, up to a horizon.
pub trait Timetable {
    /// Type of the commands.
    type Command;
    /// Sequence number; rises by one per schedule.
    fn sequence(&self) -> u16;
    /// Tick up to which all commands are known with this schedule.
    fn horizon(&self) -> u32;
    /// Commands, in rising order of ticks.
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
    /// Type of the samples.
    type Sample;
    /// Adds a sample unless the batch is full.
    fn add(&mut self, sample: &Self::Sample);
    /// Returns `true` if the batch is full.
    fn is_full(&self) -> bool;
    /// Returns `true` if the batch is empty.
    fn is_empty(&self) -> bool;
    /// Returns the collected samples as a message and empties the batch.
    fn take(&mut self) -> FromBoard;
}

/// Wire form of batches of up to `MOST` samples, which differs between roles.
pub trait WireForm<const MOST: usize> {
    /// Sample as the tick provides it.
    type Raw;
    /// Sample as sent over the line.
    type Wire;

    /// Converts a sample to its wire form.
    fn wire(raw: &Self::Raw) -> Self::Wire;
    /// Message with the samples.
    fn message(sequence: u16, samples: Vec<Self::Wire, MOST>) -> FromBoard;
}
