//! Passes of the motor from one turning point to the next, cut at ends of halves and at gaps, without their ends.

use std::ops::Range;

use super::samples::{GAP_STEPS, Samples, spread};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Least return from a turning point, as a share of the motor's travel.
const TURN_SHARE: f64 = 0.25;
/// Least share of the travel excluded at each end of a pass.
const EXCLUDED_SHARE_MIN: f64 = 0.02;
/// Largest share of the travel excluded at each end.
const EXCLUDED_SHARE_MAX: f64 = 0.25;
/// Least share of the travel left of a pass.
const PASS_SHARE_MIN: f64 = 0.1;
/// Samples examined on either side of a turning point.
const TURN_WINDOW: usize = 12;
/// Offset between the readings, in the output's usual steps, that the output shows at turning points.
const READING_OFFSET_MAX: f64 = 1.3;
/// Least samples of a pass that show the course of the difference.
const PASS_SAMPLES_MIN: usize = 24;

/// Motion of the motor in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// Samples of the pass.
    pub range: Range<usize>,
    /// True for forward motion.
    pub forwards: bool,
    /// Half of the log, 0 or 1; 0 without halves.
    pub half: usize,
}

/// All passes of a log in order of time, and the length excluded at each end.
pub fn passes(samples: &Samples, halves: &[(f64, f64)]) -> Outcome<(Vec<Pass>, f64)> {
    let travel = samples.travel();
    let turns = turning_points(&samples.motor, TURN_SHARE * travel);
    if turns.len() < 3 {
        return Err(Failure::new(format!(
            "there is no reversal in this log: the motor never goes back by a quarter of its travel of {}",
            ESTIMATE.write(travel)
        ))
        .with_help("sweep slowly to and fro over the same places, at least twice each way"));
    }
    check_simultaneous(samples, &turns)?;
    let left_out = (EXCLUDED_SHARE_MIN * travel).max(spread(&samples.difference));
    if left_out > EXCLUDED_SHARE_MAX * travel {
        return Err(Failure::new(format!(
            "the passes are too short: the difference of output and motor ranges over {}, the motor travels {}",
            ESTIMATE.write(left_out),
            ESTIMATE.write(travel)
        ))
        .with_help(
            "sweep over ten times the lost motion and more; check the units if the difference cannot be so large",
        ));
    }
    let mut passes = Vec::new();
    for pair in turns.windows(2) {
        let forwards = samples.motor[pair[1]] > samples.motor[pair[0]];
        for (half, range) in cut(samples, pair[0]..pair[1] + 1, halves) {
            let range = without_ends(&samples.motor, range, forwards, left_out);
            let long = range.len() > 1
                && (samples.motor[range.end - 1] - samples.motor[range.start]).abs() >= PASS_SHARE_MIN * travel;
            if long {
                passes.push(Pass { range, forwards, half });
            }
        }
    }
    let mut lengths: Vec<usize> = passes.iter().map(|pass| pass.range.len()).collect();
    lengths.sort_unstable();
    match lengths.get(lengths.len() / 2) {
        Some(usual) if *usual < PASS_SAMPLES_MIN => Err(Failure::new(format!(
            "the motion is too fast for this log: {usual} samples in a pass, {PASS_SAMPLES_MIN} are the least"
        ))
        .with_help("sweep more slowly, or log more often")),
        Some(_) => Ok((passes, left_out)),
        None if halves.is_empty() => Err(Failure::new("no pass is left between turning points and gaps")
            .with_help("sweep over the whole way between two gaps of the log, or record without gaps")),
        None => Err(Failure::new("no pass is left between turning points, gaps and the ends of the halves")
            .with_help("let --half FROM..TO contain whole sweeps; times count from the first sample")),
    }
}

/// Rejects a log whose output continues in the old direction after the motor has turned, or turns first. Friction and a
/// gap hold an output but never move it; readings at different times do, and mimic a width of the travel in between.
fn check_simultaneous(samples: &Samples, turns: &[usize]) -> Outcome<()> {
    let output = &samples.output;
    let mut steps: Vec<f64> =
        output.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY);
    let inner = turns.get(1..turns.len().saturating_sub(1)).unwrap_or_default();
    // Travel of the output beyond its place at the turning point, in usual steps: positive after it, negative before
    // it.
    let mut went_on: Vec<f64> = Vec::new();
    for &turn in inner {
        let forwards = samples.motor[turn] > samples.motor[turn.saturating_sub(TURN_WINDOW)];
        let sign = if forwards { 1.0 } else { -1.0 };
        let around = &output[turn.saturating_sub(TURN_WINDOW)..(turn + TURN_WINDOW + 1).min(output.len())];
        let (farthest, most) = around
            .iter()
            .enumerate()
            .map(|(place, value)| (place, sign * (value - output[turn])))
            .fold((0, f64::NEG_INFINITY), |best, next| if next.1 > best.1 { next } else { best });
        let after = farthest >= turn - turn.saturating_sub(TURN_WINDOW);
        went_on.push(if after { most } else { -most } / step);
    }
    went_on.sort_by(f64::total_cmp);
    let usual = went_on.get(went_on.len() / 2).copied().unwrap_or_default();
    if usual.abs() < READING_OFFSET_MAX {
        return Ok(());
    }
    let (late, early) = if usual > 0.0 { ("output", "motor") } else { ("motor", "output") };
    Err(Failure::new(format!(
        "the {late}'s readings are late: at turning points the output moves {} of its usual steps against the \
             motor, which neither friction nor a gap explains",
        ESTIMATE.write(usual.abs())
    ))
    .with_help(format!(
        "this mimics a width of twice the motion in between; shift the column by about {} rows against the \
             {early}'s, or read both at the same time",
        usual.abs().round()
    )))
}

/// Samples at which the motor turns, including the first and the last of its motion.
pub fn turning_points(motor: &[f64], threshold: f64) -> Vec<usize> {
    let (mut least, mut most) = (0, 0);
    let mut turns: Vec<usize> = Vec::new();
    // Direction since the last turning point; `None` before the first.
    let mut forwards: Option<bool> = None;
    let mut farthest = 0;
    for (sample, place) in motor.iter().enumerate() {
        match forwards {
            None => {
                if *place < motor[least] {
                    least = sample;
                }
                if *place > motor[most] {
                    most = sample;
                }
                if place - motor[least] >= threshold {
                    (forwards, farthest) = (Some(true), sample);
                    turns.push(least);
                } else if motor[most] - place >= threshold {
                    (forwards, farthest) = (Some(false), sample);
                    turns.push(most);
                }
            }
            Some(way) => {
                let sign = if way { 1.0 } else { -1.0 };
                if sign * (place - motor[farthest]) > 0.0 {
                    farthest = sample;
                } else if sign * (motor[farthest] - place) >= threshold {
                    turns.push(farthest);
                    (forwards, farthest) = (Some(!way), sample);
                }
            }
        }
    }
    if forwards.is_some() {
        turns.push(farthest);
    }
    turns
}

/// Parts of a stretch without gaps, each within one half.
fn cut(samples: &Samples, stretch: Range<usize>, halves: &[(f64, f64)]) -> Vec<(usize, Range<usize>)> {
    let half = |sample: usize| match halves {
        [] => Some(0),
        halves => halves.iter().position(|(from, to)| (*from..*to).contains(&samples.time[sample])),
    };
    let mut parts: Vec<(usize, Range<usize>)> = Vec::new();
    for sample in stretch.clone() {
        let Some(own) = half(sample) else { continue };
        let goes_on =
            sample > stretch.start && samples.time[sample] - samples.time[sample - 1] <= GAP_STEPS * samples.period;
        match parts.last_mut() {
            Some((last, range)) if *last == own && range.end == sample && goes_on => range.end = sample + 1,
            _ => parts.push((own, sample..sample + 1)),
        }
    }
    parts
}

/// Stretch without `left_out` of travel at both ends.
fn without_ends(motor: &[f64], range: Range<usize>, forwards: bool, left_out: f64) -> Range<usize> {
    let sign = if forwards { 1.0 } else { -1.0 };
    let (first, last) = (motor[range.start], motor[range.end - 1]);
    let inside =
        |sample: &usize| sign * (motor[*sample] - first) >= left_out && sign * (last - motor[*sample]) >= left_out;
    let begin = range.clone().find(inside);
    let end = range.rev().find(inside);
    begin.zip(end).map_or(0..0, |(begin, end)| begin..end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reversals below the threshold make no turning point.
    #[test]
    fn turning_points_ignore_small_reversals() {
        let motor: Vec<f64> = (0..400)
            .map(|sample: i32| {
                let sweep = 100 - (sample % 200 - 100).abs();
                f64::from(sweep) + if sample % 2 == 0 { 3.0 } else { -3.0 }
            })
            .collect();
        let turns = turning_points(&motor, 25.0);
        assert_eq!(turns.len(), 5, "{turns:?}");
        assert!(
            turns.iter().zip([0, 100, 200, 300, 399]).all(|(turn, truth): (&usize, usize)| turn.abs_diff(truth) < 5)
        );
        assert!(turning_points(&motor[..90], 200.0).is_empty());
    }
}
