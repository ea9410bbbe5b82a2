//! Results of a slow log: figures with intervals, the curves behind them, and the cross-validation.

use serde::Serialize;

use super::curves::Curves;
use super::loading::{Loading, check_one_load};
use super::map::Map;
use super::passes::passes;
use super::prediction::Prediction;
use super::profiles::{Profile, Profiles, check_count};
use super::samples::{Samples, Scale, resolution};
use crate::estimate::Estimate;
use crate::statistics::{mean, quantile_of, rms, student};
use report::failure::{Failure, Outcome};
use report::number::ESTIMATE;

/// Largest motion between samples, as a share of the width.
const STEP_SHARE_MAX: f64 = 0.5;

/// One figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Quantity {
    /// Key of the figure.
    pub key: String,
    /// Name of the figure.
    pub name: String,
    /// Unit of value and interval.
    pub unit: String,
    /// Best value; absent if the log does not determine it.
    pub value: Option<f64>,
    /// Lower and upper end of the 95 % interval, if passes give one.
    pub interval: Option<[f64; 2]>,
    /// Value in degrees of the output, if a turn is known [deg].
    pub value_deg: Option<f64>,
    /// Interval in degrees of the output [deg].
    pub interval_deg: Option<[f64; 2]>,
    /// Remark; may be empty.
    pub note: String,
}

/// A curve over places with its 95 % interval [units of the output].
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Curve {
    /// Mean.
    pub value: Vec<f64>,
    /// Lower end.
    pub low: Vec<f64>,
    /// Upper end.
    pub high: Vec<f64>,
}

impl Curve {
    /// Curve of estimates; half of each interval is at least `least`.
    fn from_estimates(estimates: Vec<Estimate>, least: f64) -> Self {
        let mut curve = Self::default();
        for Estimate { value, half } in estimates.into_iter().map(|one| one.with_half_at_least(least)) {
            curve.value.push(value);
            curve.low.push(value - half);
            curve.high.push(value + half);
        }
        curve
    }
}

/// All results.
pub struct Results {
    /// Source of the load's direction.
    pub loading: Loading,
    /// Unit of the output.
    pub scale: Scale,
    /// Passes over the bins.
    pub profiles: Profiles,
    /// Length excluded at each end of a pass.
    pub left_out: f64,
    /// Mean difference of each group over the bins.
    pub groups: Vec<Vec<f64>>,
    /// Lost motion, or width by direction, over the bins.
    pub width: Curve,
    /// Hysteresis under each load over the bins, if loads are known.
    pub hysteresis: Vec<Curve>,
    /// Error map.
    pub map: Map,
    /// Cross-validation.
    pub prediction: Prediction,
    /// Mean of each pass about its group's mean, over time [s, units].
    pub levels: Vec<(f64, f64)>,
    /// All figures.
    pub quantities: Vec<Quantity>,
}

impl Results {
    /// Evaluates samples and stated halves.
    pub fn evaluate(samples: &Samples, halves: &[(f64, f64)]) -> Outcome<Self> {
        let (passes, left_out) = passes(samples, halves)?;
        let profiles = Profiles::from_passes(samples, &passes, halves.len())?;
        let loading = Loading::classify(&profiles, halves.len());
        let profiles = profiles.shared(|one| loading.group(one), loading.groups())?;
        let of_groups = |values: &dyn Fn(&Profile) -> Option<Vec<f64>>| -> Option<Curves> {
            let mut groups = vec![Vec::new(); loading.groups()];
            for one in &profiles.all {
                groups[loading.group(one)].push(values(one)?);
            }
            Some(Curves(groups))
        };
        let curves = of_groups(&|one| Some(one.difference.clone())).unwrap_or_default();
        for (group, passes) in curves.0.iter().enumerate() {
            check_count(passes.len(), group / 2, halves.len(), group % 2 == 0)?;
        }
        // Lost motion is the first load's mean less the second's; positive if halves do not state the directions of
        // their loads.
        let apart = |means: &[Vec<f64>], place: usize| match loading.groups() {
            4 => 0.5 * (means[2][place] + means[3][place] - means[0][place] - means[1][place]),
            _ => means[1][place] - means[0][place],
        };
        let places = profiles.places.len();
        let over = |means: &[Vec<f64>]| -> Vec<f64> { (0..places).map(|place| apart(means, place)).collect() };
        let groups = curves.means();
        let sign = if loading == Loading::ByHalf && quantile_of(&over(&groups), 0.5) < 0.0 { -1.0 } else { 1.0 };
        let share = |share: f64| curves.estimate(|means| quantile_of(&signed(&over(means), sign), share));
        let hysteresis = |load: usize| {
            curves.estimate(|means| {
                mean(&(0..places).map(|place| means[2 * load + 1][place] - means[2 * load][place]).collect::<Vec<_>>())
            })
        };
        let shares = [0.5, 0.1, 0.9].map(share).map(|one| one.with_half_at_least(samples.resolution));
        let loops = (0..loading.groups() / 2).map(hysteresis).map(|one| one.with_half_at_least(samples.resolution));
        let loops: Vec<Estimate> = loops.collect();
        let largest = loops.iter().map(|one| one.value.abs()).fold(shares[0].value.abs(), f64::max);
        let step = profiles.speed() * samples.period;
        if halves.is_empty() && loading.groups() == 2 {
            check_one_load(&profiles, &groups, shares[0].value)?;
        }
        check_sign(loading, &shares[0])?;
        if step > STEP_SHARE_MAX * largest {
            return Err(Failure::new(format!(
                "the motion is too fast for this log: {} from one sample to the next, where the widths found are {} at most",
                ESTIMATE.write(step),
                ESTIMATE.write(largest)
            ))
            .with_help(
                "sweep more slowly, or log more often: encoders read at different times would mimic this width",
            ));
        }
        let mut found = FigureList { scale: samples.scale, resolution: samples.resolution, all: Vec::new() };
        let heights = if sign < 0.0 { "first" } else { "second" };
        let ranges: Vec<[f64; 2]> = (0..loops.len())
            .map(|load| {
                let loops: Vec<f64> =
                    (0..places).map(|place| groups[2 * load + 1][place] - groups[2 * load][place]).collect();
                [0.1, 0.9].map(|share| quantile_of(&loops, share))
            })
            .collect();
        found.widths(loading, &shares, (&loops, &ranges), 2.0 * step, heights);
        found.map(&curves, &profiles);
        let levels = found.repeatability(&curves, &profiles, &|one| loading.group(one), loading);
        for (key, name, torque, readings) in [
            ("motor", "motor torque", of_groups(&|one| one.motor_torque.clone()), &samples.motor_torque),
            ("output", "output torque", of_groups(&|one| one.output_torque.clone()), &samples.output_torque),
        ] {
            if let Some((torque, readings)) = torque.zip(readings.as_deref()) {
                found.friction(key, name, &torque, loading, resolution(readings));
            }
        }
        let hysteresis = (0..loading.groups() / 2).filter(|_| loading.groups() == 4).map(|load| {
            let loops = curves.estimates(|means, place| means[2 * load + 1][place] - means[2 * load][place]);
            Curve::from_estimates(loops, samples.resolution)
        });
        Ok(Self {
            loading,
            scale: samples.scale,
            left_out,
            width: Curve::from_estimates(
                curves.estimates(|means, place| sign * apart(means, place)),
                samples.resolution,
            ),
            hysteresis: hysteresis.collect(),
            map: Map::from_means(&profiles.places, &groups),
            prediction: Prediction::cross_validate(&curves),
            groups,
            levels,
            quantities: found.all,
            profiles,
        })
    }
}

fn signed(values: &[f64], sign: f64) -> Vec<f64> {
    values.iter().map(|value| sign * value).collect()
}

/// Rejects an output ahead of the motor, or ahead in the direction of the torque.
fn check_sign(loading: Loading, width: &Estimate) -> Outcome<()> {
    if loading == Loading::ByHalf || width.value + width.half >= 0.0 {
        return Ok(());
    }
    let what = if loading == Loading::ByTorque {
        "the output is ahead of the motor while the torque drives it forwards"
    } else {
        "the output is ahead of the motor in both directions"
    };
    Err(Failure::new(format!(
        "{what}, by {}: neither backlash nor friction explains this",
        ESTIMATE.write(-width.value)
    ))
    .with_help(
        "the difference, the torque or an encoder counts the other way, or the encoders are read at different \
             times",
    ))
}

/// Ends of the interval, if it is finite.
fn ends(Estimate { value, half }: Estimate) -> Option<[f64; 2]> {
    half.is_finite().then_some([value - half, value + half])
}

/// Collected figures.
struct FigureList {
    scale: Scale,
    /// Least half of an interval of an angle [units of the output].
    resolution: f64,
    all: Vec<Quantity>,
}

impl FigureList {
    /// Adds a figure in the unit of the output.
    fn angle(&mut self, key: impl Into<String>, name: impl Into<String>, estimate: Estimate, note: impl Into<String>) {
        let degrees = self.scale.degrees();
        let interval = ends(estimate.with_half_at_least(self.resolution));
        self.all.push(Quantity {
            key: key.into(),
            name: name.into(),
            unit: self.scale.unit.into(),
            value: Some(estimate.value),
            interval,
            value_deg: degrees.map(|degrees| degrees * estimate.value),
            interval_deg: degrees.zip(interval).map(|(degrees, ends)| ends.map(|end| degrees * end)),
            note: note.into(),
        });
    }

    /// Adds a figure in another unit.
    fn other(&mut self, key: String, name: String, unit: &str, estimate: Estimate, note: &str) {
        self.all.push(Quantity {
            key,
            name,
            unit: unit.into(),
            value: Some(estimate.value),
            interval: ends(estimate),
            value_deg: None,
            interval_deg: None,
            note: note.into(),
        });
    }

    fn widths(
        &mut self,
        loading: Loading,
        shares: &[Estimate; 3],
        (loops, ranges): (&[Estimate], &[[f64; 2]]),
        mimicked: f64,
        higher: &str,
    ) {
        let known = loading.groups() == 4;
        let by_place = [
            ("median", "median over the places"),
            ("10_percent", "10 % of the places below"),
            ("90_percent", "90 % of the places below"),
        ];
        if !known {
            self.all.push(Quantity {
                key: "lost_motion".into(),
                name: "lost motion".into(),
                unit: self.scale.unit.into(),
                value: None,
                interval: None,
                value_deg: None,
                interval_deg: None,
                note: "not determined by this log: no reversal under a known load".into(),
            });
        }
        if loading != Loading::OneWay {
            let (key, name) =
                if known { ("lost_motion", "lost motion") } else { ("width_by_direction", "width by direction") };
            for ((own, which), estimate) in by_place.iter().zip(shares) {
                let note = match (known, *own) {
                    (true, "median") if loading == Loading::ByHalf => {
                        format!("wind-up under the load included; the output stands higher in the {higher} half")
                    }
                    (true, "median") => "wind-up under the load included".to_owned(),
                    (false, "median") => "lost motion and hysteresis, not separated".to_owned(),
                    _ => String::new(),
                };
                self.angle(format!("{key}_{own}"), format!("{name}, {which}"), *estimate, note);
            }
        }
        if known || loading == Loading::OneWay {
            for (load, (name, estimate)) in loading.names().iter().zip(loops).enumerate() {
                let note = if estimate.value + estimate.half < 0.0 {
                    "negative: the output is ahead of the motor, which friction does not explain; the encoders are read \
                         at different times, or the motor's encoder is wrong"
                } else {
                    ""
                };
                let [low, high] = ranges[load].map(|end| ESTIMATE.write(end));
                let note = format!("mean over the places; 10 to 90 % of them: {low} to {high}")
                    + if note.is_empty() { "" } else { "; " }
                    + note;
                self.angle(format!("hysteresis_{}", load + 1), format!("hysteresis, {name}"), *estimate, note);
            }
        }
        self.angle(
            "feigned_by_one_period",
            "mimicked by readings one sampling period apart",
            Estimate { value: mimicked, half: f64::NAN },
            "possible error of the figures by direction; not in their intervals",
        );
    }

    fn map(&mut self, curves: &Curves, profiles: &Profiles) {
        let places = &profiles.places;
        let of = |means: &[Vec<f64>]| Map::from_means(places, means);
        let scale = curves.estimate(|means| of(means).output_per_motor());
        self.other(
            "output_per_motor".into(),
            "output for each 1 of the motor".into(),
            "",
            scale.with_half_at_least(self.resolution / (profiles.width * places.len() as f64)),
            "slope of the error map; 1 as stated",
        );
        let long = curves.estimate(|means| of(means).long_wave_range());
        self.angle("map_long_wave_range", "error map: long wave, least to greatest", long, "");
        // Contribution of the passes' scatter to the mean square of the ripple.
        let noise: f64 = curves
            .0
            .iter()
            .zip(&curves.deviations().0)
            .map(|(group, deviations)| {
                let square = rms(&Curves(vec![deviations.clone()]).values()).powi(2);
                let there = Curves(vec![group.clone()]).values().len() as f64 / profiles.places.len() as f64;
                square / (there * (curves.0.len() * curves.0.len()) as f64)
            })
            .sum();
        let ripple = curves.estimate(|means| (of(means).ripple_rms().powi(2) - noise).max(0.0).sqrt());
        let strongest = of(&curves.means()).strongest_ripple(places).map_or(String::new(), |(period, amplitude)| {
            format!(
                "scatter subtracted; strongest period {}, amplitude {} {}",
                ESTIMATE.write(period),
                ESTIMATE.write(amplitude),
                self.scale.unit
            )
        });
        self.angle("map_ripple_rms", "error map: ripple, root mean square", ripple, strongest);
    }

    /// Adds scatter and drift; returns the mean of each pass about its group's mean, over time.
    fn repeatability(
        &mut self,
        curves: &Curves,
        profiles: &Profiles,
        group: &dyn Fn(&Profile) -> usize,
        loading: Loading,
    ) -> Vec<(f64, f64)> {
        let without = |value: f64| Estimate { value, half: f64::NAN };
        let deviations = curves.deviations();
        self.angle(
            "repeatability_rms",
            "repeatability of passes, root mean square",
            without(rms(&deviations.values())),
            "",
        );
        for (load, name) in loading.names().iter().enumerate().filter(|_| loading.groups() == 4) {
            let own = Curves(deviations.0[2 * load..2 * load + 2].to_vec());
            self.angle(
                format!("repeatability_rms_{}", load + 1),
                format!("repeatability, {name}"),
                without(rms(&own.values())),
                "",
            );
        }
        let means = curves.means();
        let mut levels: Vec<(usize, f64, f64)> = Vec::new();
        for one in &profiles.all {
            let own = group(one);
            // A single pass of a group at a place is no repeat.
            let repeats = |place: usize| curves.0[own].iter().filter(|curve| curve[place].is_finite()).count() > 1;
            let about = one.difference.iter().zip(&means[own]).enumerate().filter(|(place, _)| repeats(*place));
            let about: Vec<f64> = about.map(|(_, (value, mean))| value - mean).collect();
            if about.iter().all(|value| value.is_nan()) {
                continue;
            }
            levels.push((own, one.time[1], Profile::mean(&about)));
        }
        let count = levels.len() as f64;
        let groups = curves.0.len() as f64;
        let squares: f64 = levels.iter().map(|level| level.2.powi(2)).sum();
        let whole = (squares / (count - groups)).sqrt();
        self.angle(
            "repeatability_of_whole_passes",
            "repeatability of whole passes, by their means",
            without(whole),
            "",
        );
        self.angle(
            "scatter_of_readings",
            "scatter of single readings within a bin",
            without(profiles.scatter()),
            "slope of the map over a bin included",
        );
        let time_of = |wanted: usize| {
            mean(&levels.iter().filter(|level| level.0 == wanted).map(|level| level.1).collect::<Vec<_>>())
        };
        let starts: Vec<f64> = (0..curves.0.len()).map(time_of).collect();
        let square: f64 = levels.iter().map(|level| (level.1 - starts[level.0]).powi(2)).sum();
        let slope = levels.iter().map(|level| (level.1 - starts[level.0]) * level.2).sum::<f64>() / square;
        let freedom = count - groups - 1.0;
        let left: f64 = levels.iter().map(|level| (level.2 - slope * (level.1 - starts[level.0])).powi(2)).sum();
        let half = student(freedom) * (left / freedom / square).sqrt();
        let unit = format!("{}/s", self.scale.unit);
        let note = "of the passes' means about their group's means; a width between halves includes the drift over the \
             time between them";
        let times = levels.iter().map(|level| level.1);
        let duration = times.clone().fold(f64::MIN, f64::max) - times.fold(f64::MAX, f64::min);
        let drift = Estimate { value: slope, half }.with_half_at_least(self.resolution / duration);
        self.other("drift".into(), "drift".into(), &unit, drift, note);
        levels.into_iter().map(|(_, time, level)| (time, level)).collect()
    }

    /// Adds the figures of a torque; half of each interval is at least `least` [N m].
    fn friction(&mut self, key: &str, name: &str, torque: &Curves, loading: Loading, least: f64) {
        let at = |means: &[Vec<f64>], group: usize| Profile::mean(&means[group]);
        for (load, which) in loading.names().iter().enumerate() {
            let which = if loading.groups() == 4 { format!(", {which}") } else { String::new() };
            let index = if loading.groups() == 4 { format!("_{}", load + 1) } else { String::new() };
            let [forwards, backwards] = [2 * load, 2 * load + 1];
            let figures = [
                ("forwards", torque.estimate(|means| at(means, forwards)), ""),
                ("backwards", torque.estimate(|means| at(means, backwards)), ""),
                (
                    "dry_friction",
                    torque.estimate(|means| 0.5 * (at(means, forwards) - at(means, backwards))),
                    "mean of both directions, including viscous friction at this speed",
                ),
                (
                    "load_and_asymmetry",
                    torque.estimate(|means| 0.5 * (at(means, forwards) + at(means, backwards))),
                    "load plus half the excess of forward over backward friction, not separated",
                ),
            ];
            for (own, estimate, note) in figures {
                let label = own.replace('_', " ");
                self.other(
                    format!("{key}_torque_{own}{index}"),
                    format!("{name}, {label}{which}"),
                    "N m",
                    estimate.with_half_at_least(least),
                    note,
                );
            }
        }
    }
}
