//! Named figures: what each is called, in which unit, what it means, and how one relates to another controller's. Their
//! values are made in `values` and `sight`.

use super::controller::ControllerName;

/// What kind of test a figure needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Any.
    Motion,
    /// One with impedance set-points.
    Impedance,
    /// One of observer and compensation.
    Sight,
    /// One of the width probe.
    Probe,
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

use About::{Impedance, Loop, Motion, Probe, Sight};

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
    figure("probe_error", "percent", Probe, "half-backlash that the width probe found against the truth"),
    figure("probe_time", "ms", Probe, "from the first torque of the width probe to its result"),
    figure("probe_refused", "", Probe, "1 if the width probe refused to say a width, 0 if it said one"),
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
pub fn others(impedance: bool) -> Vec<(&'static str, ControllerName)> {
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

    /// The place of that figure among all.
    pub fn place(&self) -> usize {
        self.index
    }
}
