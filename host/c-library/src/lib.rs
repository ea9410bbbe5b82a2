//! What programs in C and C++ take from here. `tables` writes a joint's tables as C source (`joint tables`); `library` builds
//! what is behind the header of `bindings/c` and `package` makes one archive of it (`joint library`); `programs` compiles C
//! for this machine and for the emulator's, `run` is the Rust half of the closed loop that those programs run, `costs`
//! counts what a call takes.

pub mod costs;
pub mod library;
pub mod package;
pub mod programs;
pub mod run;
pub mod tables;
