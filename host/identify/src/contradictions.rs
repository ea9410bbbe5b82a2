//! Rejection of logs that contradict the joint file or themselves. The angles of a geared joint turn by its ratio, and
//! a torque accelerates an inertia. If the numbers contradict this, a unit, a sign, a resolution or the time step is
//! wrong, and every result would be wrong by as much. The failure names the likely causes.

use std::f64::consts::TAU;

use super::balances::{self, CERTAINTY_SIGMA, Factor};
use super::findings::Finding;
use super::log::{FILTERED_VARIANCE_SHARE, Log};
use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::Rows;
use super::statistics::range_of;
use super::twist::{self, BLOCK_LENGTH, Twist};
use log_reader::readings::Kind;
use log_reader::resolution::{count_angle, resolution};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Largest number of moments at which the angles are compared.
const MOMENTS_MAX: usize = 4000;
/// Tolerance of the ratio over a whole turn and more: encoder errors cancel, and teeth do not slip.
const RATIO_TOLERANCE_OVER_TURNS: f64 = 2e-3;
/// Sum of the errors of both encoders at both ends of the output's travel [rad].
const ENCODER_ERROR_SUM: f64 = 0.01;
/// Tolerance of the ratio within a turn: an encoder error of 0.2 degrees mimics this much.
const RATIO_TOLERANCE_WITHIN_A_TURN: f64 = 1e-2;
/// Multiple of the joint file's gap and wind-up that may mimic another ratio while the joint hardly moves.
const SLACK_FACTOR: f64 = 3.0;
/// Error by angle allowed for any encoder [rad].
const ANGLE_ERROR_MIN: f64 = 1e-3;
/// Share of the motor's travel below which the output stands.
const STANDING_TRAVEL_SHARE: f64 = 1e-3;
/// Kernel box of the torque balances: longer than a swing on the compliance, shorter than a reversal [s].
const BALANCE_BOX: f64 = 8e-3;
/// Largest ratio between the log's and the joint file's total inertia.
const TOTAL_INERTIA_FACTOR_MAX: f64 = 1.6;
/// Largest ratio between the log's and the joint file's motor inertia, which a data sheet states.
const MOTOR_INERTIA_FACTOR_MAX: f64 = 1.25;
/// Largest factor by which the torque behind the gears may differ from the torque before the gears times the gear
/// ratio.
const GEAR_TORQUE_FACTOR_MAX: f64 = 1.5;
/// A cause is likely within this logarithm of the factor; the CAUSES_NAMED nearest causes are named.
const CAUSE_DISTANCE_MAX: f64 = 0.2;
const CAUSES_NAMED: usize = 4;
/// Largest error of the counts per turn of both encoders that is tried as a cause, as a power of two.
const BITS_TRIED: i32 = 5;
/// If a torque sensor at the output gives both inertias this much larger, or this much smaller, the time step is wrong
/// rather than both inertias.
const BOTH_INERTIAS_FACTOR_MAX: f64 = 1.08;
/// Largest step of the offset between the encoders, as a share of the lost motion.
const OFFSET_STEP_MAX: f64 = 0.03;
/// Largest phase of the swing during the output's age [rad]; an older reading hardly depends on the twist.
const OUTPUT_AGE_MAX: f64 = 0.35;
/// Variance, as a share of the quantisation's, below which angles were never read by an encoder.
const SIMULATED_VARIANCE_SHARE: f64 = 1e-6;
/// Largest age of the motor's readings relative to the output's, as a phase of the swing [rad]; older readings do not
/// belong to the logged torque.
const MOTOR_AGE_MAX: f64 = 0.2;
/// Half-intervals below zero from which a friction contradicts the log.
const NEGATIVE_FRICTION_HALVES: f64 = 3.0;
/// Largest constant torque, as a share of the largest torque.
const CONSTANT_TORQUE_MAX: f64 = 0.08;
/// Largest ratio between the torque scales of both directions.
const DIRECTION_FACTOR_MAX: f64 = 1.2;
/// Largest relative change of the torque scale above 0.6 of the largest torque.
const NONLINEARITY_MAX: f64 = 0.3;
/// Relative difference below which the torques before and behind the gears are copies of each other.
const COPY_DIFFERENCE: f64 = 0.01;

const DEGREES: f64 = 360.0 / TAU;
/// Angle units that may be mistaken for radians, per radian.
const ANGLE_UNITS: [(&str, f64); 3] = [("turns", 1.0 / TAU), ("degrees", DEGREES), ("mrad", 1e3)];
/// Torque units that may be mistaken for N m, per N m.
const TORQUE_UNITS: [(&str, f64); 5] =
    [("mN m", 1e3), ("N cm", 1e2), ("kgf cm", 10.197), ("ozf in", 141.61), ("lbf in", 8.8507)];
/// Ratios by which a time step may be wrong: another prescaler, or every n-th sample.
const TIME_STEP_FACTORS: [f64; 6] = [2.0, 3.0, 4.0, 5.0, 8.0, 10.0];
/// Range of plausible torque constants [N m/A].
const TORQUE_CONSTANTS: [f64; 2] = [0.002, 20.0];

/// Possible causes of a factor, each with its logarithmic distance from the factor.
struct Causes {
    factor: f64,
    list: Vec<(f64, String)>,
}

impl Causes {
    fn new(factor: Factor) -> Self {
        Self { factor: factor.value, list: Vec::new() }
    }

    /// Adds a cause that gives the factor `by`, if it is close enough.
    fn consider(&mut self, by: f64, text: impl Into<String>) {
        let apart = (self.factor / by).ln().abs();
        if self.factor * by > 0.0 && apart < CAUSE_DISTANCE_MAX {
            self.list.push((apart, text.into()));
        }
    }

    /// Help text: the likeliest causes, then `otherwise`, then what to check in any case.
    fn help(mut self, otherwise: Option<String>, check: &str) -> String {
        self.list.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut causes: Vec<String> = self.list.into_iter().take(CAUSES_NAMED).map(|(_, text)| text).collect();
        causes.extend(otherwise);
        if causes.is_empty() { check.to_owned() } else { format!("perhaps {}; {check}", causes.join(", or ")) }
    }
}

/// Rejects a log whose angles contradict the joint's ratio.
pub fn check_angles(log: &Log, prior: &PriorModel) -> Outcome<()> {
    let [motor, output] = [&log.motor, &log.output].map(|angles| range_of(angles));
    let of_motor = motor / prior.ratio();
    let slack =
        SLACK_FACTOR * (prior.lost_motion + 2.0 * prior.compliance * largest_torque(log, prior) + ANGLE_ERROR_MIN);
    if output < STANDING_TRAVEL_SHARE * of_motor && of_motor > slack {
        return Err(Failure::new(format!(
            "the output does not turn in this log: by {output:.6} rad, the motor over its ratio by {of_motor:.4} rad"
        ))
        .with_help("check the output encoder and its column"));
    }
    let Some(factor) = angle_factor(log, prior) else { return Ok(()) };
    let least = if output > TAU {
        RATIO_TOLERANCE_OVER_TURNS.min(ENCODER_ERROR_SUM / output)
    } else {
        RATIO_TOLERANCE_WITHIN_A_TURN
    };
    if (factor.value - 1.0).abs()
        < least.max(CERTAINTY_SIGMA * factor.deviation).max(slack / output.max(f64::MIN_POSITIVE))
    {
        return Ok(());
    }
    let message = format!(
        "output and motor do not turn together: by {output:.4} rad and {of_motor:.4} rad (motor over its ratio of {:.4}), \
         {} of them for each of the output",
        prior.ratio(),
        ESTIMATE.write(factor.value),
    );
    let check = "check the teeth of the joint file, units, --motor-bits and --output-bits, and that both encoders count up \
                 when the joint turns forwards";
    let ratio = format!("the gear ratio is {} instead", ESTIMATE.write(prior.ratio() * factor.value));
    let causes = angle_causes(log, prior, factor);
    let otherwise = causes.list.is_empty().then_some(ratio).filter(|_| factor.value > 0.0);
    Err(Failure::new(message).with_help(causes.help(otherwise, check)))
}

/// Travel of the motor over the ratio per travel of the output, separated from the change by flank.
fn angle_factor(log: &Log, prior: &PriorModel) -> Option<Factor> {
    let mut equations = Equations::default();
    for sample in (0..log.time.len()).step_by((log.time.len() / MOMENTS_MAX).max(1)) {
        let torque = log.torque[sample];
        let side = if torque == 0.0 { 0.0 } else { torque.signum() };
        let block = (log.time[sample] / BLOCK_LENGTH) as usize;
        equations.push(vec![1.0, side, log.output[sample]], log.motor[sample] / prior.ratio(), block);
    }
    Some(Factor::of_unknown(&equations.solve(&[f64::INFINITY; 3])?, 2))
}

fn angle_causes(log: &Log, prior: &PriorModel, factor: Factor) -> Causes {
    let ratio = prior.ratio();
    let [motor, output] = log.kinds;
    let [motor_turn, output_turn] = [prior.motor_turn, prior.output_turn];
    let mut causes = Causes::new(factor);
    causes.consider(1.0 / ratio, "the motor's angle is taken behind the gears");
    causes.consider(ratio, "the output's angle is the motor's");
    let counts = if log.kinds == [Kind::Counts; 2] { output_turn as f64 / motor_turn as f64 } else { 1.0 };
    causes.consider(counts * counts / (ratio * ratio), "motor and output are exchanged");
    causes.consider(-1.0, "one encoder counts down when the joint turns forwards");
    for (kind, name, sign, stated_turn) in [(motor, "motor", 1, motor_turn), (output, "output", -1, output_turn)] {
        if kind == Kind::Angles {
            for (unit, by) in ANGLE_UNITS {
                causes.consider(by.powi(sign), format!("the {name}'s angle is in {unit}"));
            }
            causes.consider((stated_turn as f64 / TAU).powi(sign), format!("the {name}'s angle is in counts"));
        } else {
            for more in (-16..=16).filter(|more| *more != 0) {
                let Some(turn) = doubled(stated_turn, more).filter(|turn| (1 << 8..=1 << 30).contains(turn)) else {
                    continue;
                };
                let text = format!("the {name} encoder has {}", resolution(turn));
                causes.consider(f64::from(-more).exp2().powi(-sign), text);
            }
        }
    }
    causes
}

/// Rejects a log whose torque does not fit the acceleration of the inertias, or the torque behind the gears.
///
/// The ringing is evaluated with a kernel box of `shortest` [s].
pub fn check_torques(log: &Log, prior: &PriorModel, shortest: f64) -> Outcome<()> {
    let rows = Rows::new(log, prior, BALANCE_BOX);
    check_gear_torque(prior, &rows)?;
    let Some(whole) = balances::total_factor(&rows, prior) else { return Ok(()) };
    if !whole.is_determined() || !whole.is_certainly_outside(TOTAL_INERTIA_FACTOR_MAX) {
        return Ok(());
    }
    // If the motor's own inertia agrees, the link's inertia is wrong.
    let rows = Rows::new(log, prior, shortest);
    let of_motor = twist::fit_free_torque(log, &rows, prior).map(|free| balances::ringing_factor(&free.solution));
    if whole.value > 0.0
        && of_motor
            .is_some_and(|factor| factor.is_determined() && !factor.is_certainly_outside(MOTOR_INERTIA_FACTOR_MAX))
    {
        let link = (whole.value * prior.total_inertia() - prior.motor_at_output()).max(0.0);
        let message = format!(
            "the link of this log has an inertia of about {} kg m^2, that of the joint file {}",
            ESTIMATE.write(link),
            ESTIMATE.write(prior.link_inertia)
        );
        let help = format!(
            "set link_inertia_kg_m2 as it was in the test, such as by --set link_inertia_kg_m2={link:.3}: the motor's own \
             inertia goes with the torque"
        );
        return Err(Failure::new(message).with_help(help));
    }
    Err(contradiction(log, prior, whole, "all that turns", prior.total_inertia()))
}

/// Rejects a log whose torque during ringing contradicts the motor inertia in the joint file; `free` is a fit with an
/// unknown torque scale.
pub fn check_ringing(log: &Log, prior: &PriorModel, free: &Solution) -> Outcome<()> {
    let factor = balances::ringing_factor(free);
    if !factor.is_determined() || !factor.is_certainly_outside(MOTOR_INERTIA_FACTOR_MAX) {
        return Ok(());
    }
    Err(contradiction(log, prior, factor, "the motor", prior.motor_inertia))
}

/// Rejects a log in which the offset between the encoders changes: a slip, lost counts, or two joined logs.
pub fn check_offsets(log: &Log, rows: &Rows, prior: &PriorModel) -> Outcome<()> {
    let Some(steps) = twist::offset_steps(log, rows, prior) else { return Ok(()) };
    let least = (OFFSET_STEP_MAX * prior.lost_motion).max(2.0 * counts(prior));
    let is_sure = |(value, deviation): &(f64, f64)| value.abs() > least + CERTAINTY_SIGMA * deviation;
    let Some(place) = steps.iter().position(is_sure) else { return Ok(()) };
    let length = log.time.last().copied().unwrap_or_default() / twist::STRETCHES as f64;
    let [from, to] = [place, place + 2].map(|place| ESTIMATE.write(place as f64 * length));
    Err(Failure::new(format!(
        "the offset between motor and output changes by {} mrad at the output from {from} s to {to} s; the \
             lost motion in the joint file is {} mrad",
        ESTIMATE.write(1e3 * steps[place].0),
        ESTIMATE.write(1e3 * prior.lost_motion)
    ))
    .with_help(
        "perhaps an encoder or a clamp slipped, counts were lost, or two logs were joined; cut the log to a \
             part without slips",
    ))
}

/// One count of both encoders, at the output [rad].
fn counts(prior: &PriorModel) -> f64 {
    count_angle(prior.motor_turn) / prior.ratio() + count_angle(prior.output_turn)
}

/// Counts per turn times 2^times; `None` unless whole.
fn doubled(turn: u64, times: i32) -> Option<u64> {
    let factor = 1_u64.checked_shl(times.unsigned_abs())?;
    if times < 0 { turn.is_multiple_of(factor).then(|| turn / factor) } else { turn.checked_mul(factor) }
}

/// Rejects a log in which motor and output are read so far apart in time that the swing reverses between the two
/// readings.
pub fn check_age(twist: &Twist, prior: &PriorModel) -> Outcome<()> {
    let age = twist.solution.values[twist::SKEW];
    let scatter = twist.solution.half(&[(twist::SKEW, 1.0)]);
    let radian = prior.swing_period() / TAU;
    let (most, older, newer) = if age > 0.0 {
        (OUTPUT_AGE_MAX * radian, "output's", "motor's")
    } else {
        (MOTOR_AGE_MAX * radian, "motor's", "output's")
    };
    if age.abs() - scatter < most {
        return Ok(());
    }
    Err(Failure::new(format!(
        "the {older} readings are {} ms older than the {newer}, but a joint that swings at {:.0} Hz needs \
             them within {} ms",
        ESTIMATE.write(1e3 * age.abs()),
        1.0 / prior.swing_period(),
        ESTIMATE.write(1e3 * most)
    ))
    .with_help(format!(
        "perhaps a filter delays the {older} readings: record them unfiltered; or one column lags by this \
             time: shift it by the corresponding number of rows"
    )))
}

/// Rejects a log of filtered angles: their scatter is below the encoders' and above that of simulated angles, or they
/// follow the torque so late that the swing reverses in the meantime.
pub fn check_filter(log: &Log, twist: &Twist, prior: &PriorModel) -> Outcome<()> {
    let Some(shares) = log.variance_shares(prior) else { return Ok(()) };
    let most = OUTPUT_AGE_MAX * prior.swing_period() / TAU;
    // With a torque measured at the output the delay shows as damping of the swing, otherwise as delay of the motor's
    // torque.
    let is_late = [(twist::RELAXATION, -1.0), (twist::DELAY, 1.0)]
        .into_iter()
        .any(|(unknown, sign)| sign * twist.solution.values[unknown] - twist.solution.half(&[(unknown, 1.0)]) > most);
    if !is_late && !shares.iter().any(|share| (SIMULATED_VARIANCE_SHARE..FILTERED_VARIANCE_SHARE).contains(share)) {
        return Ok(());
    }
    let [motor, output] = shares.map(|share| ESTIMATE.write(share.sqrt()));
    Err(Failure::new(format!(
        "the angles are smoother than encoders of {} (motor) and {} (output) give them: they scatter {motor} and {output} times \
         as much",
        resolution(prior.motor_turn),
        resolution(prior.output_turn),
    ))
    .with_help("perhaps a filter or an observer smoothed them: log raw readings, or say --motor-bits and --output-bits as they are"))
}

/// Rejects a log whose torque at the output gives implausible inertias.
pub fn check_sensor(prior: &PriorModel, [_, motor, link]: [Option<Factor>; 3]) -> Outcome<()> {
    let sure = |factor: &Option<Factor>, most: f64| {
        factor.filter(|factor| factor.is_determined() && factor.is_certainly_outside(most))
    };
    if let (Some(motor), Some(link)) = (sure(&motor, BOTH_INERTIAS_FACTOR_MAX), sure(&link, BOTH_INERTIAS_FACTOR_MAX))
        && (motor.value > 1.0) == (link.value > 1.0)
    {
        let step = (motor.value * link.value).powf(0.25);
        return Err(Failure::new(format!(
            "by the torque at the output the inertias of motor and link are {} and {} times the joint file's",
            ESTIMATE.write(motor.value),
            ESTIMATE.write(link.value)
        ))
        .with_help(format!(
            "perhaps samples are {} times as far apart in the log as in truth, or the torque at the output is in another unit; check \
             the time, units and bits",
            ESTIMATE.write(step)
        )));
    }
    let Some(motor) = sure(&motor, MOTOR_INERTIA_FACTOR_MAX) else { return Ok(()) };
    let inertia = motor.value * prior.motor_inertia;
    Err(Failure::new(format!(
        "by the torque at the output the inertia that turns with the motor is {} kg m^2, but {} kg m^2 by the \
             joint file",
        ESTIMATE.write(inertia),
        ESTIMATE.write(prior.motor_inertia)
    ))
    .with_help("check rotor_inertia_kg_m2 and the gears' inertia, units and signs of both torques"))
}

/// Rejects a log with a negative friction.
pub fn check_frictions(findings: &[Finding]) -> Outcome<()> {
    let drives = |finding: &&Finding| {
        let (Some(value), Some([low, high])) = (finding.value, finding.interval) else { return false };
        value + NEGATIVE_FRICTION_HALVES * 0.5 * (high - low) < 0.0 && finding.is_friction()
    };
    let Some(finding) = findings.iter().find(drives) else { return Ok(()) };
    Err(Failure::new(format!(
        "the {} is negative in this log: {} {}",
        finding.name,
        ESTIMATE.write(finding.value.unwrap_or_default()),
        finding.unit
    ))
    .with_help(
        "perhaps the time runs backwards, the sign of the torque or of the angles is wrong, or the efficiency \
         in the joint file is too low",
    ))
}

/// Rejects a log whose torque differs by direction, is not proportional, or has a large constant part.
pub fn check_symmetry(log: &Log, prior: &PriorModel) -> Outcome<()> {
    let rows = &Rows::new(log, prior, BALANCE_BOX);
    // If the whole balance is undetermined, so are its parts.
    if !balances::total_factor(rows, prior).is_some_and(Factor::is_determined) {
        return Ok(());
    }
    let constant = balances::constant_torque(rows, prior);
    if constant.is_some_and(|Factor { value, deviation }| {
        value.abs() - CERTAINTY_SIGMA * deviation > CONSTANT_TORQUE_MAX * rows.largest_torque
    }) {
        let value = constant.map_or(f64::NAN, |constant| constant.value);
        return Err(Failure::new(format!(
            "a constant torque of {} N m at the output is in this log, beside weight and friction, or {} N m at the motor",
            ESTIMATE.write(value),
            ESTIMATE.write(value / prior.ratio())
        ))
        .with_help("correct the zero of the torque measurement, check that its scale is the same in both directions, or \
             remove the constant load"));
    }
    if let Some([small, more]) = balances::factors_by_size(rows, prior)
        && small.is_determined()
        && more.value.abs() - CERTAINTY_SIGMA * more.deviation > NONLINEARITY_MAX * small.value.abs()
    {
        let ratio = (small.value + more.value) / small.value;
        return Err(Failure::new(format!(
            "the torque of this log is not in proportion to what turns: from six tenths of the largest on it grows {} times as fast as \
             below",
            ESTIMATE.write(ratio)
        ))
        .with_help("perhaps it is clipped, or the drive gives less than commanded: log the torque from measured currents"));
    }
    let Some([forwards, backwards]) = balances::factors_by_direction(rows, prior) else { return Ok(()) };
    let (value, deviation) = (
        forwards.value / backwards.value,
        (forwards.deviation / forwards.value).hypot(backwards.deviation / backwards.value),
    );
    let both = Factor { value, deviation: deviation * value.abs() };
    if !forwards.is_determined()
        || !backwards.is_determined()
        || value <= 0.0
        || !both.is_certainly_outside(DIRECTION_FACTOR_MAX)
    {
        return Ok(());
    }
    Err(Failure::new(format!(
        "for the same acceleration the torque of this log is {} times as large forwards as backwards",
        ESTIMATE.write(value)
    ))
    .with_help("perhaps it is clipped or scaled in one direction: check the torque measurement and its zero"))
}

/// Rejects a torque behind the gears that differs from the motor's torque less the torque for its own acceleration and
/// friction.
fn check_gear_torque(prior: &PriorModel, rows: &Rows) -> Outcome<()> {
    let mut equations = Equations::with_repetition(rows.repetition);
    let mut alone = Equations::with_repetition(rows.repetition);
    for row in rows.all.iter().filter(|row| row.direction != 0.0) {
        let Some(measured) = row.measured else { continue };
        let block = (row.time / BLOCK_LENGTH) as usize;
        equations.push(vec![row.drive_torque, row.direction, 1.0], measured, block);
        alone.push(vec![row.motor_torque / row.leverage, 1.0], measured, block);
    }
    let same = alone.solve(&[f64::INFINITY; 2]);
    let Some(factor) = equations.solve(&[f64::INFINITY; 3]).map(|solution| Factor::of_unknown(&solution, 0)) else {
        return Ok(());
    };
    let measured: Vec<f64> = rows.all.iter().filter_map(|row| row.measured).collect();
    if same.is_some_and(|same| same.noise < COPY_DIFFERENCE * root_mean_square(&measured)) {
        return Err(Failure::new(format!(
            "the torque at the output is {} times the motor's in every moment: it was not measured there",
            ESTIMATE.write(factor.value)
        ))
        .with_help("remove the column that was computed from the other"));
    }
    if !factor.is_determined() || !factor.is_certainly_outside(GEAR_TORQUE_FACTOR_MAX) {
        return Ok(());
    }
    let mut causes = Causes::new(factor);
    for (unit, by) in TORQUE_UNITS {
        causes.consider(by, format!("the torque at the output is in {unit}"));
        causes.consider(1.0 / by, format!("the motor's torque is in {unit}"));
    }
    causes.consider(1.0 / prior.ratio(), "both torques are measured on the same side of the gears");
    causes.consider(-1.0, "one torque has the other sign");
    let message = format!(
        "the torque at the output is {} times what the motor's torque gives there by the ratio of {:.4}",
        ESTIMATE.write(factor.value),
        prior.ratio()
    );
    Err(Failure::new(message).with_help(causes.help(None, "check signs and units of both torques")))
}

fn contradiction(log: &Log, prior: &PriorModel, factor: Factor, what: &str, inertia: f64) -> Failure {
    if factor.value < 0.0 {
        return Failure::new(format!("the torque of this log brakes {what} where it speeds up")).with_help(
            "change the sign of the torque, or of both angles: all must be positive when the joint turns forwards",
        );
    }
    let message = format!(
        "the torque of this log is {} times what {what} needs for its acceleration by the joint file's inertia of {} kg m^2",
        ESTIMATE.write(factor.value),
        ESTIMATE.write(inertia)
    );
    let mut causes = Causes::new(factor);
    if log.kinds == [Kind::Angles; 2] {
        for (unit, by) in ANGLE_UNITS {
            causes.consider(1.0 / by, format!("both angles are in {unit}"));
        }
    }
    if log.kinds == [Kind::Counts; 2] {
        for more in (-BITS_TRIED..=BITS_TRIED).filter(|more| *more != 0) {
            let [motor, output] = [prior.motor_turn, prior.output_turn].map(|turn| doubled(turn, -more));
            let (Some(motor), Some(output)) = (motor, output) else { continue };
            let text = format!("the encoders have {} (motor) and {} (output)", resolution(motor), resolution(output));
            causes.consider(f64::from(more).exp2(), text);
        }
    }
    for (unit, by) in TORQUE_UNITS {
        causes.consider(by, format!("the torque is in {unit}"));
    }
    causes.consider(prior.ratio(), "the torque is the output's");
    for by in TIME_STEP_FACTORS {
        causes.consider(by * by, format!("samples are {by} times as far apart in the log as in truth"));
        causes.consider(1.0 / (by * by), format!("samples are {by} times as close in the log as in truth"));
    }
    let constant = 1.0 / factor.value;
    let current = format!("the torque is a current, of {} N m/A", ESTIMATE.write(constant));
    let inertia = format!("the inertia is {} kg m^2", ESTIMATE.write(factor.value * inertia));
    let is_a_current = (TORQUE_CONSTANTS[0]..TORQUE_CONSTANTS[1]).contains(&constant);
    let otherwise = if is_a_current { format!("{current}, or {inertia}") } else { inertia };
    Failure::new(message).with_help(causes.help(Some(otherwise), "check units, encoder bits and the time"))
}

/// Root mean square of the values.
fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Largest torque of the log, at the output [N m].
fn largest_torque(log: &Log, prior: &PriorModel) -> f64 {
    prior.ratio() * log.torque.iter().fold(0.0_f64, |most, torque| most.max(torque.abs()))
}
