//! Named figures of a run: what each is called, in which unit, what it means, and its value from the truth. What the
//! observer's estimates are worth is in `sight`; which figure must be how good is the file's business.

use host_tests::closed_loop::{Figures as Plain, deviation};

use super::case::Case;
use super::controller::ControllerName;
use super::execution::Ran;
use super::file::TestFile;
use super::sight;

/// What kind of test a figure needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Any.
    Motion,
    /// One with impedance set-points.
    Impedance,
    /// One of observer and compensation.
    Sight,
    /// A hysteresis loop.
    Loop,
}

/// One figure.
#[derive(Debug, PartialEq)]
pub struct Figure {
    /// Name without its unit.
    pub stem: &'static str,
    /// As it ends the name; empty for counts.
    pub unit: &'static str,
    /// What it needs.
    pub about: About,
    /// What it means.
    pub meaning: &'static str,
}

const fn figure(stem: &'static str, unit: &'static str, about: About, meaning: &'static str) -> Figure {
    Figure { stem, unit, about, meaning }
}

use About::{Impedance, Loop, Motion, Sight};

/// All figures that a run itself has.
pub static FIGURES: &[Figure] = &[
    figure("rms", "mrad", Motion, "link against wanted position, root mean square"),
    figure("peak", "mrad", Motion, "link against wanted position, largest"),
    figure("peak_to_peak", "mrad", Motion, "largest less smallest error of the link's position"),
    figure(
        "reversal_error",
        "mrad",
        Motion,
        "largest error within 60 ms of a reversal of the wanted speed, mean over reversals",
    ),
    figure("lost_motion", "ms", Motion, "from leaving one flank to touching the other, mean"),
    figure("longest_lost_motion", "ms", Motion, "the longest of them"),
    figure("crossings", "", Motion, "changes from one flank to the other"),
    figure("last_crossing", "s", Motion, "time of the last of them; 0 without any"),
    figure("quiet", "s", Motion, "time from the last crossing to the end"),
    figure("peak_mesh_force", "N", Motion, "largest net force of the sun's meshes"),
    figure("peak_mesh_force_ratio", "", Motion, "the same over what the rated torque takes"),
    figure("effort", "N_m", Motion, "motor torque asked for, root mean square"),
    figure("peak_torque", "N_m", Motion, "motor torque asked for, largest"),
    figure("saturated", "percent", Motion, "part of the time in which the motor's limit is reached"),
    figure("deviation_rms", "mrad", Impedance, "link against the same law on teeth without a gap, root mean square"),
    figure("deviation_peak", "mrad", Impedance, "the same, largest"),
    figure(
        "torque_error",
        "N_m",
        Impedance,
        "torque between carrier and link against the same law without a gap, root mean square",
    ),
    figure("gap_error_rms", "percent", Sight, "gap coordinate against the truth over the gap 4b, root mean square"),
    figure("gap_error_max", "percent", Sight, "the same, largest"),
    figure("gap_valid", "percent", Sight, "part of the time in which the gap coordinate is said to be valid"),
    figure("gap_error_valid", "percent", Sight, "its error while it is said to be valid, root mean square"),
    figure("gap_surprise", "", Sight, "mean squared error of a valid gap over its stated variance; 1 is honest"),
    figure("side_right", "percent", Sight, "part of the time with the right contact side, outside a band of 5 %"),
    figure("missed_landings", "", Sight, "landings on a flank that were never reported"),
    figure("landing_delay_median", "ms", Sight, "from a landing to its report, median"),
    figure("landing_delay_p95", "ms", Sight, "the same, 95th percentile"),
    figure(
        "load_torque_error",
        "percent",
        Sight,
        "load torque against the truth over the rated torque, root mean square",
    ),
    figure("mesh_torque_error", "percent", Sight, "transmitted torque likewise"),
    figure("width_error", "percent", Sight, "learnt half-backlash at the end against the truth"),
    figure("width_right_after", "s", Sight, "from when on the width is right to 5 % for good"),
    figure("width_right_after_contact", "s", Sight, "the same in seconds of motion with a flank touching"),
    figure("compliance_error", "percent", Sight, "learnt compliance at the end against the truth, meshes included"),
    figure("skew_error", "us", Sight, "learnt skew of the encoders at the end against the truth"),
    figure(
        "fault_found",
        "ms",
        Sight,
        "from the first fault of the output encoder (frozen, offset, missing counts, lost frames) to the observer's falling back to the motor encoder; a thousand seconds if never",
    ),
    figure("false_alarms", "", Sight, "falls back to the motor encoder while no fault was on"),
    figure("compensated", "percent", Sight, "mean share of the compensation in the torque"),
    figure("loop_lost_motion", "mrad", Loop, "opening of the hysteresis loop at 3 % of the rated torque"),
    figure("loop_stiffness", "N_m_per_rad", Loop, "slope of the loop between half and full torque"),
];

/// A figure of the controller's run, or one against another controller's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Named {
    index: usize,
    /// Of itself or against whom.
    pub relation: Relation,
}

/// How a figure relates to runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// The controller's own.
    Own,
    /// The other's over the controller's: above 1 is better.
    GainOver(ControllerName),
    /// The controller's over the other's: below 1 is better.
    RatioTo(ControllerName),
}

/// A gain over a controller that is right to the last bit would be infinite; this says enough.
const MOST_GAIN: f64 = 1e6;

impl Figure {
    /// Its name with the unit.
    pub fn name(&self) -> String {
        if self.unit.is_empty() { self.stem.to_owned() } else { format!("{}_{}", self.stem, self.unit) }
    }

    /// Its unit as printed.
    pub fn printed_unit(&self) -> &'static str {
        match self.unit {
            "percent" => "%",
            "N_m" => "N m",
            "N_m_per_rad" => "N m/rad",
            unit => unit,
        }
    }
}

/// Whom a name behind `over` or `to` means in a test.
fn others(impedance: bool) -> Vec<(&'static str, ControllerName)> {
    let own = ControllerName::ALL.into_iter().filter(|name| !name.is_ours() && name.wants_gains() == impedance);
    let mut list: Vec<_> = own.filter(|name| *name != ControllerName::Off).map(|name| (name.word(), name)).collect();
    list.push(("baseline", ControllerName::baseline(impedance)));
    list.push(("best_rival", ControllerName::best_rival(impedance)));
    if !impedance {
        list.push(("pid", ControllerName::MotorPid));
        list.push(("cascade", ControllerName::LoadCascade));
    }
    list
}

/// Every name that a test may assert.
pub fn names(impedance: bool) -> Vec<String> {
    let mut names: Vec<String> = FIGURES.iter().map(Figure::name).collect();
    for figure in FIGURES.iter().filter(|figure| matches!(figure.about, Motion | Impedance)) {
        for (other, _) in others(impedance) {
            names.push(format!("{}_gain_over_{other}", figure.stem));
            names.push(format!("{}_ratio_to_{other}", figure.stem));
        }
    }
    names
}

impl Named {
    /// The figure of a name, in a test with or without impedance set-points.
    pub fn find(name: &str, impedance: bool) -> Option<Self> {
        if let Some(index) = FIGURES.iter().position(|figure| figure.name() == name) {
            return Some(Self { index, relation: Relation::Own });
        }
        let (stem, other, gain) = match (name.split_once("_gain_over_"), name.split_once("_ratio_to_")) {
            (Some((stem, other)), _) => (stem, other, true),
            (None, Some((stem, other))) => (stem, other, false),
            (None, None) => return None,
        };
        let index =
            FIGURES.iter().position(|figure| figure.stem == stem && matches!(figure.about, Motion | Impedance))?;
        let (_, other) = others(impedance).into_iter().find(|(word, _)| *word == other)?;
        let relation = if gain { Relation::GainOver(other) } else { Relation::RatioTo(other) };
        Some(Self { index, relation })
    }

    /// The figure that it rests on.
    pub fn base(&self) -> &'static Figure {
        &FIGURES[self.index]
    }

    /// Its value, from figures of the controller and of another one.
    pub fn value(&self, own: &Values, of: impl Fn(ControllerName) -> Option<Values>) -> Option<f64> {
        let own = own.0[self.index]?;
        let ratio = |above: f64, below: f64| match (above, below) {
            (above, below) if above == below => 1.0,
            (above, 0.0) => above.signum() * MOST_GAIN,
            (above, below) => above / below,
        };
        match self.relation {
            Relation::Own => Some(own),
            Relation::GainOver(other) => Some(ratio(of(other)?.0[self.index]?, own)),
            Relation::RatioTo(other) => Some(ratio(own, of(other)?.0[self.index]?)),
        }
    }
}

/// Values of all figures, where they could be had.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(Vec<Option<f64>>);

impl Values {
    /// Figures of a run; `without_gap` is the run that an impedance is measured from.
    pub fn of(file: &TestFile, case: &Case, ran: &Ran, without_gap: Option<&Ran>) -> Self {
        let mut values = Self(vec![None; FIGURES.len()]);
        values.motion(file, case, ran);
        if let Some(other) = without_gap {
            let (rms, peak, torque) = deviation(&ran.run, &other.run, file.settle);
            values.set("deviation_rms", 1e3 * rms);
            values.set("deviation_peak", 1e3 * peak);
            values.set("torque_error", torque);
        }
        if !ran.sights.is_empty() {
            for (stem, value) in sight::figures(file, case, ran) {
                values.set(stem, value);
            }
        }
        if file.profile.kind == "hysteresis" {
            values.hysteresis(file, case, ran);
        }
        values
    }

    /// Names and values of what could be had.
    pub fn named(&self) -> impl Iterator<Item = (&'static Figure, f64)> {
        FIGURES.iter().zip(&self.0).filter_map(|(figure, value)| Some((figure, (*value)?)))
    }

    /// A value by its stem.
    pub fn get(&self, stem: &str) -> Option<f64> {
        FIGURES.iter().position(|figure| figure.stem == stem).and_then(|index| self.0[index])
    }

    fn set(&mut self, stem: &str, value: f64) {
        if let Some(index) = FIGURES.iter().position(|figure| figure.stem == stem) {
            self.0[index] = value.is_finite().then_some(value);
        }
    }

    fn motion(&mut self, file: &TestFile, case: &Case, ran: &Ran) {
        let plain = Plain::of(&ran.run, file.settle);
        let joint = &case.truth.parameters;
        let rated = joint.rated_output_torque / (2.0 * joint.geometry.carrier_base_radius());
        let samples = || ran.run.samples.iter().filter(|sample| sample.time >= file.settle);
        let count = samples().count().max(1) as f64;
        let limit = case.train.motor.torque_limit;
        let at_limit = samples().filter(|sample| sample.command.abs() >= 0.9999 * limit).count() as f64;
        let end = ran.run.samples.last().map_or(0.0, |sample| sample.time);
        self.set("rms", 1e3 * plain.rms);
        self.set("peak", 1e3 * plain.peak);
        self.set("peak_to_peak", 1e3 * plain.peak_to_peak);
        self.set("lost_motion", 1e3 * plain.lost_motion_time);
        self.set("longest_lost_motion", 1e3 * plain.longest_lost_motion);
        self.set("crossings", plain.crossings as f64);
        self.set("last_crossing", plain.last_crossing);
        self.set("quiet", end - plain.last_crossing.max(file.settle));
        self.set("peak_mesh_force", plain.peak_mesh_force);
        self.set("peak_mesh_force_ratio", plain.peak_mesh_force / rated);
        self.set("effort", plain.effort);
        self.set("peak_torque", samples().map(|sample| sample.command.abs()).fold(0.0, f64::max));
        self.set("saturated", 100.0 * at_limit / count);
        if let Some(error) = reversal_error(file.settle, case, ran) {
            self.set("reversal_error", 1e3 * error);
        }
    }

    /// The loop of link angle over load torque, less what the motor gave way by.
    fn hysteresis(&mut self, file: &TestFile, case: &Case, ran: &Ran) {
        let ratio = case.told.geometry.ratio_by_teeth();
        let points = || {
            ran.run
                .samples
                .iter()
                .zip(&ran.truths)
                .filter(|(sample, _)| sample.time >= file.settle)
                .map(|(sample, truth)| (sample.transmitted_or(truth), sample.link - truth.motor / ratio))
        };
        let largest = points().map(|(torque, _)| torque.abs()).fold(0.0, f64::max);
        let near = |from: f64, to: f64| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (torque, angle) in points().filter(|(torque, _)| (from..to).contains(torque)) {
                sum += angle;
                count += 1.0;
                debug_assert!(torque.is_finite());
            }
            (count > 0.0).then_some(sum / count)
        };
        let share = 0.03 * case.truth.parameters.rated_output_torque;
        let band = 0.5 * share;
        if let (Some(high), Some(low)) = (near(share - band, share + band), near(-share - band, -share + band)) {
            self.set("loop_lost_motion", 1e3 * (high - low).abs());
        }
        if let (Some(high), Some(half)) = (near(0.9 * largest, largest), near(0.45 * largest, 0.55 * largest)) {
            self.set("loop_stiffness", 0.45 * largest / (high - half).abs());
        }
    }
}

/// Around a reversal the error is looked at for so long [s].
const AROUND: f64 = 0.06;

/// Mean over reversals of the largest error near each [rad].
fn reversal_error(settle: f64, case: &Case, ran: &Ran) -> Option<f64> {
    let samples = &ran.run.samples;
    let reach = (AROUND / ran.run.period).round() as usize;
    let mut before = 0.0;
    let mut largest = Vec::new();
    for (index, sample) in samples.iter().enumerate() {
        let speed = case.motion.at(sample.time).speed;
        if speed * before < 0.0 && sample.time >= settle {
            let around = &samples[index.saturating_sub(reach)..(index + reach).min(samples.len())];
            largest.push(around.iter().map(|s| (s.wanted - s.link).abs()).fold(0.0, f64::max));
        }
        if speed != 0.0 {
            before = speed;
        }
    }
    (!largest.is_empty()).then(|| largest.iter().sum::<f64>() / largest.len() as f64)
}

/// Torque through the teeth, felt at the link.
trait Transmitted {
    fn transmitted_or(&self, truth: &super::execution::Truth) -> f64;
}

impl Transmitted for host_tests::closed_loop::Sample {
    fn transmitted_or(&self, truth: &super::execution::Truth) -> f64 {
        // Without a compliance nothing is measured between carrier and link: the load stands for it.
        if self.transmitted == 0.0 { truth.load_torque } else { self.transmitted }
    }
}
