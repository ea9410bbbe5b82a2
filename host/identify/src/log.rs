//! A recorded test as samples: reads and checks the columns, converts encoder readings to angles, and computes the
//! twist from whole counts.

use std::f64::consts::TAU;

use super::arguments::Arguments;
use super::prior::PriorModel;
use super::sampling::sampling;
use super::statistics::range_of;
use board::profile::MAX_TORQUE;
use log_reader::columns::{Columns, MOTOR, OUTPUT, TIMES};
use log_reader::even_times::EvenTimes;
use log_reader::noise::Noise;
use log_reader::readings::{Kind, Readings, missing_encoder, readings};
use log_reader::resolution::count_angle;
use log_reader::{bad_readings, time_stamps};
use report::failure::{Failure, Outcome};
use report::number::TYPED;

/// Least travel of the motor [counts]: a smaller one may be scatter of the encoder.
const MOTOR_TRAVEL_MIN: f64 = 8.0;
/// Window on either side for the link's speed [s].
const SPEED_WINDOW: f64 = 1e-3;
/// Quantisation scatters by 1/12 of a count squared; readings with less than this share of it were filtered.
pub const FILTERED_VARIANCE_SHARE: f64 = 0.1;

/// A recorded test.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// Time since the first sample [s].
    pub time: Vec<f64>,
    /// Sampling period [s].
    pub period: f64,
    /// Motor angle, corrected by the encoder errors found so far [rad].
    pub motor: Vec<f64>,
    /// Output angle, corrected by the encoder errors found so far [rad].
    pub output: Vec<f64>,
    /// Motor angle corrected by the errors of the teeth; planets and carrier follow it [rad].
    pub motor_without_tooth_errors: Vec<f64>,
    /// Motor angle over the ratio less output angle, uncorrected, exact for counts [rad].
    pub twist: Vec<f64>,
    /// Motor torque [N m].
    pub torque: Vec<f64>,
    /// Torque of the joint on its link; `None` if it was not measured [N m].
    pub output_torque: Option<Vec<f64>>,
    /// Variance of motor and output readings [rad^2].
    pub noise: [Noise; 2],
    /// Age of the output's readings relative to the motor's, as far as it is known [s].
    pub output_age: f64,
    /// Kind of the motor and output readings.
    pub kinds: [Kind; 2],
    /// Changes made to the rows of the file, a sentence each.
    pub notes: Vec<String>,
    /// Even times, with the gaps between samples.
    pub times: EvenTimes,
}

impl Log {
    /// Reads a file.
    pub fn read(arguments: &Arguments, prior: &PriorModel) -> Outcome<Self> {
        arguments.read_log(prior.ratio(), Columns::has_required, |columns| Self::from_columns(columns, prior))
    }

    fn from_columns(columns: &mut Columns, prior: &PriorModel) -> Outcome<Self> {
        columns.remove_incomplete(&[&TIMES, &MOTOR, &OUTPUT, &["motor_torque_N_m"], &["output_torque_N_m"]])?;
        time_stamps::resolve(columns)?;
        for (names, turn) in [(MOTOR, prior.motor_turn), (OUTPUT, prior.output_turn)] {
            bad_readings::remove_from_encoder(columns, names, turn)?.ok_or_else(|| missing_encoder(columns, names))?;
        }
        let time = columns.time_from_start()?;
        let times = sampling(&time, columns, prior)?;
        let motor = readings(columns, MOTOR, prior.motor_turn, &times)?;
        let output = readings(columns, OUTPUT, prior.output_turn, &times)?;
        let (_, torque) = columns.named(&["motor_torque_N_m"])?;
        let output_torque = columns.finite("output_torque_N_m")?;
        for (name, torques) in [("motor_torque_N_m", Some(&torque)), ("output_torque_N_m", output_torque.as_ref())] {
            let torques = torques.into_iter().flatten();
            if let Some((row, torque)) = torques.enumerate().find(|(_, torque)| torque.abs() > MAX_TORQUE) {
                return Err(Failure::new(format!("{}: `{name}` is {}", columns.place(row), TYPED.write(*torque)))
                    .with_help(format!("it may be from -{MAX_TORQUE} to {MAX_TORQUE} N m: check the unit")));
            }
        }
        let twist = twist(&motor, &output, prior);
        let kinds = [motor.kind(), output.kind()];
        let (motor, output) = (motor.angles(prior.motor_turn), output.angles(prior.output_turn));
        let times = times.smoother(&time, &motor);
        let [motor, output, twist, torque] = [motor, output, twist, torque].map(|values| times.resample(&values));
        let log = Self {
            kinds,
            output_age: 0.0,
            time: times.times(),
            period: times.period,
            noise: [&motor, &output].map(|angles| Noise::measure(angles, |from, to| times.is_whole(from, to))),
            motor_without_tooth_errors: motor.clone(),
            motor,
            output,
            twist,
            torque,
            output_torque: output_torque.map(|torque| times.resample(&torque)),
            notes: columns.notes().iter().cloned().chain(times.note.clone()).collect(),
            times,
        };
        log.check(prior)?;
        Ok(log)
    }

    /// Phase of the teeth, one turn per mesh period at the ring, from motor and output angle weighted by their inertias
    /// [rad].
    pub fn mesh_phase(&self, sample: usize, prior: &PriorModel) -> f64 {
        let share = prior.motor_share();
        let joint = (1.0 - share) * self.output[sample] + share * self.motor[sample] / prior.ratio();
        f64::from(prior.ring_teeth) * joint
    }

    /// Returns the log with encoder and tooth errors, each a function of its angle, subtracted, and the output advanced
    /// to the motor's time. Accelerations and the phase of the teeth are sensitive to both.
    pub fn with_errors_removed(&self, errors: [&dyn Fn(f64) -> f64; 3], skew: f64, prior: &PriorModel) -> Self {
        let [motor, output, teeth] = errors;
        let corrected = |angles: &[f64], error: &dyn Fn(f64) -> f64| -> Vec<f64> {
            angles.iter().map(|angle| angle - error(angle - error(*angle))).collect()
        };
        let (motor, read) = (corrected(&self.motor, motor), corrected(&self.output, output));
        // The motor swings while the link does not, so the skew is applied with the link's own speed.
        let around = (SPEED_WINDOW / self.period).ceil() as usize;
        let speed = |sample: usize| {
            let (before, after) = (sample.saturating_sub(around), (sample + around).min(read.len() - 1));
            (read[after] - read[before]) / ((after - before) as f64 * self.period)
        };
        let output: Vec<f64> = (0..read.len()).map(|sample| read[sample] + skew * speed(sample)).collect();
        let mut log = Self { motor, output, output_age: skew, motor_without_tooth_errors: Vec::new(), ..self.clone() };
        let motor_without_tooth_errors =
            |sample: usize| log.motor[sample] - prior.ratio() * teeth(log.mesh_phase(sample, prior));
        log.motor_without_tooth_errors = (0..log.motor.len()).map(motor_without_tooth_errors).collect();
        log
    }

    /// Variance of motor and output angles over the variance of their quantisation; `None` unless one of them is
    /// smoother than its encoder can resolve.
    pub fn variance_shares(&self, prior: &PriorModel) -> Option<[f64; 2]> {
        let share = |place: usize, turn: u64| {
            let count = count_angle(turn);
            if self.kinds[place] == Kind::Angles { 12.0 * self.noise[place].mean() / (count * count) } else { 1.0 }
        };
        let shares = [share(0, prior.motor_turn), share(1, prior.output_turn)];
        shares.iter().any(|share| *share < FILTERED_VARIANCE_SHARE).then_some(shares)
    }

    fn check(&self, prior: &PriorModel) -> Outcome<()> {
        let counts = range_of(&self.motor) * prior.motor_turn as f64 / TAU;
        if counts < MOTOR_TRAVEL_MIN {
            return Err(Failure::new(format!(
                "the motor does not move in this log: by {counts:.1} counts of its encoder, {MOTOR_TRAVEL_MIN} are the least"
            ))
            .with_help("the torque must overcome the friction, and turn the motor through the gap"));
        }
        Ok(())
    }
}

/// Motor angle over the ratio less output angle; in whole numbers for counts, so that many turns lose no digits.
fn twist(motor: &Readings, output: &Readings, prior: &PriorModel) -> Vec<f64> {
    if let (Readings::Counts(motor), Readings::Counts(output)) = (motor, output) {
        let [sun, both] = prior.teeth.map(i128::from);
        let [motor_turn, output_turn] = [prior.motor_turn, prior.output_turn].map(i128::from);
        let turn = (both * motor_turn * output_turn) as f64;
        let pair = motor.iter().zip(output);
        return pair
            .map(|(&motor, &output)| {
                let apart = i128::from(motor) * sun * output_turn - i128::from(output) * both * motor_turn;
                apart as f64 / turn * TAU
            })
            .collect();
    }
    let (motor, output) = (motor.angles(prior.motor_turn), output.angles(prior.output_turn));
    motor.iter().zip(&output).map(|(motor, output)| motor / prior.ratio() - output).collect()
}
