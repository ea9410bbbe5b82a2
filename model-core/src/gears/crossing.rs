//! Crossing correction (S10): corrects a sub-step in which meshes parted or met, from the state at the end of the sub-step
//! alone (in-step correction of a switched right-hand side: R. M. Howe, Dynamics of Real-Time Simulation, ch. 11). A mesh
//! that leaves its flank and returns within the sub-step is not detected.
//!
//! From the crossing on, a time s (`since`) before the end, the fixed contact law misses a force m (`Missed::path`). Near
//! the end m(t) is known to second order, so the integrals of m over s are closed forms; they correct rate and position.
//! The corrections also deform the other meshes: one linear pass adds the forces of this deformation.

use crate::gears::contact::{Law, Laws, NetForces};
use crate::gears::excitation::{PerMesh, PhaseHarmonics};
use crate::gears::fixed_contact_set::{FixedContactSet, MeshState};
use crate::gears::planets::each_planet;
use crate::gears::stages::SubstepState;
use crate::numbers::Real;

/// End of a sub-step with a fixed contact set.
pub struct StepEnd<'a, T: Real, const N: usize, const OVERTONES: usize> {
    /// The joint.
    pub fixed: &'a FixedContactSet<'a, T, N, OVERTONES>,
    /// Advance of the mesh phase per sub-step [rad].
    pub rate: T,
    /// Harmonics of the mesh phase at the end of the sub-step.
    pub harmonics_now: &'a PhaseHarmonics<T, OVERTONES>,
    /// Violation of each mesh's law: positive if the law no longer holds.
    pub violations: &'a PerMesh<T, N>,
}

impl<T: Real, const N: usize, const OVERTONES: usize> StepEnd<'_, T, N, OVERTONES> {
    /// Corrects the motion for every violated law. The accelerations `now` and `before` become the accelerations by the new
    /// laws on the unchanged path.
    #[inline(never)]
    pub fn correct(&self, laws: &mut Laws<T, N>, state: &mut SubstepState<T, N>) {
        let tables = self.fixed.tables;
        let (mut impulse, mut shift, mut jump, mut past) =
            (NetForces::NONE, NetForces::NONE, NetForces::NONE, NetForces::NONE);
        let mut longest = T::ZERO;
        let mut add = |mesh: (usize, usize), missed: &Missed<T>| {
            impulse.add_one(mesh, missed.impulse);
            shift.add_one(mesh, missed.shift);
            jump.add_one(mesh, missed.path.value);
            past.add_one(mesh, missed.path.at(T::HALF));
            if missed.since > longest {
                longest = missed.since;
            }
        };
        each_planet!(N, i => {
            if self.violations[0][i] > T::ZERO {
                add((0, i), &self.cross((0, i), laws, state));
            }
            if self.violations[1][i] > T::ZERO {
                add((1, i), &self.cross((1, i), laws, state));
            }
        });
        let mobility = &tables.stage.mobility;
        let (rate, position) = (impulse.response(mobility, T::ZERO), shift.response(mobility, T::ZERO));
        // Forces by the corrections in all meshes. They act from now on (`jump`) and have acted since the crossing (`later`):
        // the damping force integrates to damping times the shift, the spring force to about s/4 times stiffness times the
        // shift, because the shift grew with the third power of time. Ripple is neglected.
        let quarter = T::QUARTER * longest;
        let mut later = NetForces::NONE;
        for i in 0..N {
            let (sun, sun_rate) = (position.planets[i], rate.planets[i]);
            for (kind, moved, moving) in [(0, sun, sun_rate), (1, position.gap - sun, rate.gap - sun_rate)] {
                let law = &laws[kind][i];
                let stiffness = law.closed * tables.springs[kind].stiffness;
                jump.add_one((kind, i), stiffness * moved + law.damping * moving);
                later.add_one((kind, i), T::SIX * (quarter * stiffness + law.damping) * moved);
            }
        }
        let wind_up = mobility.wind_up_stiffness * position.wind_up;
        let jump = jump.response(mobility, wind_up + mobility.wind_up_damping * rate.wind_up);
        let wind_up = quarter * wind_up + mobility.wind_up_damping * position.wind_up;
        let later = later.response(mobility, T::SIX * wind_up);
        state.for_each(&position, |coordinate, position| coordinate.position += position);
        state.for_each(&rate, |coordinate, rate| coordinate.rate += rate);
        state.for_each(&later, |coordinate, later| coordinate.rate += later);
        state.for_each(&jump, |coordinate, jump| coordinate.now += jump);
        state.for_each(&past.response(mobility, T::ZERO), |coordinate, past| coordinate.before += past);
    }

    /// Replaces the law of one mesh by the law that holds; returns the force that the old law missed.
    #[inline(never)]
    fn cross(&self, (kind, i): (usize, usize), laws: &mut Laws<T, N>, state: &SubstepState<T, N>) -> Missed<T> {
        let tables = self.fixed.tables;
        let planet = state.planets[i];
        let (mut at, mut acceleration) = (planet.point(), planet.now);
        if kind == 1 {
            (at, acceleration) = (state.gap.point().minus(at), state.gap.now - acceleration);
        }
        let was = laws[kind][i];
        let MeshState { overlap: deflection, speed, stiffness, error, .. } =
            self.fixed.mesh(&Law::OPEN, (kind, i), self.harmonics_now, at);
        let is = Law::at_deflection(tables, (kind, i), deflection, speed, stiffness);
        laws[kind][i] = is;
        // Without backlash both flanks have the same law.
        if was.closed == is.closed && was.offset == is.offset {
            return Missed::NOTHING;
        }
        let stiffness_rate = tables.meshes[kind][i].stiffness_rate(self.harmonics_now, tables.excitation.harmonics);
        // e'' = -rate^2 e for the sine of eq. 11.
        let acceleration = T::SIX * acceleration + self.rate * self.rate * error;
        // Damping that acts in every contact state (law `paper`) is not missed.
        let base = self.fixed.paper_law * tables.stage.damping[kind];
        let mesh = Crossing { deflection, speed, acceleration, stiffness, stiffness_rate, base };
        mesh.missed(&was, &is)
    }
}

/// One mesh at the end of a sub-step, on the path under the fixed laws.
struct Crossing<T> {
    deflection: T,
    speed: T,
    acceleration: T,
    stiffness: T,
    stiffness_rate: T,
    base: T,
}

/// Force that a fixed law missed, and its integrals.
struct Missed<T> {
    /// Six times the integral of the force since the crossing.
    impulse: T,
    /// Six times the double integral of the force since the crossing.
    shift: T,
    /// Missed force along the path, as if the force had always acted.
    path: Path<T>,
    /// Time s since the crossing, in sub-steps.
    since: T,
}

/// Quantity near the end of a sub-step: value, rate and acceleration at the end.
#[derive(Clone, Copy)]
struct Path<T> {
    value: T,
    rate: T,
    acceleration: T,
}

impl<T: Real> Crossing<T> {
    #[inline(always)]
    fn missed(&self, before: &Law<T>, after: &Law<T>) -> Missed<T> {
        let (was_closed, is_closed) = (before.closed > T::ZERO, after.closed > T::ZERO);
        let mut missed = Missed::NOTHING;
        if was_closed {
            let force = self.force(before);
            let gone = Path { value: -force.value, rate: -force.rate, acceleration: -force.acceleration };
            missed.add(gone, force.since_zero());
        }
        if is_closed {
            let force = self.force(after);
            // Contact began when the surfaces met; if the surfaces overlapped already, when the force changed its sign.
            let met = self.overlap(after).since_zero();
            missed.add(force, if met < T::ONE { met } else { force.since_zero() });
        }
        missed
    }

    fn overlap(&self, law: &Law<T>) -> Path<T> {
        Path { value: self.deflection - law.offset, rate: self.speed, acceleration: self.acceleration }
    }

    /// Contact force under a law minus the damping of every contact state; the damping force of the jerk is neglected.
    fn force(&self, law: &Law<T>) -> Path<T> {
        let damping = law.damping - self.base;
        let overlap = self.overlap(law);
        Path {
            value: self.stiffness * overlap.value + damping * overlap.rate,
            rate: self.stiffness * overlap.rate + self.stiffness_rate * overlap.value + damping * overlap.acceleration,
            acceleration: self.stiffness * overlap.acceleration + T::TWO * self.stiffness_rate * overlap.rate,
        }
    }
}

impl<T: Real> Path<T> {
    /// Returns the value at a time before the end.
    fn at(&self, earlier: T) -> T {
        self.value - earlier * (self.rate - T::HALF * earlier * self.acceleration)
    }

    /// Returns the time between the zero of the path and the end, by a secant and one Newton step, limited to the sub-step. A
    /// path that does not point away from zero returns the whole sub-step, over which it is small.
    fn since_zero(&self) -> T {
        let sign = if self.value < T::ZERO { -T::ONE } else { T::ONE };
        let (value, rate, acceleration) = (sign * self.value, sign * self.rate, sign * self.acceleration);
        if rate <= T::ZERO {
            return T::ONE;
        }
        // With rate > value >= 0 the quotient is within the sub-step.
        let guess = if value < rate { value / rate } else { T::ONE };
        let slope = rate - guess * acceleration;
        // Below half the secant's slope the parabola turns within the sub-step, and the secant is more accurate.
        if slope + slope < rate {
            return guess;
        }
        let rest = value - guess * (rate - T::HALF * guess * acceleration);
        let refined = guess + rest / slope;
        if refined < T::ZERO {
            T::ZERO
        } else if refined < T::ONE {
            refined
        } else {
            T::ONE
        }
    }
}

impl<T: Real> Missed<T> {
    const NOTHING: Self = Self {
        impulse: T::ZERO,
        shift: T::ZERO,
        path: Path { value: T::ZERO, rate: T::ZERO, acceleration: T::ZERO },
        since: T::ZERO,
    };

    /// Adds a force that has acted for the time `since`.
    fn add(&mut self, path: Path<T>, since: T) {
        let Path { value, rate, acceleration } = path;
        let s = since;
        // Six times the integrals: forces respond in sixths.
        self.impulse += s * (T::SIX * value - s * (T::THREE * rate - s * acceleration));
        self.shift += s * s * (T::THREE * value - s * (T::TWO * rate - T::SIX * T::EIGHTH * s * acceleration));
        self.path.value += value;
        self.path.rate += rate;
        self.path.acceleration += acceleration;
        if since > self.since {
            self.since = since;
        }
    }
}
