//! The motion of case R in windows: errors of the board's step, as designed for 10 kHz and in f32, against the reference.

use comparison::case::Case;
use comparison::curve::{PhaseEnvelope, Scalar};
use comparison::method::Method;
use comparison::run::AS_DESIGNED;
use comparison::trajectory::Errors;
use host_tests::tolerance::light_planets::{ROBOT_LINK_RMS, ROBOT_LINK_WORST, ROBOT_PEAK_FORCE};
use reference::scenarios::case_r;
use reference::scenarios::case_r::{CaseR, TICK_RATE};

use crate::variants::joint;

/// Errors over a motion with all mesh phases advanced by a number of periods.
pub fn errors(motion: CaseR, shift: f64) -> Errors {
    let case = Case::from_robot_joint("R", "what a robot joint does", motion).shifted(shift);
    let envelope = PhaseEnvelope::new(case, 1).expect("the reference follows");
    let point = envelope.point(Method::Realtime, Scalar::Single, TICK_RATE, AS_DESIGNED).expect("a sound joint");
    println!("{:?}", point.errors);
    point.errors
}

fn check(errors: &Errors) {
    ROBOT_LINK_RMS.check(errors.link_rms);
    ROBOT_LINK_WORST.check(errors.link_worst);
    ROBOT_PEAK_FORCE.check(errors.peak_force);
}

/// Output angle and peak mesh force follow the reference in every window, on the short form.
#[test]
fn short_form_follows_reference() {
    check(&errors(case_r::brief(joint()), 0.0));
}

/// Output angle and peak mesh force follow the reference in every window of case R.
#[test]
#[ignore = "half a minute: the reference through all of case R"]
fn case_r_follows_reference() {
    check(&errors(case_r::case_r(), 0.0));
}
