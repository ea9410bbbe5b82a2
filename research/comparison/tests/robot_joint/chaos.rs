//! The motion of case R is chaotic, and its windows are not: the reference compared with itself under torques that differ by a billionth.

use host_tests::tolerance::light_planets::NOISE_IN_WINDOWS;
use model_core::gears::Kinematics;
use parameters::JointParameters;
use reference::joint::Reference;
use reference::scenarios::case_r::{CaseR, TICK_RATE, brief, case_r};

use crate::variants::joint;

/// Relative size of the torque noise.
const NOISE: f64 = 1e-9;

/// RMS effect of the noise on the link's angle, over the lost motion: over the whole case, and in windows.
fn growth(case: &CaseR) -> [f64; 2] {
    let start = |joint: &JointParameters| Reference::new(joint).expect("a sound joint");
    let mut clean = start(&case.joint);
    let mut noisy = [clean.clone(), clean.clone()];
    let mut squares = [0.0; 2];
    let lost = 2.0 * case.joint.sun_planet.half_backlash[0] / case.joint.geometry.carrier_base_radius();
    let mut random = 1_u64;
    for (tick, [drive, load]) in case.torques.iter().enumerate() {
        if case.windows.contains(&tick) {
            noisy[1] = clean.clone();
        }
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let noise = 1.0 + NOISE * ((random >> 33) as f64 / 2_f64.powi(30) - 1.0);
        let time = (tick + 1) as f64 / f64::from(TICK_RATE);
        clean.advance(time, *drive, *load).expect("the reference follows");
        let right = clean.observe().link_angle;
        for (noisy, squares) in noisy.iter_mut().zip(&mut squares) {
            noisy.advance(time, drive * noise, *load).expect("the reference follows");
            *squares += ((noisy.observe().link_angle - right) / lost).powi(2);
        }
    }
    let found = squares.map(|squares| (squares / case.torques.len() as f64).sqrt());
    println!("torque noise of {NOISE:e}: {:.1e} left to itself, {:.1e} in windows", found[0], found[1]);
    found
}

/// In windows the effect of noise stays small, on the short form.
#[test]
fn noise_stays_small_in_a_window() {
    NOISE_IN_WINDOWS.check(growth(&brief(joint()))[1]);
}

/// Without windows the noise moves the joint within its gap, on all of case R.
#[test]
#[ignore = "a minute: the reference three times through all of case R"]
fn noise_grows_without_windows() {
    let [alone, in_windows] = growth(&case_r());
    NOISE_IN_WINDOWS.check(in_windows);
    assert!(alone > 1e4 * in_windows, "{alone:.1e} against {in_windows:.1e}");
}
