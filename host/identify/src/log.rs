//! A recorded test as samples: read from columns by their names, checked, encoders as angles and their difference from
//! whole counts.

use std::f64::consts::TAU;

use super::arguments::Arguments;
use super::column_map::ColumnMap;
use super::columns::Columns;
use super::log_file;
use super::noise::Noise;
use super::prior::PriorModel;
use super::sampling::sampling;
use board::profile::MAX_TORQUE;
use report::failure::{Failure, Outcome};
use report::number::{ESTIMATE, TYPED};

/// Fewer counts of the motor may be its encoder's own scatter.
const LEAST_TRAVEL: f64 = 8.0;
/// The link's speed is taken over this time to either side [s].
const SPEED_OVER: f64 = 1e-3;
/// Turns that a motor cannot make between two samples.
const JUMP_TURNS: f64 = 0.5;
/// Most steps are no longer than that of this part of them...
const USUAL: (usize, usize) = (995, 1000);
/// ... and none is so many times as long, unless it is shorter than this part of a turn.
const JUMP_STEPS: f64 = 20.0;
const JUMP_LEAST: f64 = 0.02;
/// An angle that begins anew jumps by a turn, but for what it moves meanwhile [turns].
const WHOLE_TURN: f64 = 0.2;
/// A jump is that of a turn if it is so near to it, as a ratio.
const SAME_TURN: f64 = 0.03;
/// Samples over which an encoder is seen to turn.
const STALE_WINDOW: usize = 60;
/// Share of them that may have the last reading once more.
const STALE_SHARE: f64 = 0.4;

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
    /// What motor and output were read as.
    pub kinds: [Kind; 2],
}

/// What an encoder's readings are in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole counts of a stated resolution.
    Counts,
    /// Angles.
    Angle,
}

/// Readings of one encoder.
enum Readings {
    Counts(Vec<i64>),
    Angles(Vec<f64>),
}

impl Log {
    /// Reads a file.
    pub fn read(arguments: &Arguments, prior: &PriorModel) -> Outcome<Self> {
        let path = arguments.log.as_path();
        let map = ColumnMap::new(arguments.map.as_deref(), &arguments.column, &arguments.unit)?;
        let columns = log_file::read(path, arguments.topic.as_deref(), &map, prior.ratio(), Columns::will_do)?;
        Self::of(&columns, prior).map_err(|failure| failure.while_doing(path.display()))
    }

    fn of(columns: &Columns, prior: &PriorModel) -> Outcome<Self> {
        let mut time = columns.time()?;
        let start = time.first().copied().unwrap_or_default();
        time.iter_mut().for_each(|time| *time -= start);
        let period = sampling(&time, columns, prior)?;
        let motor = readings(columns, ["motor_counts", "motor_angle_rad"], prior.motor_bits)?;
        let output = readings(columns, ["output_counts", "output_angle_rad"], prior.output_bits)?;
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
        let (motor, output) = (motor.angles(prior.motor_bits), output.angles(prior.output_bits));
        let log = Self {
            kinds,
            time,
            period,
            noise: [Noise::of(&motor), Noise::of(&output)],
            carried: motor.clone(),
            motor,
            output,
            twist,
            torque,
            output_torque,
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
        let mut log = Self { motor, output, carried: Vec::new(), ..self.clone() };
        let carried = |sample: usize| log.motor[sample] - prior.ratio() * teeth(log.teeth(sample, prior));
        log.carried = (0..log.motor.len()).map(carried).collect();
        log
    }

    fn check(&self, prior: &PriorModel) -> Outcome<()> {
        let travel = |angles: &[f64]| {
            let (least, most) = angles.iter().fold((f64::MAX, f64::MIN), |(a, b), &angle| (a.min(angle), b.max(angle)));
            most - least
        };
        let counts = travel(&self.motor) * f64::from(1_u32 << prior.motor_bits) / TAU;
        if counts < LEAST_TRAVEL {
            return Err(Failure::new(format!(
                "the motor does not move in this log: by {counts:.1} counts of its encoder, {LEAST_TRAVEL} are the least"
            ))
            .with_help("the torque must overcome the friction, and turn the motor through the gap"));
        }
        Ok(())
    }
}

impl Readings {
    fn kind(&self) -> Kind {
        match self {
            Self::Counts(_) => Kind::Counts,
            Self::Angles(_) => Kind::Angle,
        }
    }

    fn angles(&self, bits: u32) -> Vec<f64> {
        match self {
            Self::Counts(counts) => counts.iter().map(|&count| count as f64 * TAU / (1_u64 << bits) as f64).collect(),
            Self::Angles(angles) => angles.clone(),
        }
    }
}

/// Motor over ratio less output: in whole numbers as long as both are counts, so that turns cost no digit.
fn twist(motor: &Readings, output: &Readings, prior: &PriorModel) -> Vec<f64> {
    if let (Readings::Counts(motor), Readings::Counts(output)) = (motor, output) {
        let [sun, both] = prior.teeth.map(i128::from);
        let turn = (both << (prior.motor_bits + prior.output_bits)) as f64;
        let pair = motor.iter().zip(output);
        return pair
            .map(|(&motor, &output)| {
                let apart = ((i128::from(motor) * sun) << prior.output_bits)
                    - ((i128::from(output) * both) << prior.motor_bits);
                apart as f64 / turn * TAU
            })
            .collect();
    }
    let (motor, output) = (motor.angles(prior.motor_bits), output.angles(prior.output_bits));
    motor.iter().zip(&output).map(|(motor, output)| motor / prior.ratio() - output).collect()
}

/// Counts, or else angles.
fn readings(columns: &Columns, names: [&str; 2], bits: u32) -> Outcome<Readings> {
    let what = if names[0].starts_with("motor") { "motor" } else { "output" };
    let there = columns.first_of(&names)?;
    let (name, values) = there.ok_or_else(|| columns.without_encoder(what))?;
    if name == names[0] {
        let turn = 1_i64 << bits;
        if let Some(line) = values.iter().position(|value| value.fract() != 0.0 || value.abs() > 9e15) {
            return Err(Failure::new(format!("{} of `{name}` is no whole number of counts", columns.place(line)))
                .with_help("angles are understood in a column such as motor_angle_rad"));
        }
        let mut whole: Vec<i64> = values.iter().map(|&value| value as i64).collect();
        if whole.iter().all(|count| (0..turn).contains(count)) {
            unwrap(&mut whole, turn);
        }
        let steps: Vec<f64> = whole.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
        check_steps(&steps, turn as f64, 1.0, columns, name)?;
        return Ok(Readings::Counts(whole));
    }
    let angles = unwrapped(values);
    let steps: Vec<f64> = angles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    check_steps(&steps, TAU, TAU / (1_i64 << bits) as f64, columns, name)?;
    Ok(Readings::Angles(angles))
}

/// Refuses readings that no turning encoder gives: single steps beside which all others are small, and readings that are
/// the last ones again and again although the encoder turns. `count` is a step that is seen at all.
fn check_steps(steps: &[f64], turn: f64, count: f64, columns: &Columns, name: &str) -> Outcome<()> {
    let mut sizes: Vec<f64> = steps.iter().map(|step| step.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let usual = sizes.get(sizes.len() * USUAL.0 / USUAL.1).copied().unwrap_or_default().max(count);
    let jump = (JUMP_TURNS * turn).min((JUMP_STEPS * usual).max(JUMP_LEAST * turn));
    if let Some(row) = steps.iter().position(|step| step.abs() >= jump) {
        let (size, place) = (steps[row].abs(), columns.place(row + 1));
        let message =
            format!("`{name}` jumps by {} in {place}, where a turn is {}", ESTIMATE.write(size), ESTIMATE.write(turn));
        let whole = |turn: f64| (size / turn).ln().abs() < SAME_TURN;
        let other = match (8..=30).find(|bits| whole(f64::from(*bits).exp2())) {
            Some(bits) if count == 1.0 => Some(format!("an encoder of {bits} bits begins anew so")),
            _ if count == 1.0 => None,
            _ => [(1.0, "turns"), (360.0, "degrees"), (1e3 * TAU, "mrad")]
                .iter()
                .find(|(turn, _)| whole(*turn))
                .map(|(_, unit)| format!("an angle in {unit} begins anew so")),
        };
        let lost = "a reading was lost or corrupted, or the encoder's unit or resolution is not as stated";
        return Err(Failure::new(message).with_help(other.unwrap_or_else(|| lost.to_owned())));
    }
    // Windows in which every sample should have brought a count.
    let (mut moving, mut same) = (0, 0);
    for window in steps.chunks_exact(STALE_WINDOW) {
        if window.iter().sum::<f64>().abs() > 2.0 * count * STALE_WINDOW as f64 {
            moving += STALE_WINDOW;
            same += window.iter().filter(|step| step.abs() < 0.5 * count).count();
        }
    }
    if same > (STALE_SHARE * moving as f64) as usize && moving > 0 {
        let every = (moving as f64 / (moving - same).max(1) as f64).round();
        return Err(Failure::new(format!(
            "`{name}` brings a new reading in about one of {every} samples, and repeats it in between"
        ))
        .with_help("keep the rows with new readings only, or log as often as the encoder is read"));
    }
    Ok(())
}

/// Angles that begin anew every turn are taken for continuous ones.
fn unwrapped(mut angles: Vec<f64>) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = angles.first().copied().unwrap_or_default();
    for angle in angles.iter_mut().skip(1) {
        let step = *angle - last;
        last = *angle;
        // A step that is nearly a whole turn; others are none of an encoder and refused later.
        if (step.abs() - TAU).abs() < WHOLE_TURN * TAU {
            turns -= step.signum();
        }
        *angle += turns * TAU;
    }
    angles
}

/// Counts that begin anew every turn are taken for continuous ones.
fn unwrap(counts: &mut [i64], turn: i64) {
    let mut turns = 0;
    for index in 1..counts.len() {
        let before = counts[index - 1] - turns * turn;
        let step = counts[index] - before;
        turns += if step > turn / 2 { -1 } else { i64::from(step < -turn / 2) };
        counts[index] += turns * turn;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_begin_anew_every_turn_become_continuous() {
        let mut counts: Vec<i64> = (0..400).map(|step: i64| (step * 7).rem_euclid(256)).collect();
        unwrap(&mut counts, 256);
        assert_eq!(counts, (0..400).map(|step| step * 7).collect::<Vec<i64>>());
        let mut back: Vec<i64> = (0..400).map(|step: i64| (-step * 7).rem_euclid(256)).collect();
        unwrap(&mut back, 256);
        assert_eq!(back, (0..400).map(|step| -step * 7).collect::<Vec<i64>>());
    }
}
