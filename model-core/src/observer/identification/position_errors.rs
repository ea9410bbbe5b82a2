//! Position-dependent parts of the deflection: the encoders' error maps and the transmission error. Computed exactly
//! once per interval and by slopes in between, as sines cost too much for every period.

use super::least_squares::LeastSquares;
use super::regressors::{MAP_PARAMETERS, MAPPED, PLAIN, Regressors};
use super::thresholds::EstimatorThresholds;
use crate::numbers::Real;
use crate::numbers::state_words::state_words;

/// Position-dependent parts of the deflection.
#[derive(Debug, Clone, Copy)]
pub struct PositionErrors<T: Real, const P: usize> {
    /// Regressors of an open gap, in the middle of the interval.
    pub open_gap: Regressors<T, P>,
    /// Sine and cosine of the mesh phase in the middle of the interval.
    pub mid_mesh: [T; 2],
    /// Sine and cosine of the mesh phase now.
    pub mesh: [T; 2],
    /// Deflection by the errors of motor and output encoder now [m].
    pub errors: [T; 2],
    /// Change of these errors per radian of motor and output [m/rad].
    slopes: [T; 2],
    /// Turn of motor and mesh phase since the last exact computation [rad].
    turned: T,
}
state_words! { struct PositionErrors<T, P> { open_gap, mid_mesh, mesh, errors, slopes, turned } }

impl<T: Real, const P: usize> PositionErrors<T, P> {
    const LIMITS: EstimatorThresholds<T> = EstimatorThresholds::TUNED;

    /// A constant: the compiler writes it in place instead of copying from the stack.
    pub const NEW: Self = Self {
        open_gap: [T::ZERO; P],
        mid_mesh: [T::ZERO, T::ONE],
        mesh: [T::ZERO, T::ONE],
        errors: [T::ZERO; 2],
        slopes: [T::ZERO; 2],
        turned: T::ZERO,
    };

    /// Advances the errors by the turn of both shafts [rad]; `meshes` is the number of mesh periods per output turn.
    /// Returns true once the turn is too far for slopes.
    pub fn advance(&mut self, motor: T, output: T, meshes: T) -> bool {
        if P == MAPPED {
            let [of_motor, of_output] = &mut self.errors;
            *of_motor += self.slopes[0] * motor;
            *of_output += self.slopes[1] * output;
        }
        // Each half of the rotation uses the newest value of the other component, which keeps the amplitude.
        let angle = meshes * output;
        let [sine, cosine] = &mut self.mesh;
        *sine += *cosine * angle;
        *cosine -= *sine * angle;
        self.turned += motor.abs() + angle.abs();
        self.turned > Self::LIMITS.slope_angle
    }

    /// Deflection by the encoders' errors at given regressors [m].
    fn errors_at(least_squares: &LeastSquares<T, P>, open_gap: &Regressors<T, P>) -> [T; 2] {
        [PLAIN, PLAIN + MAP_PARAMETERS].map(|from| {
            let values = least_squares.values.iter().skip(from).take(MAP_PARAMETERS);
            values.zip(open_gap.iter().skip(from)).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
        })
    }

    /// Updates the parameters and adjusts the errors to its new parameters.
    pub fn update_parameters(
        &mut self,
        least_squares: &mut LeastSquares<T, P>,
        update: impl FnOnce(&mut LeastSquares<T, P>),
    ) {
        if P != MAPPED {
            return update(least_squares);
        }
        let before = Self::errors_at(least_squares, &self.open_gap);
        update(least_squares);
        let after = Self::errors_at(least_squares, &self.open_gap);
        for ((error, before), after) in self.errors.iter_mut().zip(before).zip(after) {
            *error += after - before;
        }
    }

    /// Takes over an exact computation.
    pub fn set_exact(&mut self, least_squares: &LeastSquares<T, P>, open_gap: &Regressors<T, P>, mesh: [T; 2]) {
        self.mesh = mesh;
        self.turned = T::ZERO;
        if P == MAPPED {
            self.errors = Self::errors_at(least_squares, open_gap);
            let (harmonics, _) = open_gap.get(PLAIN..).unwrap_or_default().as_chunks::<MAP_PARAMETERS>();
            let (values, _) = least_squares.values.get(PLAIN..).unwrap_or_default().as_chunks::<MAP_PARAMETERS>();
            for ((slope, harmonics), values) in self.slopes.iter_mut().zip(harmonics).zip(values) {
                let ([sine, cosine, sine_twice, cosine_twice], [a, b, c, d]) = (*harmonics, *values);
                *slope = a * cosine - b * sine + T::TWO * (c * cosine_twice - d * sine_twice);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::learner;

    /// Least squares whose motor map is 1 um sin, at a motor phase of zero.
    fn mapped() -> (LeastSquares<f32, MAPPED>, Regressors<f32, MAPPED>) {
        let mut least_squares = LeastSquares::UNINITIALIZED;
        least_squares.reset(&learner());
        least_squares.values[PLAIN] = 1e-6;
        let mut open_gap = [0.0; MAPPED];
        (open_gap[PLAIN + 1], open_gap[PLAIN + 3]) = (1.0, 1.0);
        (least_squares, open_gap)
    }

    #[test]
    fn turn_beyond_limit_needs_exact_errors() {
        let mut errors = PositionErrors::<f32, MAPPED>::NEW;
        assert!(!errors.advance(0.2, 0.0, 90.0));
        assert!(!errors.advance(-0.04, 0.0, 90.0));
        assert!(errors.advance(0.0, 2e-4, 90.0), "a mesh phase of 0.018 rad more");
    }

    #[test]
    fn slope_follows_map() {
        let (least_squares, open_gap) = mapped();
        let mut errors = PositionErrors::NEW;
        errors.set_exact(&least_squares, &open_gap, [0.0, 1.0]);
        errors.advance(0.1, 0.0, 90.0);
        assert!((errors.errors[0] - 0.1e-6).abs() < 1e-12, "{:?}", errors.errors);
        errors.set_exact(&least_squares, &open_gap, [0.0, 1.0]);
        assert_eq!(errors.errors[0], 0.0);
    }

    #[test]
    fn mesh_phase_keeps_amplitude() {
        let mut errors = PositionErrors::<f32, MAPPED>::NEW;
        (0..10_000).for_each(|_| _ = errors.advance(0.0, 1e-3, 90.0));
        let [sine, cosine] = errors.mesh;
        assert!((sine * sine + cosine * cosine - 1.0).abs() < 0.1);
    }
}
