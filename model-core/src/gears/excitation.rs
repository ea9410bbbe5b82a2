//! Stiffness and imposed error of every mesh at one instant (S3; eqs 7 and 11), from sine and cosine of the mesh phase. The
//! tables include the phases of the meshes. The wave of Fig. 3 uses a few harmonics of sine and cosine.
//!
//! Equations: (P4), (P6) in docs/theory/paper.md.

use crate::gears::tables::{Excitation, MeshTable, Tables};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;
use parameters::MAX_HARMONICS;

/// Values of all meshes: sun-planet of every planet, then ring-planet.
pub type PerMesh<T, const N: usize> = [[T; N]; 2];

/// Excitation of all meshes at one instant, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshExcitations<T, const N: usize> {
    /// Stiffness.
    pub stiffness: PerMesh<T, N>,
    /// Imposed error e.
    pub error: PerMesh<T, N>,
    /// Rate of the imposed error.
    pub error_rate: PerMesh<T, N>,
}

/// Sine and cosine of the mesh phase, or of an advance to be added to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phasor<T> {
    pub sine: T,
    pub cosine: T,
}

impl<T: Real> Phasor<T> {
    /// Creates the phasor of a phase in 2^-32 periods.
    #[inline]
    pub fn at(phase: u32) -> Self {
        let (sine, cosine) = sine_cosine(phase);
        Self { sine, cosine }
    }

    /// Returns the phasor advanced by the angle of `by`.
    #[inline]
    pub fn turned(&self, by: &Self) -> Self {
        Self {
            sine: self.sine * by.cosine + self.cosine * by.sine,
            cosine: self.cosine * by.cosine - self.sine * by.sine,
        }
    }

    /// Returns the rates of sine and cosine at a rate of the phase.
    #[inline(always)]
    pub fn rates(&self, phase_rate: T) -> Self {
        Self { sine: phase_rate * self.cosine, cosine: -(phase_rate * self.sine) }
    }

    /// Extrapolates sine and cosine linearly over `time`.
    #[inline(always)]
    pub fn moved(&self, time: T, rates: &Self) -> Self {
        Self { sine: self.sine + time * rates.sine, cosine: self.cosine + time * rates.cosine }
    }
}

/// Mesh phase over a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshPhase<T> {
    /// Phase at the start of the tick, in 2^-32 periods.
    pub start: u32,
    /// Advance of the phase over the tick, in 2^-32 periods.
    pub advance: T,
    /// d(phase)/d(tau) [rad].
    pub rate: T,
}

impl<T: Real> MeshPhase<T> {
    /// Returns the phasor after a fraction of the tick.
    #[inline]
    pub fn at(&self, part: T) -> Phasor<T> {
        Phasor::at(self.start.wrapping_add((self.advance * part).to_phase()))
    }

    /// Returns the phasor of the advance over a fraction of the tick.
    #[inline]
    pub fn phasor_over(&self, part: T) -> Phasor<T> {
        Phasor::at((self.advance * part).to_phase())
    }
}

/// Returns the phase advance in 2^-32 periods over a tick in which the rigid body travels `travel` (2^-64 turns).
#[inline]
pub fn mesh_phase_advance<T: Real>(excitation: &Excitation<T>, travel: i64) -> T {
    if excitation.periods_per_turn == 0 {
        excitation.phase_advance
    } else {
        // Two 32-bit conversions in hardware: a conversion from 64 bits is a library call.
        T::from_i32((travel >> 32) as i32) * T::from_i32(excitation.periods_per_turn as i32)
    }
}

/// Largest number of harmonics above the first.
pub const MAX_OVERTONES: usize = MAX_HARMONICS - 1;

/// Phasors of the mesh phase at one instant (fundamental and higher harmonics) and the rate of the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseHarmonics<T, const OVERTONES: usize> {
    /// Sine and cosine of the phase.
    pub phasor: Phasor<T>,
    /// Rates of sine and cosine.
    pub rates: Phasor<T>,
    /// Rate of the phase.
    pub rate: T,
    /// Phasors of the higher harmonics; places above the joint's harmonics are unused.
    multiples: [Phasor<T>; OVERTONES],
}

impl<T: Real, const OVERTONES: usize> PhaseHarmonics<T, OVERTONES> {
    /// Creates the harmonics at a phase and a phase rate [rad per unit of time].
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
    /// Rate of the imposed error.
    pub error_rate: T,
}

impl<T: Real> MeshTable<T> {
    /// Returns the imposed error at a phasor; given the phasor's rates, returns the rate of the error.
    #[inline(always)]
    pub fn error_at(&self, phasor: &Phasor<T>) -> T {
        let [sine, cosine] = self.error;
        sine * phasor.sine + cosine * phasor.cosine
    }

    /// Evaluates stiffness, error and error rate; `mean` is the mean stiffness of the mesh, `harmonics` the joint's number.
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

    /// Returns the rate of the stiffness.
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

    /// Returns the sum of the stiffness harmonics above the first.
    #[inline(never)]
    fn overtones<const OVERTONES: usize>(&self, harmonics_now: &PhaseHarmonics<T, OVERTONES>, harmonics: u32) -> T {
        self.above(harmonics_now, harmonics)
            .fold(T::ZERO, |sum, ([sine, cosine], multiple)| sum + *sine * multiple.sine + *cosine * multiple.cosine)
    }

    /// Iterates over the coefficients and phasors of the harmonics above the first.
    #[inline(always)]
    fn above<'a, const OVERTONES: usize>(
        &'a self,
        harmonics_now: &'a PhaseHarmonics<T, OVERTONES>,
        harmonics: u32,
    ) -> impl Iterator<Item = (&'a [T; 2], &'a Phasor<T>)> {
        self.ripple.iter().skip(1).zip(&harmonics_now.multiples).take(harmonics.saturating_sub(1) as usize)
    }
}

/// Returns the stiffness of every mesh at one instant.
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

/// Adds the stiffness harmonics above the first.
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

/// Evaluates every mesh at a phase and a phase rate [rad per unit of dimensionless time]. With `OVERTONES` = 0 and more
/// than one harmonic the stiffness is incomplete; the imposed errors are valid.
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
