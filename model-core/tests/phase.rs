//! Sine and cosine of a phase in 2^-32 turns.

use model_core::numbers::phase::sine_cosine;

#[test]
fn sine_and_cosine_are_right_to_single_precision_all_round() {
    for i in 0..100_003_u64 {
        let phase = (i * 42_949 + i / 7) as u32;
        let angle = f64::from(phase) / 4_294_967_296.0 * std::f64::consts::TAU;
        let (sine, cosine) = sine_cosine::<f32>(phase);
        assert!((f64::from(sine) - angle.sin()).abs() < 1.2e-7, "sine at {phase:#x}");
        assert!((f64::from(cosine) - angle.cos()).abs() < 1.2e-7, "cosine at {phase:#x}");
        let (sine, cosine) = sine_cosine::<f64>(phase);
        assert!((sine - angle.sin()).abs() < 2.5e-9 && (cosine - angle.cos()).abs() < 2.5e-9);
    }
}

#[test]
fn quarter_turns_are_exact_to_rounding() {
    for (phase, sine, cosine) in [(0, 0.0, 1.0), (1 << 30, 1.0, 0.0), (2 << 30, 0.0, -1.0), (3 << 30, -1.0, 0.0)] {
        let (s, c) = sine_cosine::<f32>(phase);
        assert!((s - sine).abs() < 1e-7 && (c - cosine).abs() < 1e-7);
    }
}
