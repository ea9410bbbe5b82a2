//! Stiffness and imposed error of every mesh at one instant (eqs 7 and 11), from one sine and one cosine: phases of
//! the meshes are folded into the tables. Fig. 3's wave is a few harmonics of the same pair.

use crate::gears::tables::{Excitation, MeshTable, Tables};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;
use parameters::MAX_HARMONICS;

/// One value for each mesh: sun-planet of every planet, then ring-planet.
pub type PerMesh<T, const N: usize> = [[T; N]; 2];

/// Excitation of all meshes at one instant, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshExcitations<T, const N: usize> {
    /// Stiffness.
    pub stiffness: PerMesh<T, N>,
    /// Imposed error e.
    pub error: PerMesh<T, N>,
    /// Its rate.
    pub error_rate: PerMesh<T, N>,
}

/// Sine and cosine of the mesh phase, or of an advance to be added to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phasor<T> {
    pub sine: T,
    pub cosine: T,
}

impl<T: Real> Phasor<T> {
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

    /// Its rates, for this rate of the phase.
    #[inline(always)]
    pub fn rates(&self, phase_rate: T) -> Self {
        Self { sine: phase_rate * self.cosine, cosine: -(phase_rate * self.sine) }
    }

    /// Moved straight along rates for so long.
    #[inline(always)]
    pub fn moved(&self, time: T, rates: &Self) -> Self {
        Self { sine: self.sine + time * rates.sine, cosine: self.cosine + time * rates.cosine }
    }
}

/// The mesh phase over a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPhase<T> {
    /// Where it starts, in 2^-32 periods.
    pub start: u32,
    /// Its advance over the tick, in 2^-32 periods.
    pub advance: T,
    /// d(phase)/d(tau) [rad].
    pub rate: T,
}

impl<T: Real> MeshPhase<T> {
    /// The phasor after a part of the tick.
    #[inline]
    pub fn at(&self, part: T) -> Phasor<T> {
        Phasor::at(self.start.wrapping_add((self.advance * part).to_phase()))
    }

    /// The advance over a part of the tick.
    #[inline]
    pub fn over(&self, part: T) -> Phasor<T> {
        Phasor::at((self.advance * part).to_phase())
    }
}

/// Mesh periods, in 2^-32, over a tick in which the rigid body travels `travel` (2^-64 turns).
#[inline]
pub fn mesh_phase_advance<T: Real>(excitation: &Excitation<T>, travel: i64) -> T {
    if excitation.periods_per_turn == 0 {
        excitation.phase_advance
    } else {
        // By two conversions of the hardware: one from 64 bits is a library call.
        T::from_i32((travel >> 32) as i32) * T::from_i32(excitation.periods_per_turn as i32)
    }
}

/// Harmonics above the first that a joint may have.
pub const MAX_OVERTONES: usize = MAX_HARMONICS - 1;

/// Phasors of the mesh phase at one moment, with its rate: the fundamental, and room for the higher harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseHarmonics<T, const OVERTONES: usize> {
    /// Sine and cosine.
    pub phasor: Phasor<T>,
    /// Their rates.
    pub rates: Phasor<T>,
    /// Rate of the phase.
    pub rate: T,
    /// Phasors of the higher harmonics, as many as the joint has.
    multiples: [Phasor<T>; OVERTONES],
}

impl<T: Real, const OVERTONES: usize> PhaseHarmonics<T, OVERTONES> {
    /// At a phase with this rate [rad a unit of dimensionless time].
    #[inline]
    pub fn new(phasor: Phasor<T>, rate: T, harmonics: u32) -> Self {
        let mut multiples = [phasor; OVERTONES];
        if OVERTONES > 0 {
            let mut multiple = phasor;
            for place in multiples.iter_mut().take(harmonics.saturating_sub(1) as usize) {
                multiple = multiple.turned(&phasor);
                *place = multiple;
            }
        }
        Self { phasor, rates: Phasor { sine: rate * phasor.cosine, cosine: -(rate * phasor.sine) }, rate, multiples }
    }
}

/// Excitation of one mesh at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshExcitation<T> {
    /// Stiffness.
    pub stiffness: T,
    /// Imposed error e.
    pub error: T,
    /// Its rate.
    pub error_rate: T,
}

impl<T: Real> MeshTable<T> {
    /// Imposed error at a phasor; its rate at the phasor's rates.
    #[inline(always)]
    pub fn error_at(&self, phasor: &Phasor<T>) -> T {
        let [sine, cosine] = self.error;
        sine * phasor.sine + cosine * phasor.cosine
    }

    /// At a moment; `mean` is that of its kind, `harmonics` that of the joint.
    #[inline(always)]
    pub fn at<const OVERTONES: usize>(
        &self,
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        mean: T,
        harmonics: u32,
    ) -> MeshExcitation<T> {
        let PhaseHarmonics { phasor, rates, .. } = harmonics_now;
        let [error_sine, error_cosine] = self.error;
        let [first_sine, first_cosine] = self.ripple[0];
        let mut stiffness = mean + first_sine * phasor.sine + first_cosine * phasor.cosine;
        if OVERTONES > 0 && harmonics > 1 {
            stiffness += self.overtones(harmonics_now, harmonics);
        }
        MeshExcitation {
            stiffness,
            error: error_sine * phasor.sine + error_cosine * phasor.cosine,
            error_rate: error_sine * rates.sine + error_cosine * rates.cosine,
        }
    }

    /// Rate of the stiffness.
    #[inline]
    pub fn stiffness_rate<const OVERTONES: usize>(
        &self,
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        harmonics: u32,
    ) -> T {
        let [sine, cosine] = self.ripple[0];
        let mut sum = sine * harmonics_now.rates.sine + cosine * harmonics_now.rates.cosine;
        if OVERTONES > 0 {
            let mut order = T::ONE;
            for ([sine, cosine], multiple) in self.above(harmonics_now, harmonics) {
                order += T::ONE;
                sum += order * harmonics_now.rate * (*sine * multiple.cosine - *cosine * multiple.sine);
            }
        }
        sum
    }

    /// Sum of the harmonics above the first.
    #[inline(never)]
    fn overtones<const OVERTONES: usize>(&self, harmonics_now: &PhaseHarmonics<T, OVERTONES>, harmonics: u32) -> T {
        self.above(harmonics_now, harmonics)
            .fold(T::ZERO, |sum, ([sine, cosine], multiple)| sum + *sine * multiple.sine + *cosine * multiple.cosine)
    }

    /// Harmonics above the first with their multiples of the phase.
    #[inline(always)]
    fn above<'a, const OVERTONES: usize>(
        &'a self,
        harmonics_now: &'a PhaseHarmonics<T, OVERTONES>,
        harmonics: u32,
    ) -> impl Iterator<Item = (&'a [T; 2], &'a Phasor<T>)> {
        self.ripple.iter().skip(1).zip(&harmonics_now.multiples).take(harmonics.saturating_sub(1) as usize)
    }
}

/// Stiffness of every mesh at one moment.
#[inline(always)]
pub fn stiffnesses<T: Real, const N: usize>(tables: &Tables<T, N>, phasor: &Phasor<T>) -> PerMesh<T, N> {
    let mut stiffness = [[T::ZERO; N]; 2];
    for kind in 0..2 {
        let mean = tables.springs[kind].stiffness;
        for i in 0..N {
            let [sine, cosine] = tables.meshes[kind][i].ripple[0];
            stiffness[kind][i] = mean + sine * phasor.sine + cosine * phasor.cosine;
        }
    }
    if tables.excitation.harmonics > 1 {
        add_overtones(tables, phasor, &mut stiffness);
    }
    stiffness
}

/// Adds the harmonics above the first.
#[inline(never)]
fn add_overtones<T: Real, const N: usize>(tables: &Tables<T, N>, phasor: &Phasor<T>, stiffness: &mut PerMesh<T, N>) {
    let harmonics = tables.excitation.harmonics;
    let harmonics_now = PhaseHarmonics::<T, MAX_OVERTONES>::new(*phasor, T::ZERO, harmonics);
    for (family, meshes) in stiffness.iter_mut().zip(&tables.meshes) {
        for (stiffness, mesh) in family.iter_mut().zip(meshes) {
            *stiffness += mesh.overtones(&harmonics_now, harmonics);
        }
    }
}

/// Evaluates every mesh at a phase with this rate [rad a unit of dimensionless time]; without overtones only the imposed
/// errors are right.
#[inline]
pub fn mesh_excitations<T: Real, const N: usize, const OVERTONES: usize>(
    tables: &Tables<T, N>,
    phasor: Phasor<T>,
    rate: T,
) -> MeshExcitations<T, N> {
    let harmonics_now = &PhaseHarmonics::<T, OVERTONES>::new(phasor, rate, tables.excitation.harmonics);
    let mut mesh_excitations =
        MeshExcitations { stiffness: [[T::ZERO; N]; 2], error: [[T::ZERO; N]; 2], error_rate: [[T::ZERO; N]; 2] };
    for kind in 0..2 {
        for i in 0..N {
            let MeshExcitation { stiffness, error, error_rate } =
                tables.meshes[kind][i].at(harmonics_now, tables.springs[kind].stiffness, tables.excitation.harmonics);
            mesh_excitations.stiffness[kind][i] = stiffness;
            mesh_excitations.error[kind][i] = error;
            mesh_excitations.error_rate[kind][i] = error_rate;
        }
    }
    mesh_excitations
}
