//! Impedance mode where the flanks are not known: spring on the link and damper on the motor while the link's encoder is read,
//! otherwise both on the motor.

use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, Compensation, CompensationTables, ImpedancePoint, Position, Stage};
use model_core::observer::{Estimate, Estimates, OutputFault, Shaft, Source};

const STIFFNESS: f64 = 100.0;
const DAMPING: f64 = 4.0;
/// Set-point less link [turns].
const ERROR: f64 = 0.001;
/// Motor beyond the link, within half of the lost motion that Q1's file has [rad].
const LEAD: f64 = 0.001;
/// Speed of the motor shaft [rad/s].
const SPEED: f64 = 0.5;

fn tables() -> CompensationTables<f64> {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
    design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, 60.0)).expect("tables")
}

/// A joint that is seen, with a half-backlash that may be valid.
fn estimates(source: Source, half_backlash_valid: bool) -> Estimates<f64> {
    let known = |value, valid| Estimate { value, variance: 0.0, valid };
    Estimates {
        source,
        gap: known(0.0, true),
        contact_valid: true,
        half_backlash: known(60e-6, half_backlash_valid),
        half_backlash_usable: true,
        encoder_offset: known(0.0, true),
        motor_lead: LEAD,
        motor: Shaft { speed: SPEED, ..Shaft::default() },
        ..Estimates::default()
    }
}

/// Torque and stage of the first period [N m].
fn first(estimates: &Estimates<f64>) -> (f64, Stage) {
    let tables = tables();
    let point = ImpedancePoint {
        position: Position { turns: 0, fraction: ERROR },
        stiffness: STIFFNESS,
        damping: DAMPING,
        ..ImpedancePoint::default()
    };
    let shaped = Compensation::new(&tables).step(estimates, &Command::Impedance(point));
    (shaped.torque / tables.gear.link_per_motor, shaped.stage)
}

/// Torque of spring and damper at an error [rad] [N m].
fn law(error: f64) -> f64 {
    STIFFNESS * error - DAMPING * tables().gear.link_per_motor * SPEED
}

#[test]
fn spring_acts_on_the_link_while_it_is_seen() {
    let (torque, stage) = first(&estimates(Source::Both, false));
    assert_eq!(stage, Stage::Plain);
    assert!((torque - law(ERROR * core::f64::consts::TAU)).abs() < 1e-9, "{torque}");
}

#[test]
fn spring_acts_on_the_motor_without_the_link() {
    let (torque, stage) = first(&estimates(Source::MotorOnly(OutputFault::Silent), false));
    assert_eq!(stage, Stage::Plain);
    assert!((torque - law(ERROR * core::f64::consts::TAU - LEAD)).abs() < 1e-9, "{torque}");
}

#[test]
fn compensation_waits_for_the_flanks() {
    assert_eq!(first(&estimates(Source::Both, false)).1, Stage::Plain);
    assert_ne!(first(&estimates(Source::Both, true)).1, Stage::Plain);
}
