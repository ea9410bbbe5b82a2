//! A tick in sub-steps, the path that is taken when contacts may change. Each sub-step freezes the contact set, so that
//! its right-hand side is smooth, and is corrected for every crossing that its end reveals. The tanh dead zone has
//! nothing to freeze: see `unfrozen`.

use core::array;

use crate::real::Real;
use crate::realtime::contact::{Drive, Laws, Net};
use crate::realtime::crossing::End;
use crate::realtime::excitation::{Beat, MeshPhase, PerMesh};
use crate::realtime::frozen::{Frozen, Start};
use crate::realtime::runge_kutta::Motion;
use crate::realtime::stages::Coordinate;
use crate::realtime::state::Relative;
use crate::tables::Mobility;

/// All coordinates, with a sub-step as the unit of time.
#[derive(Debug, Clone)]
pub struct Course<T, const N: usize> {
    /// u_s - u_pi - u_c of every planet, without imposed error.
    pub planets: [Coordinate<T>; N],
    /// u_s - 2 u_c.
    pub gap: Coordinate<T>,
    /// u_c - u_l.
    pub wind_up: Coordinate<T>,
}

/// One tick from laws and accelerations at its start; both are brought up to date.
#[inline(never)]
pub fn advance<T: Real, const N: usize, const OVERTONES: usize>(
    frozen: &Frozen<T, N, OVERTONES>,
    phase: &MeshPhase<T>,
    laws: &mut Laws<T, N>,
    course: &mut Course<T, N>,
) {
    let tables = frozen.tables;
    let compliant = tables.mobility.wind_up > T::ZERO;
    let half = phase.over(tables.half_part);
    let rate = tables.substep * phase.rate;
    let mut rotor = phase.start;
    let mut trespasses: PerMesh<T, N> = [[T::ZERO; N]; 2];
    for _ in 0..tables.substeps {
        rotor = rotor.turned(&half);
        let beat = Beat::new(rotor, rate, tables.excitation.harmonics);
        let gap = course.gap.middle();
        let wind_up = if compliant { frozen.wind_up_force(course.wind_up.middle()) } else { T::ZERO };
        let middle = frozen.pull(laws, &beat, gap, wind_up, |i| course.planets[i].middle(), |_, _| {});

        rotor = rotor.turned(&half);
        let beat = Beat::new(rotor, rate, tables.excitation.harmonics);
        let gap = course.gap.arrive(middle.gap);
        let wind_up = if compliant { frozen.wind_up_force(course.wind_up.arrive(middle.wind_up)) } else { T::ZERO };
        let planets = &mut course.planets;
        let mut trespass = T::ZERO;
        let last = frozen.pull(
            laws,
            &beat,
            gap,
            wind_up,
            |i| planets[i].arrive(middle.planets[i]),
            |(kind, i), moment| {
                let by = frozen.trespass(&laws[kind][i], (kind, i), moment);
                trespasses[kind][i] = by;
                trespass += by;
            },
        );
        for (planet, last) in course.planets.iter_mut().zip(last.planets) {
            planet.finish(last);
        }
        course.gap.finish(last.gap);
        if compliant {
            course.wind_up.finish(last.wind_up);
        }
        if trespass > T::ZERO {
            End { frozen, rate, beat: &beat, trespasses: &trespasses }.correct(laws, course);
        }
    }
}

/// The accelerations at the start of a tick, and those of half a sub-step before from a first look at the middle.
#[inline(never)]
pub fn begin<T: Real, const N: usize, const OVERTONES: usize>(
    frozen: &Frozen<T, N, OVERTONES>,
    start: &Start<T, N>,
    phase: &MeshPhase<T>,
    course: &mut Course<T, N>,
) {
    let tables = frozen.tables;
    let rotor = phase.start.turned(&phase.over(tables.half_part));
    let middle = Beat::new(rotor, tables.substep * phase.rate, tables.excitation.harmonics);
    let wind_up = frozen.wind_up_force(course.wind_up.point());
    let now = Net::of(&start.meshes, |mesh| mesh.force).accelerations(&tables.stage.mobility, &frozen.drive, wind_up);
    course.each(&now, |coordinate, now| (coordinate.now, coordinate.before) = (now, now));
    let wind_up = frozen.wind_up_force(course.wind_up.middle());
    let gap = course.gap.middle();
    let seen = frozen.pull(&start.laws, &middle, gap, wind_up, |i| course.planets[i].middle(), |_, _| {});
    course.each(&seen, |coordinate, seen| coordinate.before = coordinate.now + coordinate.now - seen);
}

impl<T: Real, const N: usize> Course<T, N> {
    /// Nowhere yet.
    pub const EMPTY: Self = Self { planets: [Coordinate::ZERO; N], gap: Coordinate::ZERO, wind_up: Coordinate::ZERO };

    /// Takes position and rate from a motion; accelerations are left as they are.
    #[inline(always)]
    pub fn place(&mut self, motion: &Motion<T, N>, length: T) {
        let Motion { position, rate } = motion;
        self.each(position, |coordinate, position| coordinate.position = position);
        self.each(rate, |coordinate, rate| coordinate.rate = length * rate);
    }

    /// Accelerations as if torques had always been larger by so much.
    #[inline(always)]
    pub fn pushed(&mut self, drive: &Drive<T>, mobility: &Mobility<T>) {
        self.each(&drive.relative(mobility), |coordinate, more| {
            coordinate.now += more;
            coordinate.before += more;
        });
    }

    /// A motion whose accelerations are not yet known, in sub-steps of a length.
    pub fn of(motion: &Motion<T, N>, length: T) -> Self {
        let mut course = Self::EMPTY;
        course.place(motion, length);
        course
    }

    /// The motion without its accelerations, from sub-steps at a rate, after it was `before`. Rates are taken over as
    /// their change, so that what no force has changed keeps its bits.
    pub fn motion(&self, length: T, per_length: T, before: &Motion<T, N>) -> Motion<T, N> {
        let rate = |coordinate: &Coordinate<T>, before: T| before + per_length * (coordinate.rate - length * before);
        let rates = &before.rate;
        Motion {
            position: Relative {
                planets: array::from_fn(|i| self.planets[i].position),
                gap: self.gap.position,
                wind_up: self.wind_up.position,
            },
            rate: Relative {
                planets: array::from_fn(|i| rate(&self.planets[i], rates.planets[i])),
                gap: rate(&self.gap, rates.gap),
                wind_up: rate(&self.wind_up, rates.wind_up),
            },
        }
    }

    /// Does the same to every coordinate with a value that belongs to it.
    #[inline(always)]
    pub fn each(&mut self, values: &Relative<T, N>, mut act: impl FnMut(&mut Coordinate<T>, T)) {
        for i in 0..N {
            act(&mut self.planets[i], values.planets[i]);
        }
        act(&mut self.gap, values.gap);
        act(&mut self.wind_up, values.wind_up);
    }
}
