//! Bounded waiting for hardware; the caller reports a wait that timed out.

/// Number of polls; outlasts the slowest start of a crystal (some milliseconds) at any clock of these boards.
const POLLS: u32 = 1_000_000;

/// Waits for a condition; `false` if it never held.
#[must_use]
pub fn wait_until(mut condition: impl FnMut() -> bool) -> bool {
    (0..POLLS).any(|_| condition())
}

/// Factor by which flash may take longer: seconds.
const LONGER: u32 = 400;

/// Waits for a condition that may take seconds; `false` if it never held.
#[must_use]
pub fn wait_longer(mut condition: impl FnMut() -> bool) -> bool {
    (0..LONGER).any(|_| wait_until(&mut condition))
}
