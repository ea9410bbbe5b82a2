//! Certificate of a fixed step: instructions, memory and stability limits, known before the step runs. `gears::design`
//! computes the certificate together with the tables. `joint check` and `joint budget` measure the error.

use core::fmt;

/// Method and number of the sub-steps of a tick in which contacts change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Substeps {
    /// Runge-Kutta sub-steps with corrected crossings.
    Corrected(u32),
    /// Position-Verlet (leapfrog) sub-steps, for light planets, or if the processor has no time for corrected sub-steps.
    Verlet(u32),
}

impl fmt::Display for Substeps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corrected(count) => write!(f, "{count} corrected sub-steps"),
            Self::Verlet(count) => write!(f, "{count} leapfrog sub-steps"),
        }
    }
}

impl Substeps {
    /// Returns the number of sub-steps.
    pub fn count(self) -> u32 {
        let (Self::Corrected(count) | Self::Verlet(count)) = self;
        count
    }

    /// Returns the name of the method.
    pub fn method(self) -> &'static str {
        match self {
            Self::Corrected(_) => "corrected",
            Self::Verlet(_) => "leapfrog",
        }
    }
}

/// Certificate of one joint at one tick rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Ticks per second [Hz].
    pub tick_rate: u32,
    /// Sub-steps of a tick while contacts change.
    pub substeps: Substeps,
    /// Instructions of a tick.
    pub instructions: Instructions,
    /// Size of the tables in flash [byte].
    pub table_bytes: u32,
    /// Size of the model in RAM, without stack [byte].
    pub model_bytes: u32,
    /// Phase of the fastest mode in a sub-step [rad].
    pub phase: f64,
    /// Stability limit of `phase` [rad].
    pub largest_phase: f64,
    /// Contact changes that may not be detected.
    pub unseen: Unseen,
    /// Lowest tick rate that is stable [Hz].
    pub lowest_rate: u32,
}

/// Instructions of a tick on a Cortex-M4F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instructions {
    /// Tick in which every mesh stays on its flank and the excitation is slow: exponential tick, or sub-steps if cheaper.
    pub contact_holds: u32,
    /// Tick in sub-steps without a crossing.
    pub contact_changes: u32,
    /// Tick in which every mesh crosses in two sub-steps, or in one sub-step after an abandoned exponential tick; or
    /// touches its flank in every Verlet sub-step.
    pub all_crossing: u32,
    /// Tick in which every mesh crosses its gap in every sub-step: an upper bound on all states of a search through a
    /// million states.
    pub bound: u32,
}

/// Contact changes that begin and end between two checks of the meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unseen {
    /// Time between two checks of the meshes: a mesh that leaves its flank and returns within it may not be detected [s].
    pub duration: f64,
    /// Largest undetected distance of a mesh from its flank, over the deflection by the load; `None` (no limit) if checks
    /// are half a period of the fastest mode apart or more.
    pub departure: Option<f64>,
}
