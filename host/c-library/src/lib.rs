//! What programs in C and C++ take from here. `tables` writes a joint's tables as C source (`joint tables`); `library` builds
//! what is behind the header of `bindings/c`, `package` makes one archive of it with `build_files` (`joint library`); `programs` compiles C
//! for this machine and for the emulator's, `run` and `controller` are the Rust halves of the closed loops that those programs run, `costs`
//! counts what a call takes.

pub mod build_files;
pub mod controller;
pub mod costs;
pub mod library;
pub mod package;
pub mod programs;
pub mod run;
pub mod tables;
