//! Case R, what a robot joint does, as a board steps it, against the reference.
//!
//! Over the whole of it nobody can follow the reference: light planets rattle after every crossing of the gap, and the
//! motion is chaotic. Torques changed by a billionth move the reference itself by 1 % of the lost motion (9.5e-3, RMS over
//! 5.6 s; `chaos` prints it). So the motion is judged in windows: wherever torques jump, and where a part of the motion
//! begins, the step is put back into the reference's state. There the same change moves the reference by 3e-9, so that
//! what is found is the step's own error, and not the motion's.

mod chaos;
mod range;
mod variants;
mod windows;
