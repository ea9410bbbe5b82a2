//! Whether the load swings faster than anything that people, weights and motions put on a link: a payload on a flexible arm. Its reaction
//! must not be fed forward as it is felt, for what is fed forward late drives the swing.
//!
//! Symbols: z load without friction, f and g its fast and slow mean, d = f - g, m the torque that measured ones are uncertain by. The load
//! changes sides when d < -m after d > m, or the other way round. Three changes, each within an eighth of a second of the one before, are a
//! swing.

use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// Notices a swing of the load.
#[derive(Debug, Clone)]
pub(super) struct LoadSwing<T: Real> {
    /// Fast and slow mean of the load [N m].
    means: [T; 2],
    /// 1 or -1: to which side of the slow mean the fast one last was far off.
    side: T,
    /// Time since that was another side, as far as it matters [s].
    since: T,
    /// Changes of the side, each soon after the one before [-].
    changes: T,
    /// Time for which the load still counts as one that swings [s].
    left: T,
}

impl<T: Real> LoadSwing<T> {
    /// Changes of the side that are a swing [-]: a step and what follows it are one or two.
    const SWING: T = T::THREE;

    /// Half the period of the slowest swing [s]: a payload's mode is at 8 Hz at least, motions and what people do below 4 Hz.
    const HALF_PERIOD: T = T::EIGHTH;

    /// Time without a swing after which there is none [s], and with which a link begins about which nothing is known.
    const KEPT: T = T::ONE;

    pub fn new() -> Self {
        Self { means: [T::ZERO; 2], side: T::ZERO, since: T::ZERO, changes: T::ZERO, left: Self::KEPT }
    }

    /// Whether the load swings, or might: nothing has shown yet that it does not.
    pub fn may_swing(&self) -> bool {
        self.left > T::ZERO
    }

    /// Whether the load swings for sure.
    pub fn swings(&self) -> bool {
        self.may_swing() && self.changes >= Self::SWING
    }

    /// Takes a period with a reading of the load, if there is one [N m].
    pub fn take(&mut self, tables: &CompensationTables<T>, reading: Option<T>) {
        let period = tables.clock.period;
        self.since = clamp(self.since + period, T::ZERO, T::ONE);
        let Some(reading) = reading.filter(|reading| reading.is_finite()) else { return };
        self.left = beyond(self.left, period);
        let [fast, slow] = &mut self.means;
        *fast += tables.switching.smoothing * (reading - *fast);
        *slow += tables.watch.smoothing * (*fast - *slow);
        let excess = beyond(*fast - *slow, tables.switching.measured);
        if excess == T::ZERO {
            return;
        }
        let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
        if side * self.side < T::ZERO {
            self.changes = if self.since < Self::HALF_PERIOD { self.changes + T::ONE } else { T::ZERO };
            self.since = T::ZERO;
            if self.changes >= Self::SWING {
                self.changes = Self::SWING;
                self.left = Self::KEPT;
            }
        }
        self.side = side;
    }
}
