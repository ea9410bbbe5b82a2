//! How fast a joint must be stepped: sub-steps a tick from its fastest mode, a prescribed mesh frequency and what a
//! board has time for. The rates that follow from it are for reports; the step itself knows only the sub-steps.

use crate::design::modes;
use crate::error::DesignError;
use crate::joint::{Excitation, JointParameters};
use crate::mesh::MESH_KINDS;

/// Sub-steps resolve the fastest mode at least this well (its phase a sub-step) [rad]: there the crossing correction
/// leaves a few 1e-4 of the motion.
const GOOD_PHASE: f64 = 0.4;
/// Beyond this many sub-steps the fastest mode is left to what stability asks: it is that of light planets, which
/// carry little of the motion.
const USUAL_SUBSTEPS: f64 = 4.0;
/// Phase of a prescribed mesh frequency that a sub-step may have: some twenty evaluations a mesh period [rad].
const EXCITATION_PHASE: f64 = 0.3;
/// Phase of the fastest mode that a sub-step may have at most; the Runge-Kutta method is stable to 2.8 [rad].
const LARGEST_PHASE: f64 = 2.4;
/// Beyond this phase of the fastest mode in a sub-step, Runge-Kutta steps damp it away and bounces of light planets with
/// it; leapfrog sub-steps of at most the second take over [rad].
const DAMPED_PHASE: f64 = 1.0;
const LEAP_PHASE: f64 = 1.1;
/// Most sub-steps a tick.
const MOST_SUBSTEPS: f64 = 16.0;

/// Instructions a second that a board may spend on the step: a Cortex-M4F at 168 MHz and 1.4 cycles an instruction.
const BOARD_INSTRUCTIONS: f64 = 120e6;
/// Instructions of a tick beside its sub-steps, and of a sub-step for each planet when some of its meshes cross;
/// counted on an emulated Cortex-M4F.
const TICK_INSTRUCTIONS: f64 = 1000.0;
const SUBSTEP_INSTRUCTIONS: f64 = 700.0;

/// How much work a tick may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// What a 168 MHz Cortex-M4F has time for, as long as that is stable.
    Board,
    /// What accuracy asks for.
    Accurate,
    /// So many sub-steps a tick, for comparisons; whether that is stable is the caller's concern.
    Substeps(u32),
}

/// What sets the pace of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Fastest mode at the stiffest moment of the ripple [rad/s].
    fastest: f64,
    /// Prescribed mesh frequency; zero in `angle` mode, where the joint's speed keeps it far below the modes [rad/s].
    mesh_frequency: f64,
    planets: f64,
}

impl Pace {
    /// Pace of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let fastest = modes::natural_frequencies(parameters).last().copied().unwrap_or(0.0);
        let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
        Self {
            fastest: fastest * libm::sqrt(1.0 + swings[0].max(swings[1])),
            mesh_frequency: match parameters.excitation {
                Excitation::Time { mesh_frequency } => mesh_frequency,
                Excitation::Angle => 0.0,
            },
            planets: parameters.geometry.planets as f64,
        }
    }

    /// Sub-steps of a tick.
    pub fn substeps(&self, tick_rate: u32, effort: Effort) -> Result<u32, DesignError> {
        if let Effort::Substeps(substeps) = effort {
            return Ok(substeps.clamp(1, MOST_SUBSTEPS as u32));
        }
        let lowest = self.lowest_rate(effort);
        if tick_rate < lowest {
            return Err(DesignError::RateTooLow { given: tick_rate, lowest });
        }
        let rate = f64::from(tick_rate);
        let accurate = libm::ceil(self.fastest / (rate * GOOD_PHASE))
            .min(USUAL_SUBSTEPS)
            .max(libm::ceil(self.mesh_frequency / (rate * EXCITATION_PHASE)));
        let affordable = match effort {
            Effort::Accurate | Effort::Substeps(_) => MOST_SUBSTEPS,
            Effort::Board => {
                libm::floor((BOARD_INSTRUCTIONS / rate - TICK_INSTRUCTIONS) / (SUBSTEP_INSTRUCTIONS * self.planets))
            }
        };
        let stable = libm::ceil(self.fastest / (rate * LARGEST_PHASE));
        Ok(accurate.min(affordable).min(MOST_SUBSTEPS).max(stable).max(1.0) as u32)
    }

    /// Leapfrog sub-steps of a tick; none where the usual sub-steps resolve the fastest mode, or where
    /// time does not matter.
    pub fn leaps(&self, tick_rate: u32, substeps: u32, effort: Effort) -> u32 {
        if effort == Effort::Board && self.phase(tick_rate, substeps) > DAMPED_PHASE {
            libm::ceil(self.phase(tick_rate, 1) / LEAP_PHASE) as u32
        } else {
            0
        }
    }

    /// Lowest tick rate that is accepted [Hz].
    pub fn lowest_rate(&self, effort: Effort) -> u32 {
        let stable = self.fastest / LARGEST_PHASE;
        let wanted = match effort {
            Effort::Board | Effort::Substeps(_) => stable,
            Effort::Accurate => stable.max(self.mesh_frequency / EXCITATION_PHASE),
        };
        libm::ceil(wanted / MOST_SUBSTEPS).max(1.0) as u32
    }

    /// Lowest tick rate at which the usual number of sub-steps resolves everything [Hz].
    pub fn recommended_rate(&self) -> u32 {
        let wanted = (self.fastest / GOOD_PHASE).max(self.mesh_frequency / EXCITATION_PHASE);
        libm::ceil(wanted / USUAL_SUBSTEPS).max(1.0) as u32
    }

    /// Phase of the fastest mode in a sub-step [rad].
    pub fn phase(&self, tick_rate: u32, substeps: u32) -> f64 {
        self.fastest / (f64::from(tick_rate) * f64::from(substeps))
    }
}
