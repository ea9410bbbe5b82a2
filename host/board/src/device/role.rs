//! Names of the roles, as typed by users and printed in reports.

use link::messages::Role;

/// Name of the role behind which no host stands: a drive on CAN.
pub const DRIVE: &str = "drive";

/// Name of a role.
pub fn role_name(role: Role) -> &'static str {
    match role {
        Role::Plant => "plant",
        Role::Observer => "observer",
        Role::Loop => "loop",
    }
}
