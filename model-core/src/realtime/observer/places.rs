//! What the way depends on by where the shafts are: the encoders' error maps and the gears' transmission error. Found
//! exactly once an interval, and by slopes in between, for sines are too dear for every period.

use super::learner::{Learner, Regressors};
use super::motion::magnitude;
use super::regressors::{self, MAP, SKEW};
use super::{MAPPED, Observer, PLAIN};
use crate::real::Real;
use crate::realtime::phase::sine_cosine;

/// What depends on places.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places<T: Real, const P: usize> {
    /// Regressors of teeth that do not touch, in the middle of the interval.
    pub free: Regressors<T, P>,
    /// Sine and cosine of the mesh phase then.
    pub mesh_then: [T; 2],
    /// The same now.
    pub mesh: [T; 2],
    /// What the errors of motor and output encoder add to the way now [m].
    pub errors: [T; 2],
    /// What a radian of motor and output adds to that [m/rad].
    slopes: [T; 2],
    /// How far motor and mesh phase have turned since the places were found [rad].
    turned: T,
}

impl<T: Real, const P: usize> Places<T, P> {
    pub fn new() -> Self {
        Self {
            free: [T::ZERO; P],
            mesh_then: [T::ZERO, T::ONE],
            mesh: [T::ZERO, T::ONE],
            errors: [T::ZERO; 2],
            slopes: [T::ZERO; 2],
            turned: T::ZERO,
        }
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
        self.turned += magnitude(motor) + magnitude(angle);
        self.turned > T::QUARTER
    }

    /// What the encoders' errors add to the way, at the regressors.
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

    /// Takes exact places.
    fn put(&mut self, learner: &Learner<T, P>, free: &Regressors<T, P>, mesh: [T; 2]) {
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

impl<T: Real, const P: usize> Observer<'_, T, P> {
    /// Finds exactly where the shafts are.
    pub(super) fn find_places(&mut self) {
        let (free, mesh) = self.exact_places();
        self.places.put(&self.learner, &free, mesh);
    }

    /// The same in the middle of an interval: what is learnt from it was there.
    pub(super) fn keep_places(&mut self) {
        let (free, mesh) = self.exact_places();
        self.places.put(&self.learner, &free, mesh);
        self.places.free = free;
        self.places.mesh_then = mesh;
    }

    fn exact_places(&self) -> (Regressors<T, P>, [T; 2]) {
        let table = &self.tables.counts;
        let (output, _) = self.counts.used();
        let both = self.supervisor.sees_both();
        let link_speed = if both { self.load.speed } else { T::ZERO };
        let output_phase = output.phase(&table.output);
        let free = regressors::free(link_speed, self.counts.motor.phase(&table.motor), both.then_some(output_phase));
        let (sine, cosine) = sine_cosine(output_phase.wrapping_mul(table.meshes));
        (free, [sine, cosine])
    }

    /// Way that everything but the teeth makes now [m].
    pub(super) fn beside_teeth(&self) -> T {
        let speed = if self.supervisor.sees_both() { self.load.speed } else { T::ZERO };
        let plain = self.learner.value(regressors::OFFSET) + self.learner.value(SKEW) * speed;
        if P == MAPPED { plain + self.places.errors[0] + self.places.errors[1] } else { plain }
    }
}
