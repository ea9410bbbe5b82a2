//! A tick in sub-steps, the path that is taken when contacts may change. Each sub-step freezes the contact set, so that
//! its right-hand side is smooth, and is corrected for every crossing that its end reveals. The tanh dead zone has
//! nothing to freeze: see `unfrozen`.

use crate::gears::contact::{Laws, Net};
use crate::gears::crossing::End;
use crate::gears::excitation::{Beat, MeshPhase, PerMesh};
use crate::gears::frozen::{Frozen, Start};
use crate::gears::stages::Course;
use crate::numbers::Real;

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
