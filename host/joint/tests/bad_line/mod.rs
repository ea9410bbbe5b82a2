//! A board behind a line that disturbs both directions by a seed and then stops. `disturbance` changes the bytes,
//! `proxy` connects host and board, `trial` runs a board behind the proxy and checks the outcome.

mod disturbance;
mod proxy;
pub mod trial;
