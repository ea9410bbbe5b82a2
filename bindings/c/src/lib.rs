#![cfg_attr(feature = "library", no_std)]
//! Plant, observer, compensation, width probe and wiring check of `model-core` for programs in C and C++. The header is
//! `bindings/c/include/lostmotion/joint.h`; it documents everything that a caller must know, and is generated from
//! here.
//!
//! The layer is thin: a function takes pointers, checks them, sets the floating-point unit to its standard mode, and
//! calls the core. The caller owns all storage. There is no heap, no mutable global, no call into libc and no panic;
//! two contexts may call at once if they use different objects. A function that fails changes nothing.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in brackets")]
#![allow(non_snake_case, reason = "units keep their letters: Nm")]
#![allow(clippy::missing_safety_doc, reason = "what a caller owes is said once, at the head of the header")]

#[cfg(feature = "measuring")]
#[path = "../measuring/bare.rs"]
mod bare;
mod compensation;
mod estimates;
mod object;
mod observer;
mod plant;
mod probe;
mod state;
mod status;
mod tables;
mod version;
mod wiring;

pub use compensation::*;
pub use estimates::*;
pub use observer::*;
pub use plant::*;
pub use probe::*;
pub use status::*;
pub use tables::*;
pub use version::*;
pub use wiring::*;

/// Unreachable: a test verifies that linked programs contain no path to a panic.
#[cfg(feature = "library")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
