//! A recorded test as samples: read from columns by their names, checked, encoders as angles and their difference from
//! whole counts.

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

/// Fewer counts of the motor may be its encoder's own scatter.
const LEAST_TRAVEL: f64 = 8.0;
/// The link's speed is taken over this time to either side [s].
const SPEED_OVER: f64 = 1e-3;
/// Readings scatter by the twelfth of a count squared; what scatters by less than this share of it was filtered.
pub const SMOOTH: f64 = 0.1;

/// A recorded test.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// From the first sample on [s].
    pub time: Vec<f64>,
    /// Sampling period [s].
    pub period: f64,
    /// Motor angle, as far as the encoder's errors are known [rad].
    pub motor: Vec<f64>,
    /// Output angle, likewise [rad].
    pub output: Vec<f64>,
    /// Motor angle as it would be without errors of the teeth: planets and carrier follow it [rad].
    pub carried: Vec<f64>,
    /// Motor over the ratio less output, as the encoders read, exact on counts [rad].
    pub twist: Vec<f64>,
    /// Motor torque [N m].
    pub torque: Vec<f64>,
    /// Torque of the joint on its link, if it was measured [N m].
    pub output_torque: Option<Vec<f64>>,
    /// How much motor and output readings scatter [rad^2].
    pub noise: [Noise; 2],
    /// By how much the output's readings are older than the motor's, as far as that is known [s].
    pub age: f64,
    /// What motor and output were read as.
    pub kinds: [Kind; 2],
    /// Changes to the rows of the file, a sentence each.
    pub told: Vec<String>,
    /// What is lost between samples.
    pub times: EvenTimes,
}

impl Log {
    /// Reads a file.
    pub fn read(arguments: &Arguments, prior: &PriorModel) -> Outcome<Self> {
        arguments.read_log(prior.ratio(), Columns::will_do, |columns| Self::of(columns, prior))
    }

    fn of(columns: &mut Columns, prior: &PriorModel) -> Outcome<Self> {
        columns.leave_out_incomplete(&[&TIMES, &MOTOR, &OUTPUT, &["motor_torque_N_m"], &["output_torque_N_m"]])?;
        time_stamps::resolve(columns)?;
        for (names, turn) in [(MOTOR, prior.motor_turn), (OUTPUT, prior.output_turn)] {
            bad_readings::leave_out_of(columns, names, turn)?.ok_or_else(|| missing_encoder(columns, names))?;
        }
        let time = columns.time_from_start()?;
        let times = sampling(&time, columns, prior)?;
        let motor = readings(columns, MOTOR, prior.motor_turn, &times)?;
        let output = readings(columns, OUTPUT, prior.output_turn, &times)?;
        let (_, torque) = columns.named(&["motor_torque_N_m"])?;
        let output_torque = columns.maybe("output_torque_N_m")?;
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
        let [motor, output, twist, torque] = [motor, output, twist, torque].map(|values| times.bring(&values));
        let log = Self {
            kinds,
            age: 0.0,
            time: times.times(),
            period: times.period,
            noise: [&motor, &output].map(|angles| Noise::of(angles, |from, to| times.is_whole(from, to))),
            carried: motor.clone(),
            motor,
            output,
            twist,
            torque,
            output_torque: output_torque.map(|torque| times.bring(&torque)),
            told: columns.told().iter().cloned().chain(times.told.clone()).collect(),
            times,
        };
        log.check(prior)?;
        Ok(log)
    }

    /// Phase of the teeth: whole periods at the ring, by the joint's angle as the inertias on either side weigh it [rad].
    pub fn teeth(&self, sample: usize, prior: &PriorModel) -> f64 {
        let share = prior.motor_share();
        let joint = (1.0 - share) * self.output[sample] + share * self.motor[sample] / prior.ratio();
        f64::from(prior.ring_teeth) * joint
    }

    /// The same with errors of both encoders and of the teeth, each by its angle, taken off the angles, and with the output
    /// at the motor's time: accelerations and the phase of the teeth are sensitive to them.
    pub fn without(&self, errors: [&dyn Fn(f64) -> f64; 3], skew: f64, prior: &PriorModel) -> Self {
        let [motor, output, teeth] = errors;
        let corrected = |angles: &[f64], error: &dyn Fn(f64) -> f64| -> Vec<f64> {
            angles.iter().map(|angle| angle - error(angle - error(*angle))).collect()
        };
        let (motor, read) = (corrected(&self.motor, motor), corrected(&self.output, output));
        // The motor swings where the link does not: the link's own speed is what counts.
        let around = (SPEED_OVER / self.period).ceil() as usize;
        let speed = |sample: usize| {
            let (before, after) = (sample.saturating_sub(around), (sample + around).min(read.len() - 1));
            (read[after] - read[before]) / ((after - before) as f64 * self.period)
        };
        let output: Vec<f64> = (0..read.len()).map(|sample| read[sample] + skew * speed(sample)).collect();
        let mut log = Self { motor, output, age: skew, carried: Vec::new(), ..self.clone() };
        let carried = |sample: usize| log.motor[sample] - prior.ratio() * teeth(log.teeth(sample, prior));
        log.carried = (0..log.motor.len()).map(carried).collect();
        log
    }

    /// By which share of what their encoders do angles scatter: motor and output; nothing where none is smoother than its encoder can
    /// read it.
    pub fn smoothness(&self, prior: &PriorModel) -> Option<[f64; 2]> {
        let share = |place: usize, turn: u64| {
            let count = count_angle(turn);
            if self.kinds[place] == Kind::Angle { 12.0 * self.noise[place].mean() / (count * count) } else { 1.0 }
        };
        let shares = [share(0, prior.motor_turn), share(1, prior.output_turn)];
        shares.iter().any(|share| *share < SMOOTH).then_some(shares)
    }

    fn check(&self, prior: &PriorModel) -> Outcome<()> {
        let counts = range_of(&self.motor) * prior.motor_turn as f64 / TAU;
        if counts < LEAST_TRAVEL {
            return Err(Failure::new(format!(
                "the motor does not move in this log: by {counts:.1} counts of its encoder, {LEAST_TRAVEL} are the least"
            ))
            .with_help("the torque must overcome the friction, and turn the motor through the gap"));
        }
        Ok(())
    }
}

/// Motor over ratio less output: in whole numbers as long as both are counts, so that turns cost no digit.
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
