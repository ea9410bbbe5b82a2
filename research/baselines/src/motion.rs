//! Relative coordinates of the joint (those of eqs 16 and 17 less the imposed errors) and their sums.

use core::array;

use model_core::numbers::{Real, digest};

/// Coordinates, or their rates or accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates<T, const N: usize> {
    /// Coordinates u_s - u_pi - u_c of every planet.
    pub planets: [T; N],
    /// Coordinate u_s - 2 u_c.
    pub gap: T,
    /// Coordinate u_c - u_l; zero unless compliant.
    pub wind_up: T,
}

impl<T: Real, const N: usize> Coordinates<T, N> {
    /// Zero in all coordinates.
    pub const ZERO: Self = Self { planets: [T::ZERO; N], gap: T::ZERO, wind_up: T::ZERO };

    /// Sum self + scale * other; includes the wind-up of a compliant joint only.
    #[inline(always)]
    pub fn plus<const COMPLIANT: bool>(&self, scale: T, other: &Self) -> Self {
        Self {
            planets: array::from_fn(|i| self.planets[i] + scale * other.planets[i]),
            gap: self.gap + scale * other.gap,
            wind_up: if COMPLIANT { self.wind_up + scale * other.wind_up } else { self.wind_up },
        }
    }
}

/// Position and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerState<T, const N: usize> {
    /// Coordinates.
    pub position: Coordinates<T, N>,
    /// Rates of the coordinates.
    pub rate: Coordinates<T, N>,
}

impl<T: Real, const N: usize> PeerState<T, N> {
    /// Digest over every bit.
    pub fn digest(&self) -> u64 {
        [&self.position, &self.rate].into_iter().fold(digest::START, |running, values| {
            let planets = values.planets.iter().fold(running, |digest, value| digest::chain(digest, value.bits()));
            digest::chain(digest::chain(planets, values.gap.bits()), values.wind_up.bits())
        })
    }
}
