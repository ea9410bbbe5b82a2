//! Tables and library for programs in C and C++. `tables` writes a joint's tables as C source (`joint tables`);
//! `library` builds the functions declared in the header of `bindings/c`, `package` packs them with `build_files` into
//! one archive (`joint library`, `tarball`). `programs` compiles C for this machine and for the emulator's; `run` and
//! `controller` are the Rust counterparts of the closed loops in those programs; `costs` counts the costs of each call;
//! `shared_object` compiles C over the library for programs that load it.

pub mod build_files;
pub mod controller;
pub mod costs;
pub mod library;
pub mod package;
pub mod programs;
pub mod run;
pub mod shared_object;
pub mod tables;
pub mod tarball;
