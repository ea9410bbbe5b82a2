//! Step-size selection: sub-steps of a tick from the joint's fastest mode, a prescribed mesh frequency, stability and the
//! processor's time. The tick rates that follow from it are for reports; the step itself needs only the sub-steps.

use core::array;

pub use crate::gears::certificate::Substeps;
use crate::gears::design::cost::Cost;
use crate::gears::design::equivalent;
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
/// Beyond this many sub-steps the fastest mode is resolved only as far as stability requires: it is that of light planets,
/// which carry little of the motion.
const USUAL_SUBSTEPS: f64 = 4.0;
/// Phase of a prescribed mesh frequency that a sub-step may have: some twenty evaluations a mesh period [rad].
const EXCITATION_PHASE: f64 = 0.3;
/// Beyond this phase of the fastest mode in a sub-step, Runge-Kutta steps damp it away and bounces of light planets with
/// it; Verlet sub-steps take over, of at most the second, or of more where the processor has no time for so many. They
/// cost less, and take over from crossings corrected one by one where there is no time for these [rad].
const DAMPED_PHASE: f64 = 1.0;
const VERLET_PHASE: f64 = 1.0;
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
    /// So many sub-steps a tick, for comparisons; not checked for stability.
    Substeps(u32),
    /// So many Verlet sub-steps a tick, likewise.
    Verlet(u32),
}

/// What sets the step size of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSize {
    /// Fastest mode at the stiffest moment of the ripple [rad/s].
    fastest: f64,
    /// Prescribed mesh frequency; zero in `angle` mode, where the joint's speed keeps it far below the modes [rad/s].
    mesh_frequency: f64,
    cost: Cost,
    /// Changes of contact are followed within a whole tick, as those of an equivalent gear are: there are no sub-steps.
    whole: bool,
    /// The dead zone is sharp; Verlet sub-steps are for no other.
    sharp: bool,
    /// Phase of the fastest mode that a sub-step may have, by the number of sub-steps of a tick from 1 on [rad].
    largest_phases: [f64; MOST_SUBSTEPS],
    /// The same of a Verlet sub-step [rad].
    largest_verlet_phase: f64,
}

impl StepSize {
    /// Of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let fastest = modes::natural_frequencies(parameters).last().copied().unwrap_or(0.0);
        let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
        let fastest = fastest * libm::sqrt(1.0 + swings[0].max(swings[1]));
        // Of a mode that the meshes carry: C = (c / k) K gives it the damping ratio omega c / 2 k.
        let relaxations =
            MESH_KINDS.map(|kind| parameters.damping_coefficient(kind) / parameters.mesh(kind).mean_stiffness);
        let damping_ratio = 0.5 * fastest * relaxations[0].max(relaxations[1]);
        let whole = parameters.equivalent_gear().is_some();
        // Ticks may each begin anew, or go on from one another without end.
        let without_end = stability::largest_phase(damping_ratio, stability::WITHOUT_END);
        Self {
            fastest,
            mesh_frequency: match parameters.excitation {
                Excitation::Time { mesh_frequency } => mesh_frequency,
                Excitation::Angle => 0.0,
            },
            cost: Cost::new(parameters),
            whole,
            sharp: parameters.dead_zone == DeadZone::Sharp,
            largest_phases: array::from_fn(|i| without_end.min(stability::largest_phase(damping_ratio, i as u32 + 1))),
            largest_verlet_phase: stability::largest_verlet_phase(damping_ratio),
        }
    }

    /// Corrected sub-steps of a tick.
    pub fn corrected_substeps(&self, tick_rate: u32, effort: Effort) -> Result<u32, DesignError> {
        if self.whole {
            let lowest = self.lowest_rate(effort);
            return if tick_rate < lowest { Err(DesignError::RateTooLow { given: tick_rate, lowest }) } else { Ok(1) };
        }
        if let Effort::Substeps(substeps) | Effort::Verlet(substeps) = effort {
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
            Effort::Accurate | Effort::Substeps(_) | Effort::Verlet(_) => MOST_SUBSTEPS as u32,
            Effort::Board => within(Processor::STM32F405),
            Effort::Within(processor) => within(processor),
        };
        let wanted = accurate.min(affordable).clamp(1, MOST_SUBSTEPS as u32);
        let stable = |substeps: &u32| {
            self.phase(tick_rate, *substeps) <= MARGIN * self.largest_phase(Substeps::Corrected(*substeps))
        };
        // Limits differ by the number of sub-steps, so the next may be stable where one more is not.
        Ok((wanted..=MOST_SUBSTEPS as u32).find(stable).or((1..wanted).rev().find(stable)).unwrap_or(wanted))
    }

    /// Sub-steps of a tick in which contacts change. Verlet sub-steps take over where sub-steps would damp the fastest mode away, or
    /// where the processor has no time for those that are corrected: as many as it has time for, if that is stable. Of two
    /// that it has no time for, the cheaper one where both would be damped, else those that are corrected.
    pub fn substeps(&self, tick_rate: u32, effort: Effort) -> Result<Substeps, DesignError> {
        let substeps = self.corrected_substeps(tick_rate, effort)?;
        if self.whole {
            return Ok(Substeps::Corrected(substeps));
        }
        let processor = match effort {
            Effort::Board => Processor::STM32F405,
            Effort::Within(processor) => processor,
            Effort::Accurate | Effort::Substeps(_) => return Ok(Substeps::Corrected(substeps)),
            Effort::Verlet(substeps) => return Ok(Substeps::Verlet(substeps.max(1))),
        };
        let substeps = Substeps::Corrected(substeps);
        let within = |most: f64| move |tried: &Substeps| self.cost.all_crossing(*tried) <= most;
        let in_time = within(processor.affordable(tick_rate));
        let damped = self.phase(tick_rate, substeps.count()) > DAMPED_PHASE;
        if !self.sharp || !damped && in_time(&substeps) {
            return Ok(substeps);
        }
        let wanted = libm::ceil(self.phase(tick_rate, 1) / VERLET_PHASE) as u32;
        let stable = |count: &u32| self.phase(tick_rate, *count) <= MARGIN * self.largest_verlet_phase;
        let fewer = (1..=wanted).rev().take_while(stable).map(Substeps::Verlet).find(in_time);
        let cheaper =
            || Some(Substeps::Verlet(wanted)).filter(|_| damped).filter(within(self.cost.all_crossing(substeps)));
        Ok(fewer.or_else(cheaper).unwrap_or(substeps))
    }

    /// Whether ticks in which contact holds are taken as a whole: where that is cheaper than the sub-steps, or time does not count.
    pub(super) fn takes_whole_ticks(&self, substeps: Substeps, effort: Effort) -> bool {
        effort == Effort::Accurate || self.cost.takes_whole_ticks(substeps)
    }

    /// Lowest tick rate that is accepted [Hz].
    pub fn lowest_rate(&self, effort: Effort) -> u32 {
        if self.whole {
            return libm::ceil(self.fastest / equivalent::LARGEST_PHASE).max(1.0) as u32;
        }
        let reach = (1..).zip(self.largest_phases).map(|(substeps, largest)| f64::from(substeps) * MARGIN * largest);
        let stable = self.fastest / reach.fold(0.0, f64::max);
        let wanted = match effort {
            Effort::Board | Effort::Within(_) | Effort::Substeps(_) | Effort::Verlet(_) => stable,
            Effort::Accurate => stable.max(self.mesh_frequency / (EXCITATION_PHASE * MOST_SUBSTEPS as f64)),
        };
        libm::ceil(wanted).max(1.0) as u32
    }

    /// Lowest tick rate at which the usual number of sub-steps resolves everything [Hz].
    pub fn recommended_rate(&self) -> u32 {
        if self.whole {
            return libm::ceil(self.fastest / GOOD_PHASE).max(1.0) as u32;
        }
        let wanted = (self.fastest / GOOD_PHASE).max(self.mesh_frequency / EXCITATION_PHASE);
        libm::ceil(wanted / USUAL_SUBSTEPS).max(1.0) as u32
    }

    /// Phase of the fastest mode in a sub-step from which on a tick of such sub-steps is unstable [rad].
    pub fn largest_phase(&self, substeps: Substeps) -> f64 {
        if self.whole {
            return equivalent::LARGEST_PHASE;
        }
        match substeps {
            Substeps::Corrected(substeps) => self.largest_phases[(substeps.max(1) as usize - 1).min(MOST_SUBSTEPS - 1)],
            Substeps::Verlet(_) => self.largest_verlet_phase,
        }
    }

    /// Instructions of a tick.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Phase of the fastest mode in a sub-step [rad].
    pub fn phase(&self, tick_rate: u32, substeps: u32) -> f64 {
        self.fastest / (f64::from(tick_rate) * f64::from(substeps))
    }
}
