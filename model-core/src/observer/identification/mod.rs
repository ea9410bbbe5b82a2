//! Estimation of joint, encoder and motor parameters during motion. The parameters of the deflection come from one
//! recursive least squares (`least_squares`); bias and friction of the motor from `bias`, cogging from `cogging`, the
//! inertia of the link from `inertia`, the variances of all parameters from `uncertainty`.
//!
//! ```text
//! (O7)  d_t = d - o - s w_l - maps - e
//! (O9)  F_n = t/r_s - (bias + friction dir),   F = F_n (1 + loss |dir|)
//! (O14) F_h = F + lag F'
//! ```
//!
//! Symbols: d = `raw_deflection`, d_t = `tooth_deflection()`, o = `OFFSET`, s = `SKEW`, e = `flank_shift`, t/r_s =
//! `motor_force`, dir = `direction`, F_n = `net`, F = `force`, lag = `force_lag`, F' = `rise` per interval.
//!
//! Estimation proceeds in learning intervals of a few control periods (`interval`). For each interval `travel` decides
//! between rest and crossing; a rest of the teeth on a flank is a dwell, whose flank `flank` determines. Intervals of a
//! dwell are averaged (`batch`); `consistency` accepts or rejects their mean; `trusted_parameters` keeps the parameters
//! of long agreement. Work that can wait is done one task per period.

mod batch;
pub mod bias;
mod co_motion;
mod cogging;
mod consistency;
mod dwell_decisions;
mod flank;
pub(crate) mod gap_variation;
mod inertia;
mod interval;
mod last_dwell;
pub mod least_squares;
pub mod mesh_measurement;
pub mod position_errors;
pub mod regressors;
pub(super) mod thresholds;
mod travel;
mod trusted_parameters;
pub mod uncertainty;

use batch::{Batch, IntervalSample};
use bias::TorqueBias;
use cogging::Cogging;
use consistency::{Consistency, ParameterAction};
use flank::FlankEvidence;
use gap_variation::GapVariation;
use inertia::LinkInertia;
use interval::{Dwell, Interval, IntervalMean, Task, is_settled};
use last_dwell::LastDwell;
use least_squares::{Innovation, LeastSquares};
use mesh_measurement::MeshMeasurement;
use position_errors::PositionErrors;
use regressors::{COMPLIANCE, ContactSample, HALF_GAP, MAPPED, OFFSET, Regressors, SKEW, TRANSMISSION_ERROR};
use thresholds::EstimatorThresholds;
use travel::{Travel, TravelDetector};
use trusted_parameters::TrustedParameters;
use uncertainty::Uncertainty;

use crate::gears::Flank;
use crate::numbers::Real;
use crate::numbers::integers::saturating_real;
use crate::numbers::phase::sine_cosine;
use crate::numbers::state_words::state_words;
use crate::observer::contact::gap_position::GapPosition;
use crate::observer::filters::Filters;
use crate::observer::filters::load_side::LoadSide;
use crate::observer::sensors::Sensors;
use crate::observer::tables::{LearnerTable, ObserverTables};

/// Parameter estimator with its evidence. `P` is the number of parameters.
#[derive(Debug, Clone)]
pub struct ParameterEstimator<T: Real, const P: usize> {
    pub least_squares: LeastSquares<T, P>,
    pub bias: TorqueBias<T>,
    pub inertia: LinkInertia<T>,
    cogging: Cogging<T>,
    pub errors: PositionErrors<T, P>,
    pub uncertainty: Uncertainty<T>,
    interval: Interval<T>,
    travel: TravelDetector<T>,
    batch: Batch<T, P>,
    last_dwell: LastDwell<T, P>,
    consistency: Consistency,
    gap_variation: GapVariation<T>,
    /// Intervals until forces update the estimates again.
    probation: u16,
    /// Parameters of the last trusted half-gap.
    trusted: Option<TrustedParameters<T, P>>,
    /// Innovation that updates the parameters in the next period.
    pending_innovation: Option<Innovation<T, P>>,
}
state_words! {
    struct ParameterEstimator<T, P> {
        least_squares, bias, inertia, cogging, errors, uncertainty, interval, travel, batch, last_dwell, consistency,
        gap_variation, probation, trusted, pending_innovation,
    }
}

/// Result of a learning interval, before it updates an estimate.
#[derive(Debug, Clone, Copy)]
pub struct IntervalResult<T: Real> {
    mean: IntervalMean<T>,
    /// Sine and cosine of the mesh phase in the middle of the interval.
    pub mesh: [T; 2],
    /// Mean deflection less offset, skew and error maps [m].
    deflection: T,
    /// Transmission error in the middle of the interval [m].
    flank_shift: T,
    travel: Travel<T>,
    /// Flank of settled contact.
    pub flank: Option<Flank>,
    /// Standard deviation of the transmission error while the half-gap is unknown; 0 afterwards [m].
    error_deviation: T,
}

/// Effect of unknown error maps and transmission error on the travel of the deflection.
struct Blur<T: Real> {
    /// Standard deviation of the transmission error while the half-gap is unknown; 0 afterwards [m].
    error_deviation: T,
    /// Change of the deflection that is no motion of the teeth, per radian of the motor [m/rad].
    per_turn: T,
    /// Transmission error to subtract [m].
    known_shift: T,
}

impl<T: Real> IntervalResult<T> {
    /// Mean mesh force [N].
    pub fn force(&self) -> T {
        self.mean.force
    }
}

/// Outcome of a period's estimation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing that concerns other parts of the observer.
    Nothing,
    /// The values that hold until the next interval have changed.
    LimitsUpdated,
    /// The teeth seem to have grown, or the shafts to have turned against each other: the output encoder fails.
    OutputEncoderFault,
}

impl<T: Real, const P: usize> ParameterEstimator<T, P> {
    const LIMITS: EstimatorThresholds<T> = EstimatorThresholds::TUNED;

    /// Estimator whose largest parts have no tables yet: a copy of those parts would not fit on a small stack.
    #[inline(always)]
    pub fn uninitialized(tables: &ObserverTables<T>) -> Self {
        Self {
            bias: TorqueBias::new(&tables.contact),
            inertia: LinkInertia::new(&tables.inertia),
            cogging: Cogging::new(&tables.cogging),
            errors: PositionErrors::NEW,
            uncertainty: Uncertainty::uninitialized(),
            least_squares: LeastSquares::UNINITIALIZED,
            interval: Interval::new(),
            travel: TravelDetector::NEW,
            batch: Batch::NEW,
            last_dwell: LastDwell::NEW,
            consistency: Consistency::default(),
            gap_variation: GapVariation::new(),
            probation: 0,
            trusted: None,
            pending_innovation: None,
        }
    }

    /// Initialises the parts without tables.
    pub fn initialize(&mut self, tables: &ObserverTables<T>) {
        self.least_squares.reset(&tables.learner);
        self.uncertainty.reset(tables, &self.least_squares);
    }

    /// Estimated half-gap [m] and compliance [m/N].
    pub fn half_gap_and_compliance(&self) -> [T; 2] {
        [self.least_squares.value(HALF_GAP), self.least_squares.value(COMPLIANCE)]
    }

    /// Variance of the half-gap at this place of the turn by its variation around the turn (O20) [m^2].
    pub fn half_gap_variation_variance(&self, tables: &ObserverTables<T>) -> T {
        self.gap_variation.variance(&tables.counts, self.least_squares.value(HALF_GAP))
    }

    /// Transmission error at a mesh phase given by sine and cosine [m].
    pub fn transmission_error(&self, mesh: &[T; 2]) -> T {
        mesh[0] * self.least_squares.value(TRANSMISSION_ERROR)
            + mesh[1] * self.least_squares.value(TRANSMISSION_ERROR + 1)
    }

    /// Combines motor and load side: deflection less offset, skew and maps (O7), and mesh force (O9).
    #[inline]
    pub fn measure_mesh(
        &self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) -> MeshMeasurement<T> {
        let levers = &tables.levers;
        let (drive, load) = (&filters.drive, &filters.load);
        let (_, difference) = sensors.counts.output_in_use();
        let flank_shift = self.transmission_error(&self.errors.mesh);
        let raw_deflection = tables.counts.length * saturating_real(difference) + levers.sun * drive.angle_residual
            - levers.output * load.angle_residual;
        let motor_force = drive.disturbance_torque * levers.per_sun;
        let direction = TorqueBias::direction(&tables.contact, drive.speed);
        let net = motor_force - self.bias.force_at(direction);
        // Load-dependent losses are friction: they reduce the driving and increase the holding force.
        let loss = if net * direction > T::ZERO { tables.contact.loss_driving } else { tables.contact.loss_driven };
        let force = net + net * direction.abs() * loss;
        let rate = levers.sun * drive.speed - levers.output * load.speed;
        let travel = if rate.abs() > tables.contact.rate_deviation { rate * tables.contact.lag } else { T::ZERO };
        let link_speed = if both_encoders { load.speed } else { T::ZERO };
        let deflection = raw_deflection - self.deflection_beside_teeth(link_speed);
        MeshMeasurement { flank_shift, raw_deflection, deflection, rate, travel, motor_force, direction, force }
    }

    /// Deflection by offset, skew and error maps now [m].
    fn deflection_beside_teeth(&self, link_speed: T) -> T {
        let plain = self.least_squares.value(OFFSET) + self.least_squares.value(SKEW) * link_speed;
        if P == MAPPED { plain + self.errors.errors[0] + self.errors.errors[1] } else { plain }
    }

    /// Position of a deflection in the gap, with the deflection's travel [m].
    pub fn gap_position(&self, deflection: T, travel: T) -> GapPosition<T> {
        let [half_gap, _] = self.half_gap_and_compliance();
        let known = &self.uncertainty;
        GapPosition {
            deflection,
            travel,
            half_gap,
            blur: known.blur,
            near: known.near,
            stiffness: known.stiffness,
            weight: known.position_weight,
        }
    }

    /// Resets all variances and the last dwell: the output encoder has returned at another offset.
    pub fn reset_variances(&mut self, tables: &ObserverTables<T>) {
        self.least_squares.reset_covariance();
        self.pending_innovation = None;
        self.last_dwell = LastDwell::NEW;
        self.update_uncertainty(tables, true);
    }

    /// Restores the trusted parameters after an exclusion of the output encoder, if the half-gap has been doubted
    /// since. Returns true if it restored them.
    pub fn restore_trusted(&mut self, tables: &ObserverTables<T>) -> bool {
        let Some(trusted) = self.trusted.filter(|_| !self.consistency.is_trusted()) else { return false };
        trusted.restore(&mut self.least_squares);
        self.pending_innovation = None;
        self.update_uncertainty(tables, false);
        self.uncertainty.update_limits(tables, &self.least_squares, self.trusted.is_some());
        true
    }

    /// Resets cogging, offset and motor map: the motor encoder has returned at another offset.
    pub fn reset_motor_offset(&mut self, tables: &ObserverTables<T>) {
        self.trusted = None;
        self.pending_innovation = None;
        self.cogging = Cogging::new(&tables.cogging);
        self.least_squares.reset_motor_variances();
        self.update_uncertainty(tables, true);
    }

    /// Pauses the estimation from forces after an exclusion, until the loop has settled after the return.
    pub fn begin_probation(&mut self) {
        self.probation = Self::LIMITS.probation;
    }

    /// Discards the open interval and the last dwell: readings have broken off.
    pub fn discard_interval(&mut self) {
        self.interval = Interval::new();
        self.travel = TravelDetector::NEW;
        self.batch = Batch::NEW;
        self.last_dwell = LastDwell::NEW;
        self.pending_innovation = None;
    }

    /// Computes exactly all position-dependent parts of the deflection: regressors of an open gap, and sine and cosine
    /// of the mesh phase.
    pub fn update_position_errors(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) -> (Regressors<T, P>, [T; 2]) {
        let table = &tables.counts;
        let (output, _) = sensors.counts.output_in_use();
        let link_speed = if both_encoders { filters.load.speed } else { T::ZERO };
        let output_phase = output.phase(&table.output);
        let motor_phase = sensors.counts.motor.phase(&table.motor);
        let open_gap = regressors::open_gap(link_speed, motor_phase, both_encoders.then_some(output_phase));
        let (sine, cosine) = sine_cosine(output_phase.wrapping_mul(table.meshes));
        let mesh = [sine, cosine];
        self.errors.set_exact(&self.least_squares, &open_gap, mesh);
        (open_gap, mesh)
    }

    /// Adds a period to the interval.
    #[inline]
    pub fn add_period(&mut self, measurement: &MeshMeasurement<T>) {
        self.interval.add(measurement);
    }

    /// Returns true in the middle period of the interval.
    pub fn is_mid_interval(&self, table: &LearnerTable<T>) -> bool {
        self.interval.periods == table.middle
    }

    /// Returns true in the last period of the interval.
    pub fn is_interval_over(&self, table: &LearnerTable<T>) -> bool {
        self.interval.periods >= table.periods
    }

    /// Returns true while tasks of the last interval are left.
    pub fn has_task(&self) -> bool {
        self.interval.task != Task::Done
    }

    /// Stores the position-dependent parts of the interval's middle, where its mean is valid.
    pub fn store_position_errors(
        &mut self,
        tables: &ObserverTables<T>,
        sensors: &Sensors,
        filters: &Filters<T>,
        both_encoders: bool,
    ) {
        self.gap_variation.set_position(sensors.counts.output.phase(&tables.counts.output));
        (self.errors.open_gap, self.errors.mid_mesh) =
            self.update_position_errors(tables, sensors, filters, both_encoders);
    }

    /// Evaluates the interval that ends now, at a motor speed [rad/s].
    pub fn evaluate_interval(
        &mut self,
        tables: &ObserverTables<T>,
        motor_speed: T,
        both_encoders: bool,
    ) -> IntervalResult<T> {
        let mean = self.interval.close(tables.learner.per_periods);
        let mesh = self.errors.mid_mesh;
        let deflection = mean.raw_deflection - self.least_squares.deflection(&self.errors.open_gap);
        let [_, compliance] = self.half_gap_and_compliance();
        let motor_turn = motor_speed.abs() * tables.learner.span;
        let Blur { error_deviation, per_turn, known_shift } = self.blur(tables, &mesh);
        let less_wind_up = deflection - compliance * mean.force - known_shift;
        let motor_sample = (mean.motor_force, mean.direction);
        let blur = per_turn * motor_turn;
        let compliance_uncertainty = self.uncertainty.compliance_uncertainty;
        let travel = self.travel.step(&tables.contact, less_wind_up, motor_sample, blur, compliance_uncertainty);
        self.average_force(mean.force, travel);
        let flank_shift = self.transmission_error(&mesh);
        let evidence = self.flank_evidence(deflection - flank_shift, mean.force);
        let flank =
            if is_settled(travel) { flank::settled_flank(&evidence, &self.interval, both_encoders) } else { None };
        IntervalResult { mean, mesh, deflection, flank_shift, travel, flank, error_deviation }
    }

    /// Effect of unknown error maps and transmission error on the travel of the deflection. Until the half-gap is
    /// known, the estimated transmission error is subtracted, so that it hides no crossing; afterwards it is left in.
    fn blur(&self, tables: &ObserverTables<T>, mesh: &[T; 2]) -> Blur<T> {
        let per_turn = tables.contact.still_per_speed;
        if self.uncertainty.half_gap_is_known {
            let per_turn = per_turn * Self::LIMITS.remaining_blur;
            return Blur { error_deviation: T::ZERO, per_turn, known_shift: T::ZERO };
        }
        let (error_deviation, reduction) = self.least_squares.error_deviation(&tables.learner);
        let mesh_turn = T::TWO * tables.counts.mesh_periods * tables.levers.per_ratio;
        let known_shift = self.transmission_error(mesh);
        Blur { error_deviation, per_turn: per_turn - mesh_turn * reduction, known_shift }
    }

    /// Updates the mean mesh force over a few intervals and over the whole dwell.
    fn average_force(&mut self, force: T, travel: Travel<T>) {
        let intervals = match travel {
            Travel::AtRest(intervals) => i32::from(intervals.min(Self::LIMITS.averaged_dwell)),
            Travel::Crossing(..) | Travel::Undecided => 1,
        };
        self.interval.steady_force += (force - self.interval.steady_force) * Self::LIMITS.steady_gain;
        self.interval.dwell_force += (force - self.interval.dwell_force) / T::from_i32(intervals);
    }

    /// Evidence of an interval on the flank: a deflection of the teeth [m] and a force [N].
    fn flank_evidence(&self, deflection: T, force: T) -> FlankEvidence<'_, T> {
        let [_, compliance] = self.half_gap_and_compliance();
        FlankEvidence {
            uncertainty: &self.uncertainty,
            position: self.gap_position(deflection, T::ZERO),
            force,
            compliance,
        }
    }

    /// Updates the estimates with an evaluated interval, and begins the next one.
    pub fn finish_interval(
        &mut self,
        tables: &ObserverTables<T>,
        interval: &IntervalResult<T>,
        both_encoders: bool,
    ) -> Outcome {
        let IntervalResult { mean, travel, .. } = interval;
        let deflection = interval.deflection - interval.flank_shift;
        if both_encoders {
            self.probation = self.probation.saturating_sub(1);
        }
        self.update_bias(tables, interval, deflection, both_encoders);
        self.bias.inflate_variance(&tables.contact);
        if interval.flank.is_some() || matches!(travel, Travel::Crossing(..)) {
            self.interval.settled_flank = interval.flank;
        }
        self.uncertainty.settled = interval.flank.is_some();
        let action = self.consistency.check_gap_force(self.force_between_flanks(tables, deflection, *travel));
        self.apply_action(tables, action);
        let encoder_fails = action == ParameterAction::OutputEncoderFault;

        let rise = mean.force - core::mem::replace(&mut self.interval.force, mean.force);
        let dwell = self.dwell(tables, interval, rise, both_encoders && !encoder_fails);
        if dwell == Dwell::No {
            self.last_dwell.interrupt();
        }
        let force = mean.force + tables.learner.force_lag * rise;
        let sample = IntervalSample {
            open_gap: &self.errors.open_gap,
            mesh: &interval.mesh,
            raw_deflection: mean.raw_deflection,
            force,
        };
        let shortest = flank::shortest_contact(&self.uncertainty, &tables.learner);
        let is_full = self.batch.add(&sample, dwell, shortest, &tables.learner);
        self.interval.task = Task::Inertia(is_full);
        self.interval.direction = mean.direction;
        self.interval.nearer_flank =
            if interval.deflection < interval.flank_shift { Flank::Back } else { Flank::Drive };
        if encoder_fails { Outcome::OutputEncoderFault } else { Outcome::Nothing }
    }

    /// Updates the torque bias (O16) while the gap is certainly open.
    fn update_bias(
        &mut self,
        tables: &ObserverTables<T>,
        interval: &IntervalResult<T>,
        deflection: T,
        both_encoders: bool,
    ) {
        let [half_gap, _] = self.half_gap_and_compliance();
        let known = self.uncertainty.half_gap_is_known;
        let (blur, near) = (self.uncertainty.blur, Self::LIMITS.near_flank * half_gap);
        let inside = half_gap - T::TWO * if blur > near { blur } else { near };
        let open = known && deflection.abs() < inside;
        self.interval.open_intervals = if open { self.interval.open_intervals.saturating_add(1) } else { 0 };
        let open_gap_sample = match interval.travel {
            _ if !both_encoders || self.probation > 0 => None,
            _ if self.interval.open_intervals >= Self::LIMITS.open_intervals => {
                Some((interval.mean.motor_force, interval.mean.direction))
            }
            Travel::Crossing(motor_force, direction) if !known => Some((motor_force, direction)),
            _ => None,
        };
        if let Some((motor_force, direction)) = open_gap_sample {
            self.bias.update(&tables.contact, motor_force, direction);
        }
    }

    /// Updates the motor's cogging once per interval, from the motor's place in its turn [turns], its speed [rad/s] and
    /// the load torque [N m]. Returns sine and cosine of the driving torque, referred to the link [N m].
    pub fn update_cogging(&mut self, tables: &ObserverTables<T>, motion: [T; 3]) -> [T; 2] {
        let settled = self.interval.settled_flank.filter(|_| self.uncertainty.settled && self.probation == 0);
        self.cogging.update(&tables.cogging, motion, settled);
        self.cogging.torque()
    }

    /// Does the next task of the last interval.
    pub fn run_task(&mut self, tables: &ObserverTables<T>, load: &mut LoadSide<T>, both_encoders: bool) -> Outcome {
        let mut outcome = Outcome::Nothing;
        self.interval.task = match self.interval.task {
            Task::Inertia(dwell) => {
                let is_usable = both_encoders && self.probation == 0 && self.uncertainty.half_gap_is_usable;
                self.inertia.update(&tables.inertia, load, is_usable);
                if dwell { Task::Flank } else { Task::Uncertainty }
            }
            Task::Flank => {
                self.determine_flank(tables);
                if self.batch.flank().is_some() { Task::CheckDwell } else { Task::UpdateParameters }
            }
            Task::CheckDwell => {
                self.interval.updated_on = self.batch.flank();
                if self.check_dwell(tables) == ParameterAction::OutputEncoderFault {
                    outcome = Outcome::OutputEncoderFault;
                }
                Task::UpdateParameters
            }
            Task::UpdateParameters => {
                self.update_with_dwell(tables);
                Task::Uncertainty
            }
            Task::Uncertainty => {
                self.least_squares.inflate(tables.learner.forgetting);
                self.update_uncertainty(tables, both_encoders);
                Task::UpdateLimits
            }
            Task::UpdateLimits | Task::Done => {
                self.uncertainty.update_limits(tables, &self.least_squares, self.trusted.is_some());
                outcome = Outcome::LimitsUpdated;
                Task::Done
            }
        };
        outcome
    }

    /// Updates the variances after an interval.
    fn update_uncertainty(&mut self, tables: &ObserverTables<T>, both_encoders: bool) {
        let mut open_gap = self.errors.open_gap;
        if let (Some(offset), false) = (open_gap.get_mut(OFFSET), both_encoders) {
            // Without an output encoder the offset has no error.
            *offset = T::ZERO;
        }
        let contact =
            ContactSample { flank: Some(self.interval.nearer_flank), force: T::ZERO, mesh: self.errors.mid_mesh };
        let [_, compliance] = self.half_gap_and_compliance();
        self.uncertainty.update_force_variances(tables, &self.bias, compliance, self.interval.direction);
        self.uncertainty.update_next_part(tables, &self.least_squares, &open_gap, &contact);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::{estimator, observer};

    #[test]
    fn dwell_force_averages_16_intervals() {
        let mut estimator = estimator(&observer());
        // A landing with 16 N, then no force.
        for interval in 1..=16 {
            estimator.average_force(if interval == 1 { 16.0 } else { 0.0 }, Travel::AtRest(interval));
        }
        assert!((estimator.interval.dwell_force - 1.0).abs() < 1e-5);
        (17..=32).for_each(|interval| estimator.average_force(0.0, Travel::AtRest(interval)));
        // 16 more intervals leave (15/16)^16.
        assert!((estimator.interval.dwell_force - 0.356).abs() < 1e-3, "{}", estimator.interval.dwell_force);
    }
}
