//! Bounds on joints with light planets: leaps, exponential ticks beside them, and a robot joint's motion in windows.
//! Where they are held against anything is the tests' business.

use super::Bound;

/// Order of convergence of leaps.
pub const ORDER_OF_LEAPS: Bound = Bound {
    of: "what the observed order of leaps falls short of their own, where light planets bounce",
    limit: 0.15,
    measured: 0.048,
    reason: "Where in a leap a contact changes goes with its length, so single errors scatter.",
};

/// Leaps as a board takes them.
pub const LEAPS: Bound = Bound {
    of: "mesh deflections over b_c in 60 ticks of 8 leaps at 10 kHz in which light planets bounce, RMS",
    limit: 5e-3,
    measured: 2.0e-3,
    reason: "A leap is 0.9 rad of the fastest mode; five planets bounce most.",
};

/// A contact that is lost and found again within a tick.
pub const PARTED_WITHIN_A_TICK: Bound = Bound {
    of: "deflections at the end of a tick in which a tooth parted and returned, over that tooth's swing",
    limit: 0.1,
    measured: 0.071,
    reason: "A period of the fastest mode in eight leaps; a tooth that was held closed would be off by 0.5.",
};

/// A gap crossed within a leap.
pub const LEAP_ACROSS_THE_GAP: Bound = Bound {
    of: "deflections after two ticks in which a leap crossed the whole gap, over the largest; tenfold in quarter leaps",
    limit: 0.2,
    measured: 0.101,
    reason: "Two contacts in one leap; second order shows in quarter leaps, at 0.044.",
};

/// A leap as deep into one flank as into the other.
pub const LEAP_THROUGH_THE_MIDDLE: Bound = Bound {
    of: "change of a planet's speed over a leap through the middle of its gap and into both flanks, relative",
    limit: 1e-9,
    measured: 0.0,
    reason: "The flanks' pushes cancel by symmetry; one flank alone would change it by 4e-3.",
};

/// Exponential ticks of light planets.
pub const PRESSED: Bound = Bound {
    of: "deflections over b_c at the end of an exponential tick of light planets in which every tooth kept pressing",
    limit: 5e-4,
    measured: 1.9e-4,
    reason: "Ripple and errors are taken as linear over the tick.",
};

/// What such a tick may overlook.
pub const HELD_OVER_AN_OPENING: Bound = Bound {
    of: "widest opening that an exponential tick of light planets took for none, over b_c",
    limit: 1e-3,
    measured: 0.0,
    reason: "None was overlooked; one narrower than this would carry no force to speak of.",
};

/// Case R, output angle.
pub const ROBOT_LINK_RMS: Bound = Bound {
    of: "link angle over a robot joint's motion in windows, over the lost motion, RMS",
    limit: 1e-3,
    measured: 3.0e-4,
    reason: "It is what is asked for.",
};

/// Its largest error.
pub const ROBOT_LINK_WORST: Bound = Bound {
    of: "link angle over a robot joint's motion in windows, over the lost motion, worst",
    limit: 1e-2,
    measured: 3.3e-3,
    reason: "It is what is asked for.",
};

/// Case R, mesh force.
pub const ROBOT_PEAK_FORCE: Bound = Bound {
    of: "largest mesh force in any part of case R, relative",
    limit: 0.1,
    measured: 0.074,
    reason: "It is what is asked for.",
};

/// The same of other joints and mesh phases.
pub const ROBOTS_PEAK_FORCE: Bound = Bound {
    of: "largest mesh force in any part of a robot joint's motion, relative",
    limit: 0.25,
    measured: 0.18,
    reason: "A part of the brief form has one to four blows, each of light planets against each other; a peak that the ends of ticks miss by a few microseconds goes with the phase.",
};

/// Output angle of joints whose planets move one by one, or are heavy beside the link.
pub const FAR_ROBOTS_LINK_RMS: Bound = Bound {
    of: "link angle of five, uneven or heavy planets, or a light link, in windows, over the lost motion, RMS",
    limit: 2e-3,
    measured: 1.3e-3,
    reason: "Runge-Kutta at 320 kHz in f64 is off by 2e-4 on five and on heavy planets, by 1e-3 on uneven ones.",
};

/// Its largest error.
pub const FAR_ROBOTS_LINK_WORST: Bound = Bound {
    of: "link angle of five, uneven or heavy planets, or a light link, in windows, over the lost motion, worst",
    limit: 2e-2,
    measured: 1.65e-2,
    reason: "Runge-Kutta at 320 kHz in f64 is off by 2e-3 on five and on heavy planets, by 8e-3 on uneven ones.",
};

/// What a vanishing change grows to in a window.
pub const NOISE_IN_WINDOWS: Bound = Bound {
    of: "link angle under torque noise of 1e-9 in the windows of a robot joint's motion, over the lost motion, RMS",
    limit: 1e-7,
    measured: 2.9e-9,
    reason: "Hundredfold growth; without windows it is ten-millionfold over all of case R.",
};
