//! The joint under a fixed contact set, which makes it linear: state of every mesh and the accelerations that follow, with a
//! sub-step as the unit of time and accelerations in sixths (see `stages`).

use crate::gears::contact::{AppliedAcceleration, Law, Laws, NetForces};
use crate::gears::excitation::{MeshExcitation, PhaseHarmonics};
use crate::gears::planets::each_planet;
use crate::gears::stages::{Point, SubstepState};
use crate::gears::state::Relative;
use crate::gears::tables::Tables;
use crate::numbers::Real;

/// One mesh at one instant under its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshState<T> {
    /// Deflection less the law's offset.
    pub overlap: T,
    /// Rate of the deflection.
    pub speed: T,
    /// Stiffness, whether it acts or not.
    pub stiffness: T,
    /// Imposed error.
    pub error: T,
    /// Force under the law, whether or not the law still holds.
    pub force: T,
}

/// The joint with everything that does not change over a tick.
#[derive(Clone, Copy)]
pub struct FixedContactSet<'a, T: Real, const N: usize, const OVERTONES: usize> {
    /// The joint.
    pub tables: &'a Tables<T, N>,
    /// Accelerations by the applied torques, in units of a stage.
    pub applied: AppliedAcceleration<T>,
    /// One under the damping law `contact`, else zero.
    pub contact_law: T,
    /// One under the damping law `paper`, else zero.
    pub paper_law: T,
}

impl<T: Real, const N: usize, const OVERTONES: usize> FixedContactSet<'_, T, N, OVERTONES> {
    /// Finds the law that every mesh is under.
    #[inline(never)]
    pub fn find_laws(
        &self,
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        state: &SubstepState<T, N>,
        laws: &mut Laws<T, N>,
    ) {
        for i in 0..N {
            let sun = state.planets[i].point();
            for (kind, at) in [(0, sun), (1, state.gap.point().minus(sun))] {
                let mesh = self.mesh(&Law::OPEN, (kind, i), harmonics_now, at);
                laws[kind][i] = Law::of(self.tables, (kind, i), mesh.overlap, mesh.speed, mesh.stiffness);
            }
        }
    }

    /// Whether any mesh is under the law of the gap.
    #[inline(always)]
    pub fn is_open(&self, laws: &Laws<T, N>) -> bool {
        let [sun, ring] = laws;
        let mut open = T::ZERO;
        each_planet!(N, i => {
            open += sun[i].open + ring[i].open;
        });
        open > T::ZERO
    }

    /// Stiffness and imposed error of one mesh.
    #[inline(always)]
    pub fn wave(&self, (kind, i): (usize, usize), harmonics_now: &PhaseHarmonics<T, OVERTONES>) -> MeshExcitation<T> {
        let tables = self.tables;
        let harmonics = tables.excitation.harmonics;
        tables.meshes[kind][i].at(harmonics_now, tables.springs[kind].stiffness, harmonics)
    }

    /// One mesh under a law.
    #[inline(always)]
    pub fn mesh(
        &self,
        law: &Law<T>,
        (kind, i): (usize, usize),
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        at: Point<T>,
    ) -> MeshState<T> {
        let MeshExcitation { stiffness, error, .. } = self.wave((kind, i), harmonics_now);
        let [sine, cosine] = self.tables.meshes[kind][i].error;
        let overlap =
            at.position - law.offset - sine * harmonics_now.phasor.sine - cosine * harmonics_now.phasor.cosine;
        let speed = at.rate - sine * harmonics_now.rates.sine - cosine * harmonics_now.rates.cosine;
        let force = law.closed * (stiffness * overlap) + law.damping * speed;
        MeshState { overlap, speed, stiffness, error, force }
    }

    /// Violation of a mesh's law: zero while it holds, positive once teeth in the gap have reached a flank, or closed ones
    /// have left it. Under the damping law `contact` they leave when their force changes sign, else when their overlap does.
    #[inline(always)]
    pub fn violation(&self, law: &Law<T>, (kind, i): (usize, usize), mesh: &MeshState<T>) -> T {
        let half_backlash = self.tables.meshes[kind][i].half_backlash;
        let MeshState { overlap, force, .. } = *mesh;
        let press = self.paper_law * overlap + self.contact_law * force;
        let room = law.side * press + law.open * (half_backlash - overlap.abs());
        // |x| - x is 0 or -2x: cheaper than a comparison for each mesh on a core whose flags are slow to read.
        room.abs() - room
    }

    /// Force between carrier and link.
    #[inline(always)]
    pub fn wind_up_force(&self, at: Point<T>) -> T {
        let mobility = &self.tables.stage.mobility;
        mobility.wind_up_stiffness * at.position + mobility.wind_up_damping * at.rate
    }

    /// Accelerations at the points of a stage; `inspect` is called with every mesh.
    #[inline(always)]
    pub fn accelerations(
        &self,
        laws: &Laws<T, N>,
        harmonics_now: &PhaseHarmonics<T, OVERTONES>,
        gap: Point<T>,
        wind_up_force: T,
        mut planet: impl FnMut(usize) -> Point<T>,
        mut inspect: impl FnMut((usize, usize), &MeshState<T>),
    ) -> Relative<T, N> {
        let mut net = NetForces::NONE;
        each_planet!(N, i => {
            let sun = planet(i);
            let ring = gap.minus(sun);
            let sun = self.mesh(&laws[0][i], (0, i), harmonics_now, sun);
            inspect((0, i), &sun);
            let ring = self.mesh(&laws[1][i], (1, i), harmonics_now, ring);
            inspect((1, i), &ring);
            net.add(i, sun.force, ring.force);
        });
        net.accelerations(&self.tables.stage.mobility, &self.applied, wind_up_force)
    }
}
