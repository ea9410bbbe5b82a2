//! Fig. 3: the rectangular stiffness wave, its duty from the contact ratio, and its first harmonic, eq. 7.

use model_core::gears::StiffnessSeries;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use parameters::{JointParameters, StiffnessWave};

use super::record::StiffnessFigure;

/// Points of a curve.
const POINTS: usize = 720;

/// Harmonics of the third curve.
const HARMONICS: usize = 8;

/// Periods drawn.
const PERIODS: f64 = 2.0;

/// The wave of the sun-planet mesh. A file that gives the harmonic wave of eq. 7 is taken at its word, and the
/// rectangle that has it for its first harmonic is drawn.
pub fn figure(joint: &JointParameters) -> StiffnessFigure {
    let wave = joint.sun_planet.stiffness_wave;
    let (contact_ratio, source, rectangular_ratio) = match wave {
        StiffnessWave::Rectangular { stiffness_ratio, contact_ratio, .. } => {
            (contact_ratio, "joint file".to_owned(), stiffness_ratio)
        }
        StiffnessWave::Harmonic { stiffness_ratio } => {
            let contact_ratio = contact_ratio(joint);
            let duty = contact_ratio.fract();
            let source = "full-depth teeth (addendum of one module) on the file's radii".to_owned();
            (contact_ratio, source, stiffness_ratio * PI / (4.0 * (PI * duty).sin()))
        }
    };
    let duty = contact_ratio.fract();
    let series = StiffnessWave::Rectangular { stiffness_ratio: rectangular_ratio, contact_ratio, order: HARMONICS };
    let sum = |phase: f64, most: usize| {
        1.0 + (1..=most)
            .map(|harmonic| {
                let (sine, cosine) = series.coefficients(harmonic);
                let (s, c) = (harmonic as f64 * phase).sin_cos();
                sine * s + cosine * c
            })
            .sum::<f64>()
    };
    let high = |phase: f64| ((phase - FRAC_PI_2 + PI).rem_euclid(TAU) - PI).abs() < PI * duty;
    let level = |phase: f64| {
        let (up, down) = (2.0 * rectangular_ratio * (1.0 - duty), -2.0 * rectangular_ratio * duty);
        1.0 + if high(phase) { up } else { down }
    };
    let phase: Vec<f64> = (0..=POINTS).map(|index| PERIODS * index as f64 / POINTS as f64).collect();
    let curve = |f: &dyn Fn(f64) -> f64| phase.iter().map(|periods| f(TAU * periods)).collect::<Vec<f64>>();
    let (sine, cosine) = series.coefficients(1);
    StiffnessFigure {
        contact_ratio,
        contact_ratio_source: source,
        rectangular_ratio,
        first_harmonic_ratio: sine.hypot(cosine),
        rectangular: curve(&level),
        first_harmonic: curve(&|phase| sum(phase, 1)),
        eight_harmonics: curve(&|phase| sum(phase, HARMONICS)),
        phase,
    }
}

/// Contact ratio of sun and planet with full-depth teeth: the length of the line of action between the tip circles over
/// the base pitch.
pub fn contact_ratio(joint: &JointParameters) -> f64 {
    let geometry = &joint.geometry;
    let angle = geometry.working_pressure_angle;
    let base_pitch = TAU * geometry.sun_base_radius / f64::from(geometry.sun_teeth);
    let module = base_pitch / (PI * angle.cos());
    let beyond_base = |base_radius: f64| {
        let tip = base_radius / angle.cos() + module;
        (tip * tip - base_radius * base_radius).sqrt()
    };
    let (sun, planet) = (geometry.sun_base_radius, geometry.planet_base_radius);
    let length = beyond_base(sun) + beyond_base(planet) - (sun + planet) * angle.tan();
    // Teeth that could not hand over from one pair to the next, or always mesh in two pairs, make no wave at all.
    (length / base_pitch).clamp(1.05, 1.95)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> JointParameters {
        joint_file::read(joint_file::preset("paper").expect("a preset")).expect("a good file").parameters
    }

    #[test]
    fn paper_teeth_have_known_contact_ratio() {
        // Tip radii 43.5 and 55.5 mm, centres 93.0 mm apart, base pitch 8.5694 mm.
        assert!((contact_ratio(&paper()) - 1.4886).abs() < 2e-4, "{}", contact_ratio(&paper()));
    }

    #[test]
    fn first_harmonic_matches_the_rectangle() {
        let figure = figure(&paper());
        assert!((figure.first_harmonic_ratio - 0.1).abs() < 1e-12);
        // The Fourier integral of what is drawn, over one period.
        let samples = POINTS / 2;
        let (mut sine, mut mean) = (0.0, 0.0);
        for index in 0..samples {
            let phase = TAU * figure.phase[index];
            sine += 2.0 * figure.rectangular[index] * phase.sin() / samples as f64;
            mean += figure.rectangular[index] / samples as f64;
        }
        assert!((sine - 0.1).abs() < 1e-3 && (mean - 1.0).abs() < 1e-3, "{sine}, {mean}");
    }
}
