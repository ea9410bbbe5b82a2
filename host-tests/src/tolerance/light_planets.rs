//! Bounds on joints with light planets: Verlet sub-steps, exponential ticks, and the motion of a robot joint in windows.

bounds! {
    /// Order of convergence of Verlet sub-steps.
    ORDER_OF_VERLET: "order of Verlet sub-steps less the observed order, where light planets bounce",
        below 0.072, was 0.048,
        since "The position of a contact change within a sub-step varies with its length, so single errors scatter.";

    /// Verlet sub-steps as a board runs them.
    SUBSTEPS: "mesh deflections over b_c in 60 ticks of 8 Verlet sub-steps at 10 kHz with bouncing light planets, RMS",
        below 3.1e-3, was 2.1e-3,
        since "A sub-step is 0.9 rad of the fastest mode; five planets bounce most.";

    /// A contact that opens and closes within one tick.
    PARTING_WITHIN_A_TICK: "deflections at the end of a tick in which a tooth parted and returned, over the tooth's swing",
        below 0.1, was 0.072,
        since "A period of the fastest mode in eight sub-steps; a tooth held closed would be off by 0.5.";

    /// A gap crossed within one sub-step.
    SUBSTEP_ACROSS_THE_GAP: "deflections after two ticks in which a sub-step crossed the whole gap, over the largest; tenfold in quarter sub-steps",
        below 0.16, was 0.11,
        since "Two contacts in one sub-step; second order shows in quarter sub-steps, at 0.044.";

    /// A sub-step that ends as deep in one flank as it began in the other.
    SUBSTEP_THROUGH_THE_MIDDLE: "change of a planet's speed over a sub-step through the middle of its gap and into both flanks, relative",
        below 1e-9, was 0.0,
        argued "The flanks' pushes cancel by symmetry; one flank alone would change it by 4e-3.";

    /// Exponential ticks of light planets in contact.
    EXPONENTIAL_TICK: "deflections over b_c at the end of an exponential tick of light planets with every tooth in contact",
        below 4.3e-4, was 2.9e-4,
        since "Ripple and errors are approximated as linear over the tick.";

    /// Exponential ticks of light planets in contact while a planet swings.
    EXPONENTIAL_TICK_SWINGING: "deflections over b_c at the end of an exponential tick of light planets with every tooth in contact and one planet swinging",
        below 1.5e-3, was 1.01e-3,
        since "The planet swings by up to 0.8 of its static deflection; Verlet sub-steps leave 2.8e-3 in the same ticks.";

    /// Openings that an exponential tick of light planets may overlook.
    OVERLOOKED_OPENING: "widest opening overlooked by an exponential tick of light planets, over b_c",
        below 1e-3, was 0.0,
        argued "No opening was overlooked; a narrower one would hardly change the force.";

    /// RMS error of the output angle on case R.
    ROBOT_LINK_RMS: "link angle over a robot joint's motion in windows, over the lost motion, RMS",
        below 1e-3, was 3.0e-4,
        argued "Requirement.";

    /// Worst error of the output angle on case R.
    ROBOT_LINK_WORST: "link angle over a robot joint's motion in windows, over the lost motion, worst",
        below 1e-2, was 3.3e-3,
        argued "Requirement.";

    /// Peak mesh force on case R.
    ROBOT_PEAK_FORCE: "largest mesh force in any part of case R, relative",
        below 0.1, was 0.074,
        argued "Requirement.";

    /// Peak mesh force of other joints and mesh phases.
    ROBOT_VARIANTS_PEAK_FORCE: "largest mesh force in any part of a robot joint's motion, relative",
        below 0.25, was 0.18,
        argued "A part of the short form has one to four impacts of light planets on each other; a peak a few microseconds from the end of a tick depends on the phase.";

    /// RMS error of the output angle of joints whose planets differ in phase or are heavy beside the link.
    UNUSUAL_ROBOTS_LINK_RMS: "link angle of five, uneven or heavy planets, or a light link, in windows, over the lost motion, RMS",
        below 2e-3, was 1.3e-3,
        argued "Runge-Kutta at 320 kHz in f64 is off by 2e-4 on five and on heavy planets, by 1e-3 on uneven ones.";

    /// Worst error of the output angle of joints whose planets differ in phase or are heavy beside the link.
    UNUSUAL_ROBOTS_LINK_WORST: "link angle of five, uneven or heavy planets, or a light link, in windows, over the lost motion, worst",
        below 2e-2, was 1.65e-2,
        argued "Runge-Kutta at 320 kHz in f64 is off by 2e-3 on five and on heavy planets, by 8e-3 on uneven ones.";

    /// Growth of a very small disturbance within a window.
    NOISE_IN_WINDOWS: "link angle under torque noise of 1e-9 in the windows of a robot joint's motion, over the lost motion, RMS",
        below 1e-7, was 2.9e-9,
        argued "Hundredfold growth; without windows it is ten-millionfold over all of case R.";
}
