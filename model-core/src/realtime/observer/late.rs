//! Readings of the output encoder that come late, by their own time: what the link was at then is compared with them, and
//! what they teach of then is carried on to now. How old a reading may be is said here; where it came from is not known.
//!
//! A filter that took the surprise of then for one of now would answer its own answers, and swing up as soon as readings
//! are about as old as it is fast.

use super::load_side::LoadSide;
use crate::real::Real;
use crate::tables::observer::LoadTable;

/// Periods up to which the past is kept: an older reading counts as lost.
pub(super) const KEPT: u32 = 16;
const _: () = assert!(KEPT.is_power_of_two());

/// Torques that the meshes passed on in the last periods.
#[derive(Debug, Clone, Copy)]
pub(super) struct Past<T: Real> {
    /// In a ring [N m].
    torques: [T; KEPT as usize],
    newest: u32,
}

impl<T: Real> Past<T> {
    pub fn new() -> Self {
        Self { torques: [T::ZERO; KEPT as usize], newest: 0 }
    }

    /// One more period, under a torque.
    pub fn push(&mut self, torque: T) {
        self.newest = self.newest.wrapping_add(1) % KEPT;
        if let Some(place) = self.torques.get_mut(self.newest as usize) {
            *place = torque;
        }
    }

    /// Corrects the load side by a reading that is so many periods old.
    #[cold]
    pub fn correct(&self, load: &mut LoadSide<T>, table: &LoadTable<T>, periods: T) {
        let [period, _] = table.angle;
        // From the middle of each period back to the reading.
        let mut since = periods - T::HALF;
        let mut bent = T::ZERO;
        for ago in 0..KEPT {
            if since < T::ZERO {
                break;
            }
            let torque = self.torques.get((self.newest.wrapping_sub(ago) % KEPT) as usize).copied();
            bent += since * (torque.unwrap_or(T::ZERO) - load.torque);
            since -= T::ONE;
        }
        let surprise = periods * period * load.speed - table.speed * period * bent - load.ahead;
        let [angle, speed, torque] = table.gain;
        let slowed = periods * table.speed * torque;
        let gain = [angle + periods * period * (speed - T::HALF * slowed), speed - slowed, torque];
        load.correct(&gain, surprise);
    }
}
