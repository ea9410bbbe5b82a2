//! Bounds of how often random motions keep what the certificate of a design promises.

bounds! {
    /// Motions worse than nine in ten are promised to be.
    LEAST_COVERAGE: "share of random motions whose error exceeds the certificate's nine-in-ten figure",
        below 0.1, was 0.06,
        since "It is the promise itself.";

    /// The same, of motions that hold contact, and of motions that lose it.
    LEAST_COVERAGE_OF_A_KIND: "share of random motions of one kind whose error exceeds the certificate's nine-in-ten figure",
        below 0.15, was 0.07,
        since "The promise holds over all motions; a kind has fewer of them.";

    /// Motions better than half are promised to be.
    MOST_COVERAGE_OF_TYPICAL: "share of random motions whose error is below the certificate's typical figure",
        below 0.9, was 0.8,
        since "A promise that nearly every motion keeps would say nothing of the usual one.";
}
