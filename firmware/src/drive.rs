//! Role `drive`: the board is a joint behind a finished drive on a CAN bus. The tick runs the joint, the drive and the
//! server of the maker's protocol; frames come from the interrupt and leave in the tick.
//!
//! The drive runs from power-up on and has the maker's own states: without a client it is disabled. It never touches
//! the enable output of the board, since its motor is simulated.

use drives::bus::CanServer;
use drives::drive::{Fault, VirtualPower};
use drives::{Drive, Frame};
use heapless::Deque;
use model_core::virtual_joint::VirtualJoint;

use crate::can::{CanSender, FRAMES, Inbox};

/// Frames that wait for the bus. CANopen has the longest burst: 4 process data, heartbeat, emergency and an answer for
/// each received frame.
const OUTBOX: usize = 32;
/// Frames that the peripherals hold at most, which bounds the sending of a tick.
const MAILBOXES: usize = 3;

/// Work of the tick.
pub struct DriveTick<'a, S, C, const N: usize> {
    joint: VirtualJoint<'a, f32, N>,
    drive: Drive,
    server: S,
    power: VirtualPower,
    bus: C,
    inbox: Inbox<'a>,
    outbox: Outbox,
}

/// Frames that wait for the bus, the oldest first.
#[derive(Default)]
struct Outbox {
    frames: Deque<Frame, OUTBOX>,
    lost: u32,
}

impl Outbox {
    /// Adds a frame. Without room the frame is lost: other nodes hold the bus, or nobody acknowledges.
    fn push(&mut self, frame: Frame) {
        if self.frames.push_back(frame).is_err() {
            self.lost = self.lost.wrapping_add(1);
        }
    }
}

impl<'a, S: CanServer, C: CanSender, const N: usize> DriveTick<'a, S, C, N> {
    /// Joint at rest behind a disabled drive.
    pub fn new(
        joint: VirtualJoint<'a, f32, N>,
        drive: Drive,
        server: S,
        power: VirtualPower,
        bus: C,
        inbox: Inbox<'a>,
    ) -> Self {
        Self { joint, drive, server, power, bus, inbox, outbox: Outbox::default() }
    }

    /// Runs one control period: frames that arrived, joint and drive, cyclic frames, sending.
    pub fn tick(&mut self) {
        let Self { joint, drive, server, power, bus, inbox, outbox } = self;
        for _ in 0..FRAMES {
            let Some(frame) = inbox.take() else { break };
            server.receive(&frame, drive, &mut |answer| outbox.push(answer));
        }
        virtual_drive::step(joint, drive, power);
        if !joint.model().is_finite() {
            // The joint begins anew at rest, and the drive has lost its encoders.
            joint.reset();
            drive.declare(Fault::MotorEncoder);
        }
        server.tick(drive, &mut |frame| outbox.push(frame));
        bus.recover();
        for _ in 0..MAILBOXES {
            let Some(frame) = outbox.frames.front() else { break };
            if !bus.send(frame) {
                break;
            }
            outbox.frames.pop_front();
        }
    }

    /// Drive.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Frames that were received but lost, and frames that could not be sent, since power-up; wrapping.
    pub fn losses(&self) -> (u32, u32) {
        (self.inbox.lost(), self.outbox.lost)
    }
}
