//! Whether a log was sampled evenly, fast and long enough for its joint, with the figures of what is needed.

use super::columns::Columns;
use super::prior::PriorModel;
use report::failure::{Failure, Outcome};

/// A shorter log cannot hold reversals and what surrounds them [s].
const LEAST_TIME: f64 = 0.5;
/// Slower samples do not show what a landing does to the torque [Hz]...
const LEAST_RATE: f64 = 2000.0;
/// ... nor do less than so many of them in a swing of the joint on its compliance: with 3 to 6 a tenth of the 95 % intervals of S1
/// and L1 missed.
const LEAST_IN_A_SWING: f64 = 6.5;
/// No encoder is read so often: the time is in another unit [Hz].
const MOST_RATE: f64 = 1e6;
/// What drives log, at most [Hz].
const LIKELY_RATE: f64 = 1e5;
/// Samples of a swing from which its damping can be told.
pub const SWING_SAMPLES: f64 = 16.0;
/// A step of time may differ by this ratio from the usual one.
const UNEVEN_RATIO: f64 = 0.5;

/// The sampling period of a log that is fast, long and even enough.
pub fn sampling(time: &[f64], columns: &Columns, prior: &PriorModel) -> Outcome<f64> {
    if time.len() < 2 {
        return Err(Failure::new(format!("there are only {} samples", time.len()))
            .with_help(format!("record several reversals, for {LEAST_TIME} s at the very least")));
    }
    let period = evenly_spaced(time, columns)?;
    check_time(period, time.len(), prior)?;
    Ok(period)
}

fn evenly_spaced(time: &[f64], columns: &Columns) -> Outcome<f64> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(line) = steps.iter().position(|&step| step <= 0.0) {
        return Err(Failure::new(format!("the time does not rise in {}", columns.place(line + 1)))
            .with_help("samples must be in the order in which they were taken, each with its own time"));
    }
    let unsorted = steps.clone();
    steps.sort_by(f64::total_cmp);
    let usual = steps[steps.len() / 2];
    match unsorted.iter().position(|step| (step / usual - 1.0).abs() > UNEVEN_RATIO) {
        Some(line) => Err(Failure::new(format!(
            "samples are not evenly spaced: {:.3e} s before {}, usually {usual:.3e} s",
            unsorted[line],
            columns.place(line + 1)
        ))
        .with_help("samples were lost: cut the log there, or resample it")),
        None => Ok((time[time.len() - 1] - time[0]) / (time.len() - 1) as f64),
    }
}

/// Refuses a log that is too short, or sampled too slowly for the joint's swing.
fn check_time(period: f64, samples: usize, prior: &PriorModel) -> Outcome<()> {
    let (rate, time) = (1.0 / period, period * samples as f64);
    let needed = LEAST_RATE.max(LEAST_IN_A_SWING / prior.swing());
    if rate < 0.999 * needed {
        let swing = 1.0 / prior.swing();
        return Err(Failure::new(format!(
            "the log is sampled too slowly: {rate:.0} Hz, at least {needed:.0} Hz are needed for a joint that swings at \
             {swing:.0} Hz"
        ))
        .with_help(match [("ms", 1e3), ("us", 1e6)].iter().find(|(_, by)| (needed..LIKELY_RATE).contains(&(rate * by))) {
            Some((unit, by)) => format!("if the time is in {unit}, which were {:.0} Hz, call its column time_{unit}", rate * by),
            None => format!(
                "record every control period; {:.0} Hz also show the damping",
                (SWING_SAMPLES * swing).max(needed)
            ),
        }));
    }
    if rate > MOST_RATE {
        return Err(Failure::new(format!(
            "the log is sampled at {rate:.3e} Hz, which no encoder is: at most {MOST_RATE:.0e} Hz"
        ))
        .with_help("check the unit of the time: time_s, time_ms and time_us are understood"));
    }
    if time < LEAST_TIME {
        return Err(Failure::new(format!("the log is too short: {time:.3} s, at least {LEAST_TIME} s are needed"))
            .with_help("record several reversals to both sides; docs/reference/identify.md tells a good test"));
    }
    Ok(())
}
