//! Solves the equations by the selected method of a library.

#[cfg(feature = "cvode")]
use super::cvode;
use super::equations::Equations;
use super::library::Library;
use super::{explicit, stiff};

impl Library {
    /// Integrates from time zero at a tolerance, relative and absolute: the state at each of the given times.
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
