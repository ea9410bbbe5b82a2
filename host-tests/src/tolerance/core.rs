//! Bounds of the core's steps: against the reference on named motions, against closed forms, and against themselves where
//! a law of nature says what must stay as it was.

use super::Bound;

/// Deflections, forces and angles that the host reads off a state of the core.
pub const READ_OFF: Bound = Bound {
    of: "deflection over b_c, mesh force over K_m b_c, offset angles [rad], against the reference's reading of one state",
    limit: 1e-7,
    measured: 2.0e-8,
    reason: "The core's sine is good to 2.4e-9 in f64, which stiffness ripple and errors of several b_c multiply.",
};

/// Energy balance of the board's scheme at ten times its rate.
pub const BOOKS_OF_THE_BOARD: Bound = Bound {
    of: "residual of the energy balance of the board's scheme in f64 at 200 kHz over what is dissipated",
    limit: 4e-5,
    measured: 2.0e-5,
    reason: "What a crossing leaves in the accelerations lasts some sub-steps, since ticks go on from one another; beginning each tick anew left 1.6e-6 at a third more work. The usual methods leave 7e-5 and more.",
};

/// Core, a step of the load while turning.
pub const STEP_LOAD: Bound = Bound {
    of: "core under a step load, over the standard deviation",
    limit: 1e-2,
    measured: 4.4e-3,
    reason: "Q1's planets ring at 13 kHz, four radians a tick, and the ripple along that is taken as a parabola.",
};

/// Core, all teeth separated at the start.
pub const ALL_SEPARATED: Bound = Bound {
    of: "core from all teeth separated, over the standard deviation",
    limit: 3e-3,
    measured: 6.8e-4,
    reason: "As for the reversal.",
};

/// Core, back-side contact.
pub const BACK_SIDE: Bound = Bound {
    of: "core in back-side contact, over the standard deviation",
    limit: 3e-3,
    measured: 1.0e-3,
    reason: "As for the step load, with a smaller step.",
};

/// Core, case A.
pub const CASE_A: Bound = Bound {
    of: "core on case A, tau 100 to 300, over the standard deviation",
    limit: 5e-4,
    measured: 2.5e-4,
    reason: "Some 230 contact changes in 200 time units, each corrected to third order.",
};

/// Core, case Q.
pub const CASE_Q: Bound = Bound {
    of: "core on case Q, tau 100 to 300, over the standard deviation",
    limit: 1e-4,
    measured: 3.0e-5,
    reason: "Whole ticks with a parabola for the ripple.",
};

/// Core, four and five planets, unequal backlash, rectangular wave, backwards.
pub const RANGE: Bound = Bound {
    of: "core beyond the usual joint, over the standard deviation",
    limit: 2e-3,
    measured: 4.3e-4,
    reason: "Four crossings of the gap each, on the back sides and on both flanks.",
};

/// Core, free motion.
pub const FREE_MOTION: Bound = Bound {
    of: "core in free motion, over the standard deviation",
    limit: 1e-3,
    measured: 1.3e-4,
    reason: "f32, errors grow by a few tens over the bounces of 0.2 s.",
};

/// Core, reversal through the gap.
pub const REVERSAL: Bound = Bound {
    of: "core through a reversal, over the standard deviation",
    limit: 5e-3,
    measured: 1.6e-3,
    reason: "Q1's planets turn by one radian of their own mode in a sub-step; L1 is at 2e-4.",
};

/// Core, the paper's joint at 0, 10, 60, 120 um.
pub const REGIMES: Bound = Bound {
    of: "core on the paper's regimes, over the standard deviation",
    limit: 2e-3,
    measured: 5.8e-4,
    reason: "Errors of 30 um at twice the highest natural frequency; every impact amplifies what came before.",
};

/// The paper's scheme where it is exact.
pub const PAPER_SCHEME_HELD: Bound = Bound {
    of: "the paper's scheme while contact holds and nothing varies, over the standard deviation",
    limit: 1e-9,
    measured: 2.4e-10,
    reason: "Exact but for the reference's own error and the phase, which has 64 bits.",
};

/// Energy of the core over a hundred thousand mesh periods.
pub const CORE_ENERGY: Bound = Bound {
    of: "energy of the core less work, over all that was dissipated",
    limit: 2e-4,
    measured: 5.8e-5,
    reason: "A step of a fifth of a natural period: what the corrections of crossings leave, and the sum over ticks.",
};

/// Order of convergence on smooth motion, and of the paper's scheme on any.
pub const ORDER: Bound = Bound {
    of: "observed order of convergence less the scheme's",
    limit: 0.15,
    measured: 0.035,
    reason: "The steps are finite, so the next order still shows; a whole order lost would be 1.",
};

/// Order of convergence where meshes part and hit.
pub const ORDER_AT_KINKS: Bound = Bound {
    of: "what the observed order of convergence falls short of the scheme's, on kinked motion",
    limit: 0.25,
    measured: 0.0,
    reason: "Where in a step a crossing falls changes with the step, so single errors scatter by half of themselves.",
};

/// The core at another backlash.
pub const CORE_SHIFT: Bound = Bound {
    of: "difference of two motions of the core that must be the same, over b_c",
    limit: 1e-11,
    measured: 6.7e-14,
    reason: "Rounding, amplified by every hit.",
};

/// Free periods of the core's sun.
pub const CORE_FREE_PERIOD: Bound = Bound {
    of: "free period of the core's sun in the gap, relative",
    limit: 2e-6,
    measured: 2.1e-7,
    reason: "Steps of 0.03 of the swing's radian; crossings are corrected to third order.",
};

/// Planets of the core by tooth counts.
pub const CORE_TOOTH_PHASE: Bound = Bound {
    of: "deflection of a planet of the core against the one that its tooth phase predicts, over b_c",
    limit: 1e-7,
    measured: 5.1e-9,
    reason: "The step's sine is right to 2.4e-9, and its error depends on the phase.",
};

/// The core at rest.
pub const CORE_STATIC: Bound = Bound {
    of: "static deflection of the core, over b_c",
    limit: 1e-12,
    measured: 8.5e-14,
    reason: "Rounding of deflections of some thirty b_c.",
};

/// The core vibrating in one mode.
pub const CORE_MODE: Bound = Bound {
    of: "core against the cosine of a mode, over b_c",
    limit: 1e-11,
    measured: 4.7e-13,
    reason: "Exact tables: only rounding adds up over 400 ticks, about a static deflection of some thirty b_c.",
};

/// The core's steady ellipse.
pub const CORE_ELLIPSE: Bound = Bound {
    of: "amplitude of the core's steady ellipse, over b_c",
    limit: 1e-4,
    measured: 1.8e-5,
    reason: "A tick is a thirtieth of the mesh period; a parabola through three moments of it is of third order.",
};

/// Energy of the core where nothing supplies any.
pub const PASSIVITY: Bound = Bound {
    of: "energy that the core gains without torques and excitation, or loses undamped, over what it had",
    limit: 1e-3,
    measured: 1.3e-4,
    reason: "Undamped planets of light joints hit a thousand times; a step at 1 MHz is a fifth of their radian.",
};

/// Speed of the rigid body against its momentum.
pub const MOMENTUM: Bound = Bound {
    of: "speed of the rigid body against what its torques made of it, over the largest",
    limit: 1e-11,
    measured: 6.6e-13,
    reason: "The core counts whole 2^-64 turns a tick, of which it drops up to one each tick; the reference is at 1e-14.",
};

/// Observed order of semi-implicit Euler.
pub const ORDER_OF_EULER: Bound = Bound {
    of: "observed order of semi-implicit Euler, less 1",
    limit: 0.1,
    measured: 0.026,
    reason: "The next order still shows at the coarsest step.",
};

/// Observed order of the classical Runge-Kutta method where meshes part and hit.
pub const ORDER_OF_RUNGE_KUTTA_AT_KINKS: Bound = Bound {
    of: "observed order of Runge-Kutta through kinks, less 2",
    limit: 0.3,
    measured: 0.13,
    reason: "Where in the step a kink falls changes from step to step and from rate to rate.",
};
