//! Integrators that a host program takes from a library, each over the same compiled right-hand side: `cvode` (Adams),
//! `stiff` (diffsol's BDF and its explicit method), `explicit` (differential-equations). `timing` times them beside the
//! fixed-step methods. Cases with a prescribed phase, torques that do not change and no compliance only.

#[cfg(feature = "cvode")]
mod cvode;
mod equations;
mod explicit;
mod stiff;
pub mod timing;

pub use equations::Equations;

/// A library's method with its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Library {
    /// SUNDIALS CVODE, Adams with fixed-point iteration.
    CvodeAdams,
    /// The same, restarted at every crossing, which its root finding finds.
    CvodeAdamsRestarted,
    /// diffsol, BDF with an analytic Jacobian.
    DiffsolBdf,
    /// diffsol, explicit, Tsitouras 4(5).
    DiffsolTsit45,
    /// differential-equations, Dormand-Prince 5(4).
    Dopri5,
    /// differential-equations, Dormand-Prince 8(5,3).
    Dop853,
    /// differential-equations, Cash-Karp 5(4).
    CashKarp,
}

impl Library {
    /// All that this build has.
    pub const ALL: &[Self] = &[
        #[cfg(feature = "cvode")]
        Self::CvodeAdams,
        #[cfg(feature = "cvode")]
        Self::CvodeAdamsRestarted,
        Self::DiffsolBdf,
        Self::DiffsolTsit45,
        Self::Dopri5,
        Self::Dop853,
        Self::CashKarp,
    ];

    /// In tables and pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::CvodeAdams => "CVODE Adams",
            Self::CvodeAdamsRestarted => "CVODE Adams, restarted at crossings",
            Self::DiffsolBdf => "diffsol BDF",
            Self::DiffsolTsit45 => "diffsol tsit45",
            Self::Dopri5 => "differential-equations dopri5",
            Self::Dop853 => "differential-equations dop853",
            Self::CashKarp => "differential-equations Cash-Karp",
        }
    }

    /// Integrates from time zero at a tolerance, relative and absolute alike: the state at each of the given times.
    pub fn solve<const N: usize, const D: usize>(
        self,
        equations: &Equations<N, D>,
        times: &[f64],
        tolerance: f64,
    ) -> Result<Vec<[f64; D]>, String> {
        match self {
            #[cfg(feature = "cvode")]
            Self::CvodeAdams => cvode::solve(equations, times, tolerance, false),
            #[cfg(feature = "cvode")]
            Self::CvodeAdamsRestarted => cvode::solve(equations, times, tolerance, true),
            #[cfg(not(feature = "cvode"))]
            Self::CvodeAdams | Self::CvodeAdamsRestarted => Err("built without CVODE".into()),
            Self::DiffsolBdf => stiff::bdf(equations, times, tolerance),
            Self::DiffsolTsit45 => stiff::tsit45(equations, times, tolerance),
            Self::Dopri5 | Self::Dop853 | Self::CashKarp => explicit::solve(self, equations, times, tolerance),
        }
    }
}
