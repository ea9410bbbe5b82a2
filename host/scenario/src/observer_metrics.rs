//! Metrics of the observer: estimates against the truth. Metrics of the motion are in `values`.

use model_core::gears::Kinematics;
use model_core::virtual_joint::fault::{EncoderShaft, FaultKind};
use model_core::width_probe::ProbeProgress;

use super::case::Case;
use super::file::{Fault, TestFile, fault_is_active};
use super::run_history::{ObserverOutput, RunHistory, Validity};

/// Largest relative error of a width that counts as right [-].
const WIDTH_TOLERANCE: f64 = 0.05;
/// Error, over the gap or the half-backlash, above which a valid value counts as wrong [-].
const WRONG_ERROR: f64 = 0.2;
/// Band in which the side is not judged: distance from an edge over the gap, or force over the rated force [-].
const SIDE_BAND: f64 = 0.05;
/// Lowest speed of a moving link [rad/s].
const MOVING_SPEED: f64 = 1e-3;

/// Stems and values of all available figures.
pub fn values(file: &TestFile, case: &Case, history: &RunHistory) -> Vec<(&'static str, f64)> {
    let joint = &case.truth.parameters;
    let lever = joint.geometry.carrier_base_radius();
    let rated = joint.rated_output_torque;
    let mut sums = Sums::default();
    let mut landings = Landings::default();
    let (mut width_wrong_at, mut contact_then, mut contact) = (0.0, 0.0, 0.0);
    // Samples are taken at the end of a period, estimates at the start, so a sample belongs to the next period's
    // estimates.
    for ((sample, truth), observed) in
        history.run.samples.iter().zip(&history.truths).zip(history.observer_outputs.iter().skip(1))
    {
        let width = f64::from(observed.half_backlash) / truth.half_backlash - 1.0;
        let touching = sample.gap.abs() > 1.0 - SIDE_BAND;
        if touching && sample.link_speed.abs() > MOVING_SPEED {
            contact += history.run.period;
        }
        if width.is_nan() || width.abs() > WIDTH_TOLERANCE {
            (width_wrong_at, contact_then) = (sample.time, contact);
        }
        if sample.time < file.settle {
            continue;
        }
        let gap = 4.0 * truth.half_backlash;
        let error = f64::from(observed.gap) - truth.gap;
        sums.count += 1.0;
        sums.gap += (error / gap).powi(2);
        sums.worst = sums.worst.max((error / gap).abs());
        sums.load += ((f64::from(observed.load_torque) - truth.load_torque) / rated).powi(2);
        sums.mesh += ((f64::from(observed.mesh_torque) - 2.0 * lever * sample.mesh_force) / rated).powi(2);
        sums.trust += f64::from(observed.trust);
        sums.short += f64::from(u8::from(observed.short_of_torque));
        sums.stepped_back += f64::from(u8::from(observed.stepped_back));
        sums.reversed += f64::from(u8::from(observed.reversed));
        if observed.valid {
            sums.valid += 1.0;
            sums.gap_valid += (error / gap).powi(2);
            sums.nees += error * error / f64::from(observed.gap_variance).max(1e-30);
        }
        sums.shares.add(observed, (error / gap).abs() > WRONG_ERROR, width.is_nan() || width.abs() > WRONG_ERROR);
        // Rated force at the sun: rated torque over both levers of the carrier.
        let force = sample.mesh_force * 2.0 * lever / rated;
        let side = if force > 0.0 {
            1
        } else if force < 0.0 {
            -1
        } else {
            0
        };
        let clear = if side == 0 { sample.gap.abs() < 1.0 - 2.0 * SIDE_BAND } else { force.abs() > SIDE_BAND };
        if clear {
            sums.judged += 1.0;
            sums.right += f64::from(u8::from(side == observed.side));
        }
        landings.add(sample.time, if sample.gap.abs() > 1.0 { side } else { 0 }, observed.side);
    }
    let percent = |sum: f64, count: f64| 100.0 * (sum / count).sqrt();
    let mut list = vec![
        ("gap_error_rms", percent(sums.gap, sums.count)),
        ("gap_error_max", 100.0 * sums.worst),
        ("gap_valid", 100.0 * sums.valid / sums.count),
        ("gap_error_valid", percent(sums.gap_valid, sums.valid)),
        ("gap_surprise", sums.nees / sums.valid),
        ("side_right", 100.0 * sums.right / sums.judged),
        ("missed_landings", landings.missed as f64),
        ("load_torque_error", percent(sums.load, sums.count)),
        ("mesh_torque_error", percent(sums.mesh, sums.count)),
        ("width_right_after", width_wrong_at),
        ("width_right_after_contact", contact_then),
        ("compensated", 100.0 * sums.trust / sums.count),
        ("short_of_torque", 100.0 * sums.short / sums.count),
        ("stepped_back", 100.0 * sums.stepped_back / sums.count),
        ("torque_reversed", 100.0 * sums.reversed / sums.count),
    ];
    list.extend(sums.shares.percent(sums.count));
    list.extend(landings.delays());
    list.extend(final_errors(case, history));
    list.extend(fault_metrics(file, history));
    list.extend(probe_metrics(history));
    list
}

/// Result of the width probe, if a probe ended.
fn probe_metrics(history: &RunHistory) -> Vec<(&'static str, f64)> {
    let times = || history.run.samples.iter().zip(&history.observer_outputs);
    let ended = times().find(|(_, observed)| !matches!(observed.probed, None | Some(ProbeProgress::Running)));
    let (Some((sample, observed)), Some(truth)) = (ended, history.truths.last()) else { return Vec::new() };
    let first = times().find(|(sample, _)| sample.command != 0.0).map_or(sample.time, |(sample, _)| sample.time);
    let mut list = vec![("probe_time", 1e3 * (sample.time - first)), ("probe_refused", 1.0)];
    if let Some(ProbeProgress::Done(width)) = observed.probed {
        list[1].1 = 0.0;
        list.push(("probe_error", 100.0 * (f64::from(width.value) / truth.half_backlash - 1.0).abs()));
    }
    list
}

#[derive(Default)]
struct Sums {
    count: f64,
    gap: f64,
    worst: f64,
    load: f64,
    mesh: f64,
    trust: f64,
    short: f64,
    stepped_back: f64,
    reversed: f64,
    valid: f64,
    gap_valid: f64,
    nees: f64,
    judged: f64,
    right: f64,
    shares: Shares,
}

/// Names of [`Shares`], in order.
const SHARE_NAMES: [&str; 8] = [
    "gap_wrong",
    "width_wrong",
    "contact_valid",
    "width_valid",
    "load_torque_valid",
    "mesh_torque_valid",
    "compliance_valid",
    "skew_valid",
];

/// Numbers of periods with valid outputs, and with outputs that are valid but wrong.
#[derive(Default)]
struct Shares([usize; SHARE_NAMES.len()]);

impl Shares {
    fn add(&mut self, observed: &ObserverOutput, gap_wrong: bool, width_wrong: bool) {
        let Validity { contact, half_backlash, mesh_torque, load_torque, compliance, skew } = observed.validity;
        let now = [
            observed.valid && gap_wrong,
            half_backlash && width_wrong,
            contact,
            half_backlash,
            load_torque,
            mesh_torque,
            compliance,
            skew,
        ];
        self.0.iter_mut().zip(now).for_each(|(count, now)| *count += usize::from(now));
    }

    fn percent(&self, periods: f64) -> impl Iterator<Item = (&'static str, f64)> {
        SHARE_NAMES.into_iter().zip(self.0.map(|count| 100.0 * count as f64 / periods))
    }
}

/// Landings on the flank opposite to the last one, and their reports.
#[derive(Default)]
struct Landings {
    before: i8,
    open: Option<(f64, i8)>,
    delays: Vec<f64>,
    missed: usize,
}

impl Landings {
    fn add(&mut self, time: f64, side: i8, reported: i8) {
        if side != 0 && side != self.before {
            if self.before != 0 {
                self.missed += usize::from(self.open.is_some());
                self.open = Some((time, side));
            }
            self.before = side;
        }
        if let Some((since, side)) = self.open
            && reported == side
        {
            self.delays.push(time - since);
            self.open = None;
        }
    }

    fn delays(mut self) -> Vec<(&'static str, f64)> {
        self.delays.sort_by(f64::total_cmp);
        let part = |part: f64| self.delays.get((part * self.delays.len() as f64) as usize).copied();
        let (median, late) = (part(0.5), part(0.95));
        [("landing_delay_median", median), ("landing_delay_p95", late)]
            .into_iter()
            .filter_map(|(stem, delay)| Some((stem, 1e3 * delay?)))
            .collect()
    }
}

/// Errors of the estimated parameters at the end of the run.
fn final_errors(case: &Case, history: &RunHistory) -> Vec<(&'static str, f64)> {
    let (Some(observed), Some(truth)) = (history.observer_outputs.last(), history.truths.last()) else {
        return Vec::new();
    };
    let joint = &case.truth.parameters;
    let lever = joint.geometry.carrier_base_radius();
    // The meshes share the force; sun and ring mesh are in series, at twice the carrier's lever.
    let meshes = (1.0 / joint.sun_planet.mean_stiffness + 1.0 / joint.ring_planet.mean_stiffness)
        / (joint.geometry.planets as f64 * (2.0 * lever).powi(2));
    let compliance = meshes + joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness);
    let surroundings = &case.truth.surroundings;
    let skew = surroundings.output_encoder.skew - surroundings.motor_encoder.skew;
    vec![
        ("width_error", 100.0 * (f64::from(observed.half_backlash) / truth.half_backlash - 1.0).abs()),
        ("compliance_error", 100.0 * (f64::from(observed.compliance) / compliance - 1.0).abs()),
        ("skew_error", 1e6 * (f64::from(observed.skew) - skew).abs()),
    ]
}

/// Fallbacks of the observer to the motor encoder: delay after the first fault, and false alarms.
fn fault_metrics(file: &TestFile, history: &RunHistory) -> Vec<(&'static str, f64)> {
    let of_output = |fault: &&Fault| {
        matches!(
            fault.kind,
            FaultKind::Frozen(EncoderShaft::Link)
                | FaultKind::Offset(EncoderShaft::Link, _)
                | FaultKind::MissingCounts(EncoderShaft::Link, _)
                | FaultKind::LostReadings(EncoderShaft::Link, _)
        )
    };
    let first = file.faults.iter().filter(of_output).map(|fault| fault.start).fold(f64::INFINITY, f64::min);
    let (mut found, mut false_alarms, mut before) = (None, 0, false);
    for (sample, observed) in history.run.samples.iter().zip(&history.observer_outputs) {
        if before && !observed.both_encoders {
            if sample.time >= first {
                found = found.or(Some(sample.time - first));
            }
            let on = file.faults.iter().any(|fault| fault_is_active(fault, sample.time));
            false_alarms += usize::from(!on);
        }
        before = observed.both_encoders;
    }
    let mut list = vec![("false_alarms", false_alarms as f64)];
    if first.is_finite() {
        // A fault that is never found counts as later than any bound.
        let end = history.run.samples.last().map_or(0.0, |sample| sample.time);
        list.push(("fault_found", 1e3 * found.unwrap_or((end - first).max(0.0) + 1e3)));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_valid_outputs_count_as_wrong() {
        let valid = ObserverOutput {
            valid: true,
            validity: Validity { half_backlash: true, skew: true, ..Validity::default() },
            ..ObserverOutput::default()
        };
        let mut shares = Shares::default();
        shares.add(&valid, true, false);
        shares.add(&valid, true, true);
        shares.add(&ObserverOutput::default(), true, true);
        shares.add(&ObserverOutput::default(), false, false);
        let found: Vec<_> = shares.percent(4.0).filter(|(_, share)| *share > 0.0).collect();
        assert_eq!(found, [("gap_wrong", 50.0), ("width_wrong", 25.0), ("width_valid", 50.0), ("skew_valid", 50.0)]);
    }
}
