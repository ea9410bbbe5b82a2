//! Extent of tests: short in `cargo test`, long with the environment variable `LONG_TESTS`, as in `.ci/attack`. Bounds hold for both forms.

/// Environment variable that selects the long form.
const LONG_TESTS: &str = "LONG_TESTS";

/// Returns true in the long form.
pub fn is_long() -> bool {
    std::env::var_os(LONG_TESTS).is_some()
}

/// Returns the value of the form that runs, such as a number of seeds.
pub fn short_or_long<T>(short: T, long: T) -> T {
    if is_long() { long } else { short }
}

/// Returns the first `short` cases, or all cases in the long form.
pub fn cases<T>(all: &[T], short: usize) -> &[T] {
    &all[..short_or_long(short.min(all.len()), all.len())]
}
