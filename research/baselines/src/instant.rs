//! Every mesh at one instant: stiffness and imposed error with its rate, from one sine and one cosine.

use model_core::numbers::Real;

use crate::plant::{Mesh, Plant};

/// Sine and cosine of the mesh phase and its rate d(phase)/d(tau).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotor<T> {
    /// Sine.
    pub sine: T,
    /// Cosine.
    pub cosine: T,
    /// Phase rate [rad per unit of dimensionless time].
    pub rate: T,
}

/// One value for each mesh: sun-planet of every planet, then ring-planet.
pub type PerMesh<T, const N: usize> = [[T; N]; 2];

/// All meshes at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant<T, const N: usize> {
    /// Stiffness.
    pub stiffness: PerMesh<T, N>,
    /// Imposed error.
    pub error: PerMesh<T, N>,
    /// Rate of the imposed error.
    pub error_rate: PerMesh<T, N>,
}

impl<T: Real, const N: usize> Instant<T, N> {
    /// Zero stiffness and errors.
    pub const EMPTY: Self =
        Self { stiffness: [[T::ZERO; N]; 2], error: [[T::ZERO; N]; 2], error_rate: [[T::ZERO; N]; 2] };

    /// All meshes at a phase.
    #[inline(always)]
    pub fn at(plant: &Plant<T, N>, rotor: &Rotor<T>) -> Self {
        let Rotor { sine, cosine, rate } = *rotor;
        let (sine_rate, cosine_rate) = (rate * cosine, -(rate * sine));
        let mut instant = Self::EMPTY;
        for kind in 0..2 {
            for i in 0..N {
                let Mesh { error, stiffness, ripple, .. } = &plant.meshes[kind][i];
                instant.error[kind][i] = error[0] * sine + error[1] * cosine;
                instant.error_rate[kind][i] = error[0] * sine_rate + error[1] * cosine_rate;
                instant.stiffness[kind][i] = *stiffness + ripple[0][0] * sine + ripple[0][1] * cosine;
            }
        }
        if plant.harmonics > 1 {
            instant.add_overtones(plant, rotor);
        }
        instant
    }

    #[inline(never)]
    fn add_overtones(&mut self, plant: &Plant<T, N>, rotor: &Rotor<T>) {
        let (mut sine, mut cosine) = (rotor.sine, rotor.cosine);
        for harmonic in 1..plant.harmonics {
            (sine, cosine) = (sine * rotor.cosine + cosine * rotor.sine, cosine * rotor.cosine - sine * rotor.sine);
            for (row, meshes) in self.stiffness.iter_mut().zip(&plant.meshes) {
                for (value, mesh) in row.iter_mut().zip(meshes) {
                    let pair = mesh.ripple.get(harmonic).copied().unwrap_or([T::ZERO; 2]);
                    *value += pair[0] * sine + pair[1] * cosine;
                }
            }
        }
    }
}
