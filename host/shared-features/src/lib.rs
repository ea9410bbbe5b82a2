//! Features of other crates that the tests need.
//!
//! Cargo builds a crate once for each set of features. Without this package the command and its tests differ in the
//! features of a few small crates, and nearly everything above them is built twice. It has no code of its own; the
//! check `cargo test -p structure` compares the features of both builds.
