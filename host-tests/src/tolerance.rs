//! Every bound that a test of this workspace holds a number against, with the value measured when it was set and the
//! reason why it is not tighter. Tests keep no tolerances of their own.

pub mod certificate;
pub mod compensation;
pub mod core;
pub mod light_planets;
pub mod observer;

/// An upper limit on the size of an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// What the error is of, and over what.
    pub of: &'static str,
    /// The error must be below this.
    pub limit: f64,
    /// What was found when the bound was set (x86-64 Linux, f64 unless said).
    pub measured: f64,
    /// Why there is a margin, or none.
    pub reason: &'static str,
}

impl Bound {
    /// Passes an error that is below the limit.
    ///
    /// # Panics
    /// If it is not, or is NaN; the message says what was measured when the bound was set.
    #[track_caller]
    pub fn check(&self, error: f64) {
        println!("{}: {error:.2e} (limit {:.0e}, was {:.1e})", self.of, self.limit, self.measured);
        assert!(
            error.abs() < self.limit,
            "{}: {error:e} is not below {:e}; it was {:e} when the bound was set. {}",
            self.of,
            self.limit,
            self.measured,
            self.reason
        );
    }
}

/// Reference against the data files of cases A and Q.
pub const CASE_DATA: Bound = Bound {
    of: "trajectory error of the reference on cases A and Q, over the standard deviation",
    limit: 1e-9,
    measured: 9.5e-12,
    reason: "The files carry twelve digits; a missed event would show as 1e-3.",
};

/// Growth of a vanishing change in a predictable motion.
pub const PREDICTABILITY: Bound = Bound {
    of: "change of mesh deflections over the change of 1e-12 m that caused it",
    limit: 100.0,
    measured: 62.6,
    reason: "Where errors grow more, a bound on a trajectory would judge the motion instead of the integrator.",
};

/// Energy balance of the reference.
pub const BOOKS_OF_THE_REFERENCE: Bound = Bound {
    of: "residual of the reference's energy balance over what is dissipated",
    limit: 1e-10,
    measured: 2.6e-12,
    reason: "The integration's own error.",
};

/// Swing of the paper's joint, simulated as the board does.
pub const SIM_PEAK_TO_PEAK: Bound = Bound {
    of: "peak to peak of the sun-planet deflection in set P's regular regimes against five known digits, relative",
    limit: 1e-3,
    measured: 4.7e-5,
    reason: "Ticks may miss a crest by a 96th of a mesh period, which is 5e-4 of the swing.",
};

/// Power beside the mesh frequency.
pub const SIM_NON_FUNDAMENTAL: Bound = Bound {
    of: "non-fundamental over fundamental in set P's regular regimes against what is printed",
    limit: 6e-3,
    measured: 1.1e-3,
    reason: "Half a unit of the last digit printed.",
};

/// Static deflection and force of a joint that stands.
pub const SIM_STATIC: Bound = Bound {
    of: "mesh force and deflection of a standing joint against oracle 4, relative",
    limit: 1e-7,
    measured: 7.9e-14,
    reason: "Torques are rounded to f32 on their way to the joint; the ones tried lose nothing by it.",
};

/// Undamped natural frequencies.
pub const NATURAL_FREQUENCY: Bound = Bound {
    of: "natural frequency, relative",
    limit: 1e-9,
    measured: 3.0e-11,
    reason: "Fitted exactly from samples; only the integration's own error is left.",
};

/// Damped eigenvalues against printed ones.
pub const EIGENVALUE: Bound = Bound {
    of: "damped eigenvalue over omega_n",
    limit: 1e-6,
    measured: 4.1e-7,
    reason: "The expected values are known to six digits after the point.",
};

/// Amplitudes of the steady ellipse against printed ones.
pub const ELLIPSE: Bound = Bound {
    of: "amplitude of the steady ellipse, over b_c",
    limit: 1e-6,
    measured: 7.5e-8,
    reason: "The expected values are known to six digits after the point.",
};

/// Whatever is no pure harmonic in the steady ellipse.
pub const ELLIPSE_PURITY: Bound = Bound {
    of: "distance from a pure ellipse, over b_c",
    limit: 1e-9,
    measured: 3.0e-11,
    reason: "The transient has fallen by exp(-0.0323 x 800); what is left is integration error.",
};

/// Static deflection, gap coordinate and lost motion.
pub const STATIC: Bound = Bound {
    of: "static deflection, over b_c",
    limit: 1e-11,
    measured: 1.6e-14,
    reason: "The transient has fallen by exp(-33) or more.",
};

/// Energy against the work that was done.
pub const ENERGY: Bound = Bound {
    of: "energy less work, over the largest energy",
    limit: 1e-8,
    measured: 1.2e-9,
    reason: "Adds up over a thousand dimensionless seconds of chaos with a thousand events; 1e-11 in shorter motions.",
};

/// The same motion at another backlash, or with everything scaled.
pub const INVARIANCE: Bound = Bound {
    of: "difference of two motions that must be the same, over b_c",
    limit: 1e-9,
    measured: 1.5e-11,
    reason: "Step sizes and event times differ between the two.",
};

/// Free periods of one mass in a dead zone.
pub const FREE_PERIOD: Bound = Bound {
    of: "free period of one mass in a dead zone, relative",
    limit: 1e-11,
    measured: 4.6e-13,
    reason: "The closed form is exact; twenty periods with up to eight events each add up.",
};

/// Poincare points of set P against printed ones.
pub const POINCARE: Bound = Bound {
    of: "Poincare point of set P, dimensionless",
    limit: 1e-4,
    measured: 5.2e-5,
    reason: "The expected values are known to four digits after the point, so 5e-5 is theirs.",
};

/// Planets in phase, or out of it by a fraction of a tooth.
pub const TOOTH_PHASE: Bound = Bound {
    of: "deflection of a planet against the one that its tooth phase predicts, over b_c",
    limit: 1e-10,
    measured: 2.3e-12,
    reason: "Steady state of a linear joint; only integration error and the rest of the transient are left.",
};

/// The same motion many turns later.
pub const MANY_TURNS: Bound = Bound {
    of: "difference of mesh deflections after many turns, over b_c",
    limit: 1e-9,
    measured: 3.7e-11,
    reason: "Coordinates stay within a tooth, so that no digits are lost however far the joint has turned.",
};

/// Stiffness of the rectangular wave against a projection of its picture.
pub const RECTANGULAR_WAVE: Bound = Bound {
    of: "stiffness of the rectangular wave, over the mean",
    limit: 1e-7,
    measured: 1.1e-8,
    reason: "The projection is a sum over 20,000 cells.",
};

/// Motions of the drive train that can be computed by hand.
pub const DRIVE_TRAIN: Bound = Bound {
    of: "drive train against a figure by hand, relative",
    limit: 1e-9,
    measured: 1.5e-13,
    reason: "Nothing in these motions changes within a part of 10 us.",
};

/// Parts of a control period in the drive train.
pub const DRIVE_TRAIN_PARTS: Bound = Bound {
    of: "link angle with 10 against 40 parts in a control period, over its travel",
    limit: 1e-2,
    measured: 4.4e-3,
    reason: "Friction and cogging follow angles and speeds with a delay of half a part, and rattling planets amplify it.",
};

/// Efficiency of the drive train, from the acceleration that is left under balanced torques.
pub const EFFICIENCY: Bound = Bound {
    of: "efficiency by the acceleration left over",
    limit: 1e-8,
    measured: 1.3e-14,
    reason: "The wind-up is damped until nothing rings; the two directions of power differ by 9e-4.",
};

/// Mesh forces of the two damping laws.
pub const MESH_FORCE: Bound = Bound {
    of: "mesh force against the law by hand, relative",
    limit: 1e-12,
    measured: 0.0,
    reason: "Deflections of micrometres between coordinates of millimetres.",
};

/// Eq. 19's matrices, derived against written out.
pub const DERIVATION: Bound = Bound {
    of: "entries of K and C of eq. 19, dimensionless",
    limit: 1e-14,
    measured: 2.2e-16,
    reason: "Two ways to the same few products of numbers near one.",
};

/// The linear flow by two methods.
pub const FLOW: Bound = Bound {
    of: "entries of exp(A h) - I against nalgebra's exponential",
    limit: 1e-13,
    measured: 4.4e-16,
    reason: "nalgebra's own error, measured on rotations.",
};

/// Eigenvalues known to six digits.
pub const PRINTED_EIGENVALUE: Bound = Bound {
    of: "damped eigenvalue against its six digits",
    limit: 1e-6,
    measured: 4.1e-7,
    reason: "Half a unit of the sixth digit in each part.",
};

/// Tanh dead zone of sharpness 100 against the sharp one.
pub const SHARP_TANH: Bound = Bound {
    of: "gap with a tanh dead zone of sharpness 100 against the sharp one, over b",
    limit: 1e-2,
    measured: 2.2e-3,
    reason: "Corners rounded over a hundredth of b_c.",
};

/// Precise integration against 50 digits.
pub const PRECISE_INTEGRATION: Bound = Bound {
    of: "|E found - E| over max(1, |E|), in units of 2^-53 max(1, |A h|)",
    limit: 2.0,
    measured: 0.6,
    reason: "Twenty are allowed; the result and its fixture are each rounded once, by a unit at most.",
};

/// Input integrals against 50 digits.
pub const PRECISE_INTEGRALS: Bound = Bound {
    of: "input integral against 50 digits, relative, in units of 2^-53 max(1, |A h|)",
    limit: 2.0,
    measured: 0.0,
    reason: "As for the increment.",
};

/// nalgebra's exponential against precise integration.
pub const NALGEBRA_EXPONENTIAL: Bound = Bound {
    of: "distance to nalgebra's exponential beyond its own error, in units of 2^-53 max(1, |A h|)",
    limit: 2.0,
    measured: 0.6,
    reason: "Its own error, measured against 50 digits, reaches a million units where motion grows before it decays.",
};

/// Small increments.
pub const DIGITS_KEPT: Bound = Bound {
    of: "diagonal of exp(A h) - I, each entry relative to itself",
    limit: 2.5e-16,
    measured: 0.0,
    reason: "Rounded once, and its fixture too.",
};

/// Eqs 1-6, eq. 19 and eq. 20 as one motion.
pub const FORMULATIONS: Bound = Bound {
    of: "mesh deflections by another formulation, over b_c",
    limit: 1e-9,
    measured: 3.4e-11,
    reason: "Each integrates with an error of its own, and every hit amplifies it.",
};

/// The reduced model against the full one.
pub const REDUCED: Bound = Bound {
    of: "entries of the flow of the reduced model against the full one's",
    limit: 3e-14,
    measured: 7.1e-15,
    reason: "Speeds of the coasting rigid body add up over 20.5: one unit of that.",
};

/// Eigenvalues of H against closed forms.
pub const CLOSED_FORM: Bound = Bound {
    of: "eigenvalue of H against its closed form",
    limit: 1e-12,
    measured: 6.1e-14,
    reason: "Planet modes are a multiple eigenvalue, which an iteration finds to fewer digits.",
};

/// Published frequencies of the gear that Table 1 is taken from.
pub const PUBLISHED_FREQUENCY: Bound = Bound {
    of: "natural frequency against the published one, relative",
    limit: 1e-4,
    measured: 4.9e-5,
    reason: "Published to a tenth of a hertz, of which half is 7e-5 at 743 Hz.",
};

/// Torsional part of a planar gear.
pub const TORSIONAL_PART: Bound = Bound {
    of: "frequency of the torsional part against the model's [kHz]",
    limit: 1e-6,
    measured: 1.3e-7,
    reason: "The rigid body's zero is the root of a rounding error; all others agree to 3e-15.",
};
