#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Role `observer`: observer and compensation for a motor controller; samples and set-points in, estimates and torques
//! out. All roles share the application; the code is in the library.

/// Role of this image, used by `role_app.rs`.
#[cfg(target_os = "none")]
mod role {
    pub use firmware::observer::ObserverProtocol as RoleProtocol;
    use firmware::observer::Observing;
    use firmware::port::Direct;
    use firmware::tables::TABLES;
    use model_core::controller::Controller;

    #[allow(dead_code, clippy::excessive_precision, reason = "generated numbers; the surroundings are real here")]
    mod control {
        include!(concat!(env!("OUT_DIR"), "/control.rs"));
    }

    pub const DIGEST: Option<u64> = Some(control::CONTROL_DIGEST);
    pub type RoleWork = Observing<Direct<'static>>;

    pub fn work() -> RoleWork {
        Observing::new(
            Direct(
                Controller::with_tables(&control::OBSERVER, &control::COMPENSATION).with_probe(control::PROBE.as_ref()),
            ),
            TABLES.digest_is_good(),
        )
    }
}

#[cfg(target_os = "none")]
include!("../role_app.rs");

/// Empty on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
