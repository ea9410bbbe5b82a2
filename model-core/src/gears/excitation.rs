//! Stiffness and imposed error of every mesh at one instant (eqs 7 and 11), from one sine and one cosine: phases of
//! the meshes are folded into the tables. Fig. 3's wave is a few harmonics of the same pair.

use crate::gears::tables::{Excitation, MeshTable, Tables};
use crate::numbers::Real;
use crate::numbers::phase::sine_cosine;
use parameters::MAX_HARMONICS;

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
    pub sine: T,
    pub cosine: T,
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
        Rotor::at((self.way * part).to_phase())
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

/// Harmonics above the first that a joint may have.
pub const MOST_OVERTONES: usize = MAX_HARMONICS - 1;

/// The mesh phase at one moment and how fast it goes, and room for multiples of it, from the second on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beat<T, const OVERTONES: usize> {
    /// Sine and cosine.
    pub rotor: Rotor<T>,
    /// Their rates.
    pub rates: Rotor<T>,
    rate: T,
    /// Sines and cosines of the multiples, as many as the joint has.
    multiples: [Rotor<T>; OVERTONES],
}

impl<T: Real, const OVERTONES: usize> Beat<T, OVERTONES> {
    /// At a phase that goes at `rate` [rad a unit of dimensionless time].
    #[inline]
    pub fn new(rotor: Rotor<T>, rate: T, harmonics: u32) -> Self {
        let mut multiples = [rotor; OVERTONES];
        if OVERTONES > 0 {
            let mut multiple = rotor;
            for place in multiples.iter_mut().take(harmonics.saturating_sub(1) as usize) {
                multiple = multiple.turned(&rotor);
                *place = multiple;
            }
        }
        Self { rotor, rates: Rotor { sine: rate * rotor.cosine, cosine: -(rate * rotor.sine) }, rate, multiples }
    }
}

/// One mesh at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshWave<T> {
    /// Stiffness.
    pub stiffness: T,
    /// Imposed error e.
    pub error: T,
    /// Its rate.
    pub error_rate: T,
}

impl<T: Real> MeshTable<T> {
    /// At a moment; `mean` is that of its kind, `harmonics` that of the joint.
    #[inline(always)]
    pub fn at<const OVERTONES: usize>(&self, beat: &Beat<T, OVERTONES>, mean: T, harmonics: u32) -> MeshWave<T> {
        let Beat { rotor, rates, .. } = beat;
        let [error_sine, error_cosine] = self.error;
        let [first_sine, first_cosine] = self.ripple[0];
        let mut stiffness = mean + first_sine * rotor.sine + first_cosine * rotor.cosine;
        if OVERTONES > 0 && harmonics > 1 {
            stiffness += self.overtones(beat, harmonics);
        }
        MeshWave {
            stiffness,
            error: error_sine * rotor.sine + error_cosine * rotor.cosine,
            error_rate: error_sine * rates.sine + error_cosine * rates.cosine,
        }
    }

    /// Rate of the stiffness.
    #[inline]
    pub fn stiffness_rate<const OVERTONES: usize>(&self, beat: &Beat<T, OVERTONES>, harmonics: u32) -> T {
        let [sine, cosine] = self.ripple[0];
        let mut sum = sine * beat.rates.sine + cosine * beat.rates.cosine;
        if OVERTONES > 0 {
            let mut order = T::ONE;
            for ([sine, cosine], multiple) in self.above(beat, harmonics) {
                order += T::ONE;
                sum += order * beat.rate * (*sine * multiple.cosine - *cosine * multiple.sine);
            }
        }
        sum
    }

    /// Sum of the harmonics above the first.
    #[inline(never)]
    fn overtones<const OVERTONES: usize>(&self, beat: &Beat<T, OVERTONES>, harmonics: u32) -> T {
        self.above(beat, harmonics)
            .fold(T::ZERO, |sum, ([sine, cosine], multiple)| sum + *sine * multiple.sine + *cosine * multiple.cosine)
    }

    /// Harmonics above the first with their multiples of the phase.
    #[inline(always)]
    fn above<'a, const OVERTONES: usize>(
        &'a self,
        beat: &'a Beat<T, OVERTONES>,
        harmonics: u32,
    ) -> impl Iterator<Item = (&'a [T; 2], &'a Rotor<T>)> {
        self.ripple.iter().skip(1).zip(&beat.multiples).take(harmonics.saturating_sub(1) as usize)
    }
}

/// Evaluates every mesh.
#[inline]
pub fn instant<T: Real, const N: usize, const OVERTONES: usize>(
    tables: &Tables<T, N>,
    beat: &Beat<T, OVERTONES>,
) -> Instant<T, N> {
    let mut instant = Instant { stiffness: [[T::ZERO; N]; 2], error: [[T::ZERO; N]; 2], error_rate: [[T::ZERO; N]; 2] };
    for kind in 0..2 {
        for i in 0..N {
            let MeshWave { stiffness, error, error_rate } =
                tables.meshes[kind][i].at(beat, tables.springs[kind].stiffness, tables.excitation.harmonics);
            instant.stiffness[kind][i] = stiffness;
            instant.error[kind][i] = error;
            instant.error_rate[kind][i] = error_rate;
        }
    }
    instant
}
