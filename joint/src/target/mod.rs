//! The target's side of the host: toolchain, images, emulator, flashing. Nothing is said to a board here.
