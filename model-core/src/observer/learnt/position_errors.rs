//! Position-dependent parts of the deflection: the encoders' error maps and the transmission error. Computed exactly
//! once per interval and by slopes in between, as sines cost too much for every period.

use super::learner::Learner;
use super::regressors::{MAP, MAPPED, PLAIN, Regressors};
use crate::numbers::Real;

/// Position-dependent parts of the deflection.
#[derive(Debug, Clone, Copy)]
pub struct PositionErrors<T: Real, const P: usize> {
    /// Regressors of an open gap, in the middle of the interval.
    pub free: Regressors<T, P>,
    /// Sine and cosine of the mesh phase in the middle of the interval.
    pub mesh_then: [T; 2],
    /// Sine and cosine of the mesh phase now.
    pub mesh: [T; 2],
    /// Deflection by the errors of motor and output encoder now [m].
    pub errors: [T; 2],
    /// Change of these errors per radian of motor and output [m/rad].
    slopes: [T; 2],
    /// Turn of motor and mesh phase since the last exact computation [rad].
    turned: T,
}

impl<T: Real, const P: usize> PositionErrors<T, P> {
    /// Turn of motor and mesh phase up to which slopes are used [rad]: at a quarter of a radian the error maps' second
    /// harmonic, at twice the angle, is off by an eighth of itself.
    const FAR: T = T::QUARTER;

    /// A constant: the compiler writes it in place instead of copying from the stack.
    const NEW: Self = Self {
        free: [T::ZERO; P],
        mesh_then: [T::ZERO, T::ONE],
        mesh: [T::ZERO, T::ONE],
        errors: [T::ZERO; 2],
        slopes: [T::ZERO; 2],
        turned: T::ZERO,
    };

    #[inline(always)]
    pub fn new() -> Self {
        Self::NEW
    }

    /// Advances the errors by the turn of both shafts [rad]; `meshes` is the number of mesh periods per output turn.
    /// Returns true once the turn is too far for slopes.
    pub fn go_on(&mut self, motor: T, output: T, meshes: T) -> bool {
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
        self.turned > Self::FAR
    }

    /// Deflection by the encoders' errors at given regressors [m].
    fn errors_of(learner: &Learner<T, P>, free: &Regressors<T, P>) -> [T; 2] {
        [PLAIN, PLAIN + MAP].map(|from| {
            let values = learner.values.iter().skip(from).take(MAP);
            values.zip(free.iter().skip(from)).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
        })
    }

    /// Changes the learner and adjusts the errors to its new parameters.
    pub fn relearn(&mut self, learner: &mut Learner<T, P>, work: impl FnOnce(&mut Learner<T, P>)) {
        if P != MAPPED {
            return work(learner);
        }
        let before = Self::errors_of(learner, &self.free);
        work(learner);
        let after = Self::errors_of(learner, &self.free);
        for ((error, before), after) in self.errors.iter_mut().zip(before).zip(after) {
            *error += after - before;
        }
    }

    /// Takes over an exact computation.
    pub fn put(&mut self, learner: &Learner<T, P>, free: &Regressors<T, P>, mesh: [T; 2]) {
        self.mesh = mesh;
        self.turned = T::ZERO;
        if P == MAPPED {
            self.errors = Self::errors_of(learner, free);
            let (places, _) = free.get(PLAIN..).unwrap_or_default().as_chunks::<MAP>();
            let (values, _) = learner.values.get(PLAIN..).unwrap_or_default().as_chunks::<MAP>();
            for ((slope, places), values) in self.slopes.iter_mut().zip(places).zip(values) {
                let ([sine, cosine, sine_twice, cosine_twice], [a, b, c, d]) = (*places, *values);
                *slope = a * cosine - b * sine + T::TWO * (c * cosine_twice - d * sine_twice);
            }
        }
    }
}
