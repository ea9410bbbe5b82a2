//! Keys of effects of real joints: each is read in SI, absent by default, and rejected by name without effect.

use joint_file::{change, preset, read};
use parameters::{Effect, Surroundings};

/// Key, value as typed, value in SI, and accessor.
type Row = (&'static str, &'static str, f64, fn(&Surroundings) -> f64);

/// Every key with a value and its SI value.
const KEYS: [Row; 29] = [
    ("payload_inertia_share", "0.4", 0.4, |of| of.payload.inertia_share),
    ("payload_frequency_Hz", "12", 12.0, |of| of.payload.frequency),
    ("payload_damping_ratio", "0.03", 0.03, |of| of.payload.damping_ratio),
    ("payload_step_time_s", "4", 4.0, |of| of.payload_step.time),
    ("payload_step_ratio", "3", 3.0, |of| of.payload_step.ratio),
    ("motor_presliding_mrad", "2", 2e-3, |of| of.presliding.motor),
    ("load_presliding_mrad", "0.2", 0.2e-3, |of| of.presliding.load),
    ("hysteresis_stiffness_share", "0.2", 0.2, |of| of.hysteresis.stiffness_share),
    ("hysteresis_torque_N_m", "1.5", 1.5, |of| of.hysteresis.torque),
    ("width_once_per_link_turn_ratio", "0.3", 0.3, |of| of.width.per_link_turn),
    ("width_once_per_motor_turn_ratio", "0.1", 0.1, |of| of.width.per_motor_turn),
    ("friction_drift_ratio_per_s", "0.005", 0.005, |of| of.drift.friction),
    ("width_drift_ratio_per_s", "-0.005", -0.005, |of| of.drift.width),
    ("torque_ripple_ratio", "0.02", 0.02, |of| of.torque_errors.ripple_ratio),
    ("torque_ripple_periods_per_turn", "42", 42.0, |of| of.torque_errors.ripple_periods_per_turn.into()),
    ("torque_resolution_ratio", "0.005", 0.005, |of| of.torque_errors.resolution_ratio),
    ("torque_saturation_ratio", "0.1", 0.1, |of| of.torque_errors.saturation_ratio),
    ("control_jitter_ratio", "0.05", 0.05, |of| of.control_jitter_ratio),
    ("motor_encoder.age_jitter_us", "10", 10e-6, |of| of.motor_encoder.age_jitter),
    ("motor_encoder.noise_counts", "1.5", 1.5, |of| of.motor_encoder.noise_counts),
    ("motor_encoder.subdivisional_error_deg", "0.05", 0.05 * DEGREE, |of| of.motor_encoder.subdivision.first),
    ("motor_encoder.subdivisional_second_error_deg", "0.04", 0.04 * DEGREE, |of| of.motor_encoder.subdivision.second),
    ("motor_encoder.subdivisional_periods_per_turn", "4", 4.0, |of| {
        of.motor_encoder.subdivision.periods_per_turn.into()
    }),
    ("motor_encoder.missing_frames_share", "0.01", 0.01, |of| of.motor_encoder.missing_share),
    ("output_encoder.age_jitter_us", "100", 100e-6, |of| of.output_encoder.age_jitter),
    ("output_encoder.noise_counts", "2", 2.0, |of| of.output_encoder.noise_counts),
    ("output_encoder.subdivisional_error_deg", "0.006", 0.006 * DEGREE, |of| of.output_encoder.subdivision.first),
    ("output_encoder.subdivisional_periods_per_turn", "8", 8.0, |of| {
        of.output_encoder.subdivision.periods_per_turn.into()
    }),
    ("output_encoder.missing_frames_share", "0.02", 0.02, |of| of.output_encoder.missing_share),
];

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Q1 with these keys set.
fn q1_with(keys: &[(&str, &str)]) -> String {
    let set = |text: String, (key, value): &(&str, &str)| change(&text, key, value).expect("a known key");
    keys.iter().fold(preset("q1").expect("a preset").to_owned(), set)
}

/// Only problem of Q1 with these keys set: message and help.
fn refusal(keys: &[(&str, &str)]) -> String {
    let problems = read(&q1_with(keys)).expect_err("it is refused");
    assert_eq!(problems.len(), 1, "{problems:#?}");
    problems[0].to_string()
}

#[test]
fn effect_keys_are_read_in_si() {
    let text = q1_with(&KEYS.map(|(key, value, ..)| (key, value)));
    let around = read(&text).expect("a joint").surroundings;
    for (key, _, si, of) in KEYS {
        assert!((of(&around) / si - 1.0).abs() < 1e-12, "{key}: {}", of(&around));
    }
}

#[test]
fn presets_have_no_effects() {
    for name in joint_file::PRESETS {
        let around = read(preset(name).expect("a preset")).expect("a joint").surroundings;
        assert_eq!(around.effects().count(), 0, "{name}");
    }
}

#[test]
fn effect_names_are_keys() {
    for effect in Effect::ALL {
        let of_encoder = joint_file::full_key(&format!("motor_encoder.{}", effect.key()));
        assert!(joint_file::full_key(effect.key()).is_ok() || of_encoder.is_ok(), "{}", effect.key());
    }
}

/// A key without effect on its own is rejected with the missing key.
#[test]
fn key_without_its_partner_is_rejected() {
    for (key, value, other) in [
        ("payload_inertia_share", "0.4", "payload_frequency_Hz"),
        ("payload_frequency_Hz", "12", "payload_inertia_share"),
        ("payload_damping_ratio", "0.1", "payload_inertia_share"),
        ("payload_step_time_s", "4", "payload_step_ratio"),
        ("hysteresis_stiffness_share", "0.2", "hysteresis_torque_N_m"),
        ("hysteresis_torque_N_m", "1", "hysteresis_stiffness_share"),
        ("torque_ripple_periods_per_turn", "6", "torque_ripple_ratio"),
    ] {
        let refused = refusal(&[(key, value)]);
        assert!(refused.contains(&format!("`{key}` has no effect without `{other}`")), "{refused}");
    }
    let refused = refusal(&[("motor_encoder.subdivisional_error_deg", "0.05")]);
    assert!(refused.contains("`subdivisional_periods_per_turn` is missing"), "{refused}");
    let refused = refusal(&[("motor_encoder.subdivisional_periods_per_turn", "4")]);
    assert!(refused.contains("has no effect without an amplitude"), "{refused}");
}

#[test]
fn negative_backlash_is_rejected() {
    let refused = refusal(&[("width_once_per_link_turn_ratio", "0.6"), ("width_once_per_motor_turn_ratio", "0.5")]);
    assert!(refused.contains("a backlash is never negative"), "{refused}");
}

#[test]
fn effect_of_missing_part_is_rejected() {
    let l1 = preset("l1").expect("a preset");
    let l1 = change(l1, "hysteresis_stiffness_share", "0.2").expect("a key");
    let l1 = change(&l1, "hysteresis_torque_N_m", "2").expect("a key");
    let problems = read(&l1).expect_err("L1 has no compliance");
    assert!(problems[0].message.contains("`hysteresis_stiffness_share`"), "{problems:?}");
}

#[test]
fn out_of_range_value_names_range() {
    for (key, value) in [
        ("payload_step_ratio", "0"),
        ("motor_presliding_mrad", "0.0001"),
        ("friction_drift_ratio_per_s", "0.2"),
        ("torque_resolution_ratio", "0.6"),
        ("torque_saturation_ratio", "1"),
        ("control_jitter_ratio", "0.6"),
        ("motor_encoder.missing_frames_share", "1.1"),
        ("motor_encoder.noise_counts", "-1"),
    ] {
        let name = key.rsplit('.').next().unwrap_or(key);
        let refused = refusal(&[(key, value)]);
        assert!(refused.contains(&format!("`{name}` must be")), "{refused}");
    }
}
