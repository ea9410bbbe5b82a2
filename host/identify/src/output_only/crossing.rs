//! Upper bound of the lost motion from the coasting of the output after a reversal of the torque.
//!
//! a is the motor's share of the inertia and g the lost motion. While the motor crosses the gap, the output is ahead of
//! the common centre of the balance of torques by
//!
//! ```text
//! r(t) = T t^2 / (2 I),   at most a g                                                            (3)
//! ```
//!
//! Afterwards r is a g less the bouncing of the teeth, plus the bending of the joint. r is averaged over twentieths of
//! the time from the reversal to the turning point. At the end of the crossing, a time that (3) gives, the mean is at
//! least 0.6 a g: 0.75 a g if the crossing takes two parts or more; after a shorter crossing the teeth have settled to
//! 0.65 a g within five parts (restitution up to 0.85). The bound is the largest g that the means allow, among those
//! whose crossing takes less than a quarter of that time.

use super::swing_fit::{COSINE, DRY, Integrals, OFFSET, SINE, STEP, SwingFit, TORQUE};
use super::swings::Swing;
use crate::estimate::Estimate;

/// Least torque of a swing that is used, over the largest torque [-], and fewest of these swings.
const STRONG_SWING_SHARE: f64 = 0.8;
const STRONG_SWINGS_MIN: usize = 4;
/// Parts of the time from the reversal to the turning point, and number of parts that are evaluated.
const PARTS: f64 = 20.0;
const PARTS_EVALUATED: usize = 5;
/// Least share of a g in the largest mean.
const MEAN_LEAD_SHARE: f64 = 0.6;
/// Error of the fitted delay over the delay [-]: the crossing looks like a part of the delay. Measured: 0.1 to 0.3 in
/// simulated logs.
const DELAY_ERROR: f64 = 0.5;
/// The search for the bound starts at the coasting distance of a crossing of a quarter, and goes down by the ratio
/// SEARCH_STEP to SEARCH_END of it.
const SEARCH_STEP: f64 = 0.98;
const SEARCH_END: f64 = 1e-6;

/// Returns the largest lost motion that the swings allow for a motor's share of the inertia from `least` to `most`
/// [rad], or the reason why no bound exists.
pub fn bound(
    integrals: &Integrals<'_>,
    swings: &[Swing],
    fit: &SwingFit,
    [least, most]: [f64; 2],
) -> Result<f64, &'static str> {
    let strength = |swing: &Swing| swing.torque[0].min(swing.torque[1]);
    let strongest = swings.iter().map(strength).fold(0.0, f64::max);
    let [dry, sine, cosine, offset] = [DRY, SINE, COSINE, OFFSET].map(|unknown| fit.torque_of(unknown).value);
    if (1.0 - most) * STRONG_SWING_SHARE * strongest <= dry.abs() + most * (sine.hypot(cosine) + offset.abs()) {
        return Err(
            "friction and weight may hold the flank when the torque reverses: step more torque, or add inertia to the link",
        );
    }
    let strong: Vec<&Swing> = swings.iter().filter(|swing| strength(swing) >= STRONG_SWING_SHARE * strongest).collect();
    let shortest = strong.iter().map(|swing| integrals.time_after(swing)).fold(f64::MAX, f64::min);
    let leads: Vec<[Option<f64>; PARTS_EVALUATED]> =
        strong.iter().filter_map(|swing| mean_leads(integrals, swing, fit, shortest / PARTS)).collect();
    let parts: Vec<Option<Estimate>> = (0..PARTS_EVALUATED)
        .map(|part| {
            let all: Vec<f64> = leads.iter().filter_map(|leads| leads[part]).collect();
            (all.len() >= STRONG_SWINGS_MIN).then(|| Estimate::of_repeats(&all))
        })
        .collect();
    let seldom =
        "the torque must step at least four times with its largest strength, and a swing must have more samples";
    let parts = parts.into_iter().collect::<Option<Vec<Estimate>>>().ok_or(seldom)?;
    let part = shortest / PARTS;
    let acceleration = strongest * fit.values[TORQUE];
    let allowed = |lead: f64| {
        let crossing = (2.0 * lead / acceleration).sqrt();
        let place = (crossing / part) as usize;
        // The torques of the swings differ, and a short crossing is visible only after the teeth have settled.
        let near = if place == 0 { 0..=PARTS_EVALUATED - 1 } else { place - 1..=(place + 1).min(PARTS_EVALUATED - 1) };
        let late = DELAY_ERROR * fit.delay * 2.0 * acceleration * crossing.max(part);
        near.filter_map(|part| parts.get(part)).map(|mean| mean.value + mean.half).fold(0.0, f64::max) + late
            >= MEAN_LEAD_SHARE * lead
    };
    let longest = 0.5 * acceleration * (PARTS_EVALUATED as f64 * part).powi(2);
    if allowed(longest) {
        return Err(
            "the output may coast for more than a quarter of the time until it turns: let each torque act longer, or log a \
                    finer encoder",
        );
    }
    let mut lead = longest;
    while lead > SEARCH_END * longest && !allowed(lead) {
        lead *= SEARCH_STEP;
    }
    Ok(lead / (SEARCH_STEP * least))
}

/// Returns the mean lead of the output over the common centre in each part after the reversal, along its motion [rad].
fn mean_leads(
    integrals: &Integrals<'_>,
    swing: &Swing,
    fit: &SwingFit,
    part: f64,
) -> Option<[Option<f64>; PARTS_EVALUATED]> {
    let left = |sample: usize| {
        let (since, angle, row) = integrals.row(swing, sample, fit.delay);
        let centre: f64 = row[..STEP].iter().zip(fit.values.iter()).map(|(row, value)| row * value).sum();
        (since, angle - centre)
    };
    let before: Vec<(f64, f64)> = (swing.before[0]..swing.before[1]).map(left).collect();
    let count = before.len() as f64;
    let [time, angle] = [0, 1].map(|place| before.iter().map(|one| [one.0, one.1][place]).sum::<f64>() / count);
    let square: f64 = before.iter().map(|(since, _)| (since - time).powi(2)).sum();
    let speed = before.iter().map(|(since, left)| (since - time) * (left - angle)).sum::<f64>() / square;
    let mut sums = [(0.0, 0.0); PARTS_EVALUATED];
    for sample in swing.after[0]..swing.after[1] {
        let (since, left) = left(sample);
        if let Some(sum) = sums.get_mut((since / part) as usize) {
            sum.0 += swing.direction * (left - angle - speed * (since - time));
            sum.1 += 1.0;
        }
    }
    speed.is_finite().then(|| sums.map(|(sum, count)| (count > 0.0).then(|| sum / count)))
}
