//! Implicit trapezoidal rule with an active set: contacts at the end of the step are guessed, the resulting linear equations solved, and
//! the guess corrected until it is consistent. Planets couple only through sun and carrier, so the system is two by two; kinks inside the
//! step are not located.

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push, acceleration};
use crate::instant::{Instant, PerMesh, Rotor};
use crate::motion::{Coordinates, PeerState};
use crate::plant::Plant;
use crate::scheme::{Phases, Scheme};

/// Largest number of guesses in a step: the remaining error is a contact about to change anyway.
const GUESSES_MAX: usize = 4;

/// The method with the data kept for the next step.
#[derive(Debug, Clone, Copy)]
pub struct Trapezoid<T, const N: usize> {
    /// One where teeth were in contact at the end of the last step, else zero.
    closed: PerMesh<T, N>,
    /// Contact offset: b on the drive side, -b on the back side, zero where open.
    offset: PerMesh<T, N>,
    /// Accelerations at the end of the last step, while torques do not change.
    last: Option<Coordinates<T, N>>,
}

/// One mesh at the end of the step: force = given + per_acceleration * its acceleration.
#[derive(Clone, Copy)]
struct LinearForce<T> {
    given: T,
    per_acceleration: T,
}

/// Acceleration of the carrier and the bodies attached to it, from the sum of mesh forces: given + per_force * sum.
struct Carrier<T> {
    given: T,
    per_force: T,
    wind_up: LinearForce<T>,
}

impl<T: Real, const N: usize> Scheme<T, N> for Trapezoid<T, N> {
    const MIDDLE: bool = false;

    fn begin(_: &Plant<T, N>, _: &Rotor<T>) -> Self {
        Self { closed: [[T::ZERO; N]; 2], offset: [[T::ZERO; N]; 2], last: None }
    }

    fn set_torques(&mut self, _: &Plant<T, N>, _: &Push<T>) {
        self.last = None;
    }

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    ) {
        let before = match self.last {
            Some(before) => before,
            None => {
                let now = Instant::at(plant, phases.start);
                acceleration::<T, N, L, COMPLIANT>(plant, push, &now, &motion.position, &motion.rate)
            }
        };
        let now = Instant::at(plant, phases.end);
        let half = plant.step * T::HALF;
        let rate = motion.rate.plus::<COMPLIANT>(half, &before);
        // x + h (v + v1) / 2 with v1 = v + h (a + a1) / 2, without the share of a1.
        let position = motion.position.plus::<COMPLIANT>(half, &motion.rate).plus::<COMPLIANT>(half, &rate);
        let predicted = PeerState { position, rate };
        for _ in 0..GUESSES_MAX {
            let after = self.solve::<L, COMPLIANT>(plant, push, &now, &predicted);
            *motion = PeerState {
                position: position.plus::<COMPLIANT>(half * half, &after),
                rate: rate.plus::<COMPLIANT>(half, &after),
            };
            self.last = Some(after);
            if self.correct_contacts::<L>(plant, &now, motion) {
                break;
            }
        }
    }
}

impl<T: Real, const N: usize> Trapezoid<T, N> {
    /// Accelerations at the end under the guessed contacts.
    #[inline(always)]
    fn solve<L: ForceLaw<T>, const COMPLIANT: bool>(
        &self,
        plant: &Plant<T, N>,
        push: &Push<T>,
        now: &Instant<T, N>,
        predicted: &PeerState<T, N>,
    ) -> Coordinates<T, N> {
        let half = plant.step * T::HALF;
        let mesh = |kind: usize, i: usize, position: T, rate: T| {
            let closed = self.closed[kind][i];
            let stiffness = closed * now.stiffness[kind][i];
            let damping = if L::PUSHES_ONLY { closed * plant.damping[kind] } else { plant.damping[kind] };
            let overlap = position - now.error[kind][i] - self.offset[kind][i];
            LinearForce {
                given: stiffness * overlap + damping * (rate - now.error_rate[kind][i]),
                per_acceleration: half * (half * stiffness + damping),
            }
        };
        let PeerState { position, rate } = predicted;
        let mut inverse = [T::ZERO; N];
        let mut driven = [T::ZERO; N];
        let mut by_gap = [T::ZERO; N];
        // Sums of forces: given, per unit of (sun - carrier) acceleration, per unit of gap acceleration.
        let (mut sun, mut ring) = ([T::ZERO; 3], [T::ZERO; 3]);
        for i in 0..N {
            let planet = position.planets[i];
            let planet_rate = rate.planets[i];
            let near = mesh(0, i, planet, planet_rate);
            let far = mesh(1, i, position.gap - planet, rate.gap - planet_rate);
            inverse[i] = T::ONE / (T::ONE + plant.planet * (near.per_acceleration + far.per_acceleration));
            driven[i] = inverse[i] * plant.planet * (far.given - near.given);
            by_gap[i] = inverse[i] * plant.planet * far.per_acceleration;
            sun[0] += near.given + near.per_acceleration * driven[i];
            sun[1] += near.per_acceleration * inverse[i];
            sun[2] += near.per_acceleration * by_gap[i];
            ring[0] += far.given - far.per_acceleration * driven[i];
            ring[1] += -(far.per_acceleration * inverse[i]);
            ring[2] += far.per_acceleration * (T::ONE - by_gap[i]);
        }
        let carrier = Self::carrier::<COMPLIANT>(plant, push, predicted);
        let (apart, gap) = (push.sun - carrier.given, push.sun - carrier.given - carrier.given);
        let (pulled, twice) = (plant.sun + carrier.per_force, carrier.per_force + carrier.per_force);
        let gap_pulled = plant.sun + twice;
        // Both sums occur on both sides: two equations.
        let sun_row = [
            T::ONE + sun[1] * pulled + sun[2] * gap_pulled,
            sun[1] * carrier.per_force + sun[2] * twice,
            sun[0] + sun[1] * apart + sun[2] * gap,
        ];
        let ring_row = [
            ring[1] * pulled + ring[2] * gap_pulled,
            T::ONE + ring[1] * carrier.per_force + ring[2] * twice,
            ring[0] + ring[1] * apart + ring[2] * gap,
        ];
        let determinant = T::ONE / (sun_row[0] * ring_row[1] - sun_row[1] * ring_row[0]);
        let sun_sum = determinant * (sun_row[2] * ring_row[1] - sun_row[1] * ring_row[2]);
        let ring_sum = determinant * (sun_row[0] * ring_row[2] - sun_row[2] * ring_row[0]);
        let carrier_acceleration = carrier.given + carrier.per_force * (sun_sum + ring_sum);
        let apart = push.sun - plant.sun * sun_sum - carrier_acceleration;
        let gap = apart - carrier_acceleration;
        let mut planets = [T::ZERO; N];
        for i in 0..N {
            planets[i] = inverse[i] * apart + driven[i] + by_gap[i] * gap;
        }
        let mut wind_up = T::ZERO;
        if COMPLIANT {
            let force = carrier.wind_up.given + carrier.wind_up.per_acceleration * (sun_sum + ring_sum);
            wind_up = carrier_acceleration - (push.link + plant.link * force);
        }
        Coordinates { planets, gap, wind_up }
    }

    #[inline(always)]
    fn carrier<const COMPLIANT: bool>(plant: &Plant<T, N>, push: &Push<T>, predicted: &PeerState<T, N>) -> Carrier<T> {
        if !COMPLIANT {
            let wind_up = LinearForce { given: T::ZERO, per_acceleration: T::ZERO };
            return Carrier { given: push.carrier, per_force: plant.carrier, wind_up };
        }
        let half = plant.step * T::HALF;
        let [stiffness, damping] = plant.wind_up;
        let per_acceleration = half * (half * stiffness + damping);
        let given = stiffness * predicted.position.wind_up + damping * predicted.rate.wind_up;
        let inverse = T::ONE / (T::ONE + per_acceleration * (plant.carrier + plant.link));
        let wind_up = LinearForce {
            given: inverse * (given + per_acceleration * (push.carrier - push.link)),
            per_acceleration: inverse * per_acceleration * plant.carrier,
        };
        Carrier {
            given: push.carrier - plant.carrier * wind_up.given,
            per_force: plant.carrier * (T::ONE - wind_up.per_acceleration),
            wind_up,
        }
    }

    /// Sets the contacts from the end of the step; returns true if the guess was right.
    #[inline(always)]
    fn correct_contacts<L: ForceLaw<T>>(
        &mut self,
        plant: &Plant<T, N>,
        now: &Instant<T, N>,
        end: &PeerState<T, N>,
    ) -> bool {
        let mut held = true;
        for kind in 0..2 {
            for i in 0..N {
                let of = |values: &Coordinates<T, N>| match kind {
                    0 => values.planets[i],
                    _ => values.gap - values.planets[i],
                };
                let deflection = of(&end.position) - now.error[kind][i];
                let half_backlash = plant.meshes[kind][i].half_backlash;
                let (mut closed, mut offset) = if deflection > half_backlash {
                    (T::ONE, half_backlash)
                } else if deflection < -half_backlash {
                    (T::ONE, -half_backlash)
                } else {
                    (T::ZERO, T::ZERO)
                };
                if L::PUSHES_ONLY && closed > T::ZERO {
                    let speed = of(&end.rate) - now.error_rate[kind][i];
                    let force = now.stiffness[kind][i] * (deflection - offset) + plant.damping[kind] * speed;
                    let pulls = if deflection < T::ZERO { force >= T::ZERO } else { force <= T::ZERO };
                    if pulls {
                        (closed, offset) = (T::ZERO, T::ZERO);
                    }
                }
                if closed != self.closed[kind][i] || offset != self.offset[kind][i] {
                    held = false;
                    self.closed[kind][i] = closed;
                    self.offset[kind][i] = offset;
                }
            }
        }
        held
    }
}
