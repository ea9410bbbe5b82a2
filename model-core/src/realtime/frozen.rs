//! The joint at one moment under frozen laws: what every mesh does, and the accelerations that follow. What to do when
//! a law no longer holds is left to `crossing`.

use core::array;

use crate::mesh::{ContactState, DampingLaw};
use crate::real::Real;
use crate::realtime::contact::{Drive, Law, Laws, Net};
use crate::realtime::excitation::{Beat, MeshWave};
use crate::realtime::runge_kutta::Motion;
use crate::realtime::stages::Point;
use crate::realtime::state::Relative;
use crate::tables::Tables;

/// One mesh at one moment under its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<T> {
    /// Deflection less the law's offset.
    pub overlap: T,
    /// Rate of the deflection.
    pub speed: T,
    /// Stiffness, whether it acts or not.
    pub stiffness: T,
    /// Imposed error.
    pub error: T,
    /// Force under the law, right or not.
    pub force: T,
}

/// What does not change over a tick.
#[derive(Clone, Copy)]
pub struct Frozen<'a, T: Real, const N: usize> {
    /// The joint.
    pub tables: &'a Tables<T, N>,
    /// Torques.
    pub drive: &'a Drive<T>,
}

impl<T: Real, const N: usize> Frozen<'_, T, N> {
    /// The laws that hold at a motion.
    #[inline(never)]
    pub fn laws(&self, beat: &Beat<T>, motion: &Motion<T, N>) -> Laws<T, N> {
        let Motion { position, rate } = motion;
        let law = |kind: usize, i: usize, position: T, rate: T| {
            let Moment { overlap, speed, stiffness, .. } =
                self.mesh(&Law::OPEN, (kind, i), beat, Point { position, rate });
            Law::of(self.tables, (kind, i), overlap, speed, stiffness)
        };
        [
            array::from_fn(|i| law(0, i, position.planets[i], rate.planets[i])),
            array::from_fn(|i| law(1, i, position.gap - position.planets[i], rate.gap - rate.planets[i])),
        ]
    }

    /// One mesh under a law.
    #[inline(always)]
    pub fn mesh(&self, law: &Law<T>, (kind, i): (usize, usize), beat: &Beat<T>, at: Point<T>) -> Moment<T> {
        let tables = self.tables;
        let MeshWave { stiffness, error, error_rate } =
            tables.meshes[kind][i].at(beat, tables.springs[kind].stiffness, tables.excitation.harmonics);
        let (overlap, speed) = (at.position - error - law.offset, at.rate - error_rate);
        let force = law.closed * (stiffness * overlap) + law.damping * speed;
        Moment { overlap, speed, stiffness, error, force }
    }

    /// Whether a mesh is still under its law.
    #[inline(always)]
    pub fn holds(&self, law: &Law<T>, (kind, i): (usize, usize), moment: &Moment<T>) -> bool {
        let Moment { overlap, force, .. } = *moment;
        let pushes_only = self.tables.damping_law == DampingLaw::Contact;
        match law.contact {
            ContactState::DriveSide => overlap >= T::ZERO && !(pushes_only && force < T::ZERO),
            ContactState::BackSide => overlap <= T::ZERO && !(pushes_only && force > T::ZERO),
            ContactState::Separated => {
                let half_backlash = self.tables.meshes[kind][i].half_backlash;
                overlap < half_backlash && overlap > -half_backlash
            }
        }
    }

    /// Accelerations at the points of a stage; `see` is shown every mesh.
    #[inline(always)]
    pub fn pull(
        &self,
        laws: &Laws<T, N>,
        beat: &Beat<T>,
        (gap, wind_up): (Point<T>, Point<T>),
        mut planet: impl FnMut(usize) -> Point<T>,
        mut see: impl FnMut((usize, usize), &Moment<T>),
    ) -> Relative<T, N> {
        let mut net = Net::NONE;
        for i in 0..N {
            let sun = planet(i);
            let ring = Point { position: gap.position - sun.position, rate: gap.rate - sun.rate };
            let sun = self.mesh(&laws[0][i], (0, i), beat, sun);
            see((0, i), &sun);
            let ring = self.mesh(&laws[1][i], (1, i), beat, ring);
            see((1, i), &ring);
            net.add(i, sun.force, ring.force);
        }
        let mobility = &self.tables.mobility;
        let wind_up = mobility.wind_up_stiffness * wind_up.position + mobility.wind_up_damping * wind_up.rate;
        net.accelerations(self.tables, self.drive, wind_up)
    }
}
