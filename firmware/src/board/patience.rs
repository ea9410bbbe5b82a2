//! Bounded waiting for hardware. A wait that gives up is reported by who waited, not here.

/// Polls that outlast the slowest start of a crystal (some milliseconds) at any clock of these boards.
const POLLS: u32 = 1_000_000;

/// Waits until it is so; `false` if it never was.
#[must_use]
pub fn wait_until(mut it_is_so: impl FnMut() -> bool) -> bool {
    (0..POLLS).any(|_| it_is_so())
}

/// How many times longer flash may take: seconds.
const LONGER: u32 = 400;

/// The same for what takes seconds.
#[must_use]
pub fn wait_longer(mut it_is_so: impl FnMut() -> bool) -> bool {
    (0..LONGER).any(|_| wait_until(&mut it_is_so))
}
