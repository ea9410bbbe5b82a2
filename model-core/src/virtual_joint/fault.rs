//! Description of the faults between a joint and its controller: encoders that freeze, slip or scatter, readings that are
//! lost, a motor with a torque bias or a limit.

use core::fmt::Debug;
use core::marker::PhantomData;

use crate::numbers::Real;

/// Units that faults are described in, and further faults that not every user can apply.
pub trait Units: Copy + Debug + PartialEq {
    /// When a fault begins and ends.
    type Time: Copy + Debug + PartialEq;
    /// Seed of a fault's random numbers.
    type Seed: Copy + Debug + PartialEq;
    /// How far an encoder is off.
    type Offset: Copy + Debug + PartialEq;
    /// Standard deviation of an encoder.
    type Deviation: Copy + Debug + PartialEq;
    /// A part of a whole.
    type Share: Copy + Debug + PartialEq;
    /// Amplitudes of angles, ratios, torques.
    type Real: Copy + Debug + PartialEq;
    /// Further faults, besides the kinds that every user can apply.
    type Other: Copy + Debug + PartialEq;
}

/// What a board counts in: control periods, 2^-32 turns, shares of 2^32, torques in N m. It can apply no other faults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedPoint<T>(PhantomData<T>);

impl<T: Real> Units for FixedPoint<T> {
    type Time = u32;
    type Seed = u64;
    type Offset = i32;
    type Deviation = u32;
    type Share = u32;
    type Real = T;
    type Other = NoOther;
}

/// There is no other fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NoOther {}

/// One fault.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "U::Time: serde::Serialize, U::Seed: serde::Serialize, FaultKind<U>: serde::Serialize",
        deserialize = "U::Time: serde::Deserialize<'de>, U::Seed: serde::Deserialize<'de>, \
                       FaultKind<U>: serde::Deserialize<'de>"
    ))
)]
pub struct Fault<U: Units> {
    /// It acts from here on.
    pub start: U::Time,
    /// It acts up to here.
    pub end: U::Time,
    /// Seed of its random numbers.
    pub seed: U::Seed,
    /// What goes wrong.
    pub kind: FaultKind<U>,
}

/// Which encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shaft {
    /// The motor's.
    Motor,
    /// The link's.
    Link,
}

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FaultKind<U: Units> {
    /// Counts stand still.
    Frozen(Shaft),
    /// Counts are offset.
    Offset(Shaft, U::Offset),
    /// Counts scatter by a standard deviation.
    Noise(Shaft, U::Deviation),
    /// A share of the motion is not counted, and stays uncounted afterwards.
    MissingCounts(Shaft, U::Share),
    /// An error that comes once a turn: the sine of the angle that is read, times an amplitude.
    Eccentric(Shaft, U::Real),
    /// A share of the readings is lost; the motor's last one is repeated in their place.
    LostReadings(Shaft, U::Share),
    /// The motor gives so much beyond the command: a ratio of it, and a torque [N m].
    TorqueBias(U::Real, U::Real),
    /// The motor gives no more than this, to either side [N m].
    Saturation(U::Real),
    /// A fault that only this user can apply.
    Other(U::Other),
}
