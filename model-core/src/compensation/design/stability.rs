//! Limits of bandwidth and control rate of a joint (K25).
//!
//! In the open gap, plain control moves the motor alone, with gains made for motor and link together. With the motor's
//! inertia J_m, the total inertia J, the bandwidth w, the damper D on the motor ([`swinging_motor_damping`]), the lag t
//! of the current loop, and a dead time of the torque's delay plus half a period, the loop is
//!
//! ```text
//! L(s) = (D s + 3 J w^2 + J w^3 / s) / (J_m s^2 (1 + t s)) e^(-s dead time)
//! ```
//!
//! Longer delays permit only a smaller D, until D has no phase lead left. Then the motor swings from flank to flank
//! without end, the observer cannot estimate the gap, and plain control stays. Small phase margins have the same effect
//! if the real delays exceed the data sheet by a fifth. `docs/decisions/control-rate.md` has the measurements.
//!
//! In contact the loop feeds back the link's angle through the compliance of the joint. With the stiffness K between
//! motor and link, the link inertia J_l and the motor's largest torque T at the link, the joint alone sets two more
//! limits:
//!
//! ```text
//! first swing    w <= sqrt(K (1/J_m + 1/J_l)) / swing_ratio
//! crossing time  w <= crossing_ratio / (2 sqrt(gap J_m / T))
//! ```

use core::f64::consts::PI;

use super::body::JointBody;
use super::damping::{loop_damping, motor_damping_bound, reaction};
use super::settings::{self, CompensationSettings, compensation_settings};
use crate::compensation::plain::swinging_motor_damping;
use crate::compensation::thresholds::BANDWIDTH;
use crate::gears::design::{BandwidthLimit, DesignError, validate};
use parameters::{JointParameters, Surroundings};

/// Smallest phase margin of the motor alone in the open gap [rad].
fn min_phase_margin() -> f64 {
    BANDWIDTH.phase_margin * PI / 180.0
}

/// Bisection steps for a frequency, a rate or a bandwidth: to a millionth.
const HALVINGS: usize = 60;

/// Rejects a bandwidth that is too wide for the joint, and a control rate that is too slow for the bandwidth.
pub(super) fn check(body: &JointBody, settings: &CompensationSettings) -> Result<(), DesignError> {
    let (widest, limit) = joint_bandwidth_limit(body, settings);
    if settings.bandwidth > widest {
        return Err(DesignError::BandwidthTooWide { bandwidth: settings.bandwidth, widest, limit });
    }
    check_rate(body, settings)
}

/// Widest bandwidth that the joint permits [rad/s], rounded down to three digits, and the property that limits it.
fn joint_bandwidth_limit(body: &JointBody, settings: &CompensationSettings) -> (f64, BandwidthLimit) {
    let swing = libm::sqrt(body.stiffness * (1.0 / body.motor + 1.0 / body.load));
    let gap = 2.0 * body.half_backlash / body.lever;
    let crossing = 2.0 * libm::sqrt(gap * body.motor / (body.gear * settings.torque_limit));
    // A joint without a gap has no crossing.
    let by_crossing = if crossing > 0.0 { BANDWIDTH.crossing_ratio / crossing } else { f64::INFINITY };
    let by_swing = swing / BANDWIDTH.swing_ratio;
    if by_swing < by_crossing {
        (rounded_down(by_swing), BandwidthLimit::Swing(swing))
    } else {
        (rounded_down(by_crossing), BandwidthLimit::Crossing(crossing))
    }
}

/// Bandwidths at which a joint can be controlled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandwidthRange {
    /// Default bandwidth: 60 rad/s, or `widest` if that is less [rad/s].
    pub usual: f64,
    /// Widest bandwidth that joint, control rate and delays permit, rounded down to three digits [rad/s].
    pub widest: f64,
    /// Property of the joint that limits `widest`; `None` if control rate and delays do.
    pub limit: Option<BandwidthLimit>,
}

/// Computes the bandwidths at which a joint can be controlled at the control rate of its surroundings, with their
/// delays of torque and current loop.
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
/// Returns an error if the joint is invalid or a setting is out of range.
pub fn bandwidth_range(joint: &JointParameters, of: &Surroundings) -> Result<BandwidthRange, DesignError> {
    validate(joint)?;
    let mut settings = compensation_settings(of, BANDWIDTH.default);
    settings::check(&settings)?;
    let body = JointBody::new(joint);
    let (by_joint, limit) = joint_bandwidth_limit(&body, &settings);
    // Without a limit by the joint, a bandwidth beyond every control rate is requested.
    settings.bandwidth = by_joint.min(f64::from(of.control_rate));
    let (widest, limit) = match check_rate(&body, &settings) {
        Ok(()) => (by_joint, Some(limit)),
        Err(DesignError::ControlTooSlow { widest, .. }) => (widest, None),
        Err(other) => return Err(other),
    };
    Ok(BandwidthRange { usual: BANDWIDTH.default.min(widest), widest, limit })
}

/// Default bandwidth: 60 rad/s, or the widest that joint, control rate and delays permit, if that is less [rad/s].
///
/// # Errors
///
/// Returns an error if the joint is invalid or a setting is out of range.
pub fn good_bandwidth(joint: &JointParameters, of: &Surroundings) -> Result<f64, DesignError> {
    bandwidth_range(joint, of).map(|range| range.usual)
}

/// Rejects a control rate that is too slow for the bandwidth.
fn check_rate(body: &JointBody, settings: &CompensationSettings) -> Result<(), DesignError> {
    let rate = f64::from(settings.control_rate);
    let permits = |rate: f64, bandwidth: f64| {
        rate >= BANDWIDTH.periods * bandwidth && phase_margin(body, settings, rate, bandwidth) >= min_phase_margin()
    };
    if permits(rate, settings.bandwidth) {
        return Ok(());
    }
    let lowest = permits(BANDWIDTH.fastest_rate, settings.bandwidth)
        .then(|| libm::ceil(bisect(rate, BANDWIDTH.fastest_rate, |rate| permits(rate, settings.bandwidth))) as u32);
    let widest = bisect(settings.bandwidth.min(rate / BANDWIDTH.periods), 0.0, |bandwidth| permits(rate, bandwidth));
    let widest = rounded_down(widest);
    Err(DesignError::ControlTooSlow { given: settings.control_rate, bandwidth: settings.bandwidth, lowest, widest })
}

/// Finds by bisection the value nearest to `bad` for which `holds` is true, as it is at `good`.
fn bisect(bad: f64, good: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut bad, mut good) = (bad, good);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (bad + good);
        *(if holds(middle) { &mut good } else { &mut bad }) = middle;
    }
    good
}

/// Rounds down to three digits; infinity is unchanged.
fn rounded_down(value: f64) -> f64 {
    if value.is_infinite() {
        return value;
    }
    let per_unit = libm::exp10(2.0 - libm::floor(libm::log10(value)));
    libm::floor(value * per_unit) / per_unit
}

/// Phase margin of the motor alone in the open gap [rad].
fn phase_margin(body: &JointBody, settings: &CompensationSettings, rate: f64, bandwidth: f64) -> f64 {
    let CompensationSettings { torque_delay, torque_lag, .. } = *settings;
    let period = 1.0 / rate;
    let both = loop_damping(body, bandwidth);
    let damper = swinging_motor_damping(motor_damping_bound(body, both, reaction(settings, period)));
    let (spring, integral) = (both * bandwidth, both * bandwidth * bandwidth / 3.0);
    // Numerator: `spring` is in phase with the position, this part leads it.
    let ahead = |frequency: f64| damper * frequency - integral / frequency;
    let gain = |frequency: f64| {
        libm::hypot(spring, ahead(frequency))
            / (body.motor * frequency * frequency * libm::hypot(1.0, torque_lag * frequency))
    };
    // The gain falls with the frequency, so that the crossover is unique.
    let below_one = |log: f64| gain(libm::exp(log)) < 1.0;
    let crossover = libm::exp(bisect(libm::log(1e-3 * bandwidth), libm::log(1e3 * rate), below_one));
    let lost = libm::atan(torque_lag * crossover) + crossover * period * (0.5 + torque_delay);
    libm::atan2(ahead(crossover), spring) - lost
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joint of two equal inertias without a gap.
    fn body() -> JointBody {
        JointBody {
            gear: 6.0,
            lever: 0.02,
            half_backlash: 0.0,
            motor: 0.01,
            load: 0.01,
            stiffness: 1e6,
            strike_impedance: 1.0,
        }
    }

    /// Settings without delays.
    fn settings(control_rate: u32, bandwidth: f64) -> CompensationSettings {
        CompensationSettings {
            control_rate,
            bandwidth,
            torque_limit: 2.5,
            peak_torque: None,
            efficiency: 1.0,
            cogging_periods: 84,
            torque_delay: 0.0,
            torque_lag: 0.0,
            motor_friction: 0.0,
            load_friction: 0.0,
        }
    }

    #[test]
    fn default_bandwidth_of_q1_is_60_rad_per_s() {
        let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
        assert_eq!(good_bandwidth(&q1.parameters, &q1.surroundings), Ok(60.0));
    }

    #[test]
    fn time_constant_has_33_periods() {
        let is_permitted = |bandwidth: f64| check_rate(&body(), &settings(3300, bandwidth)).is_ok();
        assert!(is_permitted(99.9) && !is_permitted(100.1));
    }

    #[test]
    fn phase_margin_is_3_degrees() {
        // Lags of the current loop from 4.2 to 4.9 ms: each hundredth of a millisecond costs 0.14 degrees.
        for hundredths in 420..490 {
            let torque_lag = 1e-5 * f64::from(hundredths);
            let settings = CompensationSettings { torque_lag, ..settings(10_000, 60.0) };
            let margin = phase_margin(&body(), &settings, 10_000.0, 60.0) * 180.0 / PI;
            assert_eq!(check_rate(&body(), &settings).is_ok(), margin >= 3.0, "{margin} degrees");
        }
    }

    #[test]
    fn first_swing_is_five_times_the_bandwidth() {
        // Two inertias of 0.01 kg m^2 swing with 500 rad/s.
        let slow = JointBody { stiffness: 1250.0, ..body() };
        let (widest, limit) = joint_bandwidth_limit(&slow, &settings(10_000, 60.0));
        assert!((widest - 100.0).abs() < 1.0 && matches!(limit, BandwidthLimit::Swing(_)), "{widest} {limit:?}");
    }

    #[test]
    fn control_rates_end_at_100_khz() {
        let lowest = |bandwidth: f64| match check_rate(&body(), &settings(10_000, bandwidth)) {
            Err(DesignError::ControlTooSlow { lowest, .. }) => lowest,
            other => panic!("{other:?}"),
        };
        // 33 periods per time constant need 99 and 102 kHz.
        assert_eq!([3000.0, 3090.0].map(lowest), [Some(99_000), None]);
    }
}
