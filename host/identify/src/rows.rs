//! Moments that the fits use: one flank carries torque, and all signals are smoothed by one kernel. Moments near a
//! change of flank or with an uncertain direction of motion are skipped.

use super::kernel::Kernel;
use super::log::Log;
use super::prior::PriorModel;
use log_reader::resolution::count_angle;

/// Levels of torque; a systematic error of each level, of both signs together, widens the intervals.
const TORQUE_LEVELS: f64 = 20.0;
/// Largest delay of the torque, from command to air gap [s].
const TORQUE_DELAY_MAX: f64 = 1.5e-3;
/// A flank carries if its torque exceeds this share of the largest torque, ...
const CARRYING_SHARE: f64 = 0.03;
/// ... this multiple of the torque that friction can mimic, ...
const CARRYING_FRICTIONS: f64 = 1.5;
/// ... and this many standard deviations of the torque that the motor encoder's scatter mimics.
const CARRYING_SIGMA: f64 = 4.0;
/// A kernel box above this share of a swing does not resolve the swing.
const BOX_PER_SWING_MAX: f64 = 0.5;
/// Duration of bouncing after a change of flank [s].
const BOUNCE_TIME: f64 = 0.07;
/// Two strokes are alike if duration and torque agree within this share.
const STROKE_TOLERANCE: f64 = 0.1;
/// Torque of a stroke: this quantile of the torque's size.
const STROKE_TORQUE_QUANTILE: f64 = 0.8;
/// Shares of the carrying time in strokes of one kind at which repetition begins and is complete.
const REPETITION_RANGE: [f64; 2] = [0.6, 0.75];
/// Window on either side for the direction of a slow motor [s].
const SLOW_WINDOW: f64 = 0.05;
/// Least motion of a slow motor in each quarter of the window [counts].
const SLOW_COUNTS_MIN: f64 = 2.0;
/// Steps per swing between readings that decide the motor's direction.
const DIRECTION_STEPS_PER_SWING: f64 = 6.0;
/// Largest error of an encoder from one reading to the next [counts].
const READING_ERROR_MAX: f64 = 1.01;

/// One moment of the fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Index of the moment's sample in the log.
    pub sample: usize,
    /// Time [s].
    pub time: f64,
    /// Motor angle over the ratio less output angle [rad].
    pub twist: f64,
    /// Rate of the twist, corrected by the errors of encoders and teeth [rad/s].
    pub twist_rate: f64,
    /// Motor angle [rad].
    pub motor: f64,
    /// Motor speed [rad/s].
    pub motor_speed: f64,
    /// Motor acceleration [rad/s^2].
    pub motor_acceleration: f64,
    /// Output angle [rad].
    pub output: f64,
    /// Output speed [rad/s].
    pub output_speed: f64,
    /// Output acceleration [rad/s^2].
    pub output_acceleration: f64,
    /// Motor torque less the motor's acceleration and viscous torque, referred to the output after the gears' losses [N
    /// m].
    pub drive_torque: f64,
    /// Output torque over motor torque: the ratio after the gears' losses.
    pub leverage: f64,
    /// Motor torque referred to the output after the gears' losses [N m].
    pub motor_torque: f64,
    /// Rate of the motor torque, at the output [N m/s].
    pub drive_rate: f64,
    /// Torque measured at the output; `None` if it was not measured [N m].
    pub measured: Option<f64>,
    /// Direction of the motor: -1, 1, or 0 if it is uncertain.
    pub direction: f64,
    /// Flank that carries: 1 when the motor drives forwards, -1 backwards, 0 near a change and in the gap.
    pub flank: f64,
}

/// Moments of a log, evenly spaced.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// All moments, carrying or not.
    pub all: Vec<Row>,
    /// Kernel of the smoothing.
    pub kernel: Kernel,
    /// 95 % quantile of the torque's size at the output [N m].
    pub largest_torque: f64,
    /// Changes of the carrying flank.
    pub crossings: usize,
    /// Time between moments [s].
    pub step: f64,
    /// Repetition of the strokes: 0 if at most 60 % of the carrying time is in strokes of one kind, 1 from 75 % on.
    pub repetition: f64,
    /// Share of the moments left out because samples near them are lost.
    pub excluded_share: f64,
}

impl Rows {
    /// Selects the moments of a log, smoothed with boxes of `length` [s].
    pub fn new(log: &Log, prior: &PriorModel, length: f64) -> Self {
        let samples = ((length / log.period).round() as usize).clamp(2, log.time.len() / 50);
        let kernel = Kernel::new(samples, log.period);
        let half = kernel.half();
        let guard = ((half as f64 + TORQUE_DELAY_MAX / log.period) / samples as f64).ceil() as usize;
        let end = log.time.len().saturating_sub(half);
        let moments = (half..end).step_by(samples);
        // A hole may hide a change of flank.
        let near = half + guard * samples;
        let is_known = |sample: &usize| log.times.is_whole(sample.saturating_sub(near), sample + near + 1);
        let mut all: Vec<Row> =
            moments.clone().filter(is_known).map(|sample| row(log, prior, &kernel, sample)).collect();
        let excluded_share = 1.0 - all.len() as f64 / moments.len().max(1) as f64;
        let mut torques: Vec<f64> = all.iter().map(|row| row.torque().abs()).collect();
        torques.sort_by(f64::total_cmp);
        let largest_torque = torques.get(torques.len() * 19 / 20).copied().unwrap_or_default();
        let friction = prior.ratio() * prior.surroundings.motor_friction.coulomb;
        let carrying = (CARRYING_SHARE * largest_torque).max(CARRYING_FRICTIONS * friction);
        let per_reading = prior.ratio() * prior.motor_inertia * kernel.weight_products()[2][2].sqrt();
        let flank = |row: &Row| {
            let scatter = if row.measured.is_some() { 0.0 } else { per_reading * log.noise[0].at(row.sample).sqrt() };
            let torque = row.torque();
            if torque.abs() > carrying.max(CARRYING_SIGMA * scatter) { torque.signum() } else { 0.0 }
        };
        let sides: Vec<f64> = all.iter().map(flank).collect();
        for (index, row) in all.iter_mut().enumerate() {
            let around = &sides[index.saturating_sub(guard)..(index + guard + 1).min(sides.len())];
            row.flank = if around.iter().all(|flank| *flank == sides[index]) { sides[index] } else { 0.0 };
        }
        let carried: Vec<f64> = all.iter().map(|row| row.flank).filter(|flank| *flank != 0.0).collect();
        let crossings = carried.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let repetition = repetition(&all);
        if length > BOX_PER_SWING_MAX * prior.swing_period() {
            exclude_landings(&mut all);
        }
        Self { all, kernel, largest_torque, crossings, repetition, step: samples as f64 * log.period, excluded_share }
    }

    /// Moments at which a flank carries.
    pub fn carrying(&self) -> impl Iterator<Item = &Row> {
        self.all.iter().filter(|row| row.flank != 0.0)
    }
}

/// One flank carrying, from one change to the next.
struct Stroke {
    flank: f64,
    time: f64,
    torque: f64,
    moments: usize,
}

impl Stroke {
    fn from_rows(rows: &[&Row]) -> Self {
        let mut torques: Vec<f64> = rows.iter().map(|row| row.torque().abs()).collect();
        torques.sort_by(f64::total_cmp);
        Self {
            flank: rows[0].flank,
            time: rows[rows.len() - 1].time - rows[0].time,
            torque: torques[(STROKE_TORQUE_QUANTILE * (torques.len() - 1) as f64) as usize],
            moments: rows.len(),
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |one: f64, other: f64| (one - other).abs() <= STROKE_TOLERANCE * other;
        self.flank == other.flank && near(self.time, other.time) && near(self.torque, other.torque)
    }
}

/// Repetition of the strokes, 0 to 1.
fn repetition(rows: &[Row]) -> f64 {
    let carrying: Vec<&Row> = rows.iter().filter(|row| row.flank != 0.0).collect();
    let strokes: Vec<Stroke> = carrying.chunk_by(|one, next| one.flank == next.flank).map(Stroke::from_rows).collect();
    let of_one_kind = |flank: f64| {
        let repetition = |stroke: &Stroke| -> usize {
            strokes.iter().filter(|other| other.is_like(stroke)).map(|other| other.moments).sum()
        };
        strokes.iter().filter(|stroke| stroke.flank == flank).map(repetition).max().unwrap_or_default()
    };
    let share = (of_one_kind(1.0) + of_one_kind(-1.0)) as f64 / carrying.len().max(1) as f64;
    let [none, all] = REPETITION_RANGE;
    ((share - none) / (all - none)).clamp(0.0, 1.0)
}

/// Excludes the bouncing after a landing: a kernel too long to resolve it would mistake the flight for a deflection.
fn exclude_landings(rows: &mut [Row]) {
    let (mut flank, mut landed) = (0.0, f64::NEG_INFINITY);
    for row in rows.iter_mut().filter(|row| row.flank != 0.0) {
        if row.flank != flank {
            (flank, landed) = (row.flank, row.time);
        }
        if row.time - landed < BOUNCE_TIME {
            row.flank = 0.0;
        }
    }
}

impl Row {
    /// Level of the motor torque's size, in steps of the largest torque.
    pub fn level(&self, largest_torque: f64) -> usize {
        (TORQUE_LEVELS * (self.motor_torque.abs() / largest_torque.max(f64::MIN_POSITIVE)).min(1.0)) as usize
    }

    /// Torque from joint to link, measured or known from the motor before any fit [N m].
    pub fn torque(&self) -> f64 {
        self.measured.unwrap_or(self.drive_torque)
    }

    /// Sensitivity of the torque to losses that grow with the load [N m].
    pub fn loss_sensitivity(&self) -> f64 {
        self.direction * self.torque().abs()
    }
}

fn row(log: &Log, prior: &PriorModel, kernel: &Kernel, sample: usize) -> Row {
    let smooth = |signal: &[f64], order: usize| {
        // Differences to the middle sample keep their digits after many turns.
        let middle = if order == 0 { signal[sample] } else { 0.0 };
        middle + kernel.derivative(|place| signal[place] - middle, sample, order)
    };
    let [motor_speed, output_speed] = [&log.motor, &log.output].map(|angle| smooth(angle, 1));
    let torque = smooth(&log.torque, 0);
    let motor_acceleration = smooth(&log.motor, 2);
    let net =
        torque - prior.motor_inertia * motor_acceleration - prior.surroundings.motor_friction.viscous * motor_speed;
    let direction = direction(log, prior, kernel, sample);
    // Losses that grow with the load: a driving motor passes on less torque, a braking motor has to hold more.
    let efficiency = prior.surroundings.efficiency;
    let leverage = prior.ratio()
        * match net * direction {
            power if power > 0.0 => efficiency,
            power if power < 0.0 => 1.0 / efficiency,
            _ => 1.0,
        };
    Row {
        sample,
        time: log.time[sample],
        twist: smooth(&log.twist, 0),
        twist_rate: smooth(&log.motor_without_tooth_errors, 1) / prior.ratio() - output_speed,
        motor: smooth(&log.motor, 0),
        motor_speed,
        motor_acceleration,
        output: smooth(&log.output, 0),
        output_speed,
        output_acceleration: smooth(&log.output, 2),
        drive_torque: leverage * net,
        leverage,
        motor_torque: leverage * torque,
        drive_rate: leverage * smooth(&log.torque, 1),
        measured: log.output_torque.as_ref().map(|torque| smooth(torque, 0)),
        direction,
        flank: 0.0,
    }
}

/// Direction of the motor throughout the kernel, in steps too short to hide a swing, or over SLOW_WINDOW for a motor
/// too slow for these steps.
fn direction(log: &Log, prior: &PriorModel, kernel: &Kernel, sample: usize) -> f64 {
    let count = count_angle(prior.motor_turn);
    let turns = |half: usize, step: usize, way: f64, least: f64| {
        let places = (sample.saturating_sub(half)..=(sample + half).min(log.motor.len() - 1)).step_by(step.max(1));
        let mut pairs = places.clone().zip(places.skip(1));
        pairs.all(|(before, after)| way * (log.motor[after] - log.motor[before]) > least * count)
    };
    let step = (prior.swing_period() / DIRECTION_STEPS_PER_SWING / log.period) as usize;
    let (quick, slow) = (kernel.half(), (SLOW_WINDOW / log.period) as usize);
    let sure = |way: &f64| {
        turns(quick, step, *way, READING_ERROR_MAX)
            || (turns(slow, slow / 2, *way, SLOW_COUNTS_MIN)
                && turns(quick, step, *way, -READING_ERROR_MAX)
                && log.times.is_whole(sample.saturating_sub(slow), sample + slow + 1))
    };
    [1.0, -1.0].into_iter().find(sure).unwrap_or(0.0)
}
