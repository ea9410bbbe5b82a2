//! Tolerances of all tests of this workspace, each with the value measured when it was set and the reason for its margin. Test files hold
//! no tolerances of their own.
//!
//! The word before the reason gives the kind of a bound:
//!
//! - `since`: the figure is the same in every run. The bound is at most 1.5 times the measured value.
//! - `scatters`: the figure comes from a few seeds, or from a loop in which one rounding error can change an encoder count and with it the
//!   trajectory. The bound is at most twice the measured value.
//! - `argued`: only rounding remains, which differs between platforms and is amplified by the motion; or the figure is zero; or the bound
//!   is a requirement and the test is a long one.
//!
//! The compiler checks the limits of `since` and `scatters`.

/// Largest bound allowed for a kind, from the measured value.
macro_rules! bound_max {
    (since, $measured:expr) => {
        1.5 * $measured
    };
    (scatters, $measured:expr) => {
        2.0 * $measured
    };
    (argued, $measured:expr) => {
        f64::INFINITY
    };
}

/// Rows of the table: name, quantity, bound, measured value, and the reason for the margin.
macro_rules! bounds {
    ($($(#[$about:meta])* $name:ident: $quantity:literal, below $limit:expr, was $measured:expr, $kind:ident $reason:literal;)*) => {
        $(
            $(#[$about])*
            pub const $name: $crate::tolerance::Bound =
                $crate::tolerance::Bound { quantity: $quantity, limit: $limit, measured: $measured, reason: $reason };
            // The factor covers decimal fractions that are not exact in binary.
            const _: () = assert!(
                $limit <= (1.0 + 1e-9) * bound_max!($kind, $measured),
                concat!("the bound ", stringify!($name), " is too far from what was measured")
            );
        )*
    };
}

pub mod certificate;
pub mod compensation;
pub mod core;
pub mod equivalent;
pub mod light_planets;
pub mod observer;

/// Upper limit on an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Error and its normalisation.
    pub quantity: &'static str,
    /// The error must be below this limit.
    pub limit: f64,
    /// Value measured when the bound was set (x86-64 Linux, f64 unless stated).
    pub measured: f64,
    /// Reason for the margin.
    pub reason: &'static str,
}

impl Bound {
    /// Passes an error below the limit.
    ///
    /// # Panics
    /// If the error is not below the limit, or is NaN; the message states the value measured when the bound was set.
    #[track_caller]
    pub fn check(&self, error: f64) {
        println!("{}: {error:.2e} (limit {:.0e}, was {:.1e})", self.quantity, self.limit, self.measured);
        assert!(
            error.abs() < self.limit,
            "{}: {error:e} is not below {:e}; it was {:e} when the bound was set. {}",
            self.quantity,
            self.limit,
            self.measured,
            self.reason
        );
    }
}

bounds! {
    /// Reference against the data files of cases A and Q.
    CASE_DATA: "trajectory error of the reference on cases A and Q, over the standard deviation",
        below 1e-9, was 9.5e-12,
        argued "The files have twelve digits; a missed event would show as 1e-3.";

    /// Growth of a very small disturbance in a predictable motion.
    PREDICTABILITY: "change of mesh deflections over the change of 1e-12 m that caused it",
        below 94.0, was 63.0,
        since "With larger growth, a bound on a trajectory would test the motion instead of the integrator.";

    /// Energy balance of the reference.
    REFERENCE_ENERGY_BALANCE: "residual of the reference's energy balance over the dissipated energy",
        below 1e-10, was 2.6e-12,
        argued "The integration's own error.";

    /// Swing of the paper's joint, simulated with the board's step.
    SIM_PEAK_TO_PEAK: "peak to peak of the sun-planet deflection in set P's regular regimes against five known digits, relative",
        below 1e-3, was 4.7e-5,
        argued "Ticks may miss a crest by a 96th of a mesh period, which is 5e-4 of the swing.";

    /// Power outside the mesh frequency.
    SIM_NON_FUNDAMENTAL: "non-fundamental over fundamental in set P's regular regimes against the printed figure",
        below 6e-3, was 1.1e-3,
        argued "Half a unit of the last digit printed.";

    /// Static deflection and force of a joint at rest.
    SIM_STATIC: "mesh force and deflection of a joint at rest against oracle 4, relative",
        below 1e-7, was 7.9e-14,
        argued "Torques are rounded to f32 on their way to the joint; the tested torques are exact in f32.";

    /// Undamped natural frequencies.
    NATURAL_FREQUENCY: "natural frequency, relative",
        below 1e-9, was 3.0e-11,
        argued "Fitted exactly from samples; only the integration's own error is left.";

    /// Damped eigenvalues against printed ones.
    EIGENVALUE: "damped eigenvalue over omega_n",
        below 6.1e-7, was 4.1e-7,
        since "The expected values are known to six digits after the point.";

    /// Amplitudes of the steady ellipse against printed ones.
    ELLIPSE: "amplitude of the steady ellipse, over b_c",
        below 1.1e-7, was 7.6e-8,
        since "The expected values are known to six digits after the point.";

    /// Distance of the steady motion from a pure ellipse.
    ELLIPSE_PURITY: "distance from a pure ellipse, over b_c",
        below 1e-9, was 3.0e-11,
        argued "The transient has fallen by exp(-0.0323 x 800); the rest is integration error.";

    /// Static deflection, gap coordinate and lost motion.
    STATIC: "static deflection, over b_c",
        below 1e-11, was 1.6e-14,
        argued "The transient has fallen by exp(-33) or more.";

    /// Energy balance.
    ENERGY: "energy less work, over the largest energy",
        below 1.8e-9, was 1.2e-9,
        since "Adds up over a thousand dimensionless seconds of chaos with a thousand events; 1e-11 in shorter motions.";

    /// Motions at two values of backlash, or with all quantities scaled, that must agree.
    INVARIANCE: "difference of two motions that must be the same, over b_c",
        below 1e-9, was 1.5e-11,
        argued "Step sizes and event times differ between the two.";

    /// Free periods of one mass in a dead zone.
    FREE_PERIOD: "free period of one mass in a dead zone, relative",
        below 1e-11, was 4.6e-13,
        argued "The closed form is exact; twenty periods with up to eight events each add up.";

    /// Poincare points of set P against printed ones.
    POINCARE: "Poincare point of set P, dimensionless",
        below 7.9e-5, was 5.3e-5,
        since "The expected values are known to four digits after the point, which contributes 5e-5.";

    /// Tooth phase of planets in and out of phase.
    TOOTH_PHASE: "deflection of a planet against the deflection predicted by its tooth phase, over b_c",
        below 1e-10, was 2.3e-12,
        argued "Steady state of a linear joint; only integration error and the end of the transient are left.";

    /// A motion repeated many turns later.
    MANY_TURNS: "difference of mesh deflections after many turns, over b_c",
        below 1e-9, was 3.7e-11,
        argued "Coordinates stay within a tooth, so no digits are lost however far the joint has turned.";

    /// Stiffness of the rectangular wave against a projection of its graph.
    RECTANGULAR_WAVE: "stiffness of the rectangular wave, over the mean",
        below 1.8e-8, was 1.2e-8,
        since "The projection is a sum over 20,000 cells.";

    /// Motions of the drive train that can be computed by hand.
    DRIVE_TRAIN: "drive train against a figure by hand, relative",
        below 1e-9, was 1.5e-13,
        argued "Nothing in these motions changes within a step of 10 us.";

    /// Number of integration steps in a control period of the drive train.
    DRIVE_TRAIN_PARTS: "link angle with 10 against 40 steps in a control period, over its travel",
        below 5.2e-4, was 3.5e-4,
        since "Friction and cogging follow angles and speeds with a delay of half a step, which rattling planets amplify.";

    /// Efficiency of the drive train, from the residual acceleration under balanced torques.
    EFFICIENCY: "efficiency by the residual acceleration",
        below 1e-8, was 1.3e-14,
        argued "The wind-up is damped until no oscillation is left; the two directions of power differ by 9e-4.";

    /// Mesh forces of the two damping laws.
    MESH_FORCE: "mesh force against the law by hand, relative",
        below 1e-12, was 0.0,
        argued "Deflections of micrometres between coordinates of millimetres.";

    /// Eq. 19's matrices, derived against written out.
    DERIVATION: "entries of K and C of eq. 19, dimensionless",
        below 1e-14, was 2.2e-16,
        argued "Two ways to the same few products of numbers near one.";

    /// The linear flow by two methods.
    FLOW: "entries of exp(A h) - I against nalgebra's exponential",
        below 1e-13, was 4.4e-16,
        argued "nalgebra's own error, measured on rotations.";

    /// Eigenvalues known to six digits.
    PRINTED_EIGENVALUE: "damped eigenvalue against its six digits",
        below 6.1e-7, was 4.1e-7,
        since "Half a unit of the sixth digit in each part.";

    /// Tanh dead zone of sharpness 100 against the sharp one.
    SHARP_TANH: "gap with a tanh dead zone of sharpness 100 against the sharp one, over b",
        below 3.7e-3, was 2.5e-3,
        since "Corners rounded over a hundredth of b_c.";

    /// Precise integration against 50 digits.
    PRECISE_INTEGRATION: "|E found - E| over max(1, |E|), in units of 2^-53 max(1, |A h|)",
        below 0.9, was 0.6,
        since "Twenty are allowed; the result and its fixture are each rounded once, by a unit at most.";

    /// Input integrals against 50 digits.
    PRECISE_INTEGRALS: "input integral against 50 digits, relative, in units of 2^-53 max(1, |A h|)",
        below 2.0, was 0.0,
        argued "Integrals and their fixtures are each rounded once, as the increment is.";

    /// nalgebra's exponential against precise integration.
    NALGEBRA_EXPONENTIAL: "distance to nalgebra's exponential beyond its own error, in units of 2^-53 max(1, |A h|)",
        below 0.9, was 0.6,
        since "nalgebra's own error, measured against 50 digits, reaches a million units where motion grows before it decays.";

    /// Small increments.
    DIGITS_KEPT: "diagonal of exp(A h) - I, each entry relative to itself",
        below 2.5e-16, was 0.0,
        argued "Result and fixture are each rounded once.";

    /// Eqs 1-6, eq. 19 and eq. 20 on one motion.
    FORMULATIONS: "mesh deflections by another formulation, over b_c",
        below 1e-9, was 3.4e-11,
        argued "Each integrates with an error of its own, and every hit amplifies it.";

    /// The reduced model against the full one.
    REDUCED: "entries of the flow of the reduced model against the full one's",
        below 3e-14, was 7.1e-15,
        argued "Speeds of the coasting rigid body add up over a step of 20.5; this is one unit of rounding there.";

    /// Eigenvalues of H against closed forms.
    CLOSED_FORM: "eigenvalue of H against its closed form",
        below 1e-12, was 6.1e-14,
        argued "Planet modes are a multiple eigenvalue, for which an iteration yields fewer digits.";

    /// Published frequencies of the gear that Table 1 is taken from.
    PUBLISHED_FREQUENCY: "natural frequency against the published one, relative",
        below 7.3e-5, was 4.9e-5,
        since "Published to a tenth of a hertz, of which half is 7e-5 at 743 Hz.";

    /// Torsional part of a planar gear.
    TORSIONAL_PART: "frequency of the torsional part against the model's [kHz]",
        below 2.1e-7, was 1.4e-7,
        since "The rigid body's zero is the root of a rounding error; all others agree to 3e-15.";
}
