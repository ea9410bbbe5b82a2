//! Findings of the friction of motor and link, and of the torque scale, on which both depend. `friction` fits the
//! torque balances.

use super::finding::{FOUND_INTERVAL_SHARE, Finding, finding};
use crate::estimate::Estimate;
use crate::friction::{self, MotorSide};
use crate::prior::PriorModel;
use crate::regression::Solution;
use crate::rows::{Row, Rows};
use crate::scales::ScaleUncertainty;
use crate::twist;
use crate::twist::Twist;

/// A friction, possibly zero, counts as found if half of its interval is at most this share of the largest torque.
const ZERO_FRICTION_SHARE: f64 = 0.02;
/// Dry friction that a torque balance may mimic, as a share of the largest torque.
const MIMICKED_FRICTION: f64 = 0.0015;

/// Dry friction of the motor that teeth and compliance may mimic, as a share of the largest torque.
const MIMICKED_MOTOR_FRICTION: f64 = 2e-4;

/// Reason for a missing motor friction if planets do not touch at once.
const OUT_OF_PHASE: &str = "planets mesh out of phase, and errors of the teeth bend the joint as friction does; log the torque at the \
                            output";

/// Frictions of motor and link.
pub(super) fn frictions(
    [quick, slow]: [&Rows; 2],
    twist: &Twist,
    prior: &PriorModel,
    uncertainty: Option<&ScaleUncertainty>,
) -> Vec<Finding> {
    let solution = &twist.solution;
    let measured = quick.all.iter().any(|row| row.measured.is_some());
    let small = ZERO_FRICTION_SHARE * quick.largest_torque;
    let found =
        |estimate: Estimate, least: f64| estimate.half < (FOUND_INTERVAL_SHARE * estimate.value.abs()).max(least);
    let motor = if measured { friction::fit_motor(quick, prior) } else { None };
    let compliance = solution.values[twist::COMPLIANCE];
    let of_torque = uncertainty.map_or(0.0, |uncertainty| uncertainty.scales.torque.half());
    let of_rates = uncertainty.map_or(0.0, |uncertainty| uncertainty.scales.rate_error);
    let mimicked = MIMICKED_MOTOR_FRICTION * quick.largest_torque / prior.ratio();
    let motor_dry = match &motor {
        Some(balance) => {
            let dry = Estimate::of_unknown(balance, friction::MOTOR_DRY);
            dry.with_independent_error(of_torque * dry.value)
        }
        None => {
            let value = -solution.values[twist::MOTOR_FRICTION] / compliance;
            let slopes = [(twist::MOTOR_FRICTION, -1.0 / compliance), (twist::COMPLIANCE, -value / compliance)];
            Estimate::of_function(solution, value, &slopes)
                .with_independent_error(of_torque * value)
                .widened_by(mimicked)
        }
    };
    let excess = match (&motor, uncertainty) {
        (Some(balance), _) => {
            let excess = Estimate::of_unknown(balance, friction::MOTOR_TORQUE_ERROR);
            excess.with_independent_error(of_torque * (1.0 + excess.value))
        }
        (None, Some(uncertainty)) => Estimate { value: uncertainty.scales.torque.factor() - 1.0, half: of_torque },
        (None, None) => Estimate { value: f64::NAN, half: f64::NAN },
    };
    let motor_known = found(motor_dry, small / prior.ratio());
    let why_motor = "the motor must turn both ways on each flank, and bend the joint by several counts as it does";
    let key = "drive_train.motor_coulomb_friction_N_m";
    let motor_dry_found = finding("dry friction of the motor", "N m", key, motor_dry)
        .only_if(motor_known, why_motor)
        .only_if(measured || prior.sharing.is_none(), OUT_OF_PHASE);
    let mut findings = vec![motor_dry_found.not_negative()];
    let narrower = excess.half < prior.torque_error;
    let key = "drive_train.torque_constant_error_ratio";
    let why = "the flanks must land hard enough for the motor's inertia to have an effect";
    let share = finding("true torque over the logged one, less 1", "-", key, excess).only_if(narrower, why);
    findings.push(share.with_note("by the inertias of the joint file"));
    if let Some(balance) = &motor {
        let viscous = Estimate::of_unknown(balance, friction::MOTOR_VISCOUS);
        let viscous = viscous.with_independent_error(of_torque * viscous.value).widened_by(of_rates * viscous.value);
        let fastest = fastest(quick, |row| row.motor_speed);
        let key = "drive_train.motor_viscous_friction_N_m_s_per_rad";
        let known = found(viscous, small / prior.ratio() / fastest);
        findings.push(
            finding("viscous friction of the motor", "N m s/rad", key, viscous)
                .only_if(known, why_motor)
                .not_negative(),
        );
    }
    let why_link =
        "the output must move for a while, faster than its Stribeck speed, in both directions and at different speeds";
    let names = ["dry friction of the link", "viscous friction of the link"];
    let keys = ["drive_train.load_coulomb_friction_N_m", "drive_train.load_viscous_friction_N_m_s_per_rad"];
    let units = ["N m", "N m s/rad"];
    // Without a finding, the motor's friction is the joint file's.
    let motor_known = motor_known && (measured || prior.sharing.is_none());
    let (dry, note) = if measured || motor_known {
        (motor_dry, "")
    } else {
        (Estimate { value: prior.surroundings.motor_friction.coulomb, half: 0.0 }, "if the motor's is as stated")
    };
    let delay =
        if measured { Estimate { value: 0.0, half: 0.0 } } else { Estimate::of_unknown(solution, twist::DELAY) };
    let loss = match measured {
        true => Estimate { value: 0.0, half: 0.0 },
        false => Estimate::of_unknown(solution, twist::LOSS).scaled(-1.0 / compliance),
    };
    let as_found = MotorSide { torque_error: 0.0, dry: dry.value, delay: delay.value, loss: loss.value };
    let balance = |motor: MotorSide| friction::fit_link(slow, prior, motor);
    let Some(link) = balance(as_found) else {
        let nothing = Estimate { value: f64::NAN, half: f64::NAN };
        findings.extend(
            [0, 1].map(|place| finding(names[place], units[place], keys[place], nothing).only_if(false, why_link)),
        );
        return findings;
    };
    // The effect of each uncertainty is found by repeating the balance with the changed value.
    let by_torque = balance(MotorSide { torque_error: of_torque, ..as_found });
    let by_delay = balance(MotorSide { delay: delay.value + delay.half, ..as_found });
    let by_dry = balance(MotorSide { dry: dry.value + dry.half, ..as_found });
    let by_loss = balance(MotorSide { loss: loss.value + loss.half, ..as_found });
    let of_link = |unknown: usize| {
        let shift = |moved: &Option<Solution>| {
            moved.as_ref().map_or(f64::NAN, |moved| moved.values[unknown] - link.values[unknown])
        };
        let per = |moved: &Option<Solution>, half: f64| if half > 0.0 { shift(moved) / half } else { 0.0 };
        // Motor friction and losses come from one fit with negatively correlated errors.
        let (per_dry, per_loss) = (per(&by_dry, dry.half), per(&by_loss, loss.half));
        let value = per_dry * dry.value + per_loss * loss.value;
        let slopes = [
            (twist::MOTOR_FRICTION, -per_dry / compliance),
            (twist::LOSS, -per_loss / compliance),
            (twist::COMPLIANCE, -value / compliance),
        ];
        let together = if measured { 0.0 } else { Estimate::of_function(solution, value, &slopes).half };
        Estimate::of_unknown(&link, unknown)
            .with_independent_error(shift(&by_torque))
            .with_independent_error(shift(&by_delay))
            .with_independent_error(together)
            .with_independent_error(per_dry * of_torque * dry.value)
            .widened_by(per_dry * mimicked)
    };
    let dry = of_link(friction::LINK_DRY).widened_by(MIMICKED_FRICTION * quick.largest_torque);
    let viscous = of_link(friction::LINK_VISCOUS);
    let viscous = viscous.widened_by(of_rates * viscous.value);
    let viscous_known = found(viscous, small / fastest(slow, |row| row.output_speed));
    findings.push(
        finding(names[0], units[0], keys[0], dry).only_if(found(dry, small), why_link).not_negative().with_note(note),
    );
    let note = if measured { "" } else { "if the motor's is as stated" };
    findings.push(
        finding(names[1], units[1], keys[1], viscous).only_if(viscous_known, why_link).not_negative().with_note(note),
    );
    findings
}

fn fastest(rows: &Rows, speed: impl Fn(&Row) -> f64) -> f64 {
    rows.carrying().map(|row| speed(row).abs()).fold(0.0, f64::max)
}
