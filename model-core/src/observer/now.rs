//! What one control period comes to before anything is decided.

use crate::numbers::Real;

/// What one period comes to before anything is decided.
#[derive(Debug, Clone, Copy)]
pub(super) struct Now<T: Real> {
    /// Transmission error [m].
    pub shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    pub raw: T,
    /// The same with everything taken out that was learnt, wind-up left in [m].
    pub way: T,
    /// Rate of either [m/s].
    pub rate: T,
    /// Way that goes on while what is measured lags behind, where it is more than noise [m].
    pub soon: T,
    /// Force that the motor loses, friction and bias included [N].
    pub lost: T,
    /// Direction of the motor's dry friction.
    pub direction: T,
    /// Mesh force from the motor side [N].
    pub force: T,
}

/// A difference of counts, which teeth keep small, as a number: wide whole numbers take a chip without them long to turn.
pub(super) fn small<T: Real>(difference: i64) -> T {
    let narrow = difference as i32;
    T::from_i32(if i64::from(narrow) == difference {
        narrow
    } else if difference < 0 {
        i32::MIN
    } else {
        i32::MAX
    })
}
