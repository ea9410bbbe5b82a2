//! Step-size selection: computes the sub-steps of a tick from the joint's fastest mode, a prescribed mesh frequency,
//! stability and the processor's time. The step needs only the sub-steps; tick rates are for reports.

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

/// Phase of the fastest mode per sub-step at which it counts as resolved [rad]: the error of the crossing correction is a
/// few 1e-4 of the motion.
const GOOD_PHASE: f64 = 0.4;
/// Number of sub-steps above which only stability counts: a faster mode belongs to light planets, which carry little of the
/// motion.
const USUAL_SUBSTEPS: f64 = 4.0;
/// Largest phase of a prescribed mesh frequency per sub-step, about twenty sub-steps per mesh period [rad].
const EXCITATION_PHASE: f64 = 0.3;
/// Phase of the fastest mode per sub-step above which corrected sub-steps damp the mode, and with it bounces of light
/// planets [rad]. Verlet sub-steps of at most `VERLET_PHASE` then replace the corrected sub-steps, or longer ones if the
/// processor has no time. They cost less, and also replace corrected sub-steps that do not fit into the time.
const DAMPED_PHASE: f64 = 1.0;
const VERLET_PHASE: f64 = 1.0;
/// Largest number of sub-steps per tick.
const MOST_SUBSTEPS: usize = 16;

/// Limit of the work of a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// Time of an STM32F405, unless stability needs more.
    Board,
    /// Time of a given processor, unless stability needs more.
    Within(Processor),
    /// Number of sub-steps for accuracy, without a limit of time.
    Accurate,
    /// Given number of corrected sub-steps per tick, for comparisons; not checked for stability.
    Substeps(u32),
    /// Given number of Verlet sub-steps per tick, for comparisons; not checked for stability.
    Verlet(u32),
}

/// Properties of a joint that determine the step size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSize {
    /// Frequency of the fastest mode at the largest stiffness of the ripple [rad/s].
    fastest: f64,
    /// Prescribed mesh frequency; zero in `angle` mode, where the joint's speed keeps the mesh frequency far below the
    /// modes [rad/s].
    mesh_frequency: f64,
    cost: Cost,
    /// True for an equivalent gear, which follows changes of contact without sub-steps.
    whole: bool,
    /// True for the sharp dead zone, the only one with Verlet sub-steps.
    sharp: bool,
    /// Stability limits of the fastest mode's phase per sub-step, for 1, 2, ... sub-steps per tick [rad].
    largest_phases: [f64; MOST_SUBSTEPS],
    /// Stability limit of the fastest mode's phase per Verlet sub-step [rad].
    largest_verlet_phase: f64,
}

impl StepSize {
    /// Computes the properties of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let fastest = modes::natural_frequencies(parameters).last().copied().unwrap_or(0.0);
        let swings = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.swing());
        let fastest = fastest * libm::sqrt(1.0 + swings[0].max(swings[1]));
        // Damping ratio of a mode on the meshes: C = (c / k) K gives omega c / 2 k.
        let relaxations =
            MESH_KINDS.map(|kind| parameters.damping_coefficient(kind) / parameters.mesh(kind).mean_stiffness);
        let damping_ratio = 0.5 * fastest * relaxations[0].max(relaxations[1]);
        let whole = parameters.equivalent_gear().is_some();
        // Every tick may have a cold start, or all ticks a warm start.
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

    /// Returns the number of corrected sub-steps of a tick.
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
        // The stability limit depends on the number of sub-steps; more sub-steps may be less stable.
        Ok((wanted..=MOST_SUBSTEPS as u32).find(stable).or((1..wanted).rev().find(stable)).unwrap_or(wanted))
    }

    /// Returns method and number of the sub-steps of a tick in which contacts change. Verlet sub-steps replace corrected
    /// sub-steps that would damp the fastest mode or exceed the time: as many as fit, if stable. If neither method fits and the
    /// mode would be damped, the cheaper method is used; otherwise corrected sub-steps.
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

    /// Returns true if ticks in which contacts hold are exponential ticks: cheaper than sub-steps, or `Effort::Accurate`.
    pub(super) fn takes_whole_ticks(&self, substeps: Substeps, effort: Effort) -> bool {
        effort == Effort::Accurate || self.cost.takes_whole_ticks(substeps)
    }

    /// Returns the lowest accepted tick rate [Hz].
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

    /// Returns the lowest tick rate at which `USUAL_SUBSTEPS` resolve the fastest mode and the mesh frequency [Hz].
    pub fn recommended_rate(&self) -> u32 {
        if self.whole {
            return libm::ceil(self.fastest / GOOD_PHASE).max(1.0) as u32;
        }
        let wanted = (self.fastest / GOOD_PHASE).max(self.mesh_frequency / EXCITATION_PHASE);
        libm::ceil(wanted / USUAL_SUBSTEPS).max(1.0) as u32
    }

    /// Returns the stability limit of the fastest mode's phase per sub-step [rad].
    pub fn largest_phase(&self, substeps: Substeps) -> f64 {
        if self.whole {
            return equivalent::LARGEST_PHASE;
        }
        match substeps {
            Substeps::Corrected(substeps) => self.largest_phases[(substeps.max(1) as usize - 1).min(MOST_SUBSTEPS - 1)],
            Substeps::Verlet(_) => self.largest_verlet_phase,
        }
    }

    /// Returns the instructions of a tick.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Returns the phase of the fastest mode per sub-step [rad].
    pub fn phase(&self, tick_rate: u32, substeps: u32) -> f64 {
        self.fastest / (f64::from(tick_rate) * f64::from(substeps))
    }
}
