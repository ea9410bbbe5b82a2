//! Linear fit of the joint's twist: half-gap by flank, compliance by torque, damping by the rate of the twist, dry
//! friction of the motor by its direction, errors of encoders and teeth by their angles.

use nalgebra::DVector;

use super::estimate::Estimate;
use super::harmonic::Harmonic;
use super::log::Log;
use super::prior::{Losses, PriorModel};
use super::regression::{Equations, NOISY_COEFFICIENTS, NoiseCovariance, Solution};
use super::rows::{Row, Rows};

/// Index of the offset; the constants below are indices of unknowns.
pub const OFFSET: usize = 0;
/// Half of the gap at the output [rad].
pub const HALF_GAP: usize = 1;
/// Compliance [rad/(N m)].
pub const COMPLIANCE: usize = 2;
/// Compliance times damping of the swing [s].
pub const RELAXATION: usize = 3;
/// Compliance times the motor's dry friction, negative [rad/(N m) N m].
pub const MOTOR_FRICTION: usize = 4;
/// Age of the output reading over the motor's [s].
pub const SKEW: usize = 5;
/// Delay of the torque [s].
pub const DELAY: usize = 6;
/// Sine and cosine of the motor encoder's error, once and twice a turn [rad].
pub const MOTOR_MAP: usize = 7;
/// Sine and cosine of the output encoder's error, once and twice a turn [rad].
pub const OUTPUT_MAP: usize = 11;
/// Sine and cosine of the teeth's error, once and twice a tooth [rad].
pub const TEETH: usize = 15;
/// Compliance times the excess of the motor's true torque over the logged torque, relative [rad/(N m)]. The two
/// unknowns behind it are sine and cosine of the growth of the teeth's error with the square of speed.
pub const TORQUE_ERROR: usize = 19;
/// Excess of the teeth's errors over the stated errors, in standard deviations, for planets that do not touch at once.
pub const SHARING: usize = 22;
/// Compliance times the excess of the gears' losses over the stated losses, negative [rad/(N m)].
pub const LOSS: usize = 23;
/// Compliance times a motor friction that differs by flank, as an offset of the torque would appear [rad/(N m) N m].
pub const FLANK_FRICTION: usize = 24;
/// Number of these unknowns; sine and cosine of each higher encoder error follow.
pub const UNKNOWNS: usize = 25;
/// Harmonic encoder errors are sought in these orders per turn, HARMONICS_MAX at most.
const HARMONIC_ORDERS: std::ops::RangeInclusive<u32> = 3..=24;
const HARMONICS_MAX: usize = 4;
/// A harmonic is accepted if it exceeds HARMONIC_SIGMA deviations and HARMONIC_GAP_SHARE times the half-gap.
const HARMONIC_SIGMA: f64 = 6.0;
const HARMONIC_GAP_SHARE: f64 = 0.002;
/// Stretches of a log whose offsets are compared.
pub const STRETCHES: usize = 6;

/// Prior widths: encoder and tooth errors, skew, delay and relaxation stay within them if the log does not determine
/// them.
const MOTOR_MAP_WIDTH: f64 = 0.5 * DEGREE;
const OUTPUT_MAP_WIDTH: f64 = 0.2 * DEGREE;
const TEETH_WIDTH: f64 = 0.1 * DEGREE;
const SKEW_WIDTH: f64 = 1e-3;
const DELAY_WIDTH: f64 = 2e-3;
const RELAXATION_WIDTH: f64 = 1e-2;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Standard deviation of an unknown efficiency; typical of data sheets.
pub const LOSS_WIDTH: f64 = 0.03;
/// Prior width of the friction by flank, as a share of the largest torque.
pub const FLANK_FRICTION_WIDTH: f64 = 0.02;
/// The log determines the losses if it narrows LOSS_WIDTH to this share.
const LOSS_DETERMINED_SHARE: f64 = 0.3;

/// Length of blocks with independent residuals [s].
pub const BLOCK_LENGTH: f64 = 0.1;

/// Teeth whose twist lies inside the gap by this many deviations are not in contact.
const FLIGHT_SIGMA: f64 = 6.0;

/// Prior width that removes an unknown from a fit.
const EXCLUDED_WIDTH: f64 = 1e-12;

/// Fit of the twist and its moments.
#[derive(Debug, Clone)]
pub struct Twist {
    /// Unknowns.
    pub solution: Solution,
    /// Moments, in the order of the residuals.
    pub rows: Vec<Row>,
}

/// Prior width of an unknown.
pub fn prior_width(unknown: usize) -> f64 {
    match unknown {
        TORQUE_ERROR => f64::INFINITY,
        RELAXATION => RELAXATION_WIDTH,
        SKEW => SKEW_WIDTH,
        DELAY => DELAY_WIDTH,
        SHARING => 1.0,
        LOSS | FLANK_FRICTION => f64::INFINITY,
        _ if unknown >= TEETH => TEETH_WIDTH,
        _ if unknown >= OUTPUT_MAP => OUTPUT_MAP_WIDTH,
        _ if unknown >= MOTOR_MAP => MOTOR_MAP_WIDTH,
        _ => f64::INFINITY,
    }
}

/// Fits the twist; `None` if the moments do not determine gap and compliance.
pub fn fit(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, prior.torque_error)
}

/// Fits the twist with an exact torque.
pub fn fit_exact_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, 0.0)
}

/// Fits the twist with an unknown scale of the torque; `None` if the torque was measured at the output.
pub fn fit_free_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    if log.output_torque.is_some() {
        None
    } else {
        fit_with(log, rows, &prior.with_losses(Losses::Stated(0.0)), f64::INFINITY)
    }
}

/// Changes of the offset between consecutive stretches of a log, with standard deviations [rad]; `None` if the moments
/// do not determine them.
pub fn offset_steps(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<[(f64, f64); STRETCHES - 1]> {
    let of_measured = log.output_torque.is_some();
    let twist = fit_in_stretches(log, rows, prior, if of_measured { 0.0 } else { prior.torque_error }, STRETCHES)?;
    let first = unknown_count(prior);
    let step = |after: usize| {
        let slopes: Vec<(usize, f64)> =
            (after > 0).then(|| (first + after - 1, -1.0)).into_iter().chain([(first + after, 1.0)]).collect();
        let value: f64 = slopes.iter().map(|(unknown, by)| by * twist.solution.values[*unknown]).sum();
        (value, twist.solution.half(&slopes) / twist.solution.coverage_factor)
    };
    Some(std::array::from_fn(step))
}

fn fit_with(log: &Log, rows: &Rows, prior: &PriorModel, torque_error: f64) -> Option<Twist> {
    fit_in_stretches(log, rows, prior, torque_error, 1)
}

/// Number of unknowns with the higher encoder errors.
fn unknown_count(prior: &PriorModel) -> usize {
    UNKNOWNS + 2 * prior.harmonics.len()
}

/// Fits the twist with a separate offset for each stretch.
fn fit_in_stretches(log: &Log, rows: &Rows, prior: &PriorModel, torque_error: f64, stretches: usize) -> Option<Twist> {
    let used: Vec<Row> = rows.carrying().filter(|row| row.direction != 0.0).copied().collect();
    let mut equations = Equations::with_repetition(rows.repetition);
    let products = rows.kernel.weight_products();
    for row in &used {
        let block = (row.time / BLOCK_LENGTH) as usize;
        let mut coefficients = equation(log, rows, prior, row);
        let stretch = row.sample * stretches / log.time.len();
        coefficients.extend((1..stretches).map(|later| if later == stretch { 1.0 } else { 0.0 }));
        equations.push_noisy(
            coefficients,
            evenly_shared_twist(log, prior, row),
            block,
            NOISY_UNKNOWNS,
            noise_covariance(log, &products, prior, row),
        );
        equations.set_group(row.level(rows.largest_torque));
    }
    let mut widths: Vec<f64> = (0..UNKNOWNS).map(prior_width).collect();
    widths.extend(prior.harmonics.iter().flat_map(|harmonic| [prior_width(harmonic.encoder); 2]));
    widths.extend((1..stretches).map(|_| f64::INFINITY));
    // With a torque measured behind the motor, the motor's friction and delay do not show in the twist.
    let measured = log.output_torque.is_some();
    widths[MOTOR_FRICTION] = if measured { EXCLUDED_WIDTH } else { prior.compliance * rows.largest_torque };
    let flanks = !measured && !matches!(prior.losses, Losses::Stated(_));
    widths[FLANK_FRICTION] = if flanks {
        (FLANK_FRICTION_WIDTH * prior.compliance * rows.largest_torque / prior.ratio()).max(EXCLUDED_WIDTH)
    } else {
        EXCLUDED_WIDTH
    };
    // Losses that are not sought are held; their uncertainty is part of the intervals.
    let (width, beside) = match prior.losses {
        Losses::Stated(deviation) | Losses::Estimated(deviation) if !measured => (EXCLUDED_WIDTH, deviation),
        Losses::Unknown if !measured => (LOSS_WIDTH, 0.0),
        _ => (EXCLUDED_WIDTH, 0.0),
    };
    widths[LOSS] = (prior.compliance * width).max(EXCLUDED_WIDTH);
    let considered = [(LOSS, prior.compliance * beside)];
    widths[TORQUE_ERROR] =
        if measured { EXCLUDED_WIDTH } else { (prior.compliance * torque_error).max(EXCLUDED_WIDTH) };
    if prior.equivalent {
        // An equivalent gear has no tooth errors.
        (TEETH..TORQUE_ERROR).chain(TORQUE_ERROR + 1..SHARING).for_each(|unknown| widths[unknown] = EXCLUDED_WIDTH);
    }
    if prior.sharing.is_none() {
        widths[SHARING] = EXCLUDED_WIDTH;
    }
    let solution = equations.solve_considering(&widths, &considered)?;
    Some(Twist { solution, rows: used })
}

/// Unknowns whose coefficients come from encoder readings through a rate or an acceleration.
const NOISY_UNKNOWNS: [usize; NOISY_COEFFICIENTS] = [COMPLIANCE, RELAXATION, SKEW];

/// Covariance of these coefficients and of the twist for noisy readings: the share of value, first and second
/// derivative of motor and output in each.
fn noise_covariance(log: &Log, products: &[[f64; 3]; 3], prior: &PriorModel, row: &Row) -> NoiseCovariance {
    let ratio = prior.ratio();
    let torque_slope = if row.measured.is_some() { 0.0 } else { -row.leverage };
    let torque = [0.0, torque_slope * prior.surroundings.motor_friction.viscous, torque_slope * prior.motor_inertia];
    let of_motor = [torque, [0.0, 1.0 / ratio, 0.0], [0.0; 3], [1.0 / ratio, 0.0, 0.0]];
    let of_output = [[0.0; 3], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let mut covariance = NoiseCovariance::default();
    for (parts, noise) in [of_motor, of_output].iter().zip(&log.noise) {
        let variance = noise.at(row.sample);
        for (one, other) in
            (0..=NOISY_COEFFICIENTS).flat_map(|one| (0..=NOISY_COEFFICIENTS).map(move |other| (one, other)))
        {
            let pairs = (0..3).flat_map(|order| (0..3).map(move |with| (order, with)));
            let sum: f64 =
                pairs.map(|(order, with)| parts[one][order] * parts[other][with] * products[order][with]).sum();
            covariance.0[one][other] += variance * sum;
        }
    }
    covariance
}

/// Twist of a moment if all planets carried from the first touch on, corrected to second order by the age of the output
/// [rad].
fn evenly_shared_twist(log: &Log, prior: &PriorModel, row: &Row) -> f64 {
    let reduction = prior.sharing.as_ref().map_or(0.0, |sharing| row.flank * sharing.reduction(row.torque()));
    row.twist + reduction + 0.5 * log.output_age * log.output_age * row.output_acceleration
}

/// Coefficients of the unknowns at a moment.
fn equation(log: &Log, rows: &Rows, prior: &PriorModel, row: &Row) -> Vec<f64> {
    // Errors by angle are smoothed like the twist: at speed the kernel attenuates them.
    let smooth = |of: &dyn Fn(usize) -> f64| rows.kernel.derivative(of, row.sample, 0);
    let ratio = prior.ratio();
    let mut equation = vec![1.0, row.flank, row.torque(), row.twist_rate];
    equation.push(if row.measured.is_some() { 0.0 } else { row.leverage * row.direction });
    equation.push(row.output_speed);
    equation.push(if row.measured.is_some() { 0.0 } else { -prior.compliance * row.drive_rate });
    for order in [1.0, 2.0] {
        equation.push(smooth(&|place| (order * log.motor[place]).sin()) / ratio);
        equation.push(smooth(&|place| (order * log.motor[place]).cos()) / ratio);
    }
    for order in [1.0, 2.0] {
        equation.push(-smooth(&|place| (order * log.output[place]).sin()));
        equation.push(-smooth(&|place| (order * log.output[place]).cos()));
    }
    for order in [1.0, 2.0] {
        equation.push(smooth(&|place| (order * log.mesh_phase(place, prior)).sin()));
        equation.push(smooth(&|place| (order * log.mesh_phase(place, prior)).cos()));
    }
    equation.push(if row.measured.is_some() { 0.0 } else { row.motor_torque });
    // Teeth that pass near the frequency of the swing shake more than the model of two inertias on a spring.
    let passing = f64::from(prior.ring_teeth) * row.output_speed * prior.swing_period() / std::f64::consts::TAU;
    equation.push(passing * passing * smooth(&|place| log.mesh_phase(place, prior).sin()));
    equation.push(passing * passing * smooth(&|place| log.mesh_phase(place, prior).cos()));
    equation.push(prior.sharing.as_ref().map_or(0.0, |sharing| -row.flank * sharing.excess_reduction(row.torque())));
    equation.push(if row.measured.is_some() { 0.0 } else { row.loss_sensitivity() });
    equation.push(if row.measured.is_some() { 0.0 } else { row.leverage * row.direction * row.flank });
    for &Harmonic { encoder, order } in &prior.harmonics {
        let (angles, by) = if encoder == MOTOR_MAP { (&log.motor, 1.0 / ratio) } else { (&log.output, -1.0) };
        equation.push(by * smooth(&|place| (order * angles[place]).sin()));
        equation.push(by * smooth(&|place| (order * angles[place]).cos()));
    }
    equation
}

impl Twist {
    /// Half of the lost motion at rest, where the foremost planets touch [rad].
    pub(super) fn half_lost_motion(&self, prior: &PriorModel) -> Estimate {
        let [reduction, excess] =
            prior.sharing.as_ref().map_or([0.0; 2], |sharing| [sharing.reduction(0.0), sharing.excess_reduction(0.0)]);
        let value = self.solution.values[HALF_GAP] - reduction - excess * self.solution.values[SHARING];
        Estimate::of_function(&self.solution, value, &[(HALF_GAP, 1.0), (SHARING, -excess)])
    }

    /// Compliance of the joint [rad/(N m)].
    pub fn compliance(&self) -> f64 {
        self.solution.values[COMPLIANCE]
    }

    /// Error at an angle: once and twice a turn, and the higher errors found so far [rad]; `first` is the first of its
    /// four unknowns.
    pub fn error(&self, first: usize, angle: f64, prior: &PriorModel) -> f64 {
        let part = |place: usize| self.solution.values[first + place];
        let (once, twice) = (angle.sin_cos(), (2.0 * angle).sin_cos());
        let more = prior.harmonics.iter().enumerate().filter(|(_, harmonic)| harmonic.encoder == first).map(
            |(place, harmonic)| {
                let (sine, cosine) = (harmonic.order * angle).sin_cos();
                let at = UNKNOWNS + 2 * place;
                self.solution.values[at] * sine + self.solution.values[at + 1] * cosine
            },
        );
        part(0) * once.0 + part(1) * once.1 + part(2) * twice.0 + part(3) * twice.1 + more.sum::<f64>()
    }

    /// Amplitude of a higher encoder error, by its index [rad].
    pub fn harmonic_amplitude(&self, place: usize) -> f64 {
        let at = UNKNOWNS + 2 * place;
        self.solution.values[at].hypot(self.solution.values[at + 1])
    }

    /// Encoder error of more than twice a turn that is most significant in the residuals; `None` without a significant
    /// one.
    pub fn strongest_harmonic(&self, log: &Log, prior: &PriorModel) -> Option<Harmonic> {
        if prior.harmonics.len() >= HARMONICS_MAX {
            return None;
        }
        let least = HARMONIC_GAP_SHARE * self.solution.values[HALF_GAP].abs();
        let mut most: Option<(f64, Harmonic)> = None;
        for (encoder, angles, by) in [(MOTOR_MAP, &log.motor, 1.0 / prior.ratio()), (OUTPUT_MAP, &log.output, 1.0)] {
            for order in HARMONIC_ORDERS.map(f64::from) {
                let mut equations = Equations::default();
                for (row, left) in self.rows.iter().zip(&self.solution.residuals) {
                    let (sine, cosine) = (order * angles[row.sample]).sin_cos();
                    equations.push(vec![by * sine, by * cosine], *left, (row.time / BLOCK_LENGTH) as usize);
                }
                let Some(solution) = equations.solve(&[f64::INFINITY; 2]) else { continue };
                let size = solution.values[0].hypot(solution.values[1]);
                let deviation = solution.deviation(0).hypot(solution.deviation(1));
                let stands_out = size / deviation.max(f64::MIN_POSITIVE);
                let is_there = stands_out > HARMONIC_SIGMA
                    && by * size > least
                    && !prior.harmonics.contains(&Harmonic { encoder, order });
                if is_there && most.is_none_or(|(best, _)| stands_out > best) {
                    most = Some((stands_out, Harmonic { encoder, order }));
                }
            }
        }
        most.map(|(_, harmonic)| harmonic)
    }

    /// Share of the load that is lost in addition to the known losses, with its standard deviation.
    pub fn excess_loss(&self, prior: &PriorModel) -> (f64, f64) {
        (-self.solution.values[LOSS] / prior.compliance, self.solution.deviation(LOSS) / prior.compliance)
    }

    /// Returns true if the fit, with the losses as an unknown, determines the losses.
    pub fn determines_losses(&self, prior: &PriorModel) -> bool {
        self.excess_loss(prior).1 < LOSS_DETERMINED_SHARE * LOSS_WIDTH
    }

    /// Excludes moments of flight, at any mean torque: the twist lies inside the gap by more than its scatter. Teeth
    /// may bounce for long if the joint is accelerated at the same time.
    pub fn exclude_flights(&self, log: &Log, rows: &mut Rows, prior: &PriorModel) {
        let least = self.solution.values[HALF_GAP] - FLIGHT_SIGMA * self.solution.noise;
        let gap_and_wind_up = self.gap_and_wind_up(log, rows, prior);
        for (row, (_, twist)) in rows.all.iter_mut().zip(gap_and_wind_up) {
            if row.flank * twist < least {
                row.flank = 0.0;
            }
        }
    }

    /// Twist of each moment without offset, encoder, tooth and skew errors: gap and wind-up alone [rad].
    pub fn gap_and_wind_up(&self, log: &Log, rows: &Rows, prior: &PriorModel) -> Vec<(Row, f64)> {
        let gap_and_wind_up = |row: &Row| {
            let coefficients = DVector::from_vec(equation(log, rows, prior, row));
            let errors: f64 = (0..unknown_count(prior))
                .filter(|unknown| {
                    *unknown == OFFSET || (*unknown >= SKEW && ![TORQUE_ERROR, LOSS, FLANK_FRICTION].contains(unknown))
                })
                .map(|unknown| coefficients[unknown] * self.solution.values[unknown])
                .sum();
            (*row, evenly_shared_twist(log, prior, row) - errors)
        };
        rows.all.iter().map(gap_and_wind_up).collect()
    }
}
