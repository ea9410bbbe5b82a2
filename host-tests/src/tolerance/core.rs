//! Bounds on the core's steps: against the reference on named motions, against closed forms, and on conserved quantities.

bounds! {
    /// Deflections, forces and angles that the host computes from a state of the core.
    HOST_OUTPUTS: "deflection over b_c, mesh force over K_m b_c, offset angles [rad], against the reference on one state",
        below 1e-7, was 2.0e-8,
        argued "The core's sine is good to 2.4e-9 in f64, which stiffness ripple and errors of several b_c multiply.";

    /// Energy balance of the board's scheme at ten times its rate.
    BOARD_ENERGY_BALANCE: "residual of the energy balance of the board's scheme in f64 at 200 kHz over the dissipated energy",
        below 4e-5, was 2.0e-5,
        argued "The error of a crossing in the accelerations lasts some sub-steps, since a tick continues the previous one; restarting each tick left 1.6e-6 at a third more work. The usual methods leave 7e-5 and more.";

    /// Core under a step of the load while turning.
    STEP_LOAD: "core under a step load, over the standard deviation",
        below 8.8e-3, was 5.9e-3,
        since "Q1's planets oscillate at 13 kHz, four radians a tick, and the ripple is approximated by a parabola.";

    /// Core from a start with all teeth separated.
    ALL_SEPARATED: "core from all teeth separated, over the standard deviation",
        below 3e-3, was 2e-3,
        since "Q1's planets turn by one radian of their own mode in a sub-step, as in the reversal.";

    /// Core in back-side contact.
    BACK_SIDE: "core in back-side contact, over the standard deviation",
        below 1.2e-3, was 8.3e-4,
        since "Q1's planets oscillate by four radians a tick, as under the step load, with a smaller step.";

    /// Core on case A.
    CASE_A: "core on case A, tau 100 to 300, over the standard deviation",
        below 1.8e-4, was 1.2e-4,
        since "Some 230 contact changes in 200 time units, each corrected to third order.";

    /// Core on case Q.
    CASE_Q: "core on case Q, tau 100 to 300, over the standard deviation",
        below 9.4e-6, was 6.3e-6,
        since "Whole ticks with a parabola for the ripple.";

    /// Core with four and five planets, unequal backlash, rectangular stiffness wave, or turning backwards.
    RANGE: "core on unusual joints, over the standard deviation",
        below 1e-3, was 6.8e-4,
        since "Four crossings of the gap each, on the back sides and on both flanks.";

    /// Core in free motion.
    FREE_MOTION: "core in free motion, over the standard deviation",
        below 5.7e-4, was 3.8e-4,
        since "f32, errors grow by a few tens over the bounces of 0.2 s.";

    /// Core through a reversal across the gap.
    REVERSAL: "core through a reversal, over the standard deviation",
        below 1.1e-3, was 7.6e-4,
        since "Q1's planets turn by one radian of their own mode in a sub-step; L1 is at 2e-4.";

    /// Core on the paper's joint at 0, 10, 60 and 120 um.
    REGIMES: "core on the paper's regimes, over the standard deviation",
        below 8.7e-4, was 5.8e-4,
        since "Errors of 30 um at twice the highest natural frequency; every impact amplifies earlier errors.";

    /// The paper's scheme where it is exact.
    PAPER_SCHEME_IN_CONTACT: "the paper's scheme while contact holds and nothing varies, over the standard deviation",
        below 1e-9, was 2.4e-10,
        argued "Exact but for the reference's own error and the phase, which has 64 bits.";

    /// Energy balance of the core over a hundred thousand mesh periods.
    CORE_ENERGY: "energy of the core less work, over the dissipated energy",
        below 1.1e-4, was 7.6e-5,
        since "A step of a fifth of a natural period: residual errors of the crossing corrections, summed over ticks.";

    /// Order of convergence on smooth motion, and of the paper's scheme on any motion.
    ORDER: "observed order of convergence less the scheme's",
        below 0.052, was 0.035,
        since "The steps are finite, so the next order still shows; a whole order lost would be 1.";

    /// Order of convergence through parting and hitting meshes.
    ORDER_AT_KINKS: "scheme's order less the observed order of convergence, on kinked motion",
        below 0.25, was 0.0,
        argued "The position of a crossing within a step changes with the step, so single errors scatter by half.";

    /// Core motions at two values of backlash that must agree.
    CORE_SHIFT: "difference of two motions of the core that must be the same, over b_c",
        below 1e-11, was 6.7e-14,
        argued "Rounding, amplified by every hit.";

    /// Free period of the core's sun in the gap.
    CORE_FREE_PERIOD: "free period of the core's sun in the gap, relative",
        below 3e-7, was 2e-7,
        since "Steps of 0.03 of the swing's radian; crossings are corrected to third order.";

    /// Tooth phase of the core's planets.
    CORE_TOOTH_PHASE: "deflection of a planet of the core against the deflection predicted by its tooth phase, over b_c",
        below 7.6e-9, was 5.1e-9,
        since "The step's sine is right to 2.4e-9, and its error depends on the phase.";

    /// Static deflection of the core.
    CORE_STATIC: "static deflection of the core, over b_c",
        below 1e-12, was 8.5e-14,
        argued "Rounding of deflections of some thirty b_c.";

    /// Core vibrating in one mode.
    CORE_MODE: "core against the cosine of a mode, over b_c",
        below 1e-11, was 4.7e-13,
        argued "Exact tables: only rounding adds up over 400 ticks, about a static deflection of some thirty b_c.";

    /// Steady elliptical motion of the core.
    CORE_ELLIPSE: "amplitude of the core's steady ellipse, over b_c",
        below 5.7e-6, was 3.8e-6,
        since "A tick is a thirtieth of the mesh period; a parabola through three moments of it is of third order.";

    /// Energy gained or lost by the core without input.
    PASSIVITY: "energy gained by the core without torques and excitation, or lost undamped, over the initial energy",
        below 1e-4, was 6.9e-5,
        since "Undamped planets of light joints hit a thousand times; a step at 1 MHz is a fifth of a radian of their mode.";

    /// Speed of the rigid body against its momentum.
    MOMENTUM: "speed of the rigid body against the integral of its torques, over the largest speed",
        below 1e-11, was 6.6e-13,
        argued "The core counts whole 2^-64 turns a tick and drops up to one each tick; the reference is at 1e-14.";

    /// Order of convergence of semi-implicit Euler.
    ORDER_OF_EULER: "observed order of semi-implicit Euler, less 1",
        below 0.039, was 0.026,
        since "The next order still shows at the coarsest step.";

    /// Order of convergence of classical Runge-Kutta through parting and hitting meshes.
    ORDER_OF_RUNGE_KUTTA_AT_KINKS: "observed order of Runge-Kutta through kinks, less 2",
        below 0.21, was 0.14,
        since "The position of a kink within a step changes with step and rate.";
}
