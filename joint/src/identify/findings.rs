//! What was found, each with its 95 % interval in the joint file's unit and the key that it belongs to, or the reason why
//! the log does not show it. Fitting is left to `twist` and `friction`, showing to `table` and `page`.

use serde::Serialize;

use super::estimate::Estimate;
use super::friction;
use super::log::Log;
use super::plan::Plan;
use super::regression::Solution;
use super::rows::{Row, Rows};
use super::twist::{self, Twist};

/// A value counts as found if half of its interval is at most this share of it...
const SHARE: f64 = 0.5;
/// ... or, for what may be zero, this share of the largest torque.
const SMALL: f64 = 0.02;
/// An error by angle counts as found if the log narrows it to this share of what is expected anyway.
const NARROWED: f64 = 0.1;
/// How well the motor's inertia in a joint file is usually known: what the scale of the torque rests on.
const INERTIA_SHARE: f64 = 0.015;
/// How well readings of motor and torque are taken at the same time [s]: a delay looks like damping.
const SAME_TIME: f64 = 2e-6;
/// Share of the largest torque that a balance of torques may feign as dry friction.
const BALANCE_SHARE: f64 = 0.0015;
/// Age of a reading that noise may feign [s].
const FEIGNED_AGE: f64 = 1e-7;
/// Samples of a swing from which its damping can be told.
const SWING_SAMPLES: f64 = 16.0;
/// What two inertias on a spring leave out of a joint, as a share of a value: widens every interval. Found on simulated
/// logs of the presets, where the scatter alone promised more than the reference keeps.
const MODEL_SHARE: f64 = 0.003;
/// Degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What it is.
    pub name: String,
    /// Unit of the numbers.
    pub unit: String,
    /// Key of the joint file that it belongs to.
    pub key: Option<String>,
    /// Best value; absent if the log does not show it.
    pub value: Option<f64>,
    /// Lower and upper end of the 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Why the log does not show it, or what to know about the value.
    pub note: String,
}

/// Everything that a log shows of a joint.
pub fn gather(log: &Log, quick: &Rows, slow: &Rows, twist: &Twist, plan: &Plan) -> Vec<Finding> {
    let mut findings = gap_and_compliance(log, twist, plan);
    findings.extend(frictions(quick, slow, twist, plan));
    findings.extend(maps(twist));
    let skew = Estimate::of(&twist.solution, twist::SKEW).wider_by(FEIGNED_AGE);
    let why = "the joint must turn at different speeds";
    let narrow = skew.half < 2.0 * NARROWED * twist::width(twist::SKEW);
    findings.push(
        finding("output encoder: age of a reading", "us", "drive_train.output_encoder.skew_us", skew.times(1e6))
            .if_so(narrow, why),
    );
    findings
}

fn finding(name: &str, unit: &str, key: &str, estimate: Estimate) -> Finding {
    let Estimate { value, half } = estimate;
    let half = half + MODEL_SHARE * value.abs();
    Finding {
        name: name.into(),
        unit: unit.into(),
        key: (!key.is_empty()).then(|| key.to_owned()),
        value: Some(value),
        interval: Some([value - half, value + half]),
        note: String::new(),
    }
}

impl Finding {
    /// Nothing, for a reason, unless it is so.
    fn if_so(self, so: bool, why: &str) -> Self {
        let finite = self.value.is_some_and(f64::is_finite)
            && self.interval.is_some_and(|ends| ends.iter().all(|end| end.is_finite()));
        if so && finite {
            return self;
        }
        Self { value: None, interval: None, note: format!("not identifiable from this log: {why}"), ..self }
    }

    fn noted(self, note: impl Into<String>) -> Self {
        if self.value.is_none() { self } else { Self { note: note.into(), ..self } }
    }

    /// What cannot be negative, and with it its interval.
    fn not_negative(mut self) -> Self {
        self.value = self.value.map(|value| value.max(0.0));
        self.interval = self.interval.map(|ends| ends.map(|end| end.max(0.0)));
        self
    }
}

fn gap_and_compliance(log: &Log, twist: &Twist, plan: &Plan) -> Vec<Finding> {
    let solution = &twist.solution;
    let half_gap = Estimate::of(solution, twist::HALF_GAP);
    let compliance = Estimate::of(solution, twist::COMPLIANCE);
    let rests_on_inertia = if log.output_torque.is_some() { 0.0 } else { INERTIA_SHARE };
    let compliance = compliance.wider_by(rests_on_inertia * compliance.value);
    let has_gap = half_gap.value > 0.0 && half_gap.half < SHARE * half_gap.value;
    let bends = compliance.value > 0.0 && compliance.half < SHARE * compliance.value;
    let why_gap =
        "both flanks must carry torques well above the friction, and the gap must be wider than what the encoders tell";
    let why_bends = "the torque on one flank must change by much, so that it bends the joint by several counts";
    let mut findings = vec![
        finding("half-backlash b", "um", "mesh.half_backlash_um", half_gap.times(1e6 * plan.lever))
            .if_so(has_gap, why_gap),
        finding("lost motion at the output", "mrad", "", half_gap.times(2e3)).if_so(has_gap, why_gap),
        finding("compliance at the output", "urad/(N m)", "", compliance.times(1e6)).if_so(bends, why_bends),
    ];
    // What the teeth give is known better from the joint file than from the small part that they have in it.
    let own = compliance.value - plan.mesh_compliance;
    let stiffness = if plan.compliant {
        let stiffness = Estimate { value: 1.0 / own, half: compliance.half / (own * own) };
        let bends = bends && own > 0.0 && compliance.half < SHARE * own;
        finding("stiffness behind the carrier", "N m/rad", "compliance.stiffness_N_m_per_rad", stiffness)
            .if_so(bends, why_bends)
    } else {
        let stiffness = plan.mesh_stiffness * plan.mesh_compliance / compliance.value;
        let estimate = Estimate { value: stiffness, half: stiffness * compliance.half / compliance.value };
        finding("mean stiffness of a mesh", "N/m", "mesh.mean_stiffness_N_per_m", estimate).if_so(bends, why_bends)
    };
    findings.push(stiffness);
    findings.push(damping(solution, plan, compliance, bends && plan.swing() > SWING_SAMPLES * log.period));
    findings
}

/// From the time by which the torque runs ahead of the twist to the ratio that the joint file states.
fn damping(solution: &Solution, plan: &Plan, compliance: Estimate, bends: bool) -> Finding {
    let relaxation = Estimate::of(solution, twist::RELAXATION).times(-1.0).wider_by(SAME_TIME);
    let own = compliance.value - plan.mesh_compliance;
    let (name, key, per_ratio) = if plan.compliant {
        // D = 2 zeta sqrt(J / c), on the part of the twist that is not the teeth's.
        let per_ratio =
            2.0 * (plan.swinging_inertia() / own.max(f64::MIN_POSITIVE)).sqrt() * own * own / compliance.value;
        ("damping ratio of the compliance", "compliance.damping_ratio", per_ratio)
    } else {
        ("damping ratio of the meshes", "mesh.damping_ratio", plan.mesh_relaxation_per_ratio)
    };
    let ratio = relaxation.times(1.0 / per_ratio);
    let known = bends && per_ratio > 0.0 && ratio.value > 0.0 && ratio.half < SHARE * ratio.value;
    finding(name, "-", key, ratio)
        .if_so(known, "flanks must land so hard that the joint rings, and samples must follow the ringing")
}

fn frictions(quick: &Rows, slow: &Rows, twist: &Twist, plan: &Plan) -> Vec<Finding> {
    let solution = &twist.solution;
    let measured = quick.all.iter().any(|row| row.measured.is_some());
    let small = SMALL * quick.greatest;
    let found = |estimate: Estimate, least: f64| estimate.half < (SHARE * estimate.value.abs()).max(least);
    let motor = if measured { friction::of_the_motor(quick, plan) } else { None };
    let compliance = solution.values[twist::COMPLIANCE];
    let motor_dry = match &motor {
        Some(balance) => Estimate::of(balance, friction::MOTOR_DRY),
        None => {
            let value = -solution.values[twist::MOTOR_FRICTION] / compliance;
            let slopes = [(twist::MOTOR_FRICTION, -1.0 / compliance), (twist::COMPLIANCE, -value / compliance)];
            Estimate::from(solution, value, &slopes).wider_by(INERTIA_SHARE * value)
        }
    };
    let excess = match &motor {
        Some(balance) => Estimate::of(balance, friction::TORQUE_ERROR),
        None => {
            let value = twist.torque_error();
            let slopes = [(twist::TORQUE_ERROR, 1.0 / compliance), (twist::COMPLIANCE, -value / compliance)];
            Estimate::from(solution, value, &slopes).wider_by(INERTIA_SHARE)
        }
    };
    let motor_known = found(motor_dry, small / plan.ratio());
    let why_motor = "the motor must turn both ways on each flank, and bend the joint by several counts as it does";
    let key = "drive_train.motor_coulomb_friction_N_m";
    let mut findings =
        vec![finding("dry friction of the motor", "N m", key, motor_dry).if_so(motor_known, why_motor).not_negative()];
    let narrower = excess.half < plan.torque_error;
    let key = "drive_train.torque_constant_error_ratio";
    let why = "flanks must land so hard that the motor's inertia shows";
    let share = finding("true torque over the logged one, less 1", "-", key, excess).if_so(narrower, why);
    findings.push(share.noted("by the inertia of the joint file"));
    if let Some(balance) = &motor {
        let viscous = Estimate::of(balance, friction::MOTOR_VISCOUS);
        let fastest = fastest(quick, |row| row.motor_speed);
        let key = "drive_train.motor_viscous_friction_N_m_s_per_rad";
        let known = found(viscous, small / plan.ratio() / fastest);
        findings.push(
            finding("viscous friction of the motor", "N m s/rad", key, viscous).if_so(known, why_motor).not_negative(),
        );
    }
    let why_link =
        "the output must move for a while, faster than its Stribeck speed, in both directions and at different speeds";
    let names = ["dry friction of the link", "viscous friction of the link"];
    let keys = ["drive_train.load_coulomb_friction_N_m", "drive_train.load_viscous_friction_N_m_s_per_rad"];
    let units = ["N m", "N m s/rad"];
    // Without its own finding the motor's friction is taken from the joint file.
    let (dry, note) = if measured || motor_known {
        (motor_dry, "")
    } else {
        (Estimate { value: plan.train.motor_coulomb_friction, half: 0.0 }, "if the motor's is as stated")
    };
    let balance = |excess: f64, dry: f64| friction::of_the_link(slow, plan, excess, dry);
    let Some(link) = balance(excess.value, dry.value) else {
        let nothing = Estimate { value: f64::NAN, half: f64::NAN };
        findings.extend(
            [0, 1].map(|place| finding(names[place], units[place], keys[place], nothing).if_so(false, why_link)),
        );
        return findings;
    };
    // How far what is still uncertain moves the balance is found by moving it.
    let moved = [balance(excess.value + excess.half, dry.value), balance(excess.value, dry.value + dry.half)];
    let of_link = |unknown: usize| {
        let shift = |moved: &Option<Solution>| {
            moved.as_ref().map_or(f64::NAN, |moved| moved.values[unknown] - link.values[unknown])
        };
        let estimate = Estimate::of(&link, unknown);
        Estimate { half: estimate.half.hypot(shift(&moved[0])).hypot(shift(&moved[1])), ..estimate }
    };
    let dry = of_link(friction::DRY).wider_by(BALANCE_SHARE * quick.greatest);
    let viscous = of_link(friction::VISCOUS);
    let viscous_known = found(viscous, small / fastest(slow, |row| row.output_speed));
    findings
        .push(finding(names[0], units[0], keys[0], dry).if_so(found(dry, small), why_link).not_negative().noted(note));
    let note = if measured { "" } else { "if the motor's is as stated" };
    findings
        .push(finding(names[1], units[1], keys[1], viscous).if_so(viscous_known, why_link).not_negative().noted(note));
    findings
}

fn fastest(rows: &Rows, speed: impl Fn(&Row) -> f64) -> f64 {
    rows.carrying().map(|row| speed(row).abs()).fold(0.0, f64::max)
}

/// Errors that come once and twice a turn of either encoder.
fn maps(twist: &Twist) -> Vec<Finding> {
    let solution = &twist.solution;
    let mut findings = Vec::new();
    for (encoder, first) in [("motor", twist::MOTOR_MAP), ("output", twist::OUTPUT_MAP)] {
        for (order, word) in [(0, "once"), (1, "twice")] {
            let [sine, cosine] = [first + 2 * order, first + 2 * order + 1];
            let (along, across) = (solution.values[sine], solution.values[cosine]);
            let amplitude = along.hypot(across);
            let [by_sine, by_cosine] = [along / amplitude, across / amplitude];
            let estimate = Estimate::from(solution, amplitude, &[(sine, by_sine), (cosine, by_cosine)]);
            let narrow = [sine, cosine].iter().all(|part| solution.deviation(*part) < NARROWED * twist::width(first));
            let phase = across.atan2(along) * DEGREES;
            let reach = (estimate.half / amplitude).min(std::f64::consts::PI) * DEGREES;
            let name = format!("{encoder} encoder: error {word} a turn");
            let key = format!("drive_train.{encoder}_encoder.{word}_per_turn_error_deg");
            let why = format!("the {encoder} must make a whole turn and more under torque");
            let note = format!("phase at count zero {phase:.1} deg, +- {reach:.1}");
            findings.push(
                finding(&name, "deg", &key, estimate.times(DEGREES)).if_so(narrow, &why).not_negative().noted(note),
            );
        }
    }
    findings
}
