//! What twists the joint: half of the gap by side, compliance by torque, damping by the twist's rate, the motor's dry
//! friction by its direction, errors of both encoders and of the teeth by angle. One linear fit gives them all.

use nalgebra::DVector;

use super::estimate::Estimate;
use super::higher::Higher;
use super::log::Log;
use super::prior::{Losses, PriorModel};
use super::regression::{Equations, SCATTERING, Scatter, Solution};
use super::rows::{Row, Rows};

/// Unknowns by their place.
pub const OFFSET: usize = 0;
/// Half of the lost motion at the output [rad].
pub const HALF_GAP: usize = 1;
/// [rad/(N m)].
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
/// Of the output encoder's [rad].
pub const OUTPUT_MAP: usize = 11;
/// Of the teeth's error, once and twice a tooth [rad].
pub const TEETH: usize = 15;
/// Compliance times the ratio by which the motor's true torque exceeds the logged one [rad/(N m)].
pub const TORQUE_ERROR: usize = 19;
/// How much larger the teeth's errors are than stated, in standard deviations, where planets do not touch at once; behind the
/// torque's error stand sine and cosine of what the teeth's error grows by with the square of speed.
pub const SHARING: usize = 22;
/// Compliance times the share by which the gears' losses differ from what is stated, negative [rad/(N m)].
pub const LOSS: usize = 23;
/// Compliance times a friction of the motor that is with one flank and against the other, as an offset of the torque feigns one,
/// [rad/(N m) N m].
pub const FLANK_FRICTION: usize = 24;
/// All of them; behind them stand sine and cosine of errors that come more often a turn, as far as the log has shown any.
pub const UNKNOWNS: usize = 25;
/// Such errors are looked for from this many times a turn up to that many, so many of them...
const HIGHER: std::ops::RangeInclusive<u32> = 3..=24;
const MOST_HIGHER: usize = 4;
/// ... and one is there if it stands out of its scatter by so many deviations and is larger than this share of half of the gap.
const STANDS_OUT: f64 = 6.0;
const BENDS: f64 = 0.002;
/// Stretches of a log whose offsets are held against one another.
pub const STRETCHES: usize = 6;

/// Errors beyond these are not expected: what a log does not show stays within them.
const MOTOR_MAP_WIDTH: f64 = 0.5 * DEGREE;
const OUTPUT_MAP_WIDTH: f64 = 0.2 * DEGREE;
const TEETH_WIDTH: f64 = 0.1 * DEGREE;
const SKEW_WIDTH: f64 = 1e-3;
const DELAY_WIDTH: f64 = 2e-3;
const RELAXATION_WIDTH: f64 = 1e-2;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// How well an efficiency is known where a log tells it: a standard deviation, of what data sheets say.
pub const LOSS_WIDTH: f64 = 0.03;
/// Share of the largest torque within which frictions by flank are expected.
pub const FLANKS: f64 = 0.02;
/// A log tells it that narrows it to this share.
const LOSS_TOLD: f64 = 0.3;

/// Length of the blocks whose residuals are assumed to be independent of one another [s].
pub const BLOCK_LENGTH: f64 = 0.1;

/// Teeth whose twist is inside the gap by so many deviations are not in contact.
const FLYING: f64 = 6.0;

/// Takes an unknown out of a fit.
const NONE: f64 = 1e-12;

/// The fit and the samples that it is made from.
#[derive(Debug, Clone)]
pub struct Twist {
    /// The unknowns.
    pub solution: Solution,
    /// Moments, in the order of the residuals.
    pub rows: Vec<Row>,
}

/// Widths that are expected of the map unknowns.
pub fn width(unknown: usize) -> f64 {
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

/// Fits; `None` if the moments do not determine gap and compliance.
pub fn fit(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, prior.torque_error)
}

/// The same for a torque that is right.
pub fn fit_with_this_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, 0.0)
}

/// The same for a torque whose scale is not known at all; nothing where no torque of the motor enters.
pub fn fit_with_any_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    if log.output_torque.is_some() {
        None
    } else {
        fit_with(log, rows, &prior.with_losses(Losses::Stated(0.0)), f64::INFINITY)
    }
}

/// By how much the offset of each stretch of a log but the first is another than that of the stretch before, with the standard
/// deviation [rad]; nothing where the moments do not tell.
pub fn steps_of_the_offset(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<[(f64, f64); STRETCHES - 1]> {
    let of_measured = log.output_torque.is_some();
    let twist = fit_in_stretches(log, rows, prior, if of_measured { 0.0 } else { prior.torque_error }, STRETCHES)?;
    let first = unknowns(prior);
    let step = |after: usize| {
        let slopes: Vec<(usize, f64)> =
            (after > 0).then(|| (first + after - 1, -1.0)).into_iter().chain([(first + after, 1.0)]).collect();
        let value: f64 = slopes.iter().map(|(unknown, by)| by * twist.solution.values[*unknown]).sum();
        (value, twist.solution.half(&slopes) / twist.solution.reach)
    };
    Some(std::array::from_fn(step))
}

fn fit_with(log: &Log, rows: &Rows, prior: &PriorModel, torque_error: f64) -> Option<Twist> {
    fit_in_stretches(log, rows, prior, torque_error, 1)
}

/// How many unknowns there are.
fn unknowns(prior: &PriorModel) -> usize {
    UNKNOWNS + 2 * prior.higher.len()
}

/// With an offset of its own for each stretch.
fn fit_in_stretches(log: &Log, rows: &Rows, prior: &PriorModel, torque_error: f64, stretches: usize) -> Option<Twist> {
    let used: Vec<Row> = rows.carrying().filter(|row| row.direction != 0.0).copied().collect();
    let mut equations = Equations::of_moments(rows.alike);
    let products = rows.kernel.products();
    for row in &used {
        let block = (row.time / BLOCK_LENGTH) as usize;
        let mut coefficients = equation(log, rows, prior, row);
        let stretch = row.sample * stretches / log.time.len();
        coefficients.extend((1..stretches).map(|later| if later == stretch { 1.0 } else { 0.0 }));
        equations.push_scattering(
            coefficients,
            shared(log, prior, row),
            block,
            MEASURED,
            scatter(log, &products, prior, row),
        );
        equations.in_group(row.level(rows.greatest));
    }
    let mut widths: Vec<f64> = (0..UNKNOWNS).map(width).collect();
    widths.extend(prior.higher.iter().flat_map(|higher| [width(higher.encoder); 2]));
    widths.extend((1..stretches).map(|_| f64::INFINITY));
    // With the torque measured behind them, the motor's friction and its delay do not show in the twist.
    let measured = log.output_torque.is_some();
    widths[MOTOR_FRICTION] = if measured { NONE } else { prior.compliance * rows.greatest };
    let flanks = !measured && !matches!(prior.losses, Losses::Stated(_));
    widths[FLANK_FRICTION] =
        if flanks { (FLANKS * prior.compliance * rows.greatest / prior.ratio()).max(NONE) } else { NONE };
    // Losses are held where they are not looked for; what they may be beside that is in the intervals.
    let (width, beside) = match prior.losses {
        Losses::Stated(deviation) | Losses::Told(deviation) if !measured => (NONE, deviation),
        Losses::Open if !measured => (LOSS_WIDTH, 0.0),
        _ => (NONE, 0.0),
    };
    widths[LOSS] = (prior.compliance * width).max(NONE);
    let considered = [(LOSS, prior.compliance * beside)];
    widths[TORQUE_ERROR] = if measured { NONE } else { (prior.compliance * torque_error).max(NONE) };
    if prior.equivalent {
        // No teeth, no errors of theirs.
        (TEETH..TORQUE_ERROR).chain(TORQUE_ERROR + 1..SHARING).for_each(|unknown| widths[unknown] = NONE);
    }
    if prior.sharing.is_none() {
        widths[SHARING] = NONE;
    }
    let solution = equations.solve_considering(&widths, &considered)?;
    Some(Twist { solution, rows: used })
}

/// Unknowns whose coefficients come from encoder readings by way of a rate or an acceleration.
const MEASURED: [usize; SCATTERING] = [COMPLIANCE, RELAXATION, SKEW];

/// How readings that scatter show in those coefficients and in the twist: what of each is their value, first and second
/// derivative, by motor and output.
fn scatter(log: &Log, products: &[[f64; 3]; 3], prior: &PriorModel, row: &Row) -> Scatter {
    let ratio = prior.ratio();
    let taken = if row.measured.is_some() { 0.0 } else { -row.leverage };
    let torque = [0.0, taken * prior.surroundings.motor_friction.viscous, taken * prior.motor_inertia];
    let of_motor = [torque, [0.0, 1.0 / ratio, 0.0], [0.0; 3], [1.0 / ratio, 0.0, 0.0]];
    let of_output = [[0.0; 3], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let mut covariance = Scatter::default();
    for (parts, noise) in [of_motor, of_output].iter().zip(&log.noise) {
        let variance = noise.at(row.sample);
        for (one, other) in (0..=SCATTERING).flat_map(|one| (0..=SCATTERING).map(move |other| (one, other))) {
            let pairs = (0..3).flat_map(|order| (0..3).map(move |with| (order, with)));
            let sum: f64 =
                pairs.map(|(order, with)| parts[one][order] * parts[other][with] * products[order][with]).sum();
            covariance.0[one][other] += variance * sum;
        }
    }
    covariance
}

/// The twist at a moment, were all planets to carry alike from the first touch on, and but for what the output's age has in it in
/// second order [rad].
fn shared(log: &Log, prior: &PriorModel, row: &Row) -> f64 {
    let taken = prior.sharing.as_ref().map_or(0.0, |sharing| row.side * sharing.taken(row.torque()));
    row.twist + taken + 0.5 * log.age * log.age * row.output_acceleration
}

/// Coefficients of the unknowns at a moment.
fn equation(log: &Log, rows: &Rows, prior: &PriorModel, row: &Row) -> Vec<f64> {
    // Errors by angle are smoothed as the twist is: at speed the kernel takes a part of them.
    let smooth = |of: &dyn Fn(usize) -> f64| rows.kernel.at(of, row.sample, 0);
    let ratio = prior.ratio();
    let mut equation = vec![1.0, row.side, row.torque(), row.wind_rate];
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
        equation.push(smooth(&|place| (order * log.teeth(place, prior)).sin()));
        equation.push(smooth(&|place| (order * log.teeth(place, prior)).cos()));
    }
    equation.push(if row.measured.is_some() { 0.0 } else { row.motor_torque });
    // Teeth that pass near the swing's own frequency shake more than two inertias on a spring say.
    let passing = f64::from(prior.ring_teeth) * row.output_speed * prior.swing() / std::f64::consts::TAU;
    equation.push(passing * passing * smooth(&|place| log.teeth(place, prior).sin()));
    equation.push(passing * passing * smooth(&|place| log.teeth(place, prior).cos()));
    equation.push(prior.sharing.as_ref().map_or(0.0, |sharing| -row.side * sharing.more(row.torque())));
    equation.push(if row.measured.is_some() { 0.0 } else { row.loss() });
    equation.push(if row.measured.is_some() { 0.0 } else { row.leverage * row.direction * row.side });
    for &Higher { encoder, order } in &prior.higher {
        let (angles, by) = if encoder == MOTOR_MAP { (&log.motor, 1.0 / ratio) } else { (&log.output, -1.0) };
        equation.push(by * smooth(&|place| (order * angles[place]).sin()));
        equation.push(by * smooth(&|place| (order * angles[place]).cos()));
    }
    equation
}

impl Twist {
    /// Half of the lost motion as a hand feels it: what is left where the foremost planets touch [rad].
    pub(super) fn half_lost_motion(&self, prior: &PriorModel) -> Estimate {
        let [taken, more] = prior.sharing.as_ref().map_or([0.0; 2], |sharing| [sharing.taken(0.0), sharing.more(0.0)]);
        let value = self.solution.values[HALF_GAP] - taken - more * self.solution.values[SHARING];
        Estimate::from(&self.solution, value, &[(HALF_GAP, 1.0), (SHARING, -more)])
    }

    /// Of the joint [rad/(N m)].
    pub fn compliance(&self) -> f64 {
        self.solution.values[COMPLIANCE]
    }

    /// Error at an angle that comes once and twice in its turn, and more often as far as it is known to [rad]; `first` is the first
    /// of its four unknowns.
    pub fn error(&self, first: usize, angle: f64, prior: &PriorModel) -> f64 {
        let part = |place: usize| self.solution.values[first + place];
        let (once, twice) = (angle.sin_cos(), (2.0 * angle).sin_cos());
        let more =
            prior.higher.iter().enumerate().filter(|(_, higher)| higher.encoder == first).map(|(place, higher)| {
                let (sine, cosine) = (higher.order * angle).sin_cos();
                let at = UNKNOWNS + 2 * place;
                self.solution.values[at] * sine + self.solution.values[at + 1] * cosine
            });
        part(0) * once.0 + part(1) * once.1 + part(2) * twice.0 + part(3) * twice.1 + more.sum::<f64>()
    }

    /// How large an error is that comes more often a turn, by its place in what is known [rad].
    pub fn higher(&self, place: usize) -> f64 {
        let at = UNKNOWNS + 2 * place;
        self.solution.values[at].hypot(self.solution.values[at + 1])
    }

    /// The error that comes more than twice a turn and stands out most of what this fit leaves over, if there is one.
    pub fn more_often_a_turn(&self, log: &Log, prior: &PriorModel) -> Option<Higher> {
        if prior.higher.len() >= MOST_HIGHER {
            return None;
        }
        let least = BENDS * self.solution.values[HALF_GAP].abs();
        let mut most: Option<(f64, Higher)> = None;
        for (encoder, angles, by) in [(MOTOR_MAP, &log.motor, 1.0 / prior.ratio()), (OUTPUT_MAP, &log.output, 1.0)] {
            for order in HIGHER.map(f64::from) {
                let mut equations = Equations::default();
                for (row, left) in self.rows.iter().zip(&self.solution.residuals) {
                    let (sine, cosine) = (order * angles[row.sample]).sin_cos();
                    equations.push(vec![by * sine, by * cosine], *left, (row.time / BLOCK_LENGTH) as usize);
                }
                let Some(solution) = equations.solve(&[f64::INFINITY; 2]) else { continue };
                let size = solution.values[0].hypot(solution.values[1]);
                let deviation = solution.deviation(0).hypot(solution.deviation(1));
                let stands_out = size / deviation.max(f64::MIN_POSITIVE);
                let is_there =
                    stands_out > STANDS_OUT && by * size > least && !prior.higher.contains(&Higher { encoder, order });
                if is_there && most.is_none_or(|(best, _)| stands_out > best) {
                    most = Some((stands_out, Higher { encoder, order }));
                }
            }
        }
        most.map(|(_, higher)| higher)
    }

    /// Share of the load that is lost beyond what is known, with its standard deviation.
    pub fn loss(&self, prior: &PriorModel) -> (f64, f64) {
        (-self.solution.values[LOSS] / prior.compliance, self.solution.deviation(LOSS) / prior.compliance)
    }

    /// Whether a fit that was to find losses tells them.
    pub fn tells_losses(&self, prior: &PriorModel) -> bool {
        self.loss(prior).1 < LOSS_TOLD * LOSS_WIDTH
    }

    /// Leaves out moments at which the teeth fly, whatever the mean torque: those whose twist is inside the gap by more than it
    /// scatters. Teeth may bounce on for long where the joint is accelerated as they are.
    pub fn leave_out_flights(&self, log: &Log, rows: &mut Rows, prior: &PriorModel) {
        let least = self.solution.values[HALF_GAP] - FLYING * self.solution.noise;
        let cleaned = self.cleaned(log, rows, prior);
        for (row, (_, twist)) in rows.all.iter_mut().zip(cleaned) {
            if row.side * twist < least {
                row.side = 0.0;
            }
        }
    }

    /// What is left of a moment's twist without encoder, tooth and skew errors: gap and wind-up alone [rad].
    pub fn cleaned(&self, log: &Log, rows: &Rows, prior: &PriorModel) -> Vec<(Row, f64)> {
        let cleaned = |row: &Row| {
            let coefficients = DVector::from_vec(equation(log, rows, prior, row));
            let errors: f64 = (0..unknowns(prior))
                .filter(|unknown| {
                    *unknown == OFFSET || (*unknown >= SKEW && ![TORQUE_ERROR, LOSS, FLANK_FRICTION].contains(unknown))
                })
                .map(|unknown| coefficients[unknown] * self.solution.values[unknown])
                .sum();
            (*row, shared(log, prior, row) - errors)
        };
        rows.all.iter().map(cleaned).collect()
    }
}
