//! MIT frame: an impedance command in 8 bytes, and the state of a drive in 5. Named after the drives of MIT's Cheetah
//! robots; several makers use it with ranges of their own.
//!
//! Fields stand one behind the other, the highest bit first:
//!
//! | command | bits | range | state | bits | range |
//! |---|---|---|---|---|---|
//! | position | 16 | -position to position [rad] | position | 16 | -position to position [rad] |
//! | velocity | 12 | -velocity to velocity [rad/s] | velocity | 12 | -velocity to velocity [rad/s] |
//! | stiffness | 12 | 0 to stiffness [N m/rad] | torque | 12 | -torque to torque [N m] |
//! | damping | 12 | 0 to damping [N m s/rad] | | | |
//! | torque | 12 | -torque to torque [N m] | | | |
//!
//! A field is rounded down, as in the makers' drivers: zero in the middle of a range becomes the value half a step
//! below.

use crate::drive::SetPoint;
use crate::scale::{from_range, to_range_down};
use crate::turns::Turns;

/// Ends of the fields' ranges; all positive. Velocity, torque and position are those of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// Largest position [rad].
    pub position: f32,
    /// Largest velocity [rad/s].
    pub velocity: f32,
    /// Largest torque [N m].
    pub torque: f32,
    /// Largest stiffness [N m/rad].
    pub stiffness: f32,
    /// Largest damping [N m s/rad].
    pub damping: f32,
}

impl Ranges {
    /// Ranges with the usual stiffness of 500 N m/rad and damping of 5 N m s/rad.
    pub const fn new(position: f32, velocity: f32, torque: f32) -> Self {
        Self { position, velocity, torque, stiffness: 500.0, damping: 5.0 }
    }

    fn position_field(&self) -> Field {
        Field { low: -self.position, high: self.position, bits: 16 }
    }

    fn velocity_field(&self) -> Field {
        Field { low: -self.velocity, high: self.velocity, bits: 12 }
    }

    fn torque_field(&self) -> Field {
        Field { low: -self.torque, high: self.torque, bits: 12 }
    }

    fn stiffness_field(&self) -> Field {
        Field { low: 0.0, high: self.stiffness, bits: 12 }
    }

    fn damping_field(&self) -> Field {
        Field { low: 0.0, high: self.damping, bits: 12 }
    }
}

/// Field of a frame.
#[derive(Debug, Clone, Copy)]
struct Field {
    low: f32,
    high: f32,
    bits: u32,
}

impl Field {
    /// Appends the field of a value behind the lowest bit of `word`.
    fn push(self, word: u64, value: f32) -> u64 {
        word << self.bits | u64::from(to_range_down(value, self.low, self.high, self.bits))
    }

    /// Takes the lowest field off `word`; returns its value.
    fn pop(self, word: &mut u64) -> f32 {
        let field = *word & ((1 << self.bits) - 1);
        *word >>= self.bits;
        from_range(field as u32, self.low, self.high, self.bits)
    }
}

/// Impedance command: torque = stiffness (position - angle) + damping (velocity - speed) + torque.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Command {
    /// Position [rad].
    pub position: f32,
    /// Velocity [rad/s].
    pub velocity: f32,
    /// Stiffness [N m/rad].
    pub stiffness: f32,
    /// Damping [N m s/rad].
    pub damping: f32,
    /// Feed-forward torque [N m].
    pub torque: f32,
}

impl Command {
    /// Data of the frame.
    ///
    /// ```
    /// use drives::damiao::mit::{Command, Ranges};
    /// let zero = Command::default().encode(&Ranges::new(12.5, 30.0, 10.0));
    /// assert_eq!(zero, [0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF]);
    /// ```
    pub fn encode(&self, ranges: &Ranges) -> [u8; 8] {
        let word = ranges.position_field().push(0, self.position);
        let word = ranges.velocity_field().push(word, self.velocity);
        let word = ranges.stiffness_field().push(word, self.stiffness);
        let word = ranges.damping_field().push(word, self.damping);
        ranges.torque_field().push(word, self.torque).to_be_bytes()
    }

    /// Command of a frame's data.
    pub fn decode(data: [u8; 8], ranges: &Ranges) -> Self {
        let mut word = u64::from_be_bytes(data);
        let torque = ranges.torque_field().pop(&mut word);
        let damping = ranges.damping_field().pop(&mut word);
        let stiffness = ranges.stiffness_field().pop(&mut word);
        let velocity = ranges.velocity_field().pop(&mut word);
        let position = ranges.position_field().pop(&mut word);
        Self { position, velocity, stiffness, damping, torque }
    }

    /// Set-point of a drive that executes the command.
    pub fn set_point(&self) -> SetPoint {
        SetPoint::Impedance {
            position: Turns::from_rad(self.position),
            velocity: self.velocity,
            stiffness: self.stiffness,
            damping: self.damping,
            torque: self.torque,
        }
    }
}

/// State that a drive reports.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct State {
    /// Position [rad].
    pub position: f32,
    /// Velocity [rad/s].
    pub velocity: f32,
    /// Torque [N m].
    pub torque: f32,
}

impl State {
    /// Bytes of the state.
    pub fn encode(&self, ranges: &Ranges) -> [u8; 5] {
        let word = ranges.position_field().push(0, self.position);
        let word = ranges.velocity_field().push(word, self.velocity);
        let [_, _, _, bytes @ ..] = ranges.torque_field().push(word, self.torque).to_be_bytes();
        bytes
    }

    /// State of its bytes.
    pub fn decode(bytes: [u8; 5], ranges: &Ranges) -> Self {
        let mut word = bytes.into_iter().fold(0_u64, |word, byte| word << 8 | u64::from(byte));
        let torque = ranges.torque_field().pop(&mut word);
        let velocity = ranges.velocity_field().pop(&mut word);
        let position = ranges.position_field().pop(&mut word);
        Self { position, velocity, torque }
    }
}
