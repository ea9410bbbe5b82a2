//! What is promised of a fixed step before it runs: error, instructions, memory, limits. Plain numbers that lie beside
//! the tables; where they come from is in `gears::design`, whether they suffice is the reader's judgement.

use core::fmt;

/// Parts of a tick in which contacts change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parts {
    /// Runge-Kutta sub-steps with corrected crossings.
    Substeps(u32),
    /// Leapfrog sub-steps, for light planets.
    Leaps(u32),
}

impl fmt::Display for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Substeps(count) => write!(f, "{count} corrected sub-steps"),
            Self::Leaps(count) => write!(f, "{count} leapfrog sub-steps"),
        }
    }
}

impl Parts {
    /// How many.
    pub fn count(self) -> u32 {
        let (Self::Substeps(count) | Self::Leaps(count)) = self;
        count
    }
}

/// The promise for one joint at one tick rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Fixed steps a second [Hz].
    pub tick_rate: u32,
    /// Parts of a tick while contacts change.
    pub parts: Parts,
    /// While every mesh stays on its flank.
    pub holding: ErrorPromise,
    /// While meshes part and hit.
    pub losing: ErrorPromise,
    /// Of a tick.
    pub instructions: Instructions,
    /// Flash that the tables take [byte].
    pub table_bytes: u32,
    /// RAM that the model takes between ticks [byte].
    pub model_bytes: u32,
    /// Phase of the fastest mode in a part [rad].
    pub phase: f64,
    /// Phase from which on parts would be unstable [rad].
    pub largest_phase: f64,
    /// What contact changes are not seen.
    pub unseen: Unseen,
    /// Lowest tick rate that is stable [Hz].
    pub lowest_rate: u32,
    /// Highest tick rate that the processor has time for with one sub-step; zero if none [Hz].
    pub highest_rate: u32,
}

/// RMS error of the mesh deflections over their standard deviations, for motions of 200 / omega_n that can be predicted
/// at all: a vanishing change of the start grows less than a hundredfold in them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPromise {
    /// Half of all motions stay below it.
    pub typical: f64,
    /// Nine in ten do.
    pub nine_in_ten: f64,
}

/// Instructions of a tick, of a Cortex-M4F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instructions {
    /// While every mesh stays on its flank and excitation is slow: by the exponential flow.
    pub holding: u32,
    /// In parts that see no crossing.
    pub losing: u32,
    /// Every mesh crosses in two sub-steps, or in one after an exponential tick was given up; or touches in every leap.
    pub all_crossing: u32,
    /// Every mesh crosses its gap in every part: no state of a search through a million takes more.
    pub bound: u32,
}

/// Contact changes that no look at the meshes falls into.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unseen {
    /// A mesh that leaves its flank and returns within this time may go unseen [s].
    pub duration: f64,
    /// So far beyond its flank it may go in that time, over the deflection that its load gives it; `None` where looks are
    /// half a period of the fastest mode apart or more, and anything may go unseen.
    pub departure: Option<f64>,
}
