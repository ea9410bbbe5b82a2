//! Stiffness and imposed error of every mesh at one instant (eqs 7 and 11), from one sine and one cosine: phases of
//! the meshes are folded into the tables. Fig. 3's wave is a few harmonics of the same pair.

use crate::real::Real;
use crate::realtime::phase::sine_cosine;
use crate::tables::{Excitation, MeshTable, Tables};

/// One value for each mesh: sun-planet of every planet, then ring-planet.
pub type PerMesh<T, const N: usize> = [[T; N]; 2];

/// All meshes at one instant, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant<T, const N: usize> {
    /// Stiffness.
    pub stiffness: PerMesh<T, N>,
    /// Imposed error e.
    pub error: PerMesh<T, N>,
    /// Its rate.
    pub error_rate: PerMesh<T, N>,
}

/// Sine and cosine of the mesh phase, or of a part of it to be added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotor<T> {
    sine: T,
    cosine: T,
}

impl<T: Real> Rotor<T> {
    /// At a phase in 2^-32 periods.
    #[inline]
    pub fn at(phase: u32) -> Self {
        let (sine, cosine) = sine_cosine(phase);
        Self { sine, cosine }
    }

    /// Further by another's angle.
    #[inline]
    pub fn turned(&self, by: &Self) -> Self {
        Self {
            sine: self.sine * by.cosine + self.cosine * by.sine,
            cosine: self.cosine * by.cosine - self.sine * by.sine,
        }
    }
}

/// How the mesh phase goes over a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPhase<T> {
    /// Where it starts.
    pub start: Rotor<T>,
    /// Periods over the tick, in 2^-32.
    pub way: T,
    /// d(phase)/d(tau) [rad].
    pub rate: T,
}

impl<T: Real> MeshPhase<T> {
    /// What a part of the tick adds to the phase.
    #[inline]
    pub fn over(&self, part: T) -> Rotor<T> {
        Rotor::at((self.way * part).to_i64() as u32)
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

/// Evaluates every mesh at a phase that goes at `rate`.
#[inline]
pub fn instant<T: Real, const N: usize>(tables: &Tables<T, N>, phase: &Rotor<T>, rate: T) -> Instant<T, N> {
    let Rotor { sine, cosine } = *phase;
    let (sine_rate, cosine_rate) = (rate * cosine, -(rate * sine));
    let mut instant = Instant { stiffness: [[T::ZERO; N]; 2], error: [[T::ZERO; N]; 2], error_rate: [[T::ZERO; N]; 2] };
    for kind in 0..2 {
        let mean = tables.springs[kind].stiffness;
        for i in 0..N {
            let mesh = &tables.meshes[kind][i];
            let [error_sine, error_cosine] = mesh.error;
            instant.error[kind][i] = error_sine * sine + error_cosine * cosine;
            instant.error_rate[kind][i] = error_sine * sine_rate + error_cosine * cosine_rate;
            let [first_sine, first_cosine] = mesh.ripple[0];
            instant.stiffness[kind][i] = mean + first_sine * sine + first_cosine * cosine;
        }
    }
    if tables.excitation.harmonics > 1 {
        let harmonics = tables.excitation.harmonics as usize;
        for (row, meshes) in instant.stiffness.iter_mut().zip(&tables.meshes) {
            for (stiffness, mesh) in row.iter_mut().zip(meshes) {
                *stiffness += overtones(mesh, harmonics, phase);
            }
        }
    }
    instant
}

/// Sum of the harmonics above the first.
fn overtones<T: Real>(mesh: &MeshTable<T>, harmonics: usize, phase: &Rotor<T>) -> T {
    let (mut sum, mut multiple) = (T::ZERO, *phase);
    for [sine, cosine] in mesh.ripple.iter().take(harmonics).skip(1) {
        multiple = multiple.turned(phase);
        sum += *sine * multiple.sine + *cosine * multiple.cosine;
    }
    sum
}
