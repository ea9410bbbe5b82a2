//! The paper's scheme: one constant exponential of the closed joint at mean stiffness, with dead zone, ripple and errors as a pseudo-force
//! held over the step (exponential time differencing of first order). The exponential is applied to the mean of the planets and to each
//! planet's deviation from it, which is the same product with 16 + 4n numbers for n planets instead of 4 (n + 1)^2.

use core::array;

use model_core::numbers::Real;

use crate::forces::{ForceLaw, Push, Spring};
use crate::instant::{Instant, Rotor};
use crate::motion::{Coordinates, PeerState};
use crate::plant::{Flow, Plant};
use crate::scheme::{Phases, Scheme};

/// The method with its response to the present torques.
#[derive(Debug, Clone, Copy)]
pub struct Etd1<T> {
    driven: [T; 6],
}

impl<T: Real, const N: usize> Scheme<T, N> for Etd1<T> {
    const MIDDLE: bool = false;

    fn begin(_: &Plant<T, N>, _: &Rotor<T>) -> Self {
        Self { driven: [T::ZERO; 6] }
    }

    fn set_torques(&mut self, plant: &Plant<T, N>, push: &Push<T>) {
        self.driven = plant.flow.torques.map(|row| row[0] * push.sun + row[1] * push.carrier + row[2] * push.link);
    }

    #[inline(always)]
    fn advance<L: ForceLaw<T>, const COMPLIANT: bool>(
        &mut self,
        plant: &Plant<T, N>,
        _: &Push<T>,
        phases: &Phases<'_, T>,
        motion: &mut PeerState<T, N>,
    ) {
        let PeerState { position, rate } = motion;
        let now = Instant::at(plant, phases.start);
        let flow = &plant.flow;
        // Surplus force of the closed joint at mean stiffness.
        let missing = |kind: usize, i: usize, displacement: T, speed: T| {
            let spring = Spring {
                stiffness: now.stiffness[kind][i],
                damping: plant.damping[kind],
                half_backlash: plant.meshes[kind][i].half_backlash,
                sharpness: plant.sharpness,
            };
            let deflection = displacement - now.error[kind][i];
            flow.stiffness[kind] * displacement
                - L::force_less_damping(&spring, deflection, speed, now.error_rate[kind][i])
        };
        let (mut sun_sum, mut ring_sum, mut mean, mut mean_rate) = (T::ZERO, T::ZERO, T::ZERO, T::ZERO);
        let mut apart = [T::ZERO; N];
        for i in 0..N {
            let (planet, planet_rate) = (position.planets[i], rate.planets[i]);
            let sun = missing(0, i, planet, planet_rate);
            let ring = missing(1, i, position.gap - planet, rate.gap - planet_rate);
            sun_sum += sun;
            ring_sum += ring;
            apart[i] = sun - ring;
            mean += planet;
            mean_rate += planet_rate;
        }
        (mean, mean_rate) = (flow.share * mean, flow.share * mean_rate);
        let mean_apart = flow.share * (sun_sum - ring_sum);
        let state = [mean, position.gap, position.wind_up, mean_rate, rate.gap, rate.wind_up];
        let change: [T; 6] = array::from_fn(|row| {
            if !COMPLIANT && row % 3 == 2 {
                return T::ZERO;
            }
            self.driven[row] + in_phase::<T, COMPLIANT>(flow, row, &state, sun_sum, ring_sum)
        });
        let Flow { deviation, missing_deviation, .. } = flow;
        for i in 0..N {
            let (beside, drift) = (position.planets[i] - mean, rate.planets[i] - mean_rate);
            let apart = apart[i] - mean_apart;
            position.planets[i] +=
                change[0] + deviation[0][0] * beside + deviation[0][1] * drift + missing_deviation[0] * apart;
            rate.planets[i] +=
                change[3] + deviation[1][0] * beside + deviation[1][1] * drift + missing_deviation[1] * apart;
        }
        add::<T, N, COMPLIANT>(position, change[1], change[2]);
        add::<T, N, COMPLIANT>(rate, change[4], change[5]);
    }
}

#[inline(always)]
fn in_phase<T: Real, const COMPLIANT: bool>(flow: &Flow<T>, row: usize, state: &[T; 6], sun: T, ring: T) -> T {
    let mut sum = flow.missing[row][0] * sun + flow.missing[row][1] * ring;
    for column in 0..6 {
        if COMPLIANT || column % 3 != 2 {
            sum += flow.in_phase[row][column] * state[column];
        }
    }
    sum
}

#[inline(always)]
fn add<T: Real, const N: usize, const COMPLIANT: bool>(values: &mut Coordinates<T, N>, gap: T, wind_up: T) {
    values.gap += gap;
    if COMPLIANT {
        values.wind_up += wind_up;
    }
}
