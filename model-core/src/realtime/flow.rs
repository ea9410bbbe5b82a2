//! Exponential flow of the closed joint. `hold` takes a whole tick while every mesh stays on its flank: linear motion
//! exactly, ripple and imposed error as a pseudo-force quadratic in time. `paper` is the paper's own scheme: the same
//! flow, with everything nonlinear as a pseudo-force held over the step.

#![allow(clippy::op_ref, reason = "a product by value would copy the table")]

use core::array;

use nalgebra::SVector;

use crate::mesh::DampingLaw;
use crate::real::Real;
use crate::realtime::contact::{Drive, Laws, spread};
use crate::realtime::crossing::End;
use crate::realtime::excitation::{Beat, Instant, MeshPhase, PerMesh, instant};
use crate::realtime::frozen::{Frozen, Start};
use crate::realtime::runge_kutta::Motion;
use crate::realtime::state::Relative;
use crate::realtime::substep::Course;
use crate::realtime::unfrozen::forces;
use crate::tables::{Inputs, Tables, Transition};

/// One tick with the contact set of its start; `None` if the set does not hold up to the middle. A mesh that opens
/// after that is a crossing to correct, so that no work is thrown away late.
pub fn hold<T: Real, const N: usize, const OVERTONES: bool>(
    frozen: &Frozen<T, N, OVERTONES>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    start: &Start<T, N>,
    motion: &Motion<T, N>,
) -> Option<Motion<T, N>> {
    let tables = frozen.tables;
    let flow = &tables.flow;
    let slow = phase.way < flow.longest_way && -phase.way < flow.longest_way;
    if !slow || !start.settled {
        return None;
    }
    let laws = &start.laws;
    let at_start = instant(tables, &Beat::new(phase.start, phase.rate));
    let (from_start, _) = closed_force(tables, laws, motion, &at_start);
    let modes = Modes::of(tables.planet_share, motion);

    let half = phase.over(T::HALF);
    let middle = phase.start.turned(&half);
    let guess = modes.free(&flow.half, drive).with([(&flow.half_constant, &from_start)]).motion();
    let at_middle = instant(tables, &Beat::new(middle, phase.rate));
    let (from_middle, true) = closed_force(tables, laws, &guess, &at_middle) else { return None };

    let end_beat = Beat::new(middle.turned(&half), phase.rate);
    let at_end = instant(tables, &end_beat);
    let free = modes.free(&flow.whole, drive);
    let [first, second] = &flow.whole_linear;
    let guess = free.with([(first, &from_start), (second, &from_middle)]).motion();
    let (from_end, closed) = closed_force(tables, laws, &guess, &at_end);

    let [first, second, third] = &flow.whole_quadratic;
    let end = free.with([(first, &from_start), (second, &from_middle), (third, &from_end)]).motion();
    if closed {
        return Some(end);
    }
    // In the units of a sub-step, to which half a tick is at least as long.
    let rate = tables.substep * phase.rate;
    let beat = Beat::new(end_beat.rotor, rate);
    let mut laws = *laws;
    let mut course = Course::of(&end, tables.substep);
    let wind_up = frozen.wind_up_force(course.wind_up.point());
    let mut trespasses = [[T::ZERO; N]; 2];
    let pushes_only = if tables.damping_law == DampingLaw::Contact { T::ONE } else { T::ZERO };
    let last = frozen.pull(
        &laws,
        &beat,
        course.gap.point(),
        wind_up,
        |i| course.planets[i].point(),
        |(kind, i), moment| {
            trespasses[kind][i] = frozen.trespass(&laws[kind][i], (kind, i), moment, pushes_only);
        },
    );
    course.each(&last, |coordinate, last| coordinate.now = last);
    End { frozen, rate, beat: &beat, trespasses: &trespasses }.correct(&mut laws, &mut course);
    Some(course.motion(tables.substep, tables.stage.rate, &end))
}

/// One tick of the paper's scheme: constant exponential, pseudo-force held over each sub-step (first-order
/// exponential time differencing).
pub fn paper<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.over(tables.half_part);
    let (mut motion, mut rotor) = (*motion, phase.start);
    let mut now = instant(tables, &Beat::new(rotor, phase.rate));
    for _ in 0..tables.substeps {
        let (positions, rates) = (spread(&motion.position), spread(&motion.rate));
        let mut force = forces(tables, &positions, &rates, &now);
        for kind in 0..2 {
            let spring = &tables.springs[kind];
            for i in 0..N {
                let linear = spring.stiffness * positions[kind][i] + spring.damping * rates[kind][i];
                force[kind][i] = linear - force[kind][i];
            }
        }
        let force = Sorted::new(tables.planet_share, &force);
        let free = Modes::of(tables.planet_share, &motion).free(&tables.flow.whole, drive);
        motion = free.with([(&tables.flow.whole_constant, &force)]).motion();
        rotor = rotor.turned(&half).turned(&half);
        now = instant(tables, &Beat::new(rotor, phase.rate));
    }
    motion
}

/// What the linear flow does not know of closed meshes: offset, imposed error, ripple; and whether every mesh is
/// closed, too far from opening for its speed to open it before the next node.
#[inline]
fn closed_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    laws: &Laws<T, N>,
    motion: &Motion<T, N>,
    instant: &Instant<T, N>,
) -> (Sorted<T, N>, bool) {
    let (positions, rates) = (spread(&motion.position), spread(&motion.rate));
    let mut force = positions;
    let mut holds = true;
    for kind in 0..2 {
        let spring = &tables.springs[kind];
        for i in 0..N {
            let (position, offset, error) = (positions[kind][i], laws[kind][i].offset, instant.error[kind][i]);
            let (stiffness, error_rate) = (instant.stiffness[kind][i], instant.error_rate[kind][i]);
            let overlap = position - error - offset;
            let way = tables.flow.reach * (rates[kind][i] - error_rate);
            // Beyond the flank by more than the way that the mesh may go, on the side that the offset says.
            holds &= if offset >= T::ZERO { overlap > way && overlap > -way } else { overlap < way && overlap < -way };
            force[kind][i] =
                (spring.stiffness - stiffness) * position + stiffness * (offset + error) + spring.damping * error_rate;
        }
    }
    (Sorted::new(tables.planet_share, &force), holds)
}

/// Mesh forces as the flow's inputs take them.
struct Sorted<T, const N: usize> {
    /// Sums over planets: sun-planet, ring-planet.
    sums: [T; 2],
    /// Deviation of (sun-planet - ring-planet) from its mean.
    apart: [T; N],
}

impl<T: Real, const N: usize> Sorted<T, N> {
    #[inline]
    fn new(share: T, force: &PerMesh<T, N>) -> Self {
        let sums = [total(&force[0]), total(&force[1])];
        let mean = share * (sums[0] - sums[1]);
        let mut apart = force[0];
        for (value, ring) in apart.iter_mut().zip(&force[1]) {
            *value = *value - *ring - mean;
        }
        Self { sums, apart }
    }
}

/// Motion split into what the planets do together and what each does apart, which the flow keeps apart.
#[derive(Clone, Copy)]
struct Modes<T: Real, const N: usize> {
    in_phase: SVector<T, 6>,
    deviations: [SVector<T, 2>; N],
}

impl<T: Real, const N: usize> Modes<T, N> {
    #[inline]
    fn of(share: T, motion: &Motion<T, N>) -> Self {
        let Motion { position, rate } = motion;
        let mean = share * total(&position.planets);
        let mean_rate = share * total(&rate.planets);
        Self {
            in_phase: SVector::from([mean, position.gap, position.wind_up, mean_rate, rate.gap, rate.wind_up]),
            deviations: array::from_fn(|i| SVector::from([position.planets[i] - mean, rate.planets[i] - mean_rate])),
        }
    }

    /// Linear flow under constant torques.
    #[inline]
    fn free(&self, transition: &Transition<T>, drive: &Drive<T>) -> Self {
        let torques = SVector::from([drive.sun, drive.carrier, drive.link]);
        Self {
            in_phase: self.in_phase + (&transition.in_phase.0 * &self.in_phase + &transition.torques.0 * &torques),
            deviations: array::from_fn(|i| self.deviations[i] + &transition.deviation.0 * &self.deviations[i]),
        }
    }

    /// Plus the response to pseudo-forces, each under its time weight.
    #[inline]
    fn with<const K: usize>(&self, terms: [(&Inputs<T>, &Sorted<T, N>); K]) -> Self {
        let mut sum = *self;
        for (inputs, force) in terms {
            sum.in_phase += &inputs.in_phase.0 * SVector::from(force.sums);
            let [value, rate] = inputs.deviation;
            for (deviation, apart) in sum.deviations.iter_mut().zip(&force.apart) {
                deviation[0] += value * *apart;
                deviation[1] += rate * *apart;
            }
        }
        sum
    }

    #[inline]
    fn motion(&self) -> Motion<T, N> {
        let [mean, gap, wind_up, mean_rate, gap_rate, wind_up_rate] = self.in_phase.data.0[0];
        Motion {
            position: Relative { planets: array::from_fn(|i| mean + self.deviations[i][0]), gap, wind_up },
            rate: Relative {
                planets: array::from_fn(|i| mean_rate + self.deviations[i][1]),
                gap: gap_rate,
                wind_up: wind_up_rate,
            },
        }
    }
}

fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}
