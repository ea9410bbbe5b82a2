//! The libraries' methods by name.

/// Method of a library with its settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Library {
    /// SUNDIALS CVODE, Adams with fixed-point iteration.
    CvodeAdams,
    /// SUNDIALS CVODE, Adams with fixed-point iteration, restarted at every crossing found by its root finding.
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
    /// All methods of this build.
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

    /// Name in tables and pictures.
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
}
