//! A board behind a line that does to its bytes what a bad line does: by a seed, in both directions, and then no more.
//! `disturbance` changes the bytes, `proxy` stands between host and board, `trial` runs a board behind it and judges.

mod disturbance;
mod proxy;
pub mod trial;
