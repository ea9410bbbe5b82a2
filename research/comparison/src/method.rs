//! Fixed-step methods by name: those in common use, the paper's, and the core's own step. They are implemented in `baselines` and in the
//! core.

use schemars::JsonSchema;
use serde::Serialize;

/// A fixed-step method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The core's step.
    Realtime,
    /// The paper's scheme.
    PaperEtd1,
    /// Classical Runge-Kutta, sharp dead zone.
    RungeKutta4,
    /// Classical Runge-Kutta, tanh dead zone.
    RungeKutta4Tanh,
    /// Semi-implicit Euler.
    Euler,
    /// Implicit trapezoid with an active set.
    Trapezoid,
    /// Two masses, one gap, spring-damper.
    TwoMassSpring,
    /// Two masses, one gap, restitution.
    TwoMassRestitution,
}

/// Sharpness of the tanh dead zone in the comparison: the corner error of eq. 13 is then 0.007 b_c.
pub const SHARPNESS: f64 = 20.0;

impl Method {
    /// All methods.
    pub const ALL: [Self; 8] = [
        Self::Realtime,
        Self::PaperEtd1,
        Self::RungeKutta4,
        Self::RungeKutta4Tanh,
        Self::Euler,
        Self::Trapezoid,
        Self::TwoMassSpring,
        Self::TwoMassRestitution,
    ];

    /// Returns true if the method moves every mesh; otherwise only link angle and force can be compared.
    pub fn has_meshes(self) -> bool {
        !matches!(self, Self::TwoMassSpring | Self::TwoMassRestitution)
    }

    /// Name in tables and pictures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Realtime => "this step",
            Self::PaperEtd1 => "the paper's (ETD1)",
            Self::RungeKutta4 => "RK4, sharp",
            Self::RungeKutta4Tanh => "RK4, tanh",
            Self::Euler => "semi-implicit Euler",
            Self::Trapezoid => "trapezoid, active set",
            Self::TwoMassSpring => "two masses, spring-damper",
            Self::TwoMassRestitution => "two masses, restitution",
        }
    }
}
