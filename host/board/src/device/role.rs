//! Roles by name, as users type them and as reports print them.

use link::messages::Role;

/// The word for a role.
pub fn word(role: Role) -> &'static str {
    match role {
        Role::Plant => "plant",
        Role::Observer => "observer",
        Role::Loop => "loop",
    }
}
