//! Case R, a typical motion of a robot joint, with the board's step against the reference.
//!
//! Over its whole length the reference cannot be followed: light planets rattle after every crossing of the gap, and the motion is chaotic.
//! Torques changed by a billionth move the reference itself by 1 % of the lost motion (9.5e-3, RMS over 5.6 s; `chaos` prints it). The
//! motion is therefore evaluated in windows: at each jump of the torques, and where a part of the motion begins, the step is reset to the
//! reference's state. There the same change moves the reference by 3e-9, so that the error found is that of the step and not of the motion.

mod chaos;
mod range;
mod variants;
mod windows;
