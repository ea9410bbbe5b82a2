//! The joint as y' = f(t, y) for libraries: coordinates, then their rates, dimensionless, with `D` = 2 (N + 1) entries. The forces are
//! those of the baselines, compiled for one law; the Jacobian is exact on either side of a kink.

use std::array;

use baselines::forces::{Always, ForceLaw, Push, PushOnly, acceleration};
use baselines::instant::{Instant, Rotor};
use baselines::motion::{Coordinates, PeerState};
use baselines::plant::{Law, Plant};
use model_core::gears::Scales;
use parameters::Excitation;

use crate::case::Case;
use crate::reading::{Reading, ReadingModel};
use crate::start::InitialState;

/// Case with a prescribed phase, one pair of torques and no compliance.
pub struct Equations<const N: usize, const D: usize> {
    plant: Plant<f64, N>,
    push: Push<f64>,
    reading_model: ReadingModel<N>,
    /// Mesh frequency over omega_n.
    omega: f64,
    start: [f64; D],
}

impl<const N: usize, const D: usize> Equations<N, D> {
    /// Equations of a case; `None` for a case of another kind.
    pub fn new(case: &Case) -> Option<Self> {
        let Excitation::Time { mesh_frequency } = case.joint.excitation else { return None };
        let [torques] = case.torques.as_slice() else { return None };
        let scales = Scales::new(&case.joint);
        // The step of this plant is not used.
        let plant: Plant<f64, N> = Plant::new(&case.joint, scales.frequency);
        if plant.compliant || !matches!(plant.law, Law::Always | Law::Push) || D != 2 * (N + 1) {
            return None;
        }
        let gains = &plant.gains;
        let push =
            Push { sun: gains.sun * torques.drive_torque, carrier: -gains.carrier * torques.load_torque, link: 0.0 };
        let deflected = InitialState::<N>::new(&case.joint, &case.start);
        let omega = mesh_frequency / scales.frequency;
        let error = Instant::at(&plant, &rotor(omega, 0.0));
        let speed = scales.length * scales.frequency;
        let start = array::from_fn(|entry| {
            let (values, unit, imposed) = match entry <= N {
                true => (&deflected.position, scales.length, &error.error[0]),
                false => (&deflected.rate, speed, &error.error_rate[0]),
            };
            let index = entry % (N + 1);
            if index < N { values.planets[index] / unit + imposed[index] } else { values.gap / unit }
        });
        Some(Self { plant, push, reading_model: ReadingModel::new(&case.joint), omega, start })
    }

    /// State at time zero.
    pub fn start(&self) -> &[f64; D] {
        &self.start
    }

    /// Right-hand side f(t, y).
    #[inline]
    pub fn rates(&self, time: f64, state: &[f64], rates: &mut [f64]) {
        match self.plant.law {
            Law::Push => self.rates_under::<PushOnly>(time, state, rates),
            _ => self.rates_under::<Always>(time, state, rates),
        }
    }

    #[inline(always)]
    fn rates_under<L: ForceLaw<f64>>(&self, time: f64, state: &[f64], rates: &mut [f64]) {
        let now = Instant::at(&self.plant, &rotor(self.omega, time));
        let (position, rate) = split::<N>(state);
        let change = acceleration::<f64, N, L, false>(&self.plant, &self.push, &now, &position, &rate);
        rates[..N].copy_from_slice(&rate.planets);
        rates[N] = rate.gap;
        rates[N + 1..2 * N + 1].copy_from_slice(&change.planets);
        rates[2 * N + 1] = change.gap;
    }

    /// Product of the Jacobian of f with a vector.
    pub fn jacobian_times(&self, time: f64, state: &[f64], vector: &[f64], product: &mut [f64]) {
        let plant = &self.plant;
        let now = Instant::at(plant, &rotor(self.omega, time));
        let (position, rate) = split::<N>(state);
        let (shift, drift) = split::<N>(vector);
        let mesh = |kind: usize, i: usize| {
            let of = |values: &Coordinates<f64, N>| match kind {
                0 => values.planets[i],
                _ => values.gap - values.planets[i],
            };
            let deflection = of(&position) - now.error[kind][i];
            let overlap = deflection.abs() - plant.meshes[kind][i].half_backlash;
            let speed = (of(&rate) - now.error_rate[kind][i]) * deflection.signum();
            let pulls = now.stiffness[kind][i] * overlap + plant.damping[kind] * speed <= 0.0;
            match (plant.law, overlap > 0.0) {
                (Law::Push, closed) if !closed || pulls => 0.0,
                (_, true) => now.stiffness[kind][i] * of(&shift) + plant.damping[kind] * of(&drift),
                (_, false) => plant.damping[kind] * of(&drift),
            }
        };
        let forces: [[f64; N]; 2] = array::from_fn(|kind| array::from_fn(|i| mesh(kind, i)));
        let (sun_sum, ring_sum) = (forces[0].iter().sum::<f64>(), forces[1].iter().sum::<f64>());
        let sun = -plant.sun * sun_sum;
        let carrier = plant.carrier * (sun_sum + ring_sum);
        product[..N].copy_from_slice(&drift.planets);
        product[N] = drift.gap;
        for i in 0..N {
            product[N + 1 + i] = sun - carrier - plant.planet * (forces[0][i] - forces[1][i]);
        }
        product[2 * N + 1] = sun - 2.0 * carrier;
    }

    /// Distance of each mesh from either end of its gap: the forces have a kink at zero.
    pub fn kinks(&self, time: f64, state: &[f64], distances: &mut [f64]) {
        let now = Instant::at(&self.plant, &rotor(self.omega, time));
        let (position, _) = split::<N>(state);
        for kind in 0..2 {
            for i in 0..N {
                let displacement = if kind == 0 { position.planets[i] } else { position.gap - position.planets[i] };
                let deflection = displacement - now.error[kind][i];
                let half_backlash = self.plant.meshes[kind][i].half_backlash;
                distances[2 * (kind * N + i)] = deflection - half_backlash;
                distances[2 * (kind * N + i) + 1] = deflection + half_backlash;
            }
        }
    }

    /// Reading of a state.
    pub fn read(&self, time: f64, state: &[f64]) -> Reading {
        let (position, rate) = split::<N>(state);
        self.reading_model.read(&PeerState { position, rate }, &rotor(self.omega, time), 0.0)
    }
}

fn rotor(omega: f64, time: f64) -> Rotor<f64> {
    let (sine, cosine) = (omega * time).sin_cos();
    Rotor { sine, cosine, rate: omega }
}

#[inline(always)]
fn split<const N: usize>(state: &[f64]) -> (Coordinates<f64, N>, Coordinates<f64, N>) {
    let of = |first: usize| Coordinates {
        planets: array::from_fn(|i| state[first + i]),
        gap: state[first + N],
        wind_up: 0.0,
    };
    (of(0), of(N + 1))
}
