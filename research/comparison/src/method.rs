//! The fixed-step methods by name: what people use, what the paper has, and the core's own step. How each moves a joint
//! is in `baselines` and in the core.

use serde::Serialize;

/// A fixed-step method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The core's step.
    Realtime,
    /// The paper's own.
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

/// Sharpness of the tanh dead zone in the comparison: eq. 13 is then 0.007 b_c off at its corners.
pub const SHARPNESS: f64 = 20.0;

impl Method {
    /// All.
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

    /// Whether it moves every mesh; else only link angle and force can be compared.
    pub fn has_meshes(self) -> bool {
        !matches!(self, Self::TwoMassSpring | Self::TwoMassRestitution)
    }

    /// In tables and pictures.
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
