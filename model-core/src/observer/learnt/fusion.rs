//! What both sides put together come to in one control period, before anything is decided. [`Learnt::fuse`] makes it.
//!
//! [`Learnt::fuse`]: super::Learnt::fuse

use crate::numbers::Real;

/// What one period comes to before anything is decided.
#[derive(Debug, Clone, Copy)]
pub struct Fused<T: Real> {
    /// By how much the transmission error shifts both flanks now [m].
    pub flank_shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    pub measured: T,
    /// The same with everything taken out that was learnt, wind-up left in [m].
    pub deflection: T,
    /// Rate of either [m/s].
    pub rate: T,
    /// How far the deflection goes on while what is measured lags behind, where that is more than noise [m].
    pub travel: T,
    /// Force that the motor loses, friction and bias included [N].
    pub lost: T,
    /// Direction of the motor's dry friction, from -1 to 1.
    pub direction: T,
    /// Mesh force from the motor side [N].
    pub force: T,
}

impl<T: Real> Fused<T> {
    /// Deflection of the teeth, wind-up left in: zero in the middle of the gap [m].
    pub fn of_teeth(&self) -> T {
        self.deflection - self.flank_shift
    }
}

/// A difference of counts, which teeth keep small, as a number: wide whole numbers take a chip without them long to turn.
pub fn small<T: Real>(difference: i64) -> T {
    let narrow = difference as i32;
    T::from_i32(if i64::from(narrow) == difference {
        narrow
    } else if difference < 0 {
        i32::MIN
    } else {
        i32::MAX
    })
}
