//! Integration schemes by name, as the user types them and as reports print them.

use clap::ValueEnum;
use model_core::gears::Scheme;
use parameters::JointParameters;
use report::failure::{Failure, Outcome};

/// A scheme that moves a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SchemeName {
    /// Independent f64 integration in absolute coordinates, restarted at every contact event.
    Reference,
    /// What a board runs.
    Realtime,
    /// The paper's: one constant exponential, everything nonlinear held over the step.
    Paper,
    /// Classical Runge-Kutta.
    RungeKutta4,
    /// Semi-implicit Euler.
    Euler,
}

/// What `--scheme` takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Choice {
    /// What the board runs
    Realtime,
    /// The paper's own: a constant exponential, nonlinear forces held over the step
    Paper,
    /// Independent f64 integration that restarts at every contact event
    Reference,
    /// Classical Runge-Kutta of order 4
    Rk4,
    /// Semi-implicit Euler
    Euler,
    /// All that the joint has, with the error of each against the reference and its cost
    All,
}

impl SchemeName {
    /// All, the reference first.
    const ALL: [Self; 5] = [Self::Reference, Self::Realtime, Self::Paper, Self::RungeKutta4, Self::Euler];

    /// Schemes that can move a joint, the reference first: an equivalent gear has no meshes for the others to step.
    pub fn of_joint(joint: &JointParameters) -> &'static [Self] {
        match joint.equivalent_gear() {
            Some(_) => &[Self::Reference, Self::Realtime],
            None => &Self::ALL,
        }
    }

    /// Refuses a joint that this scheme cannot move.
    pub fn check_joint(self, joint: &JointParameters) -> Outcome<()> {
        let of_joint = Self::of_joint(joint);
        if of_joint.contains(&self) {
            return Ok(());
        }
        let names: Vec<String> = of_joint.iter().map(|scheme| format!("--scheme {}", scheme.name())).collect();
        let message = format!(
            "--scheme {} steps meshes of teeth, and joint `{}` has an equivalent gear",
            self.name(),
            joint.name
        );
        Err(Failure::new(message).with_help(format!("give {}", names.join(" or "))))
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::Realtime => "realtime",
            Self::Paper => "paper",
            Self::RungeKutta4 => "rk4",
            Self::Euler => "euler",
        }
    }

    /// What it is, in a few words.
    pub fn description(self) -> &'static str {
        match self {
            Self::Reference => "adaptive order 8 in absolute coordinates, restarted at every contact event, f64",
            Self::Realtime => "what the board runs: exponential flow, sub-steps with corrected crossings",
            Self::Paper => "the paper's: constant exponential, nonlinear forces held over the step",
            Self::RungeKutta4 => "classical Runge-Kutta of order 4",
            Self::Euler => "semi-implicit Euler",
        }
    }

    /// The core's scheme; none for the reference, which is not the core's.
    pub fn of_core(self) -> Option<Scheme> {
        match self {
            Self::Reference => None,
            Self::Realtime => Some(Scheme::Realtime),
            Self::Paper => Some(Scheme::PaperEtd1),
            Self::RungeKutta4 => Some(Scheme::RungeKutta4),
            Self::Euler => Some(Scheme::SemiImplicitEuler),
        }
    }
}

impl Choice {
    /// The word for it.
    pub fn name(self) -> &'static str {
        if self == Self::All { "all" } else { self.shown().name() }
    }

    /// The scheme whose motion is shown; of all it is the board's.
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
