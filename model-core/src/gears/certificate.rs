//! The certificate of a fixed step, known before it runs: instructions, memory, stability limits. Plain numbers that accompany
//! the tables; `gears::design` computes them. The error is measured, by `joint check` and `joint budget`.

use core::fmt;

/// The sub-steps of a tick in which contacts change: by which method, and how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Substeps {
    /// Runge-Kutta sub-steps with corrected crossings.
    Corrected(u32),
    /// Position-Verlet (leapfrog) sub-steps, for light planets, and where there is no time for corrected ones.
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
    /// How many.
    pub fn count(self) -> u32 {
        let (Self::Corrected(count) | Self::Verlet(count)) = self;
        count
    }

    /// The method in one word.
    pub fn method(self) -> &'static str {
        match self {
            Self::Corrected(_) => "corrected",
            Self::Verlet(_) => "leapfrog",
        }
    }
}

/// The certificate of one joint at one tick rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Fixed steps a second [Hz].
    pub tick_rate: u32,
    /// Sub-steps of a tick while contacts change.
    pub substeps: Substeps,
    /// Of a tick.
    pub instructions: Instructions,
    /// Flash that the tables take [byte].
    pub table_bytes: u32,
    /// RAM that the model takes between ticks [byte].
    pub model_bytes: u32,
    /// Phase of the fastest mode in a sub-step [rad].
    pub phase: f64,
    /// Phase from which on sub-steps would be unstable [rad].
    pub largest_phase: f64,
    /// Contact changes that may go unnoticed.
    pub unseen: Unseen,
    /// Lowest tick rate that is stable [Hz].
    pub lowest_rate: u32,
}

/// Instructions of a tick, of a Cortex-M4F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instructions {
    /// While every mesh stays on its flank and excitation is slow: by the exponential flow.
    pub contact_holds: u32,
    /// In sub-steps, none of which has a crossing.
    pub contact_changes: u32,
    /// Every mesh crosses in two sub-steps, or in one after an exponential tick was given up; or touches in every
    /// Verlet sub-step.
    pub all_crossing: u32,
    /// Every mesh crosses its gap in every sub-step: an upper bound on every state of a search through a million.
    pub bound: u32,
}

/// Contact changes that begin and end between two checks of the meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unseen {
    /// A mesh that leaves its flank and returns within this time may go unseen [s].
    pub duration: f64,
    /// So far beyond its flank it may go in that time, over the deflection that its load gives it; `None` where checks are
    /// half a period of the fastest mode apart or more: then there is no limit.
    pub departure: Option<f64>,
}
