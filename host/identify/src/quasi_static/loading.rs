//! Direction of the output's load in each pass: stated by halves, shown by the torque, or unknown.

use super::profiles::{Profile, Profiles};
use crate::statistics::{mean, rms};
use report::failure::{Failure, Outcome};

/// Share of a pass's bins with one sign of the torque from which the pass is loaded one way.
const SIGN_SHARE_MIN: f64 = 0.9;
/// Passes of one direction lie on two levels if these differ by LEVELS_APART of the width ...
const LEVELS_APART: f64 = 0.5;
/// ... and the widest gap between passes exceeds LEVELS_CLEAR deviations of the passes on one level.
const LEVELS_CLEAR: f64 = 4.0;
/// Passes of one direction do not repeat if they differ by REPEAT_DISTANCE_MAX of the width ...
const REPEAT_DISTANCE_MAX: f64 = 0.5;
/// ... and by ABOVE_ROUGHNESS times the difference between neighbouring places.
const ABOVE_ROUGHNESS: f64 = 3.0;

/// Source of the load's direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Stated by `--half`.
    ByHalf,
    /// The torque keeps its sign within each pass, and has both signs in both directions.
    ByTorque,
    /// Unknown; only the direction of motion is known.
    ByDirection {
        /// True if a measured output torque reverses with the direction of motion.
        reverses: bool,
    },
    /// The torque has one sign in all passes: one flank carries throughout.
    OneWay,
}

impl Loading {
    /// Determines the loading of these passes.
    pub fn classify(profiles: &Profiles, halves: usize) -> Self {
        if halves > 0 {
            return Self::ByHalf;
        }
        let signs: Vec<(bool, f64)> = profiles.all.iter().map(|one| (one.pass.forwards, sign(one))).collect();
        let count = |forwards: bool, wanted: f64| signs.iter().filter(|own| **own == (forwards, wanted)).count();
        let unknown = signs.iter().filter(|(_, sign)| *sign == 0.0).count();
        let measured = profiles.all.iter().all(|one| one.output_torque.is_some());
        let kinds =
            [(true, 1.0), (false, 1.0), (true, -1.0), (false, -1.0)].map(|(forwards, sign)| count(forwards, sign));
        let enough = kinds.map(|count| count >= 2);
        match kinds.map(|count| count > 0) {
            _ if unknown > 0 => Self::ByDirection { reverses: false },
            [true, true, true, true] if enough == [true; 4] => Self::ByTorque,
            [true, true, false, false] | [false, false, true, true] => Self::OneWay,
            [true, false, false, true] => Self::ByDirection { reverses: measured },
            _ => Self::ByDirection { reverses: false },
        }
    }

    /// Number of groups: by direction, and by load if loads of both signs are known.
    pub fn groups(self) -> usize {
        if matches!(self, Self::ByHalf | Self::ByTorque) { 4 } else { 2 }
    }

    /// Group of a pass: forwards and backwards under the first load, then under the second. The first half, or a
    /// positive torque, is the first load.
    pub fn group(self, profile: &Profile) -> usize {
        let load = match self {
            Self::ByHalf => profile.pass.half,
            Self::ByTorque => usize::from(sign(profile) < 0.0),
            Self::ByDirection { .. } | Self::OneWay => 0,
        };
        2 * load + usize::from(!profile.pass.forwards)
    }

    /// Names of the loads.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::ByHalf => &["first half", "second half"],
            Self::ByTorque => &["positive torque", "negative torque"],
            Self::ByDirection { .. } | Self::OneWay => &["all passes"],
        }
    }

    /// The loading in one sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::ByHalf => "The load is stated: one way in the first half, the other way in the second.",
            Self::ByTorque => {
                "The torque shows the load: it keeps its sign within each pass, and has both signs in both \
                     directions."
            }
            Self::ByDirection { reverses: true } => {
                "The measured output torque reverses with the direction of motion: each direction carries on its own flank, so \
                 the width by direction is lost motion and hysteresis together, which this log does not separate."
            }
            Self::ByDirection { reverses: false } => {
                "The load is unknown. If friction at the output closes one flank forwards and the other backwards, \
                     the width by direction is lost motion and hysteresis together; if a load keeps one flank closed, it \
                     is hysteresis alone. This log does not show which: sweep under known loads of both directions and \
                     state --half, or log the output torque."
            }
            Self::OneWay => {
                "The torque has one sign throughout: one flank carries all the time, so that the width by direction is \
                 hysteresis, and the lost motion is not in this log."
            }
        }
    }
}

/// Sign of the torque in nearly all of a pass, measured at the output or else at the motor; 0 without one.
fn sign(profile: &Profile) -> f64 {
    let Some(torque) = profile.output_torque.as_ref().or(profile.motor_torque.as_ref()) else { return 0.0 };
    let there: Vec<f64> = torque.iter().copied().filter(|value| value.is_finite()).collect();
    let share = |sign: f64| there.iter().filter(|value| *value * sign > 0.0).count() as f64 / there.len() as f64;
    [1.0, -1.0].into_iter().find(|sign| share(*sign) >= SIGN_SHARE_MIN).unwrap_or(0.0)
}

/// Rejects passes of one direction that lie on two levels or do not repeat, as after an unstated change of the load.
/// `means` are both directions' means by place, `width` is their distance.
pub fn check_one_load(profiles: &Profiles, means: &[Vec<f64>], width: f64) -> Outcome<()> {
    let deviations = |one: &Profile| -> Vec<f64> {
        let own = &means[usize::from(!one.pass.forwards)];
        let all = one.difference.iter().zip(own).map(|(value, mean)| value - mean);
        all.filter(|value| value.is_finite()).collect()
    };
    let all: Vec<Vec<f64>> = profiles.all.iter().map(deviations).collect();
    check_levels(profiles, &all, width)?;
    let steps: Vec<f64> = all.iter().flat_map(|one| one.windows(2).map(|pair| pair[1] - pair[0])).collect();
    let (apart, rough) = (rms(&all.concat()), rms(&steps) / std::f64::consts::SQRT_2);
    if apart < REPEAT_DISTANCE_MAX * width.abs() || apart < ABOVE_ROUGHNESS * rough {
        return Ok(());
    }
    Err(Failure::new(format!(
        "passes of one direction do not repeat: they differ by {apart:.4} while the two directions differ by \
             {:.4}",
        width.abs()
    ))
    .with_help(
        "the load changed, or something slips or drifts: sweep loaded one way first and then the other, and name both stretches by \
         --half FROM..TO",
    ))
}

fn check_levels(profiles: &Profiles, deviations: &[Vec<f64>], width: f64) -> Outcome<()> {
    let levels: Vec<f64> = deviations.iter().map(|one| mean(one)).collect();
    let mut sorted = levels.clone();
    sorted.sort_by(f64::total_cmp);
    let gap = |pair: &[f64]| pair[1] - pair[0];
    let Some(widest) = sorted.windows(2).max_by(|a, b| gap(a).total_cmp(&gap(b))) else { return Ok(()) };
    let limit = 0.5 * (widest[0] + widest[1]);
    let (below, above): (Vec<f64>, Vec<f64>) = sorted.iter().partition(|value| **value < limit);
    let both_ways = |upper: bool| {
        let own = |forwards: bool| {
            let passes = profiles.all.iter().zip(&levels);
            passes.filter(|(one, level)| one.pass.forwards == forwards && (**level > limit) == upper).count()
        };
        own(true) >= 2 && own(false) >= 2
    };
    if !both_ways(true) || !both_ways(false) {
        return Ok(());
    }
    let apart = mean(&above) - mean(&below);
    let scatter: Vec<f64> =
        below.iter().map(|value| value - mean(&below)).chain(above.iter().map(|value| value - mean(&above))).collect();
    if apart < LEVELS_APART * width.abs() || gap(widest) < LEVELS_CLEAR * rms(&scatter) {
        return Ok(());
    }
    // Stretches of consecutive passes on one level.
    let mut stretches: Vec<(bool, f64, f64)> = Vec::new();
    for (one, level) in profiles.all.iter().zip(&levels) {
        let (upper, [from, _, to]) = (*level > limit, one.time);
        match stretches.last_mut() {
            Some((last, _, end)) if *last == upper => *end = to,
            _ => stretches.push((upper, from, to)),
        }
    }
    let help = match stretches[..] {
        [(_, a, b), (_, c, d)] => format!(
            "if it is loaded one way and then the other, name the stretches, such as --half {:.0}..{:.0} --half {:.0}..{:.0}",
            a.floor(),
            b.ceil(),
            c.floor(),
            d.ceil()
        ),
        _ => "sweep loaded one way first and then the other, and name both stretches by --half FROM..TO".to_owned(),
    };
    Err(Failure::new(format!(
        "the load changes in this log: passes of one direction lie on two levels, apart by {apart:.4} while \
             the two directions differ by {:.4}",
        width.abs()
    ))
    .with_help(help))
}
