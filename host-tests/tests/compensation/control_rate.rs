//! Lowest control rate and widest bandwidth of a joint: the design rejects the rest and names both limits. A motor alone in the open gap,
//! simulated with delay and lag, has to be stable at these limits.

use model_core::compensation::design::{CompensationSettings, compensation_settings, design_compensation};
use model_core::compensation::{Command, Compensation, CompensationTables, Motion};
use model_core::gears::design::DesignError;
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimate, Estimates, ObserverTables, Source};
use parameters::{JointParameters, Surroundings};

fn preset(name: &str) -> (JointParameters, Surroundings) {
    let file = joint_file::read(joint_file::preset(name).expect("a preset")).expect("a good one");
    (file.parameters, file.surroundings)
}

fn q1() -> (JointParameters, CompensationSettings) {
    let (joint, surroundings) = preset("q1");
    (joint, compensation_settings(&surroundings, 60.0))
}

fn tables(joint: &JointParameters, settings: &CompensationSettings) -> Result<CompensationTables<f64>, DesignError> {
    design_compensation(joint, settings)
}

/// Lowest rate and widest bandwidth that the error of a rejected design names.
fn named_limits(joint: &JointParameters, settings: &CompensationSettings) -> (Option<u32>, f64) {
    match tables(joint, settings) {
        Err(DesignError::ControlTooSlow { lowest, widest, .. }) => (lowest, widest),
        Err(DesignError::BandwidthTooWide { widest, .. }) => (None, widest),
        other => panic!("{settings:?} is to be refused: {:?}", other.err()),
    }
}

/// Amplitude of a motor alone in the open gap between two times [rad], from half a milliradian beside the set-point. Its torque acts after
/// the settings' delay and the current loop's `lag` [s].
fn amplitude(tables: &CompensationTables<f64>, settings: &CompensationSettings, lag: f64, from: f64, to: f64) -> f64 {
    const FINE: usize = 50;
    let step = tables.clock.period / FINE as f64;
    let known = |value| Estimate { value, variance: 0.0, valid: true };
    // Set-point too slow to travel, so that the law of motion applies and not that of rest.
    let command = Command::Position { now: Motion { speed: 1e-9, ..Motion::default() }, ahead: None };
    let mut compensation = Compensation::new(tables);
    let (mut place, mut speed, mut torque) = (0.5e-3, 0.0, 0.0);
    let (mut wanted, mut swing, mut time) = ([0.0; 2], [f64::INFINITY, f64::NEG_INFINITY], 0.0);
    let delayed = (settings.torque_delay * FINE as f64).round() as usize;
    assert!(delayed <= FINE, "a period of delay at most");
    while time < to {
        let mut estimates = Estimates {
            source: Source::Both,
            contact_valid: true,
            half_backlash: known(40e-6),
            half_backlash_usable: true,
            encoder_offset: known(0.0),
            load_torque: known(0.0),
            ..Estimates::default()
        };
        estimates.motor_lead = place;
        estimates.motor.speed = speed * tables.gear.motor_per_link;
        wanted = [compensation.step(&estimates, &command).torque * tables.gear.motor_per_link, wanted[0]];
        for fine in 0..FINE {
            let now = wanted[usize::from(fine < delayed)];
            torque += (now - torque) * (-(-step / lag).exp_m1());
            speed += torque / tables.body.motor_inertia * step;
            place += speed * step;
        }
        time += tables.clock.period;
        if time >= from {
            swing = [swing[0].min(place), swing[1].max(place)];
        }
    }
    0.5 * (swing[1] - swing[0])
}

/// The named limits are accepted, slightly lower rates and wider bandwidths are rejected.
#[test]
fn named_rate_and_bandwidth_are_limits() {
    let (joint, usual) = q1();
    let heavy = JointParameters { link_inertia: 0.54, ..joint.clone() };
    let light = JointParameters { link_inertia: 0.03, ..joint.clone() };
    // In the first three cases the delays decide, in the others the periods per time constant.
    for (joint, rate, lag, bandwidth, delays) in [
        (&joint, 2000, 1e-3, 60.0, true),
        (&heavy, 2500, 0.2e-3, 60.0, true),
        (&light, 2000, 2.5e-3, 60.0, true),
        (&joint, 1000, 0.2e-3, 60.0, false),
        (&light, 2500, 0.2e-3, 90.0, false),
        (&joint, 500, 0.2e-3, 60.0, false),
    ] {
        let slow = CompensationSettings { control_rate: rate, torque_lag: lag, bandwidth, ..usual.clone() };
        let (lowest, widest) = named_limits(joint, &slow);
        let lowest = lowest.expect("some rate does");
        assert_eq!(f64::from(lowest) > 33.1 * bandwidth, delays, "{lowest} Hz");
        let at = |control_rate| CompensationSettings { control_rate, ..slow.clone() };
        let with = |bandwidth| CompensationSettings { bandwidth, ..slow.clone() };
        tables(joint, &at(lowest)).expect("the rate that was named");
        tables(joint, &with(widest)).expect("the bandwidth that was named");
        named_limits(joint, &at(lowest - 2));
        named_limits(joint, &with(widest + 1.01));
    }
}

/// Where no rate compensates the lag, the error names a bandwidth only.
#[test]
fn long_lag_names_bandwidth_only() {
    let (joint, usual) = q1();
    let slow = CompensationSettings { torque_lag: 4e-3, ..usual };
    let (lowest, widest) = named_limits(&joint, &slow);
    assert_eq!(lowest, None);
    let text = tables(&joint, &slow).expect_err("too slow").to_string();
    tables(&joint, &CompensationSettings { bandwidth: widest, ..slow }).expect("the bandwidth that was named");
    assert!(text.contains(&format!("a bandwidth of {widest} rad/s or less")), "{text}");
    assert!(!text.contains("Hz or more"), "{text}");
}

/// The named bandwidth is positive and accepted for any slow motor and any absurd request.
#[test]
fn named_bandwidth_is_positive() {
    let (joint, usual) = q1();
    for (torque_lag, bandwidth) in [(1.0, 60.0), (0.2e-3, 1e300)] {
        let asked = CompensationSettings { torque_lag, bandwidth, ..usual.clone() };
        let (_, widest) = named_limits(&joint, &asked);
        assert!(widest > 0.0, "{widest} rad/s");
        tables(&joint, &CompensationSettings { bandwidth: widest, ..asked }).expect("the bandwidth that was named");
    }
}

/// At the lowest rate the phase margin is three degrees: the motor comes to rest with the nominal delays, and oscillates with half a
/// millisecond more.
#[test]
fn lowest_rate_is_just_stable_in_the_gap() {
    let (joint, usual) = q1();
    let heavy = JointParameters { link_inertia: 0.54, ..joint.clone() };
    for (joint, lag) in [(&heavy, 0.2e-3), (&joint, 1e-3)] {
        let slow = CompensationSettings { control_rate: 1000, torque_lag: lag, ..usual.clone() };
        let lowest = named_limits(joint, &slow).0.expect("some rate does");
        let settings = CompensationSettings { control_rate: lowest, ..slow };
        let tables = tables(joint, &settings).expect("the rate that was named");
        let at = |lag| amplitude(&tables, &settings, lag, 1.0, 1.2);
        let (settled, swinging) = (at(lag), at(lag + 0.5e-3));
        assert!(settled < 0.05e-3, "{lag}: {settled} rad are left of 0.5 mrad at {lowest} Hz");
        assert!(swinging > 0.5e-3, "{lag}: {swinging} rad with half a millisecond more at {lowest} Hz");
    }
}

/// Each preset passes both designs at its own control rate.
#[test]
fn presets_pass_at_their_own_rate() {
    for name in ["q1", "s1", "d2", "l1", "c1"] {
        let (joint, surroundings) = preset(name);
        tables(&joint, &compensation_settings(&surroundings, 60.0)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let observer: Result<ObserverTables<f32>, _> = design_observer(&joint, &observer_settings(&surroundings));
        observer.unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// The observer's estimation interval of 1 ms must hold at least one period.
#[test]
fn observer_below_1_khz_is_rejected() {
    let (joint, surroundings) = preset("q1");
    let at = |control_rate| {
        let designed: Result<ObserverTables<f32>, _> =
            design_observer(&joint, &observer_settings(&Surroundings { control_rate, ..surroundings }));
        designed.map(|_| ())
    };
    at(1000).expect("one period is enough");
    let text = at(999).expect_err("less than one").to_string();
    assert!(text.contains("control rate is 999") && text.contains("1000"), "{text}");
}
