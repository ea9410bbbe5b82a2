//! Joint with a fixed contact set, which is linear: state of every mesh (S2) and accelerations (S4). The unit of time is a
//! sub-step; accelerations are in sixths (see `stages`).

use crate::gears::contact::{AppliedAcceleration, Law, Laws, NetForces};
use crate::gears::excitation::{MeshExcitation, PhaseHarmonics};
use crate::gears::planets::each_planet;
use crate::gears::stages::{Point, SubstepState};
use crate::gears::state::Relative;
use crate::gears::tables::Tables;
use crate::numbers::Real;

/// State of one mesh at one instant under its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshState<T> {
    /// Deflection minus the offset of the law.
    pub overlap: T,
    /// Rate of the deflection.
    pub speed: T,
    /// Stiffness, also if the mesh is open.
    pub stiffness: T,
    /// Imposed error.
    pub error: T,
    /// Force under the law, also if the law no longer holds.
    pub force: T,
}

/// Joint and quantities that are constant over a tick.
#[derive(Clone, Copy)]
pub struct FixedContactSet<'a, T: Real, const N: usize, const OVERTONES: usize> {
    /// Tables of the joint.
    pub tables: &'a Tables<T, N>,
    /// Accelerations by the applied torques, in stage units.
    pub applied: AppliedAcceleration<T>,
    /// 1 under the damping law `contact`, else 0.
    pub contact_law: T,
    /// 1 under the damping law `paper`, else 0.
    pub paper_law: T,
}

impl<T: Real, const N: usize, const OVERTONES: usize> FixedContactSet<'_, T, N, OVERTONES> {
    /// Finds the law of every mesh.
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
                laws[kind][i] = Law::at_deflection(self.tables, (kind, i), mesh.overlap, mesh.speed, mesh.stiffness);
            }
        }
    }

    /// Returns true if any mesh is open.
    #[inline(always)]
    pub fn is_open(&self, laws: &Laws<T, N>) -> bool {
        let [sun, ring] = laws;
        let mut open = T::ZERO;
        each_planet!(N, i => {
            open += sun[i].open + ring[i].open;
        });
        open > T::ZERO
    }

    /// Returns stiffness and imposed error of one mesh.
    #[inline(always)]
    pub fn wave(&self, (kind, i): (usize, usize), harmonics_now: &PhaseHarmonics<T, OVERTONES>) -> MeshExcitation<T> {
        let tables = self.tables;
        let harmonics = tables.excitation.harmonics;
        tables.meshes[kind][i].at(harmonics_now, tables.springs[kind].stiffness, harmonics)
    }

    /// Evaluates one mesh under a law.
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

    /// Returns the violation of a mesh's law: zero while the law holds, positive if an open mesh has reached a flank or a
    /// closed mesh has left it. A mesh leaves its flank when its force (law `contact`) or overlap (law `paper`) changes sign.
    #[inline(always)]
    pub fn violation(&self, law: &Law<T>, (kind, i): (usize, usize), mesh: &MeshState<T>) -> T {
        let half_backlash = self.tables.meshes[kind][i].half_backlash;
        let MeshState { overlap, force, .. } = *mesh;
        let press = self.paper_law * overlap + self.contact_law * force;
        let room = law.side * press + law.open * (half_backlash - overlap.abs());
        // |x| - x is 0 or -2x: cheaper than a comparison for each mesh on a core whose flags are slow to read.
        room.abs() - room
    }

    /// Returns the force between carrier and link.
    #[inline(always)]
    pub fn wind_up_force(&self, at: Point<T>) -> T {
        let mobility = &self.tables.stage.mobility;
        mobility.wind_up_stiffness * at.position + mobility.wind_up_damping * at.rate
    }

    /// Returns the accelerations at a stage; calls `inspect` with the state of every mesh.
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
