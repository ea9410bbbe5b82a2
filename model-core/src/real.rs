//! The scalar that the core is written over: `f32` on the board, `f64` where a test wants the same source without
//! rounding. Only operations whose bits agree on host and target are here; nothing fused, nothing from the platform.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number with bit-exact arithmetic everywhere.
pub trait Real:
    nalgebra::Scalar
    + Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + nalgebra::ClosedAddAssign
    + nalgebra::ClosedMulAssign
    + num_traits_zero_one::Zero
    + num_traits_zero_one::One
{
}
