//! Metrics of a run, called figures in test files: name, unit, meaning, and relation to another controller's metric.
//! `values` and `observer_metrics` compute the values.

use super::controller::ControllerName;

/// Kind of test that a metric requires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Requirement {
    /// Any test.
    Motion,
    /// A test with impedance set-points.
    Impedance,
    /// A test of observer and compensation.
    Observer,
    /// A test of the width probe.
    Probe,
    /// A hysteresis loop.
    Loop,
}

/// One metric.
#[derive(Debug, PartialEq)]
pub struct Metric {
    /// Name without the unit.
    pub stem: &'static str,
    /// Unit as the suffix of the name; empty for counts.
    pub unit: &'static str,
    /// Kind of test that the metric requires.
    pub requires: Requirement,
    /// Meaning.
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
    metric("lost_motion", "ms", Motion, "time from leaving one flank to touching the other, mean"),
    metric("longest_lost_motion", "ms", Motion, "longest time from leaving one flank to touching the other"),
    metric("crossings", "", Motion, "changes from one flank to the other"),
    metric("strikes", "", Motion, "landings on either flank after the teeth had left one by a fifth of the half-gap"),
    metric("last_crossing", "s", Motion, "time of the last crossing; 0 without a crossing"),
    metric("quiet", "s", Motion, "time from the last crossing to the end"),
    metric("peak_mesh_force", "N", Motion, "largest net force between the flanks at the motor's side"),
    metric("peak_mesh_force_ratio", "", Motion, "peak mesh force over the mesh force at the rated torque"),
    metric("effort", "N_m", Motion, "commanded motor torque, root mean square"),
    metric("peak_torque", "N_m", Motion, "commanded motor torque, largest"),
    metric("saturated", "percent", Motion, "share of the time at the torque limit of the motor"),
    metric(
        "deviation_rms",
        "mrad",
        Impedance,
        "link against the impedance law on teeth without a gap, root mean square",
    ),
    metric("deviation_peak", "mrad", Impedance, "link against the impedance law on teeth without a gap, largest"),
    metric(
        "torque_error",
        "N_m",
        Impedance,
        "torque between carrier and link against the impedance law without a gap, root mean square",
    ),
    metric("gap_error_rms", "percent", Observer, "error of the gap coordinate over the gap 4b, root mean square"),
    metric("gap_error_max", "percent", Observer, "error of the gap coordinate over the gap 4b, largest"),
    metric("gap_valid", "percent", Observer, "share of the time with a valid gap coordinate"),
    metric(
        "gap_error_valid",
        "percent",
        Observer,
        "error of the valid gap coordinate over the gap 4b, root mean square",
    ),
    metric(
        "gap_surprise",
        "",
        Observer,
        "mean squared error of the valid gap coordinate over its published variance; 1 is consistent",
    ),
    metric(
        "gap_wrong",
        "percent",
        Observer,
        "share of the time with a valid gap coordinate that is wrong by more than 20 % of the gap 4b",
    ),
    metric("contact_valid", "percent", Observer, "share of the time with a valid contact side"),
    metric("width_valid", "percent", Observer, "share of the time with a valid half-backlash"),
    metric(
        "width_wrong",
        "percent",
        Observer,
        "share of the time with a valid half-backlash that is wrong by more than 20 %",
    ),
    metric("load_torque_valid", "percent", Observer, "share of the time with a valid load torque"),
    metric("mesh_torque_valid", "percent", Observer, "share of the time with a valid transmitted torque"),
    metric("compliance_valid", "percent", Observer, "share of the time with a valid compliance"),
    metric("skew_valid", "percent", Observer, "share of the time with a valid skew of the encoders"),
    metric("side_right", "percent", Observer, "share of the time with the right contact side, outside a band of 5 %"),
    metric("missed_landings", "", Observer, "landings on a flank that the observer never reported"),
    metric("landing_delay_median", "ms", Observer, "time from a landing to its report, median"),
    metric("landing_delay_p95", "ms", Observer, "time from a landing to its report, 95th percentile"),
    metric(
        "load_torque_error",
        "percent",
        Observer,
        "error of the load torque over the rated torque, root mean square",
    ),
    metric(
        "mesh_torque_error",
        "percent",
        Observer,
        "error of the transmitted torque over the rated torque, root mean square",
    ),
    metric("width_error", "percent", Observer, "error of the estimated half-backlash at the end"),
    metric("width_right_after", "s", Observer, "time from which on the estimated half-backlash stays right to 5 %"),
    metric(
        "width_right_after_contact",
        "s",
        Observer,
        "time in motion with a flank in contact until the estimated half-backlash stays right to 5 %",
    ),
    metric("compliance_error", "percent", Observer, "error of the estimated compliance at the end, meshes included"),
    metric("skew_error", "us", Observer, "error of the estimated skew of the encoders at the end"),
    metric(
        "fault_found",
        "ms",
        Observer,
        "time from the first fault of the output encoder (frozen, offset, missing counts, lost frames) to the observer's fallback to the motor encoder; 1000 s if never",
    ),
    metric("false_alarms", "", Observer, "fallbacks to the motor encoder while no fault was active"),
    metric("compensated", "percent", Observer, "mean share of the compensation in the torque"),
    metric(
        "short_of_torque",
        "percent",
        Observer,
        "share of the time in which the law demands more torque than the limit, or brakes early because of the limit",
    ),
    metric("stepped_back", "percent", Observer, "share of the time under motor-side control after the loop hunted"),
    metric(
        "torque_reversed",
        "percent",
        Observer,
        "share of the time without torque after the motor ran against its torque",
    ),
    metric("probe_error", "percent", Probe, "error of the half-backlash that the width probe found"),
    metric("probe_time", "ms", Probe, "time from the first torque of the width probe to its result"),
    metric("probe_refused", "", Probe, "1 if the width probe refused to publish a width, else 0"),
    metric("loop_lost_motion", "mrad", Loop, "opening of the hysteresis loop at 3 % of the rated torque"),
    metric("loop_stiffness", "N_m_per_rad", Loop, "slope of the loop between half and full torque"),
];

/// A metric of the controller's run, or one relative to another controller's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedMetric {
    index: usize,
    /// Relation to another controller's metric.
    pub relation: Relation,
}

/// Relation of a metric to runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Metric of the tested controller.
    Own,
    /// Other controller's metric over the tested one's: above 1 is better.
    GainOver(ControllerName),
    /// Tested controller's metric over the other's: below 1 is better.
    RatioTo(ControllerName),
    /// Metric of the other controller.
    Of(ControllerName),
}

impl Metric {
    /// Name with the unit.
    pub fn name(&self) -> String {
        if self.unit.is_empty() { self.stem.to_owned() } else { format!("{}_{}", self.stem, self.unit) }
    }

    /// Unit as printed.
    pub fn printed_unit(&self) -> &'static str {
        match self.unit {
            "percent" => "%",
            "N_m" => "N m",
            "N_m_per_rad" => "N m/rad",
            unit => unit,
        }
    }
}

/// Names that may follow `over` or `to` in a test, with their controllers.
pub fn rival_names(impedance: bool) -> Vec<(&'static str, ControllerName)> {
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

/// All names that a test may assert.
pub fn assertable_names(impedance: bool) -> Vec<String> {
    let mut names: Vec<String> = METRICS.iter().map(Metric::name).collect();
    for metric in METRICS.iter().filter(|metric| matches!(metric.requires, Motion | Impedance)) {
        for (other, _) in rival_names(impedance) {
            names.push(format!("{}_gain_over_{other}", metric.stem));
            names.push(format!("{}_ratio_to_{other}", metric.stem));
            names.push(format!("{}_of_{other}", metric.name()));
        }
    }
    names
}

impl NamedMetric {
    /// Metric of a name, in a test with or without impedance set-points.
    pub fn find(name: &str, impedance: bool) -> Option<Self> {
        if let Some(index) = METRICS.iter().position(|metric| metric.name() == name) {
            return Some(Self { index, relation: Relation::Own });
        }
        let of_motion = |metric: &Metric| matches!(metric.requires, Motion | Impedance);
        if let Some((own, other)) = name.rsplit_once("_of_")
            && let Some((_, other)) = rival_names(impedance).into_iter().find(|(word, _)| *word == other)
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
        let (_, other) = rival_names(impedance).into_iter().find(|(word, _)| *word == other)?;
        let relation = if gain { Relation::GainOver(other) } else { Relation::RatioTo(other) };
        Some(Self { index, relation })
    }

    /// Metric of a single run that the relation is based on.
    pub fn base(&self) -> &'static Metric {
        &METRICS[self.index]
    }

    /// Index of the base metric.
    pub fn index(&self) -> usize {
        self.index
    }
}
