//! Stiffness and imposed error of every mesh at one instant (eqs 7 and 11), from one sine and one cosine: phases of
//! the meshes are folded into the tables. Fig. 3's wave is a few harmonics of the same pair.

use core::array;

use crate::real::Real;
use crate::realtime::phase::sine_cosine;
use crate::tables::{Excitation, MeshTable, Tables};

/// One mesh at one instant, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant<T> {
    /// Stiffness.
    pub stiffness: T,
    /// Imposed error e.
    pub error: T,
    /// Its rate.
    pub error_rate: T,
}

/// All meshes at one instant: sun-planet, ring-planet.
pub type Instants<T, const N: usize> = [[Instant<T>; N]; 2];

/// Where the mesh phase is at the start of a tick, and how fast it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPhase<T> {
    /// In 2^-32 periods.
    pub start: u32,
    /// Periods over the tick, in 2^-32.
    pub way: T,
    /// d(phase)/d(tau) [rad].
    pub rate: T,
}

impl<T: Real> MeshPhase<T> {
    /// What a part of the tick adds to the phase, in 2^-32 periods.
    #[inline]
    pub fn step(&self, part: T) -> u32 {
        (self.way * part).to_i64() as u32
    }
}

/// Mesh periods, in 2^-32, over a tick in which the rigid body goes `way` (2^-64 turns).
#[inline]
pub fn mesh_way<T: Real>(excitation: &Excitation<T>, way: i64) -> T {
    if excitation.periods_per_turn == 0 {
        excitation.phase_way
    } else {
        // 2^31 turns times the teeth of any ring stays inside 64 bits.
        T::from_i64((way >> 32) * i64::from(excitation.periods_per_turn))
    }
}

/// Evaluates every mesh at a phase.
#[inline]
pub fn instants<T: Real, const N: usize>(tables: &Tables<T, N>, phase: u32, rate: T) -> Instants<T, N> {
    let (sine, cosine) = sine_cosine::<T>(phase);
    let harmonics = tables.excitation.harmonics as usize;
    array::from_fn(|kind| {
        let mean = tables.springs[kind].stiffness;
        array::from_fn(|i| {
            let mesh = &tables.meshes[kind][i];
            let [error_sine, error_cosine] = mesh.error;
            Instant {
                stiffness: mean + ripple(mesh, harmonics, sine, cosine),
                error: error_sine * sine + error_cosine * cosine,
                error_rate: rate * (error_sine * cosine - error_cosine * sine),
            }
        })
    })
}

/// Sum of the harmonics in use; sine and cosine of the higher ones by the angle sum.
#[inline]
fn ripple<T: Real>(mesh: &MeshTable<T>, harmonics: usize, sine: T, cosine: T) -> T {
    let [first_sine, first_cosine] = mesh.ripple[0];
    let mut sum = first_sine * sine + first_cosine * cosine;
    let (mut s, mut c) = (sine, cosine);
    for [sine_part, cosine_part] in mesh.ripple.iter().take(harmonics).skip(1) {
        (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
        sum += *sine_part * s + *cosine_part * c;
    }
    sum
}
