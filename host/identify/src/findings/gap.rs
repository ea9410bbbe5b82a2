//! Findings of gap, compliance and damping.

use super::finding::{CONFOUNDED, FOUND_INTERVAL_SHARE, Finding, finding};
use super::quantisation;
use crate::estimate::Estimate;
use crate::log::Log;
use crate::prior::PriorModel;
use crate::regression::Solution;
use crate::rows::Rows;
use crate::sampling::DAMPING_SAMPLES_PER_SWING;
use crate::scales::ScaleUncertainty;
use crate::twist;
use crate::twist::Twist;

/// Largest time between the readings of motor and torque [s]; a delay looks like damping.
const READING_SKEW_MAX: f64 = 2e-6;

/// Relative change of the damping by planets that land one after the other.
const SHARING_DAMPING_SHARE: f64 = 0.35;

/// Gap, compliance and damping.
pub(super) fn gap_and_compliance(
    log: &Log,
    rows: &Rows,
    twist: &Twist,
    prior: &PriorModel,
    uncertainty: Option<&ScaleUncertainty>,
) -> Vec<Finding> {
    let solution = &twist.solution;
    let half_gap = Estimate::of_unknown(solution, twist::HALF_GAP);
    let compliance = Estimate::of_unknown(solution, twist::COMPLIANCE);
    let open = uncertainty
        .map_or(0.0, |uncertainty| uncertainty.scales.torque.half().hypot(uncertainty.compliance_by_inertia));
    let compliance = compliance
        .with_independent_error(open * compliance.value)
        .with_independent_error(quantisation::twist(prior) / rows.largest_torque);
    let has_gap = half_gap.value > 0.0 && half_gap.half < FOUND_INTERVAL_SHARE * half_gap.value;
    let bends = compliance.value > 0.0 && compliance.half < FOUND_INTERVAL_SHARE * compliance.value;
    let or_together = |unknown: usize, why| if solution.is_separated(unknown) { why } else { CONFOUNDED };
    let why_gap = "both flanks must carry torques well above the friction, and the gap must be wider than the \
             resolution of the encoders";
    let why_bends = "the torque on one flank must change enough to bend the joint by several counts";
    let why_gap = or_together(twist::HALF_GAP, why_gap);
    let why_bends = or_together(twist::COMPLIANCE, why_bends);
    let width = Shown { why: why_gap, is_shown: has_gap };
    let bend = Shown { why: why_bends, is_shown: bends };
    let mut findings = static_findings(prior, [half_gap, twist.half_lost_motion(prior), compliance], [width, bend]);
    findings.push(damping(
        solution,
        prior,
        compliance,
        bends && prior.swing_period() > DAMPING_SAMPLES_PER_SWING * log.period,
    ));
    findings
}

/// Visibility of a parameter in a log, with the reason if the log does not show the parameter.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'w> {
    pub is_shown: bool,
    pub why: &'w str,
}

/// Half-gap and half lost motion [rad], and compliance [rad/(N m)], at the output, by the keys of the joint file.
pub(crate) fn static_findings(
    prior: &PriorModel,
    [half_gap, half_lost_motion, compliance]: [Estimate; 3],
    [width, bend]: [Shown<'_>; 2],
) -> Vec<Finding> {
    let mut findings = Vec::new();
    if !prior.equivalent {
        let half_backlash = half_gap.scaled(1e6 * prior.lever);
        let found = finding("half-backlash b", "um", "mesh.half_backlash_um", half_backlash);
        findings.push(found.only_if(width.is_shown, width.why));
    }
    let lost_motion_key = if prior.equivalent { "equivalent_gear.lost_motion_mrad" } else { "" };
    findings.extend([
        finding("lost motion at the output", "mrad", lost_motion_key, half_lost_motion.scaled(2e3))
            .only_if(width.is_shown, width.why),
        finding("compliance at the output", "urad/(N m)", "", compliance.scaled(1e6)).only_if(bend.is_shown, bend.why),
    ]);
    // The joint file knows the compliance of the teeth better than the log, in which it is a small part.
    let own = compliance.value - prior.mesh_compliance;
    let Shown { is_shown: bends, why } = bend;
    findings.push(if prior.compliant {
        let stiffness = Estimate { value: 1.0 / own, half: compliance.half / (own * own) };
        let bends = bends && own > 0.0 && compliance.half < FOUND_INTERVAL_SHARE * own;
        finding("stiffness behind the carrier", "N m/rad", "compliance.stiffness_N_m_per_rad", stiffness)
            .only_if(bends, why)
    } else if prior.equivalent {
        let stiffness = compliance.value.recip();
        let estimate = Estimate { value: stiffness, half: stiffness * compliance.half / compliance.value };
        finding("stiffness at the output", "N m/rad", "equivalent_gear.stiffness_N_m_per_rad", estimate)
            .only_if(bends, why)
    } else {
        let stiffness = prior.mesh_stiffness * prior.mesh_compliance / compliance.value;
        let estimate = Estimate { value: stiffness, half: stiffness * compliance.half / compliance.value };
        finding("mean stiffness of a mesh", "N/m", "mesh.mean_stiffness_N_per_m", estimate).only_if(bends, why)
    });
    findings
}

/// Damping ratio of the joint file, from the time by which the torque leads the twist.
fn damping(solution: &Solution, prior: &PriorModel, compliance: Estimate, bends: bool) -> Finding {
    // A motor reading older than the output's may be older than the torque as well.
    let lead = -solution.values[twist::SKEW];
    let relaxation =
        Estimate::of_unknown(solution, twist::RELAXATION).scaled(-1.0).widened_by(READING_SKEW_MAX.max(lead));
    let own = compliance.value - prior.mesh_compliance;
    let (name, key, per_ratio) = if prior.compliant {
        // D = 2 zeta sqrt(J / c), on the twist beyond the teeth's.
        let per_ratio =
            2.0 * (prior.swinging_inertia() / own.max(f64::MIN_POSITIVE)).sqrt() * own * own / compliance.value;
        ("damping ratio of the compliance", "compliance.damping_ratio", per_ratio)
    } else if prior.equivalent {
        // D / K = 2 zeta sqrt(J c).
        let per_ratio = 2.0 * (prior.swinging_inertia() * compliance.value.max(0.0)).sqrt();
        ("damping ratio of the gear", "equivalent_gear.damping_ratio", per_ratio)
    } else {
        ("damping ratio of the meshes", "mesh.damping_ratio", prior.mesh_relaxation_per_ratio)
    };
    let mut ratio = relaxation.scaled(1.0 / per_ratio);
    if prior.sharing.is_some() {
        ratio = ratio.with_independent_error(SHARING_DAMPING_SHARE * ratio.value);
    }
    let known = ratio.value < 1.0
        && bends
        && per_ratio > 0.0
        && ratio.value > 0.0
        && ratio.half < FOUND_INTERVAL_SHARE * ratio.value;
    finding(name, "-", key, ratio).only_if(
        known,
        "the flanks must land hard enough for the joint to ring, and the samples must resolve the ringing",
    )
}
