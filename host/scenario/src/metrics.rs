//! The metrics of a run, which test files call figures: name, unit, meaning, and how one relates to another
//! controller's. Their values are computed in `values` and `observer_metrics`.

use super::controller::ControllerName;

/// The kind of test that a metric needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Requirement {
    /// Any.
    Motion,
    /// One with impedance set-points.
    Impedance,
    /// One of observer and compensation.
    Observer,
    /// One of the width probe.
    Probe,
    /// A hysteresis loop.
    Loop,
}

/// One metric.
#[derive(Debug, PartialEq)]
pub struct Metric {
    /// Name without its unit.
    pub stem: &'static str,
    /// As it ends the name; empty for counts.
    pub unit: &'static str,
    /// What it needs.
    pub requires: Requirement,
    /// What it means.
    pub meaning: &'static str,
}

const fn metric(stem: &'static str, unit: &'static str, requires: Requirement, meaning: &'static str) -> Metric {
    Metric { stem, unit, requires, meaning }
}

use Requirement::{Impedance, Loop, Motion, Observer, Probe};

/// All metrics of a single run.
pub static METRICS: &[Metric] = &[
    metric("rms", "mrad", Motion, "link against wanted position, root mean square"),
    metric("peak", "mrad", Motion, "link against wanted position, largest"),
    metric("peak_to_peak", "mrad", Motion, "largest less smallest error of the link's position"),
    metric(
        "reversal_error",
        "mrad",
        Motion,
        "largest error within 60 ms of a reversal of the wanted speed, mean over reversals",
    ),
    metric("lost_motion", "ms", Motion, "from leaving one flank to touching the other, mean"),
    metric("longest_lost_motion", "ms", Motion, "the longest of them"),
    metric("crossings", "", Motion, "changes from one flank to the other"),
    metric("strikes", "", Motion, "landings on either flank after the teeth had left one by a fifth of the half-gap"),
    metric("last_crossing", "s", Motion, "time of the last of them; 0 without any"),
    metric("quiet", "s", Motion, "time from the last crossing to the end"),
    metric("peak_mesh_force", "N", Motion, "largest net force between the flanks at the motor's side"),
    metric("peak_mesh_force_ratio", "", Motion, "the same over what the rated torque takes"),
    metric("effort", "N_m", Motion, "motor torque asked for, root mean square"),
    metric("peak_torque", "N_m", Motion, "motor torque asked for, largest"),
    metric("saturated", "percent", Motion, "part of the time in which the motor's limit is reached"),
    metric("deviation_rms", "mrad", Impedance, "link against the same law on teeth without a gap, root mean square"),
    metric("deviation_peak", "mrad", Impedance, "the same, largest"),
    metric(
        "torque_error",
        "N_m",
        Impedance,
        "torque between carrier and link against the same law without a gap, root mean square",
    ),
    metric("gap_error_rms", "percent", Observer, "gap coordinate against the truth over the gap 4b, root mean square"),
    metric("gap_error_max", "percent", Observer, "the same, largest"),
    metric("gap_valid", "percent", Observer, "part of the time in which the gap coordinate is said to be valid"),
    metric("gap_error_valid", "percent", Observer, "its error while it is said to be valid, root mean square"),
    metric("gap_surprise", "", Observer, "mean squared error of a valid gap over its stated variance; 1 is honest"),
    metric(
        "gap_wrong",
        "percent",
        Observer,
        "part of the time in which the gap coordinate is said to be valid and is wrong by more than 20 % of the lost motion, the gap 4b",
    ),
    metric("contact_valid", "percent", Observer, "part of the time in which the contact side is said to be valid"),
    metric("width_valid", "percent", Observer, "part of the time in which the half-backlash is said to be valid"),
    metric(
        "width_wrong",
        "percent",
        Observer,
        "part of the time in which the half-backlash is said to be valid and is wrong by more than 20 %",
    ),
    metric("load_torque_valid", "percent", Observer, "part of the time in which the load torque is said to be valid"),
    metric(
        "mesh_torque_valid",
        "percent",
        Observer,
        "part of the time in which the transmitted torque is said to be valid",
    ),
    metric("compliance_valid", "percent", Observer, "part of the time in which the compliance is said to be valid"),
    metric("skew_valid", "percent", Observer, "part of the time in which the skew of the encoders is said to be valid"),
    metric("side_right", "percent", Observer, "part of the time with the right contact side, outside a band of 5 %"),
    metric("missed_landings", "", Observer, "landings on a flank that were never reported"),
    metric("landing_delay_median", "ms", Observer, "from a landing to its report, median"),
    metric("landing_delay_p95", "ms", Observer, "the same, 95th percentile"),
    metric(
        "load_torque_error",
        "percent",
        Observer,
        "load torque against the truth over the rated torque, root mean square",
    ),
    metric("mesh_torque_error", "percent", Observer, "transmitted torque likewise"),
    metric("width_error", "percent", Observer, "learnt half-backlash at the end against the truth"),
    metric("width_right_after", "s", Observer, "from when on the width is right to 5 % for good"),
    metric("width_right_after_contact", "s", Observer, "the same in seconds of motion with a flank touching"),
    metric("compliance_error", "percent", Observer, "learnt compliance at the end against the truth, meshes included"),
    metric("skew_error", "us", Observer, "learnt skew of the encoders at the end against the truth"),
    metric(
        "fault_found",
        "ms",
        Observer,
        "from the first fault of the output encoder (frozen, offset, missing counts, lost frames) to the observer's falling back to the motor encoder; a thousand seconds if never",
    ),
    metric("false_alarms", "", Observer, "falls back to the motor encoder while no fault was on"),
    metric("compensated", "percent", Observer, "mean share of the compensation in the torque"),
    metric(
        "short_of_torque",
        "percent",
        Observer,
        "time in which the law asks for more torque than there is, or brakes early because of that",
    ),
    metric("stepped_back", "percent", Observer, "time in which the motor alone is controlled because the loop hunted"),
    metric("torque_reversed", "percent", Observer, "time after the motor ran against its torque, which was taken away"),
    metric("probe_error", "percent", Probe, "half-backlash that the width probe found against the truth"),
    metric("probe_time", "ms", Probe, "from the first torque of the width probe to its result"),
    metric("probe_refused", "", Probe, "1 if the width probe refused to say a width, 0 if it said one"),
    metric("loop_lost_motion", "mrad", Loop, "opening of the hysteresis loop at 3 % of the rated torque"),
    metric("loop_stiffness", "N_m_per_rad", Loop, "slope of the loop between half and full torque"),
];

/// A metric of the controller's run, or one relative to another controller's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedMetric {
    index: usize,
    /// Of itself or against whom.
    pub relation: Relation,
}

/// How a metric relates to runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// The controller's own.
    Own,
    /// The other's over the controller's: above 1 is better.
    GainOver(ControllerName),
    /// The controller's over the other's: below 1 is better.
    RatioTo(ControllerName),
    /// The other's own.
    Of(ControllerName),
}

impl Metric {
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
pub fn others(impedance: bool) -> Vec<(&'static str, ControllerName)> {
    let own = ControllerName::ALL.into_iter().filter(|name| !name.is_compensation() && name.wants_gains() == impedance);
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
    let mut names: Vec<String> = METRICS.iter().map(Metric::name).collect();
    for metric in METRICS.iter().filter(|metric| matches!(metric.requires, Motion | Impedance)) {
        for (other, _) in others(impedance) {
            names.push(format!("{}_gain_over_{other}", metric.stem));
            names.push(format!("{}_ratio_to_{other}", metric.stem));
            names.push(format!("{}_of_{other}", metric.name()));
        }
    }
    names
}

impl NamedMetric {
    /// The figure of a name, in a test with or without impedance set-points.
    pub fn find(name: &str, impedance: bool) -> Option<Self> {
        if let Some(index) = METRICS.iter().position(|metric| metric.name() == name) {
            return Some(Self { index, relation: Relation::Own });
        }
        let of_motion = |metric: &Metric| matches!(metric.requires, Motion | Impedance);
        if let Some((own, other)) = name.rsplit_once("_of_")
            && let Some((_, other)) = others(impedance).into_iter().find(|(word, _)| *word == other)
        {
            let index = METRICS.iter().position(|metric| metric.name() == own && of_motion(metric))?;
            return Some(Self { index, relation: Relation::Of(other) });
        }
        let (stem, other, gain) = match (name.split_once("_gain_over_"), name.split_once("_ratio_to_")) {
            (Some((stem, other)), _) => (stem, other, true),
            (None, Some((stem, other))) => (stem, other, false),
            (None, None) => return None,
        };
        let index = METRICS.iter().position(|metric| metric.stem == stem && of_motion(metric))?;
        let (_, other) = others(impedance).into_iter().find(|(word, _)| *word == other)?;
        let relation = if gain { Relation::GainOver(other) } else { Relation::RatioTo(other) };
        Some(Self { index, relation })
    }

    /// The figure that it rests on.
    pub fn base(&self) -> &'static Metric {
        &METRICS[self.index]
    }

    /// The place of that figure among all.
    pub fn place(&self) -> usize {
        self.index
    }
}
