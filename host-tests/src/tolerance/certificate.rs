//! Bounds of how often random motions keep what the certificate of a design promises. What they move and how is left to
//! the tests.

use super::Bound;

/// Motions worse than nine in ten are promised to be.
pub const LEAST_COVERAGE: Bound = Bound {
    of: "share of random motions whose error exceeds the certificate's nine-in-ten figure",
    limit: 0.1,
    measured: 0.06,
    reason: "It is the promise itself.",
};

/// The same, of motions that hold contact, and of motions that lose it.
pub const LEAST_COVERAGE_OF_A_KIND: Bound = Bound {
    of: "share of random motions of one kind whose error exceeds the certificate's nine-in-ten figure",
    limit: 0.15,
    measured: 0.07,
    reason: "The promise holds over all motions; a kind has fewer of them.",
};

/// Motions better than half are promised to be.
pub const MOST_COVERAGE_OF_TYPICAL: Bound = Bound {
    of: "share of random motions whose error is below the certificate's typical figure",
    limit: 0.9,
    measured: 0.8,
    reason: "A promise that nearly every motion keeps would say nothing of the usual one.",
};
