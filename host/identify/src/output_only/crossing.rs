//! Upper bound of the lost motion by how far the output goes on after a reversal.
//!
//! With the motor's share a of the inertia and the lost motion g the output is ahead of what the balance of torques says of the common
//! centre by
//!
//! ```text
//! r(t) = T t^2 / (2 I)   while the motor crosses the gap, at most a g                            (3)
//! ```
//!
//! and by a g less what the teeth bounce afterwards, more by what the joint bends. Means of r are taken over twentieths of the time from the
//! reversal to the turning point. At the end of the crossing, which is where (3) says, the mean is no less than 0.6 a g: 0.75 a g if the
//! crossing takes two parts or more, and after a shorter one the teeth have come to rest to 0.65 a g within five parts (restitution up to
//! 0.85). The bound is the largest g that the means allow, among those whose crossing takes less than a quarter of the time.

use super::balance::{Balance, COSINE, DRY, Integrals, OFFSET, SINE, STEP, TORQUE};
use super::swings::Swing;
use crate::estimate::Estimate;
use crate::quasi_static::statistics::{mean, student};

/// Torques of this share of the largest one are used, of as many swings at least.
const STRONG: f64 = 0.8;
const LEAST_SWINGS: usize = 4;
/// Parts of the time from the reversal to the turning point, and how many of them are looked at.
const PARTS: f64 = 20.0;
const QUARTER: usize = 5;
/// Least share of a g that the largest mean shows.
const SHOWN: f64 = 0.6;
/// Share of the torque's delay that the fit may have wrong, since the crossing looks like a part of it. Found: 0.1 to 0.3 in simulated logs.
const DELAY_ERROR: f64 = 0.5;
/// The bound is looked for from what a crossing of a quarter makes the output go on, downwards by steps of this ratio to this share.
const FINER: f64 = 0.98;
const LEAST: f64 = 1e-6;

/// Greatest lost motion that the swings allow with a motor's share of the inertia from least to most [rad]; else why there is none.
pub fn bound(
    integrals: &Integrals<'_>,
    swings: &[Swing],
    balance: &Balance,
    [least, most]: [f64; 2],
) -> Result<f64, &'static str> {
    let strength = |swing: &Swing| swing.torque[0].min(swing.torque[1]);
    let strongest = swings.iter().map(strength).fold(0.0, f64::max);
    let [dry, sine, cosine, offset] = [DRY, SINE, COSINE, OFFSET].map(|unknown| balance.torque_of(unknown).value);
    if (1.0 - most) * STRONG * strongest <= dry.abs() + most * (sine.hypot(cosine) + offset.abs()) {
        return Err(
            "friction and weight may hold the flank when the torque reverses: step more torque, or add inertia to the link",
        );
    }
    let strong: Vec<&Swing> = swings.iter().filter(|swing| strength(swing) >= STRONG * strongest).collect();
    let shortest = strong.iter().map(|swing| integrals.time_after(swing)).fold(f64::MAX, f64::min);
    let ahead: Vec<[Option<f64>; QUARTER]> =
        strong.iter().filter_map(|swing| ahead(integrals, swing, balance, shortest / PARTS)).collect();
    let parts: Vec<Option<Estimate>> = (0..QUARTER)
        .map(|part| {
            let all: Vec<f64> = ahead.iter().filter_map(|ahead| ahead[part]).collect();
            let (count, value) = (all.len() as f64, mean(&all));
            let variance = all.iter().map(|one| (one - value).powi(2)).sum::<f64>() / (count - 1.0);
            (all.len() >= LEAST_SWINGS)
                .then(|| Estimate { value, half: student(count - 1.0) * (variance / count).sqrt() })
        })
        .collect();
    let seldom =
        "the torque must step at least four times with its largest strength, and a swing must have more samples";
    let parts = parts.into_iter().collect::<Option<Vec<Estimate>>>().ok_or(seldom)?;
    let part = shortest / PARTS;
    let acceleration = strongest * balance.values[TORQUE];
    let allowed = |ahead: f64| {
        let crossing = (2.0 * ahead / acceleration).sqrt();
        let place = (crossing / part) as usize;
        // Torques differ, and a short crossing is seen when the teeth have come to rest.
        let near = if place == 0 { 0..=QUARTER - 1 } else { place - 1..=(place + 1).min(QUARTER - 1) };
        let late = DELAY_ERROR * balance.delay * 2.0 * acceleration * crossing.max(part);
        near.filter_map(|part| parts.get(part)).map(|mean| mean.value + mean.half).fold(0.0, f64::max) + late
            >= SHOWN * ahead
    };
    let longest = 0.5 * acceleration * (QUARTER as f64 * part).powi(2);
    if allowed(longest) {
        return Err(
            "the output may go on alone for more than a quarter of the time until it turns: let each torque act longer, or log a \
                    finer encoder",
        );
    }
    let mut ahead = longest;
    while ahead > LEAST * longest && !allowed(ahead) {
        ahead *= FINER;
    }
    Ok(ahead / (FINER * least))
}

/// How far the output is ahead in each part after the reversal, along its motion [rad].
fn ahead(integrals: &Integrals<'_>, swing: &Swing, balance: &Balance, part: f64) -> Option<[Option<f64>; QUARTER]> {
    let left = |sample: usize| {
        let (since, angle, row) = integrals.row(swing, sample, balance.delay);
        let centre: f64 = row[..STEP].iter().zip(balance.values.iter()).map(|(row, value)| row * value).sum();
        (since, angle - centre)
    };
    let before: Vec<(f64, f64)> = (swing.before[0]..swing.before[1]).map(left).collect();
    let count = before.len() as f64;
    let [time, angle] = [0, 1].map(|place| before.iter().map(|one| [one.0, one.1][place]).sum::<f64>() / count);
    let square: f64 = before.iter().map(|(since, _)| (since - time).powi(2)).sum();
    let speed = before.iter().map(|(since, left)| (since - time) * (left - angle)).sum::<f64>() / square;
    let mut sums = [(0.0, 0.0); QUARTER];
    for sample in swing.after[0]..swing.after[1] {
        let (since, left) = left(sample);
        if let Some(sum) = sums.get_mut((since / part) as usize) {
            sum.0 += swing.direction * (left - angle - speed * (since - time));
            sum.1 += 1.0;
        }
    }
    speed.is_finite().then(|| sums.map(|(sum, count)| (count > 0.0).then(|| sum / count)))
}
