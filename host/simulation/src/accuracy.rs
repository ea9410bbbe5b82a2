//! Error of a joint's step on a board at a rate, measured on standard motions with the tables of that board and rate.
//! The exact motion comes from the core in f64 with negligibly fine steps; `joint sim --scheme all` measures the error
//! against the independent reference.
//!
//! Definition of the error, as in all of `sim` (`sim::errors`): root mean square over the motion's own standard
//! deviation, of all mesh deflections together, of the gap coordinate, and of the link's offset from the rigid body. It
//! is taken for as long as a relative disturbance of the torques by 1e-6 moves none of these quantities by more than
//! 1e-3 of the motion.

use std::f64::consts::TAU;

use board::profile::{BUILTIN, TorqueProfile};
use link::messages::Command;
use model_core::gears::design::{DesignError, Effort, Processor, StepSize, design_scheme};
use model_core::gears::{Kinematics, Mechanics, Model, Scheme, Torques};
use model_core::numbers::Real;
use parameters::{Excitation, JointParameters, MeshPhases};
use rayon::prelude::*;
use reference::joint::Start;
use serde::Serialize;

use crate::sim::errors::{DISTURBANCE, Errors, PREDICTABLE_DEPARTURE, errors, is_constant, standard_deviation};
use crate::sim::plan::{DEFAULT_SPEED, steady_duration};
use crate::sim::start::{StartName, core_state};
use crate::sim::stepping::SimulationSpec;
use report::failure::{Failure, Outcome};

/// Largest phase of the fastest mode in a tick of the finer run [rad], least number of its ticks in a board's tick, and
/// its sub-steps a tick, the largest number possible.
const FINE_PHASE: f64 = 2.0;
const MIN_FINE_TICKS: u32 = 2;
const FINE_SUBSTEPS: u32 = 16;
/// Largest number of ticks of a motion, so that no joint takes minutes.
const MAX_MOTION_TICKS: f64 = 2e6;
/// Further motions of each kind: shift of the mesh phases in periods, and torques over those of the standard motion.
const FURTHER_MOTIONS: [(f64, f64); 2] = [(1.0 / 3.0, 0.8), (2.0 / 3.0, -0.6)];
/// Durations of the further motions [s]: reversals up to a quarter of a second after the first crossing of the gap, and
/// half a second under constant torques.
const FURTHER_DURATIONS: [f64; 2] = [1.5, 0.5];
/// Bound over the greatest error of all these motions, for the spread of motions that are not measured.
const BOUND_MARGIN: f64 = 3.0;

/// Errors on the standard motions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StandardErrors {
    /// Reversals through the gap, as run by `joint hil` and `joint sim --profile reversals`.
    pub reversals: MotionErrors,
    /// One turn a second under the rated torque, the default motion of `joint sim`.
    pub steady: MotionErrors,
}

/// Errors on one motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MotionErrors {
    /// Error on the motion itself; absent if the step breaks off or the motion is unpredictable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub typical: Option<Errors>,
    /// Bound on the errors of this motion and of others of its kind with other mesh phases and torques.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<Errors>,
    /// Time up to which the motion is predictable.
    pub predictable_until_s: f64,
    /// Length of the motion.
    pub duration_s: f64,
    /// Reason for a missing error.
    #[serde(skip)]
    pub unmeasured: Option<Unmeasured>,
}

/// Reason for a missing error of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unmeasured {
    /// Deflections, gap and link offset are constant: the error has no motion to refer to.
    Still,
    /// The disturbed motion leaves the exact one within a tick.
    Unpredictable,
    /// The step breaks off.
    BreaksOff,
}

impl Unmeasured {
    /// Reason as text.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Still => "no oscillation, so no error to measure",
            Self::Unpredictable => "chaotic from the first tick on, so not predictable",
            Self::BreaksOff => "the step breaks off",
        }
    }
}

/// Kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Reversals through the gap.
    Reversals,
    /// Constant torques.
    Steady,
}

/// A joint and its motion at a board's rate.
pub struct Motion {
    joint: JointParameters,
    rate: u32,
    ticks: u32,
    torques: Vec<Command>,
    start: Start,
}

/// Result of one run: errors, predictable time [s], and length [s].
struct MeasuredErrors {
    errors: Result<Errors, Unmeasured>,
    predictable: f64,
    duration: f64,
}

/// Measures a joint's step on a processor at a rate [Hz].
pub fn measure(joint: &JointParameters, processor: &Processor, rate: u32) -> Outcome<StandardErrors> {
    measure_up_to(joint, processor, rate, f64::INFINITY)
}

/// Measures a joint's step on motions that are cut off after a time [s].
pub fn measure_up_to(
    joint: &JointParameters,
    processor: &Processor,
    rate: u32,
    longest: f64,
) -> Outcome<StandardErrors> {
    let of = |kind: Kind| motion_errors(kind, joint, processor, rate, longest);
    let (reversals, steady) = rayon::join(|| of(Kind::Reversals), || of(Kind::Steady));
    Ok(StandardErrors { reversals: reversals?, steady: steady? })
}

/// Typical error of the reversals only, cut off after a time [s].
pub fn typical(joint: &JointParameters, processor: &Processor, rate: u32, longest: f64) -> Outcome<Option<Errors>> {
    let motion = Motion::new(Kind::Reversals, joint, rate, (0.0, 1.0), longest)?;
    Ok(motion.measure(processor)?.errors.ok())
}

/// Errors of a kind of motion: the standard motion and further ones.
fn motion_errors(
    kind: Kind,
    joint: &JointParameters,
    processor: &Processor,
    rate: u32,
    longest: f64,
) -> Outcome<MotionErrors> {
    let mut motions = vec![Motion::new(kind, joint, rate, (0.0, 1.0), longest)?];
    for other in FURTHER_MOTIONS {
        motions.push(Motion::new(kind, joint, rate, other, FURTHER_DURATIONS[kind as usize].min(longest))?);
    }
    let found: Vec<Outcome<MeasuredErrors>> = motions.par_iter().map(|motion| motion.measure(processor)).collect();
    let found = found.into_iter().collect::<Outcome<Vec<MeasuredErrors>>>()?;
    let standard = &found[0];
    let greatest = found.iter().filter_map(|found| found.errors.ok()).reduce(Errors::max);
    Ok(MotionErrors {
        typical: standard.errors.ok(),
        unmeasured: standard.errors.err(),
        bound: standard.errors.ok().and(greatest).map(|greatest| greatest.scaled(BOUND_MARGIN)),
        predictable_until_s: standard.predictable,
        duration_s: standard.duration,
    })
}

/// Joint with all mesh phases advanced by a fraction of a period.
fn with_shifted_phases(joint: &JointParameters, periods: f64) -> JointParameters {
    let mut shifted = joint.clone();
    for mesh in [&mut shifted.sun_planet, &mut shifted.ring_planet] {
        match &mut mesh.phases {
            MeshPhases::FromTeeth { stiffness, error } => {
                [stiffness, error].into_iter().for_each(|phase| *phase += TAU * periods);
            }
            MeshPhases::Given { stiffness, error } => {
                stiffness.iter_mut().chain(error).for_each(|phase| *phase += TAU * periods);
            }
        }
    }
    shifted
}

/// Deflections of every mesh, gap, link offset; one list each, by ticks of the board.
type Columns = Vec<Vec<f64>>;

impl Motion {
    /// Motion of a kind on a joint at a rate [Hz], with shifted mesh phases (in periods), scaled torques, and limited
    /// length [s].
    pub fn new(
        kind: Kind,
        joint: &JointParameters,
        rate: u32,
        (shift, scale): (f64, f64),
        longest: f64,
    ) -> Outcome<Self> {
        let joint = with_shifted_phases(joint, shift);
        let ticks = |seconds: f64| (seconds.min(longest) * f64::from(rate)).round().clamp(1.0, MAX_MOTION_TICKS) as u32;
        if kind == Kind::Reversals {
            let mut profile = TorqueProfile::load(BUILTIN[0], &joint, rate, None)?;
            for command in &mut profile.commands {
                command.drive_torque *= scale as f32;
                command.load_torque *= scale as f32;
            }
            let ticks = ticks(f64::from(profile.ticks) / f64::from(rate));
            return Ok(Self { joint, rate, ticks, torques: profile.commands, start: Start::Still });
        }
        let drive = scale * joint.rated_output_torque / joint.geometry.ratio_by_radii();
        let load = joint.balanced_load_torque(drive);
        let command = Command { tick: 0, drive_torque: drive as f32, load_torque: load as f32 };
        let (start, speed) = match joint.excitation {
            Excitation::Time { .. } => (StartName::Centred, 0.0),
            Excitation::Angle => (StartName::Seated, DEFAULT_SPEED),
        };
        let start = start.state(&joint, speed, (command.drive_torque.into(), command.load_torque.into()));
        Ok(Self { rate, ticks: ticks(steady_duration(&joint)), torques: vec![command], start, joint })
    }

    /// Simulation of this motion by `sim`, with the step of a processor.
    pub fn simulation_spec(&self, processor: Processor) -> SimulationSpec {
        SimulationSpec {
            joint: self.joint.clone(),
            tick_rate: self.rate,
            ticks: self.ticks,
            torques: self.torques.clone(),
            start: self.start.clone(),
            double: false,
            effort: Effort::Within(processor),
        }
    }

    fn measure(&self, processor: &Processor) -> Outcome<MeasuredErrors> {
        match self.joint.geometry.planets {
            1 => self.measure_with::<1>(processor),
            3 => self.measure_with::<3>(processor),
            4 => self.measure_with::<4>(processor),
            5 => self.measure_with::<5>(processor),
            other => Err(Failure::new(format!("joint `{}` has {other} planets", self.joint.name))
                .with_help("a joint may have 3, 4 or 5 planets")),
        }
    }

    fn measure_with<const N: usize>(&self, processor: &Processor) -> Outcome<MeasuredErrors> {
        let phase = StepSize::new(&self.joint).phase(self.rate, 1);
        let finer = ((phase / FINE_PHASE).ceil() as u32).max(MIN_FINE_TICKS);
        let fine = Effort::Substeps(FINE_SUBSTEPS);
        let exact = self.follow::<f64, N>(finer, fine, 0.0, |_, _| true)?;
        let bounds: Vec<f64> = exact.iter().map(|column| PREDICTABLE_DEPARTURE * standard_deviation(column)).collect();
        // Samples after the disturbed run has departed carry no information.
        let disturbed = self.follow::<f64, N>(finer, fine, DISTURBANCE, |tick, values| {
            let near = |((exact, bound), value): ((&Vec<f64>, &f64), &f64)| {
                exact.get(tick).is_some_and(|exact| (exact - value).abs() <= *bound)
            };
            exact.iter().zip(&bounds).zip(values).all(near)
        })?;
        let samples = disturbed[0].len();
        let board = self.follow::<f32, N>(1, Effort::Within(*processor), 0.0, |tick, _| tick < samples)?;
        let time = |samples: usize| samples.saturating_sub(1) as f64 / f64::from(self.rate);
        Ok(MeasuredErrors {
            errors: if exact.iter().all(|column| is_constant(column)) {
                Err(Unmeasured::Still)
            } else if samples > 1 {
                Errors::from_values(errors(&exact, &board, samples)).ok_or(Unmeasured::BreaksOff)
            } else {
                Err(Unmeasured::Unpredictable)
            },
            predictable: time(samples),
            duration: time(self.ticks as usize + 1),
        })
    }

    /// Steps the joint with `finer` ticks to one of the board's, while the state is finite and `go_on` accepts the tick
    /// and its values; the first rejected tick is left out.
    fn follow<T: Real, const N: usize>(
        &self,
        finer: u32,
        effort: Effort,
        disturbance: f64,
        go_on: impl Fn(usize, &[f64]) -> bool,
    ) -> Outcome<Columns> {
        let failed = |error: DesignError| {
            Failure::new(format!("joint `{}` cannot be designed for {} Hz: {error}", self.joint.name, self.rate))
        };
        let tables = design_scheme::<T, N>(&self.joint, finer * self.rate, Scheme::Realtime, effort).map_err(failed)?;
        let mut model = Model::new(&tables);
        model.set_state(core_state(&self.joint, &tables, &self.start));
        let mut columns = vec![Vec::new(); 2 * N + 2];
        let mut values = Vec::with_capacity(columns.len());
        let (mut commands, mut torques) = (self.torques.iter().peekable(), [0.0; 2]);
        let mut factor = 1.0 + disturbance;
        for tick in 0..=self.ticks {
            let outputs = model.outputs();
            values.clear();
            values.extend(outputs.deflections.as_flattened().iter().map(|value| value.to_f64()));
            values.extend([outputs.gap.to_f64(), outputs.link_offset.to_f64()]);
            if !model.is_finite() || !go_on(tick as usize, &values) {
                break;
            }
            columns.iter_mut().zip(&values).for_each(|(column, value)| column.push(*value));
            while let Some(command) = commands.next_if(|command| command.tick <= tick) {
                torques = [command.drive_torque.into(), command.load_torque.into()];
            }
            let [drive, load] = torques.map(|torque: f64| T::from_f64(factor * torque));
            for _ in 0..finer {
                model.step(Torques { drive, load });
            }
            factor = 2.0 - factor;
        }
        Ok(columns)
    }
}
