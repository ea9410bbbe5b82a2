//! The reference without backlash against linear algebra: natural frequencies, damped eigenvalues, the steady ellipse. With backlash at
//! rest: static deflections and lost motion.

use std::f64::consts::TAU;

use host_tests::tolerance::{EIGENVALUE, ELLIPSE, ELLIPSE_PURITY, NATURAL_FREQUENCY, STATIC};
use nalgebra::{Complex, Matrix4, Vector4};
use parameters::{DampingLaw, JointParameters};
use reference::joint::RelativeState;
use reference::scenarios::{PAPER_LENGTH, Scenario, TorqueSegment, paper_joint, paper_natural_frequency, q1, run_at};

/// Dimensionless sampling interval, short against every mode.
const INTERVAL: f64 = 0.5;

/// Scenario without torques.
fn free(joint: JointParameters, start: RelativeState) -> Scenario {
    Scenario::new("free vibration", joint, start)
}

/// Free vibration of the paper's joint without backlash, ripple and error, all modes excited: sum of the sun-planet deflections (overall
/// modes) and difference of two (planet mode), dimensionless.
fn free_vibration(damping_ratio: f64) -> (Vec<f64>, Vec<f64>) {
    let mut joint = paper_joint(0.0, 0.0, 0.0, 0.0);
    joint.sun_planet.damping_ratio = damping_ratio;
    joint.ring_planet.damping_ratio = damping_ratio;
    let start = RelativeState {
        sun_planet: [3e-6, -5e-6, 9e-6].into_iter().collect(),
        gap: 11e-6,
        ..RelativeState::centred(3)
    };
    let times: Vec<f64> = (0..40).map(|sample| f64::from(sample) * INTERVAL / paper_natural_frequency()).collect();
    let found = run_at(&free(joint, start), &times).expect("a linear joint runs");
    let overall = found.signal(|sample| sample.deflections[0].iter().sum::<f64>() / PAPER_LENGTH);
    let planet = found.signal(|sample| (sample.deflections[0][1] - sample.deflections[0][0]) / PAPER_LENGTH);
    (overall, planet)
}

/// Eigenvalue of the overall modes next to a guess, as root of the characteristic polynomial of x[k+4] = a x[k+3] + b x[k+2] + c x[k+1] + d
/// x[k], the sum of two decaying oscillations.
fn overall_eigenvalue(signal: &[f64], guess: Complex<f64>) -> Complex<f64> {
    let matrix = Matrix4::from_fn(|row, column| signal[4 * row + 3 - column]);
    let coefficients =
        matrix.lu().solve(&Vector4::from_fn(|row, _| signal[4 * row + 4])).expect("both modes are there");
    let mut root = (guess * INTERVAL).exp();
    for _ in 0..20 {
        let value = root.powi(4)
            - (0..4).map(|power| root.powi(3 - power) * coefficients[power as usize]).sum::<Complex<f64>>();
        let slope = root.powi(3) * 4.0
            - (0..3)
                .map(|power| root.powi(2 - power) * (coefficients[power as usize] * f64::from(3 - power)))
                .sum::<Complex<f64>>();
        root -= value / slope;
    }
    root.ln() / INTERVAL
}

/// Eigenvalue of the planet mode from x[k+2] = a x[k+1] + b x[k], one decaying oscillation.
fn planet_eigenvalue(signal: &[f64]) -> Complex<f64> {
    let determinant = signal[1] * signal[6] - signal[0] * signal[7];
    let a = (signal[2] * signal[6] - signal[0] * signal[8]) / determinant;
    let b = (signal[1] * signal[8] - signal[2] * signal[7]) / determinant;
    let root = (a + Complex::new(a * a + 4.0 * b, 0.0).sqrt()) / 2.0;
    root.ln() / INTERVAL
}

/// Free vibration has the frequencies of the characteristic polynomial.
#[test]
fn free_vibration_has_natural_frequencies() {
    let (overall, planet) = free_vibration(0.0);
    let (stiffness, sun, planet_mass, n): (f64, f64, f64, f64) = (1e8, 0.39, 0.61, 3.0);
    let carrier = (6.29 + 3.0 * 0.66) / 24.6_f64.to_radians().cos().powi(2);
    let l1 = sun * planet_mass * carrier;
    let l2 = -(n * stiffness * planet_mass * carrier
        + 2.0 * stiffness * carrier * sun
        + n * 2.0 * stiffness * planet_mass * sun);
    let l3 = n * stiffness * stiffness * (n * planet_mass + carrier + 4.0 * sun);
    let root = (l2 * l2 - 4.0 * l1 * l3).sqrt();
    for (square, hertz) in [((-l2 - root) / (2.0 * l1), 2082.85), ((-l2 + root) / (2.0 * l1), 4997.09)] {
        let expected = square.sqrt();
        let guess = Complex::new(0.0, expected * 1.001 / paper_natural_frequency());
        let found = overall_eigenvalue(&overall, guess) * paper_natural_frequency();
        NATURAL_FREQUENCY.check((found - Complex::new(0.0, expected)).norm() / expected);
        assert_eq!((found.im / TAU * 100.0).round() / 100.0, hertz);
    }
    let expected = (2.0 * stiffness / planet_mass).sqrt();
    let found = planet_eigenvalue(&planet).im * paper_natural_frequency();
    NATURAL_FREQUENCY.check(found / expected - 1.0);
}

/// Free vibration decays with the damped eigenvalues.
#[test]
fn free_vibration_has_damped_eigenvalues() {
    let (overall, planet) = free_vibration(0.05);
    for expected in [Complex::new(-0.032282, 0.637513), Complex::new(-0.119223, 1.526734)] {
        EIGENVALUE.check((overall_eigenvalue(&overall, expected) - expected).norm());
    }
    EIGENVALUE.check((planet_eigenvalue(&planet) - Complex::new(-0.050725, 0.881718)).norm());
}

/// Without backlash and ripple the steady motion is the known ellipse.
#[test]
fn steady_motion_is_the_known_ellipse() {
    const SAMPLES: u32 = 64;
    let omega = 2.1;
    let joint = paper_joint(0.0, 30e-6, 0.0, omega);
    let mut scenario = free(joint, RelativeState::centred(3));
    scenario.torques = balanced(&scenario.joint, 80.0);
    let period = TAU / omega;
    let first = (800.0 / period).ceil() * period;
    let times: Vec<f64> = (0..SAMPLES)
        .map(|sample| (first + period * f64::from(sample) / f64::from(SAMPLES)) / paper_natural_frequency())
        .collect();
    let found = run_at(&scenario, &times).expect("a linear joint runs");
    for (kind, amplitude) in [(0, 5.658641), (1, 2.925511)] {
        let signal = found.signal(|sample| sample.deflections[kind][0] / PAPER_LENGTH);
        let phase = |sample: usize| TAU * sample as f64 / f64::from(SAMPLES);
        let mean = signal.iter().sum::<f64>() / f64::from(SAMPLES);
        let part = |wave: fn(f64) -> f64| {
            let sum: f64 = signal.iter().enumerate().map(|(index, value)| value * wave(phase(index))).sum();
            2.0 * sum / f64::from(SAMPLES)
        };
        let (sine, cosine) = (part(f64::sin), part(f64::cos));
        ELLIPSE.check(sine.hypot(cosine) - amplitude);
        let rest = signal
            .iter()
            .enumerate()
            .map(|(index, value)| (value - mean - sine * phase(index).sin() - cosine * phase(index).cos()).abs());
        ELLIPSE_PURITY.check(rest.fold(0.0, f64::max));
    }
}

/// Rigid ratio of eq. 4, 2 r_c cos(alpha) / r_bs.
fn ratio(joint: &JointParameters) -> f64 {
    let geometry = &joint.geometry;
    2.0 * geometry.carrier_radius * geometry.working_pressure_angle.cos() / geometry.sun_base_radius
}

/// Torques under which the rigid body does not accelerate.
fn balanced(joint: &JointParameters, drive_torque: f64) -> Vec<TorqueSegment> {
    vec![TorqueSegment { from_tick: 0, drive_torque, load_torque: drive_torque * ratio(joint) }]
}

/// The joint settles at the static deflection of either flank, four half-backlashes apart.
#[test]
fn joint_settles_at_static_deflection() {
    let half_backlash = 60e-6;
    for law in [DampingLaw::Paper, DampingLaw::Contact] {
        let mut joint = paper_joint(0.0, 0.0, half_backlash, 0.0);
        joint.damping_law = law;
        joint.ring_planet.mean_stiffness = 1.6e8;
        let settled = |drive_torque: f64| {
            let mut scenario = free(joint.clone(), RelativeState::centred(3));
            scenario.torques = balanced(&joint, drive_torque);
            run_at(&scenario, &[0.1]).expect("the joint settles").samples.remove(0)
        };
        let sun_radius = joint.geometry.sun_base_radius;
        let force = 80.0 / (3.0 * sun_radius);
        let (drive, back) = (settled(80.0), settled(-80.0));
        for (side, sample) in [(1.0, &drive), (-1.0, &back)] {
            for planet in 0..3 {
                STATIC.check((sample.deflections[0][planet] - side * (half_backlash + force / 1e8)) / PAPER_LENGTH);
                STATIC.check((sample.deflections[1][planet] - side * (half_backlash + force / 1.6e8)) / PAPER_LENGTH);
            }
            let gap = side * (2.0 * half_backlash + force * (1.0 / 1e8 + 1.0 / 1.6e8));
            STATIC.check((sample.gap - gap) / PAPER_LENGTH);
        }
        let elastic = 2.0 * force * (1.0 / 1e8 + 1.0 / 1.6e8) / sun_radius;
        let lost_motion = (drive.motor_angle - drive.link_angle * ratio(&joint))
            - (back.motor_angle - back.link_angle * ratio(&joint));
        STATIC.check((lost_motion - elastic - 4.0 * half_backlash / sun_radius) * sun_radius / PAPER_LENGTH);
    }
}

/// A static load winds the compliance up by torque over stiffness.
#[test]
fn static_load_winds_up_the_compliance() {
    let mut joint = q1();
    // Far more damping than Q1's, so that the joint settles soon.
    joint.compliance.as_mut().expect("Q1 is compliant").damping_ratio = 2.0;
    let mut scenario = free(joint.clone(), RelativeState::centred(3));
    scenario.torques = balanced(&joint, 1.0);
    let sample = run_at(&scenario, &[0.3]).expect("the joint settles").samples.remove(0);
    let lever = joint.geometry.carrier_radius * joint.geometry.working_pressure_angle.cos();
    let stiffness = joint.compliance.expect("Q1 is compliant").stiffness;
    STATIC.check((sample.wind_up / lever - 6.0 / stiffness) * lever / PAPER_LENGTH);
}
