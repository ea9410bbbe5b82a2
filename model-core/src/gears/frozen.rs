//! The joint at one moment under frozen laws: what every mesh does, and the accelerations that follow, with a sub-step
//! as the unit of time and accelerations in sixths (see `stages`).

use crate::gears::contact::{Drive, Law, Laws, Net};
use crate::gears::excitation::{Beat, MeshWave, PerMesh};
use crate::gears::planets::each_planet;
use crate::gears::stages::{Course, Point};
use crate::gears::state::Relative;
use crate::gears::tables::Tables;
use crate::numbers::Real;

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

impl<T: Real> Moment<T> {
    const ZERO: Self = Self { overlap: T::ZERO, speed: T::ZERO, stiffness: T::ZERO, error: T::ZERO, force: T::ZERO };
}

/// The start of a tick.
#[derive(Debug, Clone)]
pub struct Start<T, const N: usize> {
    /// The laws that hold.
    pub laws: Laws<T, N>,
    /// What every mesh does.
    pub meshes: PerMesh<Moment<T>, N>,
    /// Whether every mesh is closed, too far from opening for its speed to open it before the middle of the tick.
    pub settled: bool,
}

impl<T: Real, const N: usize> Start<T, N> {
    /// To be filled.
    pub const EMPTY: Self = Self { laws: [[Law::ZERO; N]; 2], meshes: [[Moment::ZERO; N]; 2], settled: false };
}

impl<T: Real, const N: usize> Start<T, N> {
    /// Whether any mesh is under the law of the gap.
    #[inline(always)]
    pub fn is_open(&self) -> bool {
        let [sun, ring] = &self.laws;
        let mut open = T::ZERO;
        each_planet!(N, i => {
            open += sun[i].open + ring[i].open;
        });
        open > T::ZERO
    }
}

/// What does not change over a tick.
#[derive(Clone, Copy)]
pub struct Frozen<'a, T: Real, const N: usize, const OVERTONES: usize> {
    /// The joint.
    pub tables: &'a Tables<T, N>,
    /// Torques, as accelerations of a stage.
    pub drive: Drive<T>,
    /// One under the law `contact`, else zero.
    pub pushes_only: T,
    /// One less that.
    pub adheres: T,
}

impl<T: Real, const N: usize, const OVERTONES: usize> Frozen<'_, T, N, OVERTONES> {
    /// The joint at the start of a tick.
    #[inline(never)]
    pub fn start(&self, beat: &Beat<T, OVERTONES>, course: &Course<T, N>, start: &mut Start<T, N>) {
        start.settled = true;
        let reach = self.tables.flow.reach * self.tables.stage.rate;
        for i in 0..N {
            let sun = course.planets[i].point();
            for (kind, at) in [(0, sun), (1, course.gap.point().less(sun))] {
                let mut mesh = self.mesh(&Law::OPEN, (kind, i), beat, at);
                let law = Law::of(self.tables, (kind, i), mesh.overlap, mesh.speed, mesh.stiffness);
                mesh.overlap -= law.offset;
                mesh.force = law.closed * (mesh.stiffness * mesh.overlap) + law.damping * mesh.speed;
                start.settled &= law.side * mesh.overlap > reach * mesh.speed.abs();
                start.meshes[kind][i] = mesh;
                start.laws[kind][i] = law;
            }
        }
    }

    /// Stiffness and imposed error of one mesh.
    #[inline(always)]
    pub fn wave(&self, (kind, i): (usize, usize), beat: &Beat<T, OVERTONES>) -> MeshWave<T> {
        let tables = self.tables;
        let harmonics = tables.excitation.harmonics;
        tables.meshes[kind][i].at(beat, tables.springs[kind].stiffness, harmonics)
    }

    /// One mesh under a law.
    #[inline(always)]
    pub fn mesh(&self, law: &Law<T>, (kind, i): (usize, usize), beat: &Beat<T, OVERTONES>, at: Point<T>) -> Moment<T> {
        let MeshWave { stiffness, error, .. } = self.wave((kind, i), beat);
        let [sine, cosine] = self.tables.meshes[kind][i].error;
        let overlap = at.position - law.offset - sine * beat.rotor.sine - cosine * beat.rotor.cosine;
        let speed = at.rate - sine * beat.rates.sine - cosine * beat.rates.cosine;
        let force = law.closed * (stiffness * overlap) + law.damping * speed;
        Moment { overlap, speed, stiffness, error, force }
    }

    /// Zero while a mesh is under its law; positive when the law no longer holds: teeth in the gap reach a flank, or
    /// closed ones leave it. Where teeth only push they leave when their force turns, else when their overlap does.
    #[inline(always)]
    pub fn trespass(&self, law: &Law<T>, (kind, i): (usize, usize), moment: &Moment<T>) -> T {
        let half_backlash = self.tables.meshes[kind][i].half_backlash;
        let Moment { overlap, force, .. } = *moment;
        let press = self.adheres * overlap + self.pushes_only * force;
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

    /// Accelerations at the points of a stage; `see` is shown every mesh.
    #[inline(always)]
    pub fn pull(
        &self,
        laws: &Laws<T, N>,
        beat: &Beat<T, OVERTONES>,
        gap: Point<T>,
        wind_up_force: T,
        mut planet: impl FnMut(usize) -> Point<T>,
        mut see: impl FnMut((usize, usize), &Moment<T>),
    ) -> Relative<T, N> {
        let mut net = Net::NONE;
        each_planet!(N, i => {
            let sun = planet(i);
            let ring = gap.less(sun);
            let sun = self.mesh(&laws[0][i], (0, i), beat, sun);
            see((0, i), &sun);
            let ring = self.mesh(&laws[1][i], (1, i), beat, ring);
            see((1, i), &ring);
            net.add(i, sun.force, ring.force);
        });
        net.accelerations(&self.tables.stage.mobility, &self.drive, wind_up_force)
    }
}
