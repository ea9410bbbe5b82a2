//! Integration schemes by name, on the command line and in reports.

use clap::ValueEnum;
use model_core::gears::Scheme;
use parameters::JointParameters;
use report::failure::{Failure, Outcome};

/// An integration scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SchemeName {
    /// Independent f64 integration in absolute coordinates, restarted at every contact event.
    Reference,
    /// Scheme of a board.
    Realtime,
    /// Scheme of the paper: one constant exponential, with nonlinear forces held over the step.
    Paper,
    /// Classical Runge-Kutta.
    RungeKutta4,
    /// Semi-implicit Euler.
    Euler,
}

/// Values of `--scheme`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemeChoice {
    /// Scheme of the board
    Realtime,
    /// Scheme of the paper: constant exponential, nonlinear forces held over the step
    Paper,
    /// Independent f64 integration that restarts at every contact event
    Reference,
    /// Classical Runge-Kutta of order 4
    Rk4,
    /// Semi-implicit Euler
    Euler,
    /// All schemes of the joint, each with its cost and its error against the reference
    All,
}

impl SchemeName {
    /// All schemes, the reference first.
    const ALL: [Self; 5] = [Self::Reference, Self::Realtime, Self::Paper, Self::RungeKutta4, Self::Euler];

    /// Schemes for a joint, the reference first: an equivalent gear has no meshes for the others to step.
    pub fn for_joint(joint: &JointParameters) -> &'static [Self] {
        match joint.equivalent_gear() {
            Some(_) => &[Self::Reference, Self::Realtime],
            None => &Self::ALL,
        }
    }

    /// Rejects a joint that this scheme cannot step.
    pub fn check_joint(self, joint: &JointParameters) -> Outcome<()> {
        let schemes = Self::for_joint(joint);
        if schemes.contains(&self) {
            return Ok(());
        }
        let names: Vec<String> = schemes.iter().map(|scheme| format!("--scheme {}", scheme.name())).collect();
        let message = format!(
            "--scheme {} steps meshes of teeth, and joint `{}` has an equivalent gear",
            self.name(),
            joint.name
        );
        Err(Failure::new(message).with_help(format!("give {}", names.join(" or "))))
    }

    /// Word on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::Realtime => "realtime",
            Self::Paper => "paper",
            Self::RungeKutta4 => "rk4",
            Self::Euler => "euler",
        }
    }

    /// Short description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Reference => "adaptive order 8 in absolute coordinates, restarted at every contact event, f64",
            Self::Realtime => "scheme of the board: exponential flow, sub-steps with corrected crossings",
            Self::Paper => "the paper's: constant exponential, nonlinear forces held over the step",
            Self::RungeKutta4 => "classical Runge-Kutta of order 4",
            Self::Euler => "semi-implicit Euler",
        }
    }

    /// Scheme of the core; `None` for the reference.
    pub fn core_scheme(self) -> Option<Scheme> {
        match self {
            Self::Reference => None,
            Self::Realtime => Some(Scheme::Realtime),
            Self::Paper => Some(Scheme::PaperEtd1),
            Self::RungeKutta4 => Some(Scheme::RungeKutta4),
            Self::Euler => Some(Scheme::SemiImplicitEuler),
        }
    }
}

impl SchemeChoice {
    /// Word on the command line.
    pub fn name(self) -> &'static str {
        if self == Self::All { "all" } else { self.shown().name() }
    }

    /// Scheme whose motion is shown; for `all` the board's.
    pub fn shown(self) -> SchemeName {
        match self {
            Self::Realtime | Self::All => SchemeName::Realtime,
            Self::Paper => SchemeName::Paper,
            Self::Reference => SchemeName::Reference,
            Self::Rk4 => SchemeName::RungeKutta4,
            Self::Euler => SchemeName::Euler,
        }
    }
}
