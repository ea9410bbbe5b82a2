//! Limits of bandwidth and control rate of a joint (K25).
//!
//! While the gap is open, plain control holds the motor alone by gains that are made for motor and link together. With
//! the motor's inertia J_m, that of both J, the bandwidth w, the damper D on the motor ([`damping_on_motor`]), the current
//! loop's lag t, and a dead time of half a period more than the torque's delay, the loop is
//!
//! ```text
//! L(s) = (D s + 3 J w^2 + J w^3 / s) / (J_m s^2 (1 + t s)) e^(-s dead time)
//! ```
//!
//! D may be no larger the longer the delays are, so that with them its phase lead is lost, and the motor swings from flank to
//! flank for good: of such a swing the observer learns no gap, and plain control stays. Where phase margins are small, delays
//! that the data sheet says a fifth too short do the same. `docs/decisions/control-rate.md` has the measurements.
//!
//! In contact the loop feeds the link's angle back through the joint's compliance. With the stiffness K between motor and link, link
//! inertia J_l and the motor's largest torque T at the link, two more limits follow from the joint alone:
//!
//! ```text
//! first swing    w <= sqrt(K (1/J_m + 1/J_l)) / SWING
//! crossing time  w <= CROSSING / (2 sqrt(gap J_m / T))
//! ```

use core::f64::consts::PI;

use super::body::Body;
use super::damping::{of_both, on_motor_alone, reaction};
use super::settings::{self, CompensationSettings, compensation_settings};
use crate::compensation::plain::damping_on_motor;
use crate::gears::design::{BandwidthLimit, DesignError, validate};
use parameters::{JointParameters, Surroundings};

/// Smallest phase margin of the motor alone in the open gap [rad]: three degrees. Down to 4.7 the gap was learnt by as many
/// joints, whose lag was up to a fifth longer than the sheet says, as at any rate; below zero a third to nearly all did not learn it.
const LEAST_MARGIN: f64 = 3.0 * PI / 180.0;

/// Control periods in a time constant of the loop, 1/w: from 33 on the gap was learnt by as many joints as at any rate, with 28
/// and less not by all.
const PERIODS: f64 = 33.0;

/// First swing of motor against link over the bandwidth, at least [-]. Tuned on one strain wave gear in motion T2: it hunts at 3.9 and
/// not at 5; inertias 30 % off move the swing by 15 %. No test holds it yet.
const SWING: f64 = 5.0;

/// Crossing time from rest to rest at the largest torque, over the time constant of the loop, at most [-]. Tuned on one joint with
/// 80 mrad of play in a sine of 1 Hz: it throws its link from flank to flank at 0.56 and not at 0.42; the guess of the gap may be
/// half of the gap. No test holds it yet.
const CROSSING: f64 = 0.3;

/// Bandwidth of a controller whose user asks for none, where the joint lets it [rad/s].
const USUAL: f64 = 60.0;

/// The fastest control that is thought of [Hz].
const FASTEST: f64 = 1e5;

/// Halvings that find a frequency, a rate or a bandwidth to a millionth.
const HALVINGS: usize = 60;

/// Refuses a bandwidth that the joint does not bear, and a control rate that is too slow for the bandwidth.
pub(super) fn check(body: &Body, settings: &CompensationSettings) -> Result<(), DesignError> {
    let (widest, limit) = of_joint(body, settings);
    if settings.bandwidth > widest {
        return Err(DesignError::BandwidthTooWide { bandwidth: settings.bandwidth, widest, limit });
    }
    check_rate(body, settings)
}

/// The widest bandwidth that the joint itself bears [rad/s], to three digits, and the property that limits it.
fn of_joint(body: &Body, settings: &CompensationSettings) -> (f64, BandwidthLimit) {
    let swing = libm::sqrt(body.stiffness * (1.0 / body.motor + 1.0 / body.load));
    let gap = 2.0 * body.half_backlash / body.lever;
    let crossing = 2.0 * libm::sqrt(gap * body.motor / (body.gear * settings.torque_limit));
    // Without a gap there is nothing to cross.
    let by_crossing = if crossing > 0.0 { CROSSING / crossing } else { f64::INFINITY };
    let by_swing = swing / SWING;
    if by_swing < by_crossing {
        (rounded_down(by_swing), BandwidthLimit::Swing(swing))
    } else {
        (rounded_down(by_crossing), BandwidthLimit::Crossing(crossing))
    }
}

/// Up to which bandwidth a joint can be controlled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandwidthRange {
    /// Of a compensation whose user asks for none: 60 rad/s, or the widest if that is less [rad/s].
    pub usual: f64,
    /// The widest that joint, control rate and delays allow, to three digits [rad/s].
    pub widest: f64,
    /// Property of the joint that sets the widest; none where control rate and delays set it.
    pub limit: Option<BandwidthLimit>,
}

/// Up to which bandwidth a joint can be controlled at the control rate of its surroundings, with their delays of torque and current loop.
///
/// ```
/// use model_core::compensation::design::bandwidth_range;
///
/// let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
/// let range = bandwidth_range(&q1.parameters, &q1.surroundings)?;
/// assert_eq!(range.usual, 60.0);
/// assert!(range.widest > range.usual);
/// # Ok::<(), model_core::gears::design::DesignError>(())
/// ```
///
/// # Errors
///
/// A joint that is none, or settings out of their range.
pub fn bandwidth_range(joint: &JointParameters, of: &Surroundings) -> Result<BandwidthRange, DesignError> {
    validate(joint)?;
    let mut settings = compensation_settings(of, USUAL);
    settings::check(&settings)?;
    let body = Body::new(joint);
    let (of_joint, limit) = of_joint(&body, &settings);
    // A joint without limits of its own is asked for a bandwidth that no control rate bears.
    settings.bandwidth = of_joint.min(f64::from(of.control_rate));
    let (widest, limit) = match check_rate(&body, &settings) {
        Ok(()) => (of_joint, Some(limit)),
        Err(DesignError::ControlTooSlow { widest, .. }) => (widest, None),
        Err(other) => return Err(other),
    };
    Ok(BandwidthRange { usual: USUAL.min(widest), widest, limit })
}

/// Bandwidth of a compensation whose user asks for none: 60 rad/s, or as much as joint, control rate and delays allow [rad/s].
///
/// # Errors
///
/// A joint that is none, or settings out of their range.
pub fn good_bandwidth(joint: &JointParameters, of: &Surroundings) -> Result<f64, DesignError> {
    bandwidth_range(joint, of).map(|range| range.usual)
}

/// Refuses a control rate that is too slow for the bandwidth.
fn check_rate(body: &Body, settings: &CompensationSettings) -> Result<(), DesignError> {
    let rate = f64::from(settings.control_rate);
    let bears = |rate: f64, bandwidth: f64| {
        rate >= PERIODS * bandwidth && phase_margin(body, settings, rate, bandwidth) >= LEAST_MARGIN
    };
    if bears(rate, settings.bandwidth) {
        return Ok(());
    }
    let lowest = bears(FASTEST, settings.bandwidth)
        .then(|| libm::ceil(between(rate, FASTEST, |rate| bears(rate, settings.bandwidth))) as u32);
    let widest = between(settings.bandwidth.min(rate / PERIODS), 0.0, |bandwidth| bears(rate, bandwidth));
    let widest = rounded_down(widest);
    Err(DesignError::ControlTooSlow { given: settings.control_rate, bandwidth: settings.bandwidth, lowest, widest })
}

/// The place nearest to `bad` that `holds`, as far as it holds from there to `good`.
fn between(bad: f64, good: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut bad, mut good) = (bad, good);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (bad + good);
        *(if holds(middle) { &mut good } else { &mut bad }) = middle;
    }
    good
}

/// To three digits, no larger than it is; infinite as it is.
fn rounded_down(value: f64) -> f64 {
    if value.is_infinite() {
        return value;
    }
    let per_unit = libm::exp10(2.0 - libm::floor(libm::log10(value)));
    libm::floor(value * per_unit) / per_unit
}

/// Phase margin of the motor alone in the open gap [rad].
fn phase_margin(body: &Body, settings: &CompensationSettings, rate: f64, bandwidth: f64) -> f64 {
    let CompensationSettings { torque_delay, torque_lag, .. } = *settings;
    let period = 1.0 / rate;
    let both = of_both(body, bandwidth);
    let damper = damping_on_motor(on_motor_alone(body, both, reaction(settings, period)));
    let (spring, integral) = (both * bandwidth, both * bandwidth * bandwidth / 3.0);
    // Of the numerator, in phase with the place and ahead of it.
    let ahead = |frequency: f64| damper * frequency - integral / frequency;
    let gain = |frequency: f64| {
        libm::hypot(spring, ahead(frequency))
            / (body.motor * frequency * frequency * libm::hypot(1.0, torque_lag * frequency))
    };
    // The gain falls with the frequency.
    let below_one = |log: f64| gain(libm::exp(log)) < 1.0;
    let crossover = libm::exp(between(libm::log(1e-3 * bandwidth), libm::log(1e3 * rate), below_one));
    let lost = libm::atan(torque_lag * crossover) + crossover * period * (0.5 + torque_delay);
    libm::atan2(ahead(crossover), spring) - lost
}
