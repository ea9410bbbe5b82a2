#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Role `loop`: joint, motor, observer and compensation on one chip; a trajectory in, samples of the motion out. All
//! roles share the application; the code is in the library.

/// Role of this image, used by `role_app.rs`.
#[cfg(target_os = "none")]
mod role {
    use firmware::port::Direct;
    use firmware::tables::{PLANETS, TABLES};
    pub use firmware::whole_loop::LoopProtocol as RoleProtocol;
    use firmware::whole_loop::WholeLoop;
    use model_core::controller::Controller;

    #[allow(dead_code, clippy::excessive_precision, reason = "generated numbers; a motion in knots asks for no probe")]
    mod control {
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    pub const DIGEST: Option<u64> = Some(control::CONTROL_DIGEST);
    pub type RoleWork = WholeLoop<'static, Direct<'static>, PLANETS>;

    pub fn work() -> RoleWork {
        let controller = Controller::with_tables(&control::OBSERVER, &control::COMPENSATION);
        WholeLoop::new(&TABLES, &control::SURROUNDINGS, Direct(controller))
    }
}

#[cfg(target_os = "none")]
include!("../role_app.rs");

/// Empty on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
