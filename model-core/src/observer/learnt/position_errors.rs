//! What the deflection depends on by where the shafts are: the encoders' error maps and the gears' transmission error.
//! Found exactly once an interval, and by slopes in between, for sines are too dear for every period.

use super::learner::Learner;
use super::regressors::{MAP, MAPPED, PLAIN, Regressors};
use crate::numbers::Real;

/// What depends on where the shafts are.
#[derive(Debug, Clone, Copy)]
pub struct PositionErrors<T: Real, const P: usize> {
    /// Regressors of teeth that do not touch, in the middle of the interval.
    pub free: Regressors<T, P>,
    /// Sine and cosine of the mesh phase then.
    pub mesh_then: [T; 2],
    /// The same now.
    pub mesh: [T; 2],
    /// What the errors of motor and output encoder add to the deflection now [m].
    pub errors: [T; 2],
    /// What a radian of motor and output adds to that [m/rad].
    slopes: [T; 2],
    /// How far motor and mesh phase have turned since they were found exactly [rad].
    turned: T,
}

impl<T: Real, const P: usize> PositionErrors<T, P> {
    /// Turn of motor and mesh phase beyond which slopes are too far off [rad]: at a quarter of a radian the error maps'
    /// second harmonic, at twice the angle, is off by an eighth of itself.
    const FAR: T = T::QUARTER;

    /// A constant, so that the compiler writes it to its place instead of copying one from the stack.
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

    /// Both shafts have turned by so much [rad], with so many mesh periods in a turn of the output. True when that was too
    /// far for slopes.
    pub fn go_on(&mut self, motor: T, output: T, meshes: T) -> bool {
        if P == MAPPED {
            let [of_motor, of_output] = &mut self.errors;
            *of_motor += self.slopes[0] * motor;
            *of_output += self.slopes[1] * output;
        }
        // Turned in two halves, each by the newest of the other: the amplitude stays.
        let angle = meshes * output;
        let [sine, cosine] = &mut self.mesh;
        *sine += *cosine * angle;
        *cosine -= *sine * angle;
        self.turned += motor.abs() + angle.abs();
        self.turned > Self::FAR
    }

    /// What the encoders' errors add to the deflection, at the regressors.
    fn errors_of(learner: &Learner<T, P>, free: &Regressors<T, P>) -> [T; 2] {
        [PLAIN, PLAIN + MAP].map(|from| {
            let values = learner.values.iter().skip(from).take(MAP);
            values.zip(free.iter().skip(from)).fold(T::ZERO, |sum, (value, regressor)| sum + *value * *regressor)
        })
    }

    /// Does something to the learner, and follows it.
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

    /// Takes errors that were found exactly.
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
