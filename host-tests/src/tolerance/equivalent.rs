//! Bounds on equivalent gears: the core's step against the reference, and both against closed forms.

bounds! {
    /// Gap of random equivalent gears, core in f32, over predictable motions.
    RANDOM: "gap of a random equivalent gear in f32 against the reference, over its RMS",
        below 3.7e-4, was 2.5e-4,
        since "The worst of about a hundred motions: little damping, 0.6 rad of the contact a tick, errors grown thirtyfold; half of all are below 1e-6.";

    /// Median of [`RANDOM`] at 20 kHz.
    RANDOM_MEDIAN: "gap of a random equivalent gear in f32 against the reference, over its RMS, median over 120 seeds at 20 kHz",
        below 9e-7, was 6.1e-7,
        since "Rounding of f32, which motions amplify more or less.";
    /// 90th percentile of [`RANDOM`] at 20 kHz.
    RANDOM_90_PERCENT: "gap of a random equivalent gear in f32 against the reference, over its RMS, 90th percentile over 120 seeds at 20 kHz",
        below 1.2e-5, was 8.5e-6,
        since "Motions with little damping and many changes of contact.";

    /// Gap of random equivalent gears, core in f64.
    RANDOM_DOUBLE: "gap of a random equivalent gear in f64 against the reference, over its RMS",
        below 3.7e-4, was 2.5e-4,
        since "The error comes from the step, not from f32.";

    /// Momentum of motor and link, referred to the link.
    MOMENTUM: "momentum of motor and link less the integral of the torques, over its largest value",
        below 1e-8, was 1.8e-10,
        argued "The core counts momentum in whole 2^-64 turns a tick; slow heavy joints have few of them.";

    /// Energy gained by an equivalent gear without input.
    ENERGY_GAINED: "energy gained by an equivalent gear in f32 without input, over its energy",
        below 2.1e-5, was 1.4e-5,
        since "Computed from a state in f32; a gear without damping, for 4,000 ticks.";

    /// Energy lost by an undamped equivalent gear without input.
    ENERGY_LOST: "energy lost by an undamped equivalent gear in f32 without input, over its energy",
        below 0.013, was 8.7e-3,
        since "At 0.6 rad of the contact a tick each contact change costs about 1e-5 of the motion, a thousand times over.";

    /// Static twist under a torque.
    STATIC: "twist of an equivalent gear at rest under a torque, relative",
        below 1e-10, was 4.4e-16,
        argued "The transient has fallen by exp(-80).";

    /// Free swings with a known period.
    FREE_SWING: "twist after whole periods of a free swing, over its amplitude",
        below 1e-8, was 1.9e-13,
        argued "Ten periods, each with four changes of contact at 0.03 rad of the contact a tick.";
}
