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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Source;
    use crate::observer::design::{design_usual_probe, observer_settings};

    /// Usual probe of Q1, whose motor has 2.5 N m.
    fn q1() -> ProbeTable<f64> {
        let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        let settings = observer_settings(&q1.surroundings);
        design_usual_probe(&q1.parameters, &settings).expect("tables").expect("a probe")
    }

    /// Estimates of a motor at a speed [rad/s].
    fn turning(speed: f64) -> Estimates<f64> {
        let mut estimates = Estimates { source: Source::Both, ..Estimates::default() };
        estimates.motor.speed = speed;
        estimates
    }

    /// Probe that has found its motor at rest.
    fn begun(table: &ProbeTable<f64>) -> Probe<'_, f64> {
        let mut probe = Probe::new(table);
        probe.step(&turning(0.0));
        probe
    }

    /// Periods at a speed until a condition holds.
    fn periods_until(probe: &mut Probe<'_, f64>, speed: f64, holds: impl Fn(&Probe<'_, f64>) -> bool) -> Option<u32> {
        (1..20_000).find(|_| {
            probe.step(&turning(speed));
            holds(probe)
        })
    }

    #[test]
    fn probe_ends_after_half_a_second() {
        let table = q1();
        let refused = ProbeProgress::Refused(ProbeRefusal::NotHeld);
        assert_eq!(periods_until(&mut begun(&table), 10.0, |probe| probe.progress == refused), Some(5001));
    }

    #[test]
    fn torque_settles_for_50_ms() {
        let table = q1();
        // Then 10 ms of rest are averaged.
        assert_eq!(periods_until(&mut begun(&table), 0.0, |probe| probe.still == 1), Some(500));
    }

    #[test]
    fn rest_is_averaged_over_10_ms() {
        let table = q1();
        let mut probe = begun(&table);
        (0..1000).for_each(|_| _ = probe.step(&turning(10.0)));
        assert_eq!(periods_until(&mut probe, 0.0, |probe| probe.rest == 1), Some(100));
    }

    #[test]
    fn torque_rises_in_12_ms() {
        let table = q1();
        let mut probe = begun(&table);
        // The first period has risen, too.
        (1..120).for_each(|_| _ = probe.step(&turning(0.0)));
        assert!((probe.torque / table.torque - 0.632).abs() < 1e-3, "{}", probe.torque);
    }

    #[test]
    fn damping_stops_the_motor_in_3_ms() {
        let table = q1();
        let torque = |speed: f64| begun(&table).step(&turning(speed)).0;
        // Of Q1's motor, 2.51e-4 kg m^2, at 50 Hz.
        assert!((torque(0.0) - torque(1.0) - 0.0788).abs() < 1e-3, "{}", torque(0.0) - torque(1.0));
    }

    #[test]
    fn usual_torque_is_a_fifth_of_the_limit() {
        // The single torque is half of the probe's.
        assert!((q1().torque - 0.25).abs() < 1e-12);
    }

    #[test]
    fn usual_torque_is_eight_uncertainties() {
        let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        let settings = crate::observer::design::ObserverSettings {
            torque_uncertainty: 0.1,
            ..observer_settings(&q1.surroundings)
        };
        let table = design_usual_probe::<f64>(&q1.parameters, &settings).expect("tables").expect("a probe");
        assert!((table.torque - 0.4).abs() < 1e-12, "{}", table.torque);
    }

    #[test]
    fn passes_that_differ_by_an_eighth_are_unsteady() {
        let table = q1();
        // Distances between the flanks in motor angles [rad]: of the first pass, and the last less the first.
        let is_unsteady = |part: f64| {
            let width = 0.02;
            let again = part * width;
            let drive = width - 0.5 * again;
            let angles = [drive, drive, 0.0, 0.0, drive + again, drive + again];
            Probe { angles, ..Probe::new(&table) }.result() == ProbeProgress::Refused(ProbeRefusal::Unsteady)
        };
        assert_eq!([0.12, 0.13, -0.12, -0.13].map(is_unsteady), [false, true, false, true]);
    }
}
