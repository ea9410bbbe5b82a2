//! Checks that a log is sampled evenly, fast and long enough for its joint.

use super::prior::PriorModel;
use log_reader::columns::{Columns, TIMES};
use log_reader::even_times::EvenTimes;
use report::failure::{Failure, Outcome};

/// Least duration, for reversals and their surroundings [s].
const DURATION_MIN: f64 = 0.5;
/// Least sampling rate, to resolve the torque of a landing [Hz].
const RATE_MIN: f64 = 2000.0;
/// Least samples per swing of the joint on its compliance: with 3 to 6, a tenth of the 95 % intervals of S1 and L1
/// missed.
const SAMPLES_PER_SWING_MIN: f64 = 6.5;
/// Largest plausible rate of an encoder; above it the time has another unit [Hz].
const RATE_MAX: f64 = 1e6;
/// Largest common logging rate of drives [Hz].
const LOGGING_RATE_MAX: f64 = 1e5;
/// Least samples per swing for an estimate of the damping.
pub const DAMPING_SAMPLES_PER_SWING: f64 = 16.0;

/// Returns the even times of a log that is fast, long and whole enough; `time` begins at zero.
pub fn sampling(time: &[f64], columns: &Columns, prior: &PriorModel) -> Outcome<EvenTimes> {
    if time.len() < 2 {
        return Err(Failure::new(format!("there are only {} samples", time.len()))
            .with_help(format!("record several reversals, for {DURATION_MIN} s at the very least")));
    }
    let times = EvenTimes::new(time, columns)?;
    check_time(times.period, time.len(), prior, columns)?;
    Ok(times)
}

/// Rejects a log that is too short, or sampled too slowly for the joint's swing.
fn check_time(period: f64, samples: usize, prior: &PriorModel, columns: &Columns) -> Outcome<()> {
    let (rate, time) = (1.0 / period, period * samples as f64);
    let needed = RATE_MIN.max(SAMPLES_PER_SWING_MIN / prior.swing_period());
    if rate < 0.999 * needed {
        let swing = 1.0 / prior.swing_period();
        return Err(Failure::new(format!(
            "the log is sampled too slowly: {rate:.0} Hz, at least {needed:.0} Hz are needed for a joint that swings at \
             {swing:.0} Hz"
        ))
        .with_help(match [1e3, 1e6].into_iter().find(|by| (needed..LOGGING_RATE_MAX).contains(&(rate * by))) {
            Some(by) => finer_unit_help(columns, by, rate * by),
            None => format!(
                "record every control period; {:.0} Hz also show the damping",
                (DAMPING_SAMPLES_PER_SWING * swing).max(needed)
            ),
        }));
    }
    if rate > RATE_MAX {
        return Err(Failure::new(format!(
            "the log is sampled at {rate:.3e} Hz, faster than any encoder: at most {RATE_MAX:.0e} Hz"
        ))
        .with_help("check the unit of the time: time_s, time_ms and time_us are accepted"));
    }
    if time < DURATION_MIN {
        return Err(Failure::new(format!("the log is too short: {time:.3} s, at least {DURATION_MIN} s are needed"))
            .with_help("record several reversals to both sides; docs/reference/identify.md describes a good test"));
    }
    Ok(())
}

/// Help for a log that is fast enough if its unit of time is smaller by the factor `by`.
fn finer_unit_help(columns: &Columns, by: f64, rate: f64) -> String {
    let used = columns.name_of(&TIMES).and_then(|used| TIMES.iter().position(|name| *name == used)).unwrap_or_default();
    let finer = TIMES.get(used + if by > 1e4 { 2 } else { 1 }).filter(|_| !columns.is_unit_stated(TIMES[used]));
    match finer {
        Some(name) => {
            format!(
                "if the time is in {}, for a rate of {rate:.0} Hz, name its column {name}",
                name.trim_start_matches("time_")
            )
        }
        None => format!(
            "if the unit of the time is {by:.0} times smaller than stated, for a rate of {rate:.0} Hz, state that \
                 unit"
        ),
    }
}
