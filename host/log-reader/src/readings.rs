//! Readings of an encoder: whole counts or angles, made continuous over turns, and rejected if no turning encoder gives
//! them.

use std::f64::consts::TAU;

use super::columns::{Columns, MOTOR};
use super::even_times::EvenTimes;
use super::register::Register;
use super::resolution::{count_angle, resolution};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Largest motion of a motor between two samples [turns].
const STEP_TURNS_MAX: f64 = 0.5;
/// Quantile of the steps that is the usual largest step.
const USUAL_STEP_QUANTILE: (usize, usize) = (995, 1000);
/// A step is a jump if it exceeds JUMP_STEPS usual steps and JUMP_LEAST of a turn.
const JUMP_STEPS: f64 = 20.0;
const JUMP_LEAST: f64 = 0.02;
/// Tolerance of a wrap: an angle that wraps jumps by a turn less the motion [turns].
const WRAP_TOLERANCE: f64 = 0.2;
/// Logarithmic tolerance within which a jump equals a turn.
const TURN_TOLERANCE: f64 = 0.03;
/// Samples of a window that shows whether an encoder turns.
const STALE_WINDOW: usize = 60;
/// Largest share of repeated readings while the encoder turns.
const STALE_SHARE_MAX: f64 = 0.4;

/// Kind of an encoder's readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole counts of a stated resolution.
    Counts,
    /// Angles.
    Angles,
}

/// Readings of one encoder.
#[derive(Debug, Clone, PartialEq)]
pub enum Readings {
    /// Counts, joined over turns.
    Counts(Vec<i64>),
    /// Angles, joined over turns [rad].
    Angles(Vec<f64>),
}

impl Readings {
    /// Kind of the readings.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Counts(_) => Kind::Counts,
            Self::Angles(_) => Kind::Angles,
        }
    }

    /// Readings as angles of an encoder with `turn` counts per turn [rad].
    pub fn angles(&self, turn: u64) -> Vec<f64> {
        match self {
            Self::Counts(counts) => counts.iter().map(|&count| count as f64 * TAU / turn as f64).collect(),
            Self::Angles(angles) => angles.clone(),
        }
    }
}

/// Encoder of a column, with the size of its turn.
struct Encoder<'a> {
    /// `motor` or `output`.
    what: &'a str,
    /// Name of the column.
    name: &'a str,
    /// Stated counts per turn.
    counts_per_turn: u64,
    /// Size of a turn, and of the smallest step, in the column's unit.
    turn: f64,
    count: f64,
}

/// Reads an encoder's counts, or else its angles.
pub fn readings(columns: &mut Columns, names: [&str; 2], counts_per_turn: u64, times: &EvenTimes) -> Outcome<Readings> {
    let what = if names[0].starts_with("motor") { "motor" } else { "output" };
    let there = columns.first_of(&names)?;
    let (name, mut values) = there.ok_or_else(|| missing_encoder(columns, names))?;
    if name == names[0] {
        let turn = counts_per_turn as f64;
        if let Some(line) = values.iter().position(|value| value.fract() != 0.0 || value.abs() > 9e15) {
            return Err(Failure::new(format!("{} of `{name}` is not a whole number of counts", columns.place(line)))
                .with_help("angles belong in a column such as motor_angle_rad"));
        }
        if let Some(register) = Register::find(&values, Some(turn)) {
            register.join(&mut values, |row| times.periods_before(row));
            register.note(name, Some(turn)).into_iter().for_each(|note| columns.add_note(note));
        }
        let steps = times.per_period_steps(values.windows(2).map(|pair| pair[1] - pair[0]).collect());
        check_steps(&steps, &Encoder { what, name, counts_per_turn, turn, count: 1.0 }, columns)?;
        return Ok(Readings::Counts(values.into_iter().map(|value| value as i64).collect()));
    }
    let angles = unwrap_angles(values, times);
    let steps = times.per_period_steps(angles.windows(2).map(|pair| pair[1] - pair[0]).collect());
    let count = count_angle(counts_per_turn);
    check_steps(&steps, &Encoder { what, name, counts_per_turn, turn: TAU, count }, columns)?;
    Ok(Readings::Angles(angles))
}

/// Failure for a missing encoder; the help names the option for such a log.
pub fn missing_encoder(columns: &Columns, names: [&str; 2]) -> Failure {
    let (what, option, of) = if names == MOTOR {
        ("motor", "--output-only", "a joint without an encoder at the motor")
    } else {
        ("output", "--output-locked", "a joint with a clamped output")
    };
    let failure = columns.missing_encoder(what);
    let help = failure.full_help().unwrap_or_default();
    failure.with_help(format!("{help}; {option} reads a log of {of}"))
}

/// Rejects readings that no turning encoder gives: single steps far above all others, and repeated readings while the
/// encoder turns.
fn check_steps(steps: &[f64], encoder: &Encoder<'_>, columns: &Columns) -> Outcome<()> {
    let Encoder { name, turn, count, .. } = *encoder;
    let mut sizes: Vec<f64> = steps.iter().map(|step| step.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let usual =
        sizes.get(sizes.len() * USUAL_STEP_QUANTILE.0 / USUAL_STEP_QUANTILE.1).copied().unwrap_or_default().max(count);
    let jump = (STEP_TURNS_MAX * turn).min((JUMP_STEPS * usual).max(JUMP_LEAST * turn));
    let jumps: Vec<f64> = steps.iter().map(|step| step.abs()).filter(|step| *step >= jump).collect();
    if let Some(row) = steps.iter().position(|step| step.abs() >= jump) {
        let (size, place) = (steps[row].abs(), columns.place(row + 1));
        let message =
            format!("`{name}` jumps by {} in {place}, where a turn is {}", ESTIMATE.write(size), ESTIMATE.write(turn));
        return Err(Failure::new(message).with_help(encoder.jump_cause(&jumps)));
    }
    // Windows in which every sample should bring a new count.
    let (mut moving, mut same) = (0, 0);
    for window in steps.chunks_exact(STALE_WINDOW) {
        if window.iter().sum::<f64>().abs() > 2.0 * count * STALE_WINDOW as f64 {
            moving += STALE_WINDOW;
            same += window.iter().filter(|step| step.abs() < 0.5 * count).count();
        }
    }
    if same > (STALE_SHARE_MAX * moving as f64) as usize && moving > 0 {
        let every = (moving as f64 / (moving - same).max(1) as f64).round();
        return Err(Failure::new(format!(
            "`{name}` has a new reading in about one of {every} samples, and repeats it in between"
        ))
        .with_help("keep the rows with new readings only, or log as often as the encoder is read"));
    }
    Ok(())
}

impl Encoder<'_> {
    /// Likely cause of jumps, with the option to state.
    fn jump_cause(&self, jumps: &[f64]) -> String {
        let Self { what, name, counts_per_turn, turn: set, .. } = *self;
        let resolution = resolution(counts_per_turn);
        let whole = |turn: f64| jumps.iter().all(|jump| (jump / turn).ln().abs() < TURN_TOLERANCE);
        if self.count < 1.0 {
            let units = [(1.0, "turns"), (360.0, "degrees"), (1e3 * TAU, "mrad")];
            if let Some((_, unit)) = units.iter().find(|(turn, _)| whole(*turn)) {
                return format!("an angle in {unit} wraps by this jump");
            }
        } else if whole(set) {
            return format!("a turn of the {resolution} that are set was lost or counted twice: cut the log there");
        } else if let Some(found) = (8..=32).find(|bits| whole(f64::from(*bits).exp2())) {
            return if f64::from(found).exp2() < set {
                format!(
                    "an encoder of {found} bits wraps by this jump, but {resolution} are set: if a turn has 2^{found} \
                         counts, state --{what}-bits {found}"
                )
            } else {
                format!(
                    "a register of {found} bits begins anew so, but it does not hold the other readings: take off what was added to \
                     `{name}`, so that it goes from 0 to 2^{found} - 1 or from -2^{0} to 2^{0} - 1",
                    found - 1
                )
            };
        }
        format!(
            "the readings do not return, so that the jump is no single lost or corrupted reading: cut the log \
                 there, or check the unit of `{name}` and its resolution of {resolution}"
        )
    }
}

/// Joins angles that wrap every turn.
fn unwrap_angles(mut angles: Vec<f64>, times: &EvenTimes) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = angles.first().copied().unwrap_or_default();
    let mut before = 0.0;
    for row in 1..angles.len() {
        let read = angles[row];
        // Over lost samples the encoder is assumed to keep its speed.
        let expected = before * (times.periods_before(row) - 1.0);
        let step = read - last - expected;
        // Only steps of nearly a turn are wraps; other jumps are rejected later.
        if (step.abs() - TAU).abs() < WRAP_TOLERANCE * TAU {
            turns -= step.signum();
        }
        last = read;
        angles[row] += turns * TAU;
        before = (angles[row] - angles[row - 1]) / times.periods_before(row);
    }
    angles
}
