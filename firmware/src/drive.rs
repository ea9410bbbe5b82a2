//! Role `drive`: the board is a joint behind a finished drive on a CAN bus. The tick runs the joint, the drive and the
//! server of the maker's protocol; frames come from the interrupt and leave in the tick.
//!
//! The drive runs from power-up on and has the maker's own states: without a client it is disabled. It never touches
//! the enable output of the board, since its motor is simulated.

use drives::{Drive, Frame};
use heapless::Deque;
use virtual_drive::VirtualDrive;
use virtual_drive::maker::Maker;

use crate::can::{CanSender, Inbox};

/// Frames that wait for the bus. CANopen has the longest burst: 4 process data, heartbeat, emergency and an answer for
/// each received frame.
const OUTBOX: usize = 32;
/// Frames that the peripherals hold at most, which bounds the sending of a tick.
const MAILBOXES: usize = 3;

/// Work of the tick.
pub struct DriveTick<'a, M: Maker, C, const N: usize> {
    drive: VirtualDrive<'a, M, N>,
    bus: C,
    inbox: Inbox<'a>,
    outbox: Outbox,
}

/// Frames that wait for the bus, the oldest first.
#[derive(Default)]
struct Outbox(Deque<Frame, OUTBOX>);

impl Outbox {
    /// Adds a frame. Without room the frame is lost: other nodes hold the bus, or nobody acknowledges.
    fn push(&mut self, frame: Frame) {
        let _ = self.0.push_back(frame);
    }
}

impl<'a, M: Maker, C: CanSender, const N: usize> DriveTick<'a, M, C, N> {
    /// Tick of a drive on a bus.
    pub fn new(drive: VirtualDrive<'a, M, N>, bus: C, inbox: Inbox<'a>) -> Self {
        Self { drive, bus, inbox, outbox: Outbox::default() }
    }

    /// Runs the oldest control period without a tick, if there is one, and returns whether another one waits: state of the bus, frames that arrived, joint and drive, cyclic frames, sending. The parts
    /// are not inlined: each needs much stack, but not at the same time.
    pub fn tick(&mut self) -> bool {
        if !self.inbox.begin_tick() {
            return false;
        }
        self.serve();
        self.drive.advance();
        self.send();
        self.inbox.behind() > 0
    }

    /// Tells the server about the bus, and hands it the frames that arrived.
    #[inline(never)]
    fn serve(&mut self) {
        let Self { drive, bus, inbox, outbox } = self;
        drive.note_bus_state(bus.is_off(), &mut |frame| outbox.push(frame));
        for _ in 0..inbox.count() {
            let Some(frame) = inbox.take() else { break };
            drive.receive(&frame, &mut |answer| outbox.push(answer));
        }
    }

    /// Makes the cyclic frames, and hands the oldest frames to the peripheral.
    #[inline(never)]
    fn send(&mut self) {
        let Self { drive, bus, outbox, .. } = self;
        drive.send_cyclic(&mut |frame| outbox.push(frame));
        for _ in 0..MAILBOXES {
            let Some(frame) = outbox.0.front() else { break };
            if !bus.send(frame) {
                break;
            }
            outbox.0.pop_front();
        }
    }

    /// Drive.
    pub fn drive(&self) -> &Drive {
        self.drive.drive()
    }
}
