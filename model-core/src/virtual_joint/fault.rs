//! Description of the faults between a joint and its controller: encoders that freeze, slip or scatter, lost readings,
//! and a motor with a torque bias or a limit.

use core::fmt::Debug;
use core::marker::PhantomData;

use crate::numbers::Real;

/// Units of the fault descriptions, and further faults that only some users can apply.
pub trait FaultUnits: Copy + Debug + PartialEq {
    /// Time at which a fault begins or ends.
    type Time: Copy + Debug + PartialEq;
    /// Seed of a fault's random numbers.
    type Seed: Copy + Debug + PartialEq;
    /// Offset of an encoder.
    type Offset: Copy + Debug + PartialEq;
    /// Standard deviation of an encoder.
    type Deviation: Copy + Debug + PartialEq;
    /// Part of a whole.
    type Share: Copy + Debug + PartialEq;
    /// Amplitudes of angles, ratios, torques.
    type Real: Copy + Debug + PartialEq;
    /// Faults in addition to the kinds that every user can apply.
    type Other: Copy + Debug + PartialEq;
}

/// Units of a board: control periods, 2^-32 turns, shares of 2^32, torques in N m. A board has no further faults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedPoint<T>(PhantomData<T>);

impl<T: Real> FaultUnits for FixedPoint<T> {
    type Time = u32;
    type Seed = u64;
    type Offset = i32;
    type Deviation = u32;
    type Share = u32;
    type Real = T;
    type Other = NoOtherFault;
}

/// Empty type: no further faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NoOtherFault {}

/// Fault with its duration.
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
pub struct Fault<U: FaultUnits> {
    /// First time at which the fault acts.
    pub start: U::Time,
    /// Time from which the fault no longer acts.
    pub end: U::Time,
    /// Seed of the fault's random numbers.
    pub seed: U::Seed,
    /// Kind of fault.
    pub kind: FaultKind<U>,
}

/// Shaft of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EncoderShaft {
    /// Motor shaft.
    Motor,
    /// Link shaft.
    Link,
}

/// Kind of fault.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FaultKind<U: FaultUnits> {
    /// Counts stand still.
    Frozen(EncoderShaft),
    /// Counts are offset.
    Offset(EncoderShaft, U::Offset),
    /// Counts scatter with a standard deviation.
    Noise(EncoderShaft, U::Deviation),
    /// A share of the motion is not counted; the missing counts remain missing afterwards.
    MissingCounts(EncoderShaft, U::Share),
    /// Error once per turn: the sine of the read angle times an amplitude.
    Eccentric(EncoderShaft, U::Real),
    /// A share of the readings is lost; the motor's last reading is repeated instead.
    LostReadings(EncoderShaft, U::Share),
    /// Torque in excess of the command: a ratio of the command, and a torque [N m].
    TorqueBias(U::Real, U::Real),
    /// Torque limit of the motor in both directions [N m].
    Saturation(U::Real),
    /// Further fault that only this user can apply.
    Other(U::Other),
}
