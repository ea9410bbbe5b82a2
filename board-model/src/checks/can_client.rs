//! Clients of the drives that images are: CANSimple of ODrive 3.6, and the registers of moteus, in bare bytes, so that no
//! codec of the drive judges itself.

use drives::Frame;
use drives::frame::{Id, extended, standard};
use virtual_drive::maker::Name;

/// Kind of a client, for the drive with identifier 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Client {
    /// CANSimple: the mode is in the heartbeat.
    Simple,
    /// Registers: the mode is in the answer.
    Moteus,
}

/// Order of a client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Control by position.
    Enable,
    /// Position of this step.
    Move(u16),
    /// Reports of the drive.
    Read,
    /// Stop at once.
    Stop,
    /// No errors, no torque.
    Clear,
}

/// Mode of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// No torque, no error.
    Off,
    /// Control.
    On,
    /// Stopped for a reason: an error, or no command in time.
    Stopped,
}

impl Client {
    /// Client for a maker's drive.
    pub fn of(maker: Name) -> Self {
        if maker.is_flexible { Self::Moteus } else { Self::Simple }
    }

    /// Frames of an order.
    pub fn frames(self, order: Order) -> Vec<Frame> {
        match self {
            Self::Simple => simple(order),
            Self::Moteus => moteus(order),
        }
    }

    /// Frame for nobody here, as short as the bus allows: on CAN FD the end of the frame has the second bit rate.
    pub fn foreign(self, count: u16) -> Option<Frame> {
        let id = standard(0x700 | count & 0x3f);
        match self {
            Self::Simple => Frame::classic(id, &[]),
            Self::Moteus => Frame::flexible(id, &[], 0),
        }
    }

    /// Mode in a frame of the drive.
    pub fn mode(self, frame: &Frame) -> Option<Mode> {
        let data = frame.data();
        match self {
            Self::Simple if frame.id == simple_id(0x01) => {
                let has_error = data.get(..4)? != [0; 4];
                Some(match data.get(4)? {
                    _ if has_error => Mode::Stopped,
                    8 => Mode::On,
                    _ => Mode::Off,
                })
            }
            Self::Moteus if frame.raw_id() == 0x100 => match data.get(..3)? {
                [0x21, 0x00, 0] => Some(Mode::Off),
                [0x21, 0x00, 10] => Some(Mode::On),
                [0x21, 0x00, _] => Some(Mode::Stopped),
                _ => None,
            },
            _ => None,
        }
    }
}

/// Identifier of a command to node 1.
fn simple_id(command: u16) -> Id {
    standard(1 << 5 | command)
}

fn simple(order: Order) -> Vec<Frame> {
    let frame = |command: u16, data: &[u8]| Frame::classic(simple_id(command), data);
    let frames = match order {
        // State 8 is closed-loop control, 1 idle.
        Order::Enable => vec![frame(0x07, &[8, 0, 0, 0])],
        Order::Move(step) => {
            let turns = (0.002 * f32::from(step)).to_le_bytes();
            vec![frame(0x0c, &[turns[0], turns[1], turns[2], turns[3], 0, 0, 0, 0])]
        }
        Order::Read => [0x03, 0x09, 0x0a, 0x14, 0x17, 0x1d]
            .map(|command| Frame::remote(simple_id(command), 8))
            .into_iter()
            .collect(),
        Order::Stop => vec![frame(0x02, &[])],
        Order::Clear => vec![frame(0x18, &[]), frame(0x07, &[1, 0, 0, 0])],
    };
    frames.into_iter().flatten().collect()
}

fn moteus(order: Order) -> Vec<Frame> {
    // Int8 at register 0: the mode. Reads of the mode, and of position, speed and torque as floats.
    let mode = |mode: u8| vec![0x01, 0x00, mode];
    let reads = [0x11, 0x00, 0x1f, 0x01];
    let data = match order {
        Order::Enable => mode(10),
        Order::Move(step) => {
            let turns = (0.001 * f32::from(step)).to_le_bytes();
            [mode(10), vec![0x0d, 0x20], turns.to_vec(), reads.to_vec()].concat()
        }
        Order::Read => reads.to_vec(),
        Order::Stop | Order::Clear => mode(0),
    };
    // Padding is a no-operation. The highest bit of the source asks for an answer.
    Frame::flexible(extended(0x8001), &data, 0x50).into_iter().collect()
}
