#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_op_in_unsafe_fn, reason = "the framework writes its tasks so")]
//! Role `plant`: the board simulates the joint; torques in, motion out. All roles share the application; the code is in
//! the library.

/// Role of this image, used by `role_app.rs`.
#[cfg(target_os = "none")]
mod role {
    use firmware::plant::{Plant, PlantProtocol};
    use firmware::tables::{PLANETS, TABLES};

    pub const DIGEST: Option<u64> = None;
    pub type RoleProtocol = PlantProtocol<PLANETS>;
    pub type RoleWork = Plant<'static, PLANETS>;

    pub fn work() -> RoleWork {
        Plant::new(&TABLES)
    }
}

#[cfg(target_os = "none")]
include!("../role_app.rs");

/// Empty on a host: this image is for a board.
#[cfg(not(target_os = "none"))]
fn main() {}
