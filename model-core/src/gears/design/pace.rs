//! How fast a joint must be stepped: sub-steps a tick from its fastest mode, a prescribed mesh frequency, stability and
//! what a processor has time for. The rates that follow from it are for reports; the step itself knows only the sub-steps.

use core::array;

pub use crate::gears::certificate::Parts;
use crate::gears::design::cost::Cost;
use crate::gears::design::error::DesignError;
use crate::gears::design::modes;
use crate::gears::design::processor::Processor;
use crate::gears::design::stability::{self, MARGIN};
use crate::gears::mechanics::Mechanics;
use crate::gears::stiffness_series::StiffnessSeries;
use parameters::{DeadZone, Excitation, JointParameters, MESH_KINDS};

/// Sub-steps resolve the fastest mode at least this well (its phase a sub-step) [rad]: there the crossing correction
/// leaves a few 1e-4 of the motion.
const GOOD_PHASE: f64 = 0.4;
/// Beyond this many sub-steps the fastest mode is left to what stability asks: it is that of light planets, which
/// carry little of the motion.
const USUAL_SUBSTEPS: f64 = 4.0;
/// Phase of a prescribed mesh frequency that a sub-step may have: some twenty evaluations a mesh period [rad].
const EXCITATION_PHASE: f64 = 0.3;
/// Beyond this phase of the fastest mode in a sub-step, Runge-Kutta steps damp it away and bounces of light planets with
/// it; leapfrog sub-steps of at most the second take over [rad].
const DAMPED_PHASE: f64 = 1.0;
const LEAP_PHASE: f64 = 1.0;
/// Most sub-steps a tick.
const MOST_SUBSTEPS: usize = 16;

/// How much work a tick may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// What an STM32F405 has time for, as long as that is stable.
    Board,
    /// The same for another processor.
    Within(Processor),
    /// What accuracy asks for.
    Accurate,
    /// So many sub-steps a tick, for comparisons; whether that is stable is the caller's concern.
    Substeps(u32),
    /// So many leaps a tick, likewise.
    Leaps(u32),
}

/// What sets the pace of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pace {
    /// Fastest mode at the stiffest moment of the ripple [rad/s].
    fastest: f64,
    /// Prescribed mesh frequency; zero in `angle` mode, where the joint's speed keeps it far below the modes [rad/s].
    mesh_frequency: f64,
    cost: Cost,
    /// Leaps know the sharp dead zone alone.
    sharp: bool,
    /// Phase of the fastest mode that a sub-step may have, by the number of sub-steps of a tick from 1 on [rad].
    largest_phases: [f64; MOST_SUBSTEPS],
    /// The same of a leap [rad].
    largest_leap: f64,
}

impl Pace {
    /// Pace of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let fastest = modes::natural_frequencies(parameters).last().copied().unwrap_or(0.0);
        let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
        let fastest = fastest * libm::sqrt(1.0 + swings[0].max(swings[1]));
        // Of a mode that the meshes carry: C = (c / k) K gives it the damping ratio omega c / 2 k.
        let relaxations =
            MESH_KINDS.map(|kind| parameters.damping_coefficient(kind) / parameters.mesh(kind).mean_stiffness);
        let damping_ratio = 0.5 * fastest * relaxations[0].max(relaxations[1]);
        // Ticks may each begin anew, or go on from one another without end.
        let without_end = stability::largest_phase(damping_ratio, stability::WITHOUT_END);
        Self {
            fastest,
            mesh_frequency: match parameters.excitation {
                Excitation::Time { mesh_frequency } => mesh_frequency,
                Excitation::Angle => 0.0,
            },
            cost: Cost::new(parameters),
            sharp: parameters.dead_zone == DeadZone::Sharp,
            largest_phases: array::from_fn(|i| without_end.min(stability::largest_phase(damping_ratio, i as u32 + 1))),
            largest_leap: stability::largest_leap(damping_ratio),
        }
    }

    /// Sub-steps of a tick.
    pub fn substeps(&self, tick_rate: u32, effort: Effort) -> Result<u32, DesignError> {
        if let Effort::Substeps(substeps) | Effort::Leaps(substeps) = effort {
            return Ok(substeps.clamp(1, MOST_SUBSTEPS as u32));
        }
        let lowest = self.lowest_rate(effort);
        if tick_rate < lowest {
            return Err(DesignError::RateTooLow { given: tick_rate, lowest });
        }
        let rate = f64::from(tick_rate);
        let accurate = libm::ceil(self.fastest / (rate * GOOD_PHASE))
            .min(USUAL_SUBSTEPS)
            .max(libm::ceil(self.mesh_frequency / (rate * EXCITATION_PHASE))) as u32;
        let within = |processor: Processor| self.cost.affordable(processor.affordable(tick_rate), MOST_SUBSTEPS as u32);
        let affordable = match effort {
            Effort::Accurate | Effort::Substeps(_) | Effort::Leaps(_) => MOST_SUBSTEPS as u32,
            Effort::Board => within(Processor::STM32F405),
            Effort::Within(processor) => within(processor),
        };
        let wanted = accurate.min(affordable).clamp(1, MOST_SUBSTEPS as u32);
        let stable = |substeps: &u32| {
            self.phase(tick_rate, *substeps) <= MARGIN * self.largest_phase(Parts::Substeps(*substeps))
        };
        // Limits differ by the number of sub-steps, so the next may be stable where one more is not.
        Ok((wanted..=MOST_SUBSTEPS as u32).find(stable).or((1..wanted).rev().find(stable)).unwrap_or(wanted))
    }

    /// Parts of a tick where contacts change. Leaps take over where sub-steps would damp the fastest mode away, if the
    /// processor has time for them or they are the cheaper of two that it has no time for.
    pub fn parts(&self, tick_rate: u32, effort: Effort) -> Result<Parts, DesignError> {
        let substeps = self.substeps(tick_rate, effort)?;
        let processor = match effort {
            Effort::Board => Processor::STM32F405,
            Effort::Within(processor) => processor,
            Effort::Accurate | Effort::Substeps(_) => return Ok(Parts::Substeps(substeps)),
            Effort::Leaps(leaps) => return Ok(Parts::Leaps(leaps.max(1))),
        };
        let substeps = Parts::Substeps(substeps);
        let leaps = Parts::Leaps(libm::ceil(self.phase(tick_rate, 1) / LEAP_PHASE) as u32);
        let resolved = self.phase(tick_rate, substeps.count()) <= DAMPED_PHASE;
        let budget = processor.affordable(tick_rate).max(self.cost.all_crossing(substeps));
        let affordable = self.cost.all_crossing(leaps) <= budget;
        Ok(if self.sharp && !resolved && affordable { leaps } else { substeps })
    }

    /// Lowest tick rate that is accepted [Hz].
    pub fn lowest_rate(&self, effort: Effort) -> u32 {
        let reach = (1..).zip(self.largest_phases).map(|(substeps, largest)| f64::from(substeps) * MARGIN * largest);
        let stable = self.fastest / reach.fold(0.0, f64::max);
        let wanted = match effort {
            Effort::Board | Effort::Within(_) | Effort::Substeps(_) | Effort::Leaps(_) => stable,
            Effort::Accurate => stable.max(self.mesh_frequency / (EXCITATION_PHASE * MOST_SUBSTEPS as f64)),
        };
        libm::ceil(wanted).max(1.0) as u32
    }

    /// Lowest tick rate at which the usual number of sub-steps resolves everything [Hz].
    pub fn recommended_rate(&self) -> u32 {
        let wanted = (self.fastest / GOOD_PHASE).max(self.mesh_frequency / EXCITATION_PHASE);
        libm::ceil(wanted / USUAL_SUBSTEPS).max(1.0) as u32
    }

    /// Phase of the fastest mode in a part from which on a tick of such parts is unstable [rad].
    pub fn largest_phase(&self, parts: Parts) -> f64 {
        match parts {
            Parts::Substeps(substeps) => self.largest_phases[(substeps.max(1) as usize - 1).min(MOST_SUBSTEPS - 1)],
            Parts::Leaps(_) => self.largest_leap,
        }
    }

    /// Instructions of a tick.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Prescribed mesh frequency; zero in `angle` mode [rad/s].
    pub(super) fn mesh_frequency(&self) -> f64 {
        self.mesh_frequency
    }

    /// Phase of the fastest mode in a sub-step [rad].
    pub fn phase(&self, tick_rate: u32, substeps: u32) -> f64 {
        self.fastest / (f64::from(tick_rate) * f64::from(substeps))
    }
}
