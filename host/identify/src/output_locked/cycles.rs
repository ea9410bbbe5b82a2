//! Cycles of the torque, to one side and back, each with its fit of equation (1). A sample is used if the motor
//! certainly moves on a flank: beyond the torques that cross the gap, and after friction has changed its sign at a
//! reversal.

use nalgebra::{SMatrix, SVector};

use crate::quasi_static::passes::turning_points;
use crate::statistics::{mean, quantile_of};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// The torque turns if it then goes back by this share of its range.
const TURN_SHARE: f64 = 0.5;
/// Least torque at both ends of a whole way, over the peak.
const WAY_END_TORQUE_MIN: f64 = 0.7;
/// Least cycles for an interval.
const CYCLES_MIN: usize = 3;
/// Largest ratio of the peaks of both sides.
const PEAK_RATIO_MAX: f64 = 2.0;
/// Least load that is used: this share of the peak, and LOAD_MIN_FRICTIONS times the friction.
const LOAD_MIN: f64 = 0.3;
const LOAD_MIN_FRICTIONS: f64 = 3.0;
/// Largest least load, as a share of the peak; above it too little is left to fit a flank.
const LOAD_MIN_LIMIT: f64 = 0.6;
/// After a reversal, samples are skipped until the torque has changed by STICKING_FACTOR times the change by friction
/// plus STICKING_SHARE of the peak.
const STICKING_FACTOR: f64 = 1.3;
const STICKING_SHARE: f64 = 0.05;
/// First guess of the skipped change, as a share of the peak.
const STICKING_FIRST_GUESS: f64 = 0.35;
/// Fits in succession, each with the friction found by the previous one.
const FIT_ROUNDS: usize = 4;
/// Least samples of a cycle on each flank and in each direction.
const FLANK_SAMPLES_MIN: usize = 6;
/// Largest residual over the whole travel; above it the flanks are not straight.
const RESIDUAL_MAX: f64 = 0.1;
/// Unknowns: ends of both flanks at zero torque, compliance, and the angle by friction and by losses.
const UNKNOWNS: usize = 5;

/// Parameters of one cycle, at the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Ends of the upper and the lower flank at zero torque [rad].
    pub ends: [f64; 2],
    /// Lost motion: upper end less lower end [rad].
    pub lost_motion: f64,
    /// Compliance [rad/(N m)].
    pub compliance: f64,
    /// Compliance above the middle of the loads less compliance below it [rad/(N m)].
    pub curvature: f64,
    /// Dry friction of the motor times the ratio [N m].
    pub friction: f64,
    /// Share of the load that is lost.
    pub loss: f64,
    /// Root mean square of the residuals [rad].
    residual: f64,
}

/// All cycles of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycles {
    /// Cycles in order of time.
    pub all: Vec<Cycle>,
    /// Least and largest torque of the samples used [N m].
    pub loads: [f64; 2],
    /// Rate of the torque [N m/s].
    pub torque_rate: f64,
    /// Changes of the flank.
    pub crossings: usize,
}

/// A sample used: angle, torque, direction of the torque.
#[derive(Clone, Copy)]
struct Moment {
    twist: f64,
    torque: f64,
    way: f64,
}

impl Cycles {
    /// Finds and fits the cycles.
    pub fn fit(time: &[f64], twist: &[f64], torque: &[f64]) -> Outcome<Self> {
        let [low, high] = [0.005, 0.995].map(|share| quantile_of(torque, share));
        if !(low < 0.0 && high > 0.0) {
            return Err(Failure::new(format!(
                "there is no reversal in this log: the torque at the output stays between {} and {} N m",
                ESTIMATE.write(low),
                ESTIMATE.write(high)
            ))
            .with_help("let the torque alternate slowly, so that both flanks of the teeth carry"));
        }
        let peak = high.min(-low);
        if high.max(-low) > PEAK_RATIO_MAX * peak {
            return Err(Failure::new(format!(
                "the torque reaches {} N m in one direction and {} N m in the other",
                ESTIMATE.write(high),
                ESTIMATE.write(low)
            ))
            .with_help(
                "let the torque reach the same value in both directions: both flanks are fitted over equal ranges",
            ));
        }
        // A log may begin and end anywhere: only whole ways from peak to peak are used.
        let mut turns = turning_points(torque, TURN_SHARE * (high - low));
        turns.retain(|turn| torque[*turn].abs() >= WAY_END_TORQUE_MIN * peak);
        let cycles: Vec<[usize; 3]> = turns.windows(3).step_by(2).map(|turns| [turns[0], turns[1], turns[2]]).collect();
        if cycles.len() < CYCLES_MIN {
            return Err(Failure::new(format!(
                "too few cycles: the torque goes to and fro {} times, {CYCLES_MIN} are the least",
                cycles.len()
            ))
            .with_help("repeat the cycle: the intervals come from the scatter between cycles"));
        }
        let (mut sticking, mut least) = (STICKING_FIRST_GUESS * peak, LOAD_MIN * peak);
        let mut all = Vec::new();
        for _ in 0..FIT_ROUNDS {
            let fit = |turns: &[usize; 3]| {
                Cycle::from_moments(&moments(twist, torque, turns, sticking, least), [least, peak])
            };
            all = cycles.iter().map(fit).collect::<Option<Vec<Cycle>>>().ok_or_else(too_coarse)?;
            let of = |part: fn(&Cycle) -> f64| mean(&all.iter().map(part).collect::<Vec<_>>());
            let (friction, loss) = (of(|cycle| cycle.friction).max(0.0), of(|cycle| cycle.loss).max(0.0));
            sticking = STICKING_FACTOR * 2.0 * (friction + loss * peak) + STICKING_SHARE * peak;
            least = (LOAD_MIN * peak).max(LOAD_MIN_FRICTIONS * friction);
            if least > LOAD_MIN_LIMIT * peak || sticking > (1.0 - LOAD_MIN) * peak {
                return Err(Failure::new(format!(
                    "the torque is too small against the friction: {} N m at the output, including {} N m of friction",
                    ESTIMATE.write(peak),
                    ESTIMATE.write(friction + loss * peak)
                ))
                .with_help(
                    "let the torque reach ten times the motor's friction; with a self-locking gear, drive the output \
                     instead",
                ));
            }
        }
        let way = twist.iter().copied().fold(f64::MIN, f64::max) - twist.iter().copied().fold(f64::MAX, f64::min);
        let residual = quantile_of(&all.iter().map(|cycle| cycle.residual).collect::<Vec<_>>(), 0.5);
        if residual > RESIDUAL_MAX * way || mean(&all.iter().map(|cycle| cycle.compliance).collect::<Vec<_>>()) <= 0.0 {
            return Err(Failure::new(format!(
                "the angle does not follow the torque along two straight flanks: the residual is {} rad of {} rad in \
                     all",
                ESTIMATE.write(residual),
                ESTIMATE.write(way)
            ))
            .with_help(
                "change the torque evenly and slowly, with at least a second per cycle; check the signs of motor and \
                     torque, and that the output is held",
            ));
        }
        let whole =
            turns.windows(2).map(|pair| (torque[pair[1]] - torque[pair[0]]).abs() / (time[pair[1]] - time[pair[0]]));
        let torque_rate = quantile_of(&whole.collect::<Vec<_>>(), 0.5);
        Ok(Self { all, loads: [least, peak], torque_rate, crossings: turns.len() - 1 })
    }
}

fn too_coarse() -> Failure {
    Failure::new("a cycle has too few samples on a flank, or its torques do not determine a fit")
        .with_help("change the torque evenly and slowly, and log more often")
}

/// Samples of a cycle that are used.
fn moments(twist: &[f64], torque: &[f64], turns: &[usize; 3], sticking: f64, least: f64) -> Vec<Moment> {
    let half = |from: usize, to: usize| {
        let way = (torque[to] - torque[from]).signum();
        (from..to).filter_map(move |sample| {
            let moment = Moment { twist: twist[sample], torque: torque[sample], way };
            let is_used = moment.torque.abs() >= least && way * (moment.torque - torque[from]) >= sticking;
            is_used.then_some(moment)
        })
    };
    half(turns[0], turns[1]).chain(half(turns[1], turns[2])).collect()
}

impl Cycle {
    fn from_moments(moments: &[Moment], [least, peak]: [f64; 2]) -> Option<Self> {
        for (side, way) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let own = moments.iter().filter(|moment| moment.torque * side > 0.0 && moment.way == way);
            if own.count() < FLANK_SAMPLES_MIN {
                return None;
            }
        }
        let solved = fit(moments)?;
        let middle = 0.5 * (least + peak);
        let part = |upper: bool| -> Option<f64> {
            let own: Vec<Moment> =
                moments.iter().copied().filter(|moment| (moment.torque.abs() > middle) == upper).collect();
            fit(&own).map(|solved| solved[2])
        };
        let curvature = part(true).zip(part(false)).map_or(0.0, |(upper, lower)| upper - lower);
        let left = |moment: &Moment| (moment.twist - row(moment).dot(&solved)).powi(2);
        let compliance = solved[2];
        Some(Self {
            ends: [solved[0], solved[1]],
            lost_motion: solved[0] - solved[1],
            compliance,
            curvature,
            friction: -solved[3] / compliance,
            loss: -solved[4] / compliance,
            residual: (moments.iter().map(left).sum::<f64>() / moments.len() as f64).sqrt(),
        })
    }
}

fn row(moment: &Moment) -> SVector<f64, UNKNOWNS> {
    let Moment { torque, way, .. } = *moment;
    let upper = f64::from(u8::from(torque > 0.0));
    SVector::from([upper, 1.0 - upper, torque, way, way * torque.abs()])
}

/// Least squares of (1), with scaled unknowns.
fn fit(moments: &[Moment]) -> Option<SVector<f64, UNKNOWNS>> {
    let greatest = moments.iter().map(|moment| moment.torque.abs()).fold(0.0, f64::max);
    let scale = SVector::<f64, UNKNOWNS>::from([1.0, 1.0, greatest, 1.0, greatest]);
    let (mut square, mut right) = (SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros(), SVector::<f64, UNKNOWNS>::zeros());
    for moment in moments {
        let row = row(moment).component_div(&scale);
        square += row * row.transpose();
        right += row * moment.twist;
    }
    let solved = square.cholesky()?.solve(&right).component_div(&scale);
    solved.iter().all(|value| value.is_finite()).then_some(solved)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gear with a clamped output, friction and losses: time, angle and torque over four cycles.
    fn clamped_gear(friction: f64, loss: f64) -> [Vec<f64>; 3] {
        let (compliance, lost_motion, peak) = (1e-4, 4e-3, 12.0);
        let mut spring = -peak;
        let wave = |row: i32| peak * (std::f64::consts::TAU * f64::from(row) / 2000.0).cos();
        let torque: Vec<f64> = (0..8500).map(wave).collect();
        let twist = torque
            .iter()
            .map(|torque| {
                // The spring's torque changes only while the motor's torque exceeds the friction.
                let upper =
                    if *torque > 0.0 { (torque - friction) * (1.0 - loss) } else { (torque - friction) / (1.0 - loss) };
                let lower =
                    if *torque < 0.0 { (torque + friction) * (1.0 - loss) } else { (torque + friction) / (1.0 - loss) };
                spring = f64::clamp(spring, upper.min(lower), upper.max(lower));
                compliance * spring + 0.5 * lost_motion * spring.signum()
            })
            .collect();
        [(0..8500).map(|row| f64::from(row) * 1e-3).collect(), twist, torque]
    }

    /// Lost motion and compliance are recovered beside friction and losses.
    #[test]
    fn cycles_separate_flanks_from_friction() {
        for (friction, loss) in [(0.0, 0.0), (0.5, 0.0), (0.2, 0.04)] {
            let [time, twist, torque] = clamped_gear(friction, loss);
            let cycles = Cycles::fit(&time, &twist, &torque).expect("cycles");
            assert_eq!(cycles.all.len(), 4);
            for cycle in &cycles.all {
                assert!((cycle.lost_motion / 4e-3 - 1.0).abs() < 5e-3, "{cycle:?}");
                assert!((cycle.compliance / 1e-4 - 1.0).abs() < 5e-3, "{cycle:?}");
                assert!((cycle.friction - friction).abs() < 0.02 && (cycle.loss - loss).abs() < 5e-3, "{cycle:?}");
            }
        }
    }

    /// Rejects a torque of one sign, of two cycles, or within the friction.
    #[test]
    fn cycles_unusable_torque_is_rejected() {
        let [time, twist, torque] = clamped_gear(0.2, 0.0);
        let shifted: Vec<f64> = torque.iter().map(|torque| torque + 13.0).collect();
        let refused = |torque: &[f64], count: usize| {
            Cycles::fit(&time[..count], &twist[..count], &torque[..count]).expect_err("refused").message().to_owned()
        };
        assert!(refused(&shifted, 8500).contains("no reversal"));
        assert!(refused(&torque, 4600).contains("too few cycles: the torque goes to and fro 2 times"));
        let [time, twist, torque] = clamped_gear(5.0, 0.0);
        assert!(
            Cycles::fit(&time, &twist, &torque)
                .expect_err("refused")
                .message()
                .contains("too small against the friction")
        );
    }
}
