//! Width probe: the motor pushes gently against a held load, and its rest angles give the half-backlash. For joints
//! without an output encoder, or before any motion. The user must hold the load; the probe refuses if the load is not
//! held.
//!
//! On each flank the motor comes to rest under one torque and under twice that torque. Twice the first angle less the
//! second is the rest angle without torque (O28): the wind-up cancels for any compliance. A damping torque keeps
//! landings soft.

use core::fmt;

use crate::numbers::{Real, thresholds};
use crate::observer::{Estimate, Estimates, ProbeTable, Shaft, TorqueResponse};

thresholds! {
    /// Passes of the width probe.
    ProbeThresholds<T> {
        /// Largest difference between the first and the last pass, over the gap [-]: a larger difference means that the
        /// load moved.
        max_disagreement: T = T::EIGHTH,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn thresholds() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [ProbeThresholds::<f64>::TUNED.list()].concat()
}

/// Rests of a probe: sign and multiple of the single torque.
const RESTS: [(i32, i32); 6] = [(1, 1), (1, 2), (-1, 1), (-1, 2), (1, 1), (1, 2)];

/// Reason for which a probe gives no width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProbeRefusal {
    /// The motor turned when the probe began; let the motor come to rest.
    NotAtRest,
    /// The load presses the teeth with more torque than the probe may use; remove the load.
    Loaded,
    /// The motor did not come to rest, or moved farther than the teeth allow; hold the load.
    NotHeld,
    /// The motor hardly moved: friction exceeds the torque of the probe, or the joint is blocked.
    Stuck,
    /// The first and the last pass disagree: the load moved.
    Unsteady,
    /// Samples were missing or wrong, or torque or motor encoder has the wrong sign.
    BadSamples,
}

impl fmt::Display for ProbeRefusal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::NotAtRest => "the motor was turning when the probe began: let it come to rest",
            Self::Loaded => "the load pushes the teeth with more than the probe may use: take the load off",
            Self::NotHeld => "the motor did not come to rest, or went further than the teeth allow: hold the load",
            Self::Stuck => "the motor hardly moved: friction is more than the probe may use, or the joint is blocked",
            Self::Unsteady => "the first and the last pass do not agree: something moved",
            Self::BadSamples => "samples were missing or wrong, or torque or motor encoder has the wrong sign",
        })
    }
}

/// State of a probe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProbeProgress<T: Real> {
    /// Continue: command the torque and pass the estimates of the next period.
    Running,
    /// Finished: half-backlash [m].
    Done(Estimate<T>),
    /// Refused: no width, with the reason.
    Refused(ProbeRefusal),
}

/// Running width probe.
///
/// In this example somebody holds the link, and the probe uses at most 0.5 N m of the motor:
///
/// ```
/// use model_core::gears::{Tables, design::design};
/// use model_core::observer::design::{design_observer, design_probe, observer_settings};
/// use model_core::observer::{MAPPED, Observer};
/// use model_core::width_probe::{Probe, ProbeProgress};
/// use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
///
/// let mut q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// q1.surroundings.load_friction.coulomb = 50.0; // the hand
/// let settings = observer_settings(&q1.surroundings);
/// let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
/// let around = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
/// let (tables, table) = (design_observer(&q1.parameters, &settings)?, design_probe(&q1.parameters, &settings, 0.5)?);
/// let (mut joint, mut probe) = (VirtualJoint::new(&gears, &around), Probe::new(&table));
/// let mut observer = Observer::<f32, MAPPED>::new(&tables);
/// let mut progress = ProbeProgress::Running;
/// for period in 0..7000 {
///     let estimates = observer.step(&joint.samples());
///     let mut torque = 0.0;
///     if period > 1000 {
///         (torque, progress) = probe.step(estimates);
///     }
///     joint.advance(torque, 0.0);
/// }
/// let ProbeProgress::Done(half_backlash) = progress else { panic!("{progress:?}") };
/// assert!((half_backlash.value / 40e-6 - 1.0).abs() < 0.1, "it is 40 um: {half_backlash:?}");
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Probe<'tables, T: Real> {
    table: &'tables ProbeTable<T>,
    start: Option<Shaft<T>>,
    rest: usize,
    /// Periods of this rest, then periods without motion.
    periods: u32,
    still: u32,
    total: u32,
    torque: T,
    /// Sum of the angles from the start position while at rest [rad].
    sum: T,
    angles: [T; RESTS.len()],
    progress: ProbeProgress<T>,
}

impl<'tables, T: Real> Probe<'tables, T> {
    const LIMITS: ProbeThresholds<T> = ProbeThresholds::TUNED;

    /// Builds a probe that has not begun.
    pub fn new(table: &'tables ProbeTable<T>) -> Self {
        Self {
            table,
            start: None,
            rest: 0,
            periods: 0,
            still: 0,
            total: 0,
            torque: T::ZERO,
            sum: T::ZERO,
            angles: [T::ZERO; RESTS.len()],
            progress: ProbeProgress::Running,
        }
    }

    /// Advances by one control period. Returns the next torque to command [N m], zero once the probe has ended, and the
    /// state.
    pub fn step(&mut self, estimates: &Estimates<T>) -> (T, ProbeProgress<T>) {
        if self.progress == ProbeProgress::Running {
            self.progress = self.advance(estimates);
        }
        if self.progress != ProbeProgress::Running {
            return (T::ZERO, self.progress);
        }
        let target = RESTS.get(self.rest).map_or(T::ZERO, |(side, part)| self.table.torque * T::from_i32(side * part));
        self.torque += (target - self.torque) * self.table.rise;
        (self.torque - self.table.damping * estimates.motor.speed, self.progress)
    }

    fn advance(&mut self, estimates: &Estimates<T>) -> ProbeProgress<T> {
        let table = self.table;
        let notices = estimates.notices;
        let is_bad = notices.torque_unknown || notices.out_of_time || notices.motor_implausible || notices.motor_jumped;
        let reversed = estimates.torque_response == TorqueResponse::Reversed;
        if is_bad || reversed || !estimates.source.allows_control() {
            return ProbeProgress::Refused(ProbeRefusal::BadSamples);
        }
        let speed = estimates.motor.speed.abs();
        let Some(start) = self.start else {
            self.start = Some(estimates.motor);
            if speed > table.moving {
                return ProbeProgress::Refused(ProbeRefusal::NotAtRest);
            }
            if estimates.mesh_torque.value.abs() > table.loaded {
                return ProbeProgress::Refused(ProbeRefusal::Loaded);
            }
            return ProbeProgress::Running;
        };
        let turns = T::from_i32(estimates.motor.turns.wrapping_sub(start.turns));
        let angle = (turns + (estimates.motor.fraction - start.fraction)) * table.turn;
        self.total += 1;
        if angle.abs() > table.furthest || self.total > table.longest {
            return ProbeProgress::Refused(ProbeRefusal::NotHeld);
        }
        self.periods += 1;
        if self.periods < table.settle {
            return ProbeProgress::Running;
        }
        if speed > table.moving {
            (self.still, self.sum) = (0, T::ZERO);
            return ProbeProgress::Running;
        }
        self.still += 1;
        self.sum += angle;
        if self.still < table.still {
            return ProbeProgress::Running;
        }
        if let Some(place) = self.angles.get_mut(self.rest) {
            *place = self.sum * table.per_still;
        }
        self.rest += 1;
        (self.periods, self.still, self.sum) = (0, 0, T::ZERO);
        if self.rest < RESTS.len() { ProbeProgress::Running } else { self.result() }
    }

    fn result(&self) -> ProbeProgress<T> {
        let table = self.table;
        let [first, second, third, fourth, fifth, sixth] = self.angles;
        let flank = |single: T, double: T| single + single - double;
        let (drive, back, again) = (flank(first, second), flank(third, fourth), flank(fifth, sixth));
        let width = (T::HALF * (drive + again) - back) * table.deflection;
        if width < table.least {
            return ProbeProgress::Refused(ProbeRefusal::Stuck);
        }
        let disagreement = (again - drive) * table.deflection;
        if disagreement.abs() > Self::LIMITS.max_disagreement * width {
            return ProbeProgress::Refused(ProbeRefusal::Unsteady);
        }
        let quarter = T::HALF * T::HALF;
        // Friction may have stopped the motor short of its equilibrium on either flank. The squared difference between
        // the first and the last pass on the drive flank is therefore added to the variance.
        let variance = (table.variance + disagreement * disagreement) * quarter * quarter;
        ProbeProgress::Done(Estimate { value: width * quarter, variance, valid: true })
    }
}
