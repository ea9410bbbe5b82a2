//! Table of the wiring check, made by `wiring::design`: behaviour of a correctly wired joint, and limits of its motion.

use crate::numbers::Real;
use crate::observer::tables::{ClockTable, CountTable};

/// Table of the wiring check.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct WiringTable<T: Real> {
    /// Clock of the samples.
    pub clock: ClockTable<T>,
    /// Both encoders.
    pub counts: CountTable<T>,
    /// Motor turns per output turn.
    pub ratio: T,
    /// Output turns per motor turn.
    pub per_ratio: T,
    /// Control periods of a block, over which motion is compared with torque.
    pub block: u32,
    /// 1 over the periods of a block.
    pub per_block: T,
    /// Inertias of motor and link over the square of a block, for angles of motor and output [N m/rad].
    pub impulse: [T; 2],
    /// Largest difference between motor and output without a fault, as output angle: half of the lost motion, encoder
    /// errors, counts [rad].
    pub slack: T,
    /// Lost motion at the output [rad].
    pub lost_motion: T,
    /// Largest motor travel with a stationary output, as output angle: lost motion, wind-up, slack [rad].
    pub play: T,
    /// Tolerance of the measured ratio beside slack over travel [-].
    pub ratio_tolerance: T,
    /// Tolerance of the torque as a factor [-].
    pub torque_factor: T,
    /// Travel of motor and output from a standstill at which the other shaft would have moved if it had followed
    /// [counts].
    pub leads: [u32; 2],
    /// Travel of motor and output, from the start of a leg, at which the motor is braked [counts].
    pub leg: [u32; 2],
    /// Travel of motor and output, from the start of the check, at which the check ends [counts].
    pub limit: [u32; 2],
    /// Growth of the torque [N m/period].
    pub rise: T,
    /// Largest torque of the check [N m].
    pub torque: T,
    /// Torque limit of the motor [N m].
    pub torque_limit: T,
    /// Torque expected to set the joint in motion [N m].
    pub friction: T,
    /// Periods without torque before each leg.
    pub rest: u32,
    /// Periods of a window over which speed is measured.
    pub window: u32,
    /// Periods after which a leg at full torque ends although the joint has not travelled far enough, and longest
    /// braking.
    pub hold: u32,
    /// Periods after which the check ends.
    pub longest: u32,
}
