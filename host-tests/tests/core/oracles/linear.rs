//! Oracles 1 to 4: tables and steps of the core while contact holds, so that the joint is linear.

use std::f64::consts::TAU;

use host_tests::tolerance::core::{CORE_ELLIPSE, CORE_MODE, CORE_STATIC};
use host_tests::tolerance::{CLOSED_FORM, ELLIPSE, NATURAL_FREQUENCY, PRINTED_EIGENVALUE};
use model_core::gears::design::dynamics::Dynamics;
use model_core::gears::design::{hamiltonian, modes};
use model_core::gears::{Kinematics, Relative, Scales};
use nalgebra::{Complex, Matrix2, Matrix3, Vector3};
use parameters::DampingLaw;
use reference::scenarios::{PAPER_LENGTH, paper_natural_frequency, same};

use super::closed_forms::{ClosedForm, joint};
use super::{Start, run};

/// Preload [N m] and half-backlash [m] that keep contact under small vibrations.
const DRIVE: f64 = 2400.0;
const HALF_BACKLASH: f64 = 60e-6;

/// Oracle 1 on the design's matrices, for 3 to 5 planets.
#[test]
fn frequencies_match_closed_form() {
    for planets in 3..=5 {
        let form = ClosedForm::new(planets, 0.0);
        let [planet, low, high] = form.frequencies();
        let mut expected = vec![0.0, low, high];
        expected.extend(vec![planet; planets - 1]);
        expected.sort_by(f64::total_cmp);
        let parameters = joint(planets, 0.0, 0.0, 1.0);
        let full = modes::natural_frequencies(&parameters);
        // The reduced model has the same frequencies except for the rigid body's zero.
        let dynamics = Dynamics::new(&parameters, &Scales::new(&parameters));
        let mut reduced: Vec<f64> =
            dynamics.stiffness.complex_eigenvalues().iter().map(|value| value.re.sqrt()).collect();
        reduced.sort_by(f64::total_cmp);
        assert_eq!((full.len(), reduced.len()), (planets + 2, planets + 1));
        for (full, expected) in full.iter().zip(&expected) {
            NATURAL_FREQUENCY.check(full / paper_natural_frequency() - expected);
        }
        for (reduced, expected) in reduced.iter().zip(&expected[1..]) {
            NATURAL_FREQUENCY.check(reduced / expected - 1.0);
        }
    }
    // Frequencies known for the paper's joint [Hz].
    let known = [2881.84, 2082.85, 4997.09];
    for (found, known) in ClosedForm::with_ring(3, 0.0, 1.0).frequencies().into_iter().zip(known) {
        assert_eq!((found * paper_natural_frequency() / TAU * 100.0).round() / 100.0, known);
    }
}

/// Oracle 1 on the step: small undamped vibrations about the loaded joint follow the cosine of their mode.
fn check_modes<const N: usize>() {
    let form = ClosedForm::new(N, 0.0);
    let mut parameters = joint(N, 0.0, HALF_BACKLASH, 0.0);
    for mesh in [&mut parameters.sun_planet, &mut parameters.ring_planet] {
        mesh.transmission_error = same(N, 0.0);
    }
    let [sun, _, gap] = form.at_rest(DRIVE, HALF_BACKLASH / PAPER_LENGTH);
    let stiffness = form.in_phase(form.stiffness);
    let [planet, low, high] = form.frequencies();
    let mut apart = [0.0; N];
    (apart[0], apart[1]) = (1.0, -1.0);
    let together = |frequency: f64| {
        let gap = stiffness[(1, 0)] / (frequency * frequency - stiffness[(1, 1)]);
        (frequency, [1.0; N], gap)
    };
    for (frequency, planets, gap_share) in [(planet, apart, 0.0), together(low), together(high)] {
        let amplitude = 0.3;
        let start = Start {
            position: Relative {
                planets: planets.map(|share| sun + amplitude * share),
                gap: gap + amplitude * gap_share,
                wind_up: 0.0,
            },
            ..Start::<N>::centred(DRIVE)
        };
        // Some 40 to 100 periods, one or two radians a tick.
        for (tick, (outputs, _)) in run(&parameters, 20_000, &start, 0, 400).iter().enumerate() {
            let wave = amplitude * (frequency * tick as f64 * paper_natural_frequency() / 20_000.0).cos();
            CORE_MODE.check(outputs.gap / PAPER_LENGTH - gap - gap_share * wave);
            for (found, share) in outputs.deflections[0].iter().zip(planets) {
                CORE_MODE.check(found / PAPER_LENGTH - sun - share * wave);
            }
        }
    }
}

/// In contact the core vibrates in each mode at its natural frequency, for 3 to 5 planets.
#[test]
fn modes_vibrate_at_their_frequency() {
    check_modes::<3>();
    check_modes::<4>();
    check_modes::<5>();
}

/// Oracle 2: n - 1 planet modes from their own quadratic, two overall modes as roots of det(s^2 + C s + K).
#[test]
fn damped_eigenvalues_match_closed_form() {
    for planets in 3..=5 {
        for ring in [1.0, 1.3] {
            let form = ClosedForm::with_ring(planets, 0.05, ring);
            let mut parameters = joint(planets, 0.05, 0.0, 1.0);
            parameters.ring_planet.mean_stiffness = ring * 1e8;
            let dynamics = Dynamics::new(&parameters, &Scales::new(&parameters));
            let [rate, square] =
                [form.damping, form.stiffness].map(|families| (families[0] + families[1]) / form.planet);
            let planet = Complex::new(-0.5 * rate, (square - 0.25 * rate * rate).sqrt());
            let found: Vec<Complex<f64>> =
                hamiltonian::matrix(&dynamics).complex_eigenvalues().iter().copied().filter(|s| s.im > 0.0).collect();
            let (planet_modes, overall): (Vec<Complex<f64>>, Vec<Complex<f64>>) =
                found.iter().copied().partition(|s| (*s - planet).norm() < 1e-3);
            assert_eq!((planet_modes.len(), overall.len()), (planets - 1, 2), "{found:?}");
            planet_modes.iter().for_each(|s| CLOSED_FORM.check((*s - planet).norm()));
            let [stiffness, damping] = [form.stiffness, form.damping].map(|families| form.in_phase(families));
            for s in overall {
                let matrix = stiffness.zip_map(&damping, |k, c| s * c + k) + Matrix2::identity() * (s * s);
                CLOSED_FORM.check(matrix.determinant().norm());
            }
        }
    }
    let known = ClosedForm::with_ring(3, 0.05, 1.0);
    let decay = 0.5 * (known.damping[0] + known.damping[1]) / known.planet;
    PRINTED_EIGENVALUE.check(decay - 0.050725);
}

/// Amplitude of a signal at a frequency per sample, by least squares with a mean.
fn amplitude(signal: &[f64], frequency: f64) -> f64 {
    let waves = |index: usize| {
        let (sine, cosine) = (frequency * index as f64).sin_cos();
        Vector3::new(1.0, sine, cosine)
    };
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (index, value) in signal.iter().enumerate() {
        matrix += waves(index) * waves(index).transpose();
        right += waves(index) * *value;
    }
    let fitted = matrix.lu().solve(&right).expect("more samples than unknowns");
    fitted[1].hypot(fitted[2])
}

/// Oracle 3 with the teeth pressed together by the load, whose static deflection is not part of the ellipse.
fn check_ellipse<const N: usize>(ring: f64) -> [f64; 2] {
    const TICK_RATE: u32 = 200_000;
    let omega = 2.1;
    let mut parameters = joint(N, 0.05, HALF_BACKLASH, omega);
    parameters.ring_planet.mean_stiffness = ring * 1e8;
    let expected = ClosedForm::with_ring(N, 0.05, ring).ellipse(omega, 3.0).map(Complex::norm);
    // This load presses the teeth together so firmly that the core advances every tick as a whole.
    let found = run(&parameters, TICK_RATE, &Start::<N>::centred(4.0 * DRIVE), 6000, 600);
    let step = omega * paper_natural_frequency() / f64::from(TICK_RATE);
    for (kind, expected) in expected.into_iter().enumerate() {
        let signal: Vec<f64> = found.iter().map(|(outputs, _)| outputs.deflections[kind][1] / PAPER_LENGTH).collect();
        CORE_ELLIPSE.check(amplitude(&signal, step) - expected);
    }
    expected
}

/// The steady motion of the core has the amplitudes of the closed form, for 3 to 5 planets.
#[test]
fn steady_motion_is_the_known_ellipse() {
    let known = check_ellipse::<3>(1.0);
    ELLIPSE.check(known[0] - 5.658641);
    ELLIPSE.check(known[1] - 2.925511);
    check_ellipse::<3>(1.3);
    check_ellipse::<4>(1.3);
    check_ellipse::<5>(1.3);
}

/// Oracle 4: deflections on either flank, and the lost motion at the sun.
fn check_settling<const N: usize>(law: DampingLaw) {
    let half_backlash = HALF_BACKLASH / PAPER_LENGTH;
    let mut parameters = joint(N, 0.2, HALF_BACKLASH, 0.0);
    parameters.damping_law = law;
    for mesh in [&mut parameters.sun_planet, &mut parameters.ring_planet] {
        mesh.transmission_error = same(N, 0.0);
    }
    let form = ClosedForm::new(N, 0.2);
    let twist = [DRIVE, -DRIVE].map(|drive| {
        let (outputs, _) = run(&parameters, 20_000, &Start::<N>::centred(drive), 2000, 1).remove(0);
        let [sun, ring, gap] = form.at_rest(drive, half_backlash);
        CORE_STATIC.check(outputs.gap / PAPER_LENGTH - gap);
        for (found, expected) in outputs.deflections.iter().zip([sun, ring]) {
            found.iter().for_each(|found| CORE_STATIC.check(found / PAPER_LENGTH - expected));
        }
        outputs.motor_offset - parameters.geometry.ratio_by_radii() * outputs.link_offset
    });
    let elastic = form.at_rest(DRIVE, 0.0)[2] - form.at_rest(-DRIVE, 0.0)[2];
    let lost = (twist[0] - twist[1]) * 36.8241e-3 / PAPER_LENGTH - elastic;
    CORE_STATIC.check(lost - 4.0 * half_backlash);
}

/// The core settles at the static deflection of either flank, four half-backlashes apart, for 3 to 5 planets.
#[test]
fn joint_settles_at_static_deflection() {
    for law in [DampingLaw::Paper, DampingLaw::Contact] {
        check_settling::<3>(law);
        check_settling::<4>(law);
        check_settling::<5>(law);
    }
}
