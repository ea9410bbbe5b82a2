//! Exponential flow of the closed joint: a whole tick while every mesh stays on its flank. The linear motion is exact;
//! ripple, backlash and imposed error are a pseudo-force, cubic in time through value and rate at the start and the
//! values at two looks on the way.

use core::array;

use crate::gears::contact::{Drive, Laws, Net};
use crate::gears::crossing::End;
use crate::gears::excitation::{Beat, MeshPhase, MeshWave};
use crate::gears::frozen::{Frozen, Moment, Start};
use crate::gears::planets::each_planet;
use crate::gears::runge_kutta::Motion;
use crate::gears::stages::{Course, Point};
use crate::gears::state::Relative;
use crate::gears::tables::{Block, Inputs, Transition};
use crate::numbers::Real;

/// What became of a tick with the contact set of its start.
pub enum Held<T, const N: usize> {
    /// The set held.
    Whole(Motion<T, N>),
    /// A mesh opened after the first look: a crossing to correct at the end, so that no work is thrown away late.
    Late(Motion<T, N>),
    /// The set does not hold up to the first look.
    Not,
}

/// One tick with the contact set of its start. `K` is the number of in-phase coordinates: 3 with compliance, 2 without.
#[inline(never)]
pub fn hold<T: Real, const N: usize, const K: usize, const OVERTONES: usize>(
    frozen: &Frozen<T, N, OVERTONES>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    start: &Start<T, N>,
    course: &Course<T, N>,
    motion: &Motion<T, N>,
) -> Held<T, N> {
    let tables = frozen.tables;
    let flow = &tables.flow;
    let slow = phase.way < flow.longest_way && -phase.way < flow.longest_way;
    if !slow || !start.settled {
        return Held::Not;
    }
    let laws = &start.laws;
    let (value, rate) = frozen.pseudo_force_at_start(phase, start, course);
    let modes = Modes::<T, N, K>::of(tables.planet_share, motion);
    let torques = [drive.sun, drive.carrier, drive.link];
    let look = |part: T| Beat::new(phase.start.turned(&phase.over(part)), phase.rate, tables.excitation.harmonics);

    let [first, second] = &flow.early_inputs;
    let place = modes.place(&flow.early, &torques).with([(first, &value), (second, &rate)]);
    let (early, trespass) = frozen.pseudo_force(laws, &look(flow.looks[0]), &place);
    if trespass > T::ZERO {
        return Held::Not;
    }

    let [first, second, third] = &flow.late_inputs;
    let place = modes.place(&flow.late, &torques).with([(first, &value), (second, &rate), (third, &early)]);
    let (late, trespass) = frozen.pseudo_force(laws, &look(flow.looks[1]), &place);

    let [first, second, third, fourth] = &flow.whole_inputs;
    let forces = [(first, &value), (second, &rate), (third, &early), (fourth, &late)];
    let last = modes.flow(&flow.whole, &torques).with(forces).motion();
    if trespass > T::ZERO { Held::Late(last) } else { Held::Whole(last) }
}

/// The end of a tick in whose second half meshes have opened.
#[inline(never)]
pub fn corrected<T: Real, const N: usize, const OVERTONES: usize>(
    frozen: &Frozen<T, N, OVERTONES>,
    laws: &mut Laws<T, N>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let tables = frozen.tables;
    let rate = tables.substep * phase.rate;
    let beat = Beat::new(phase.start.turned(&phase.over(T::ONE)), rate, tables.excitation.harmonics);
    let mut course = Course::of(motion, tables.substep);
    let wind_up = frozen.wind_up_force(course.wind_up.point());
    let mut trespasses = [[T::ZERO; N]; 2];
    let last = frozen.pull(
        laws,
        &beat,
        course.gap.point(),
        wind_up,
        |i| course.planets[i].point(),
        |(kind, i), moment| trespasses[kind][i] = frozen.trespass(&laws[kind][i], (kind, i), moment),
    );
    course.each(&last, |coordinate, last| coordinate.now = last);
    End { frozen, rate, beat: &beat, trespasses: &trespasses }.correct(laws, &mut course);
    course.motion(tables.substep, tables.stage.rate, motion)
}

impl<T: Real, const N: usize, const OVERTONES: usize> Frozen<'_, T, N, OVERTONES> {
    /// What the linear flow of the closed joint does not know of its forces at the start of a tick,
    /// k_mean x + c x' - F, and its rate, a sub-step.
    #[inline]
    fn pseudo_force_at_start(
        &self,
        phase: &MeshPhase<T>,
        start: &Start<T, N>,
        course: &Course<T, N>,
    ) -> (Push<T, N>, Push<T, N>) {
        let tables = self.tables;
        let rate = tables.substep * phase.rate;
        let square = rate * rate;
        let beat = Beat::<T, OVERTONES>::new(phase.start, rate, tables.excitation.harmonics);
        let mesh = |(kind, i): (usize, usize), at: Point<T>| {
            let (spring, damping) = (tables.springs[kind].stiffness, tables.stage.damping[kind]);
            let Moment { overlap, speed, stiffness, error, force } = start.meshes[kind][i];
            let harmonics = tables.excitation.harmonics;
            let stiffness_rate = tables.meshes[kind][i].stiffness_rate(&beat, harmonics);
            // e'' = -rate^2 e.
            (
                spring * at.position + damping * at.rate - force,
                spring * at.rate - stiffness * speed - stiffness_rate * overlap - damping * (square * error),
            )
        };
        let (mut value, mut change) = (Net::NONE, Net::NONE);
        each_planet!(N, i => {
            let sun = course.planets[i].point();
            let ring = mesh((1, i), course.gap.point().less(sun));
            let sun = mesh((0, i), sun);
            value.add(i, sun.0, ring.0);
            change.add(i, sun.1, ring.1);
        });
        (Push::of(tables.planet_share, &value), Push::of(tables.planet_share, &change))
    }

    /// What the linear flow does not know of closed meshes: offset, imposed error, ripple; and more than zero when a
    /// mesh is beyond its flank.
    #[inline(never)]
    fn pseudo_force(&self, laws: &Laws<T, N>, beat: &Beat<T, OVERTONES>, place: &Place<T, N>) -> (Push<T, N>, T) {
        let tables = self.tables;
        let (mut net, mut trespass) = (Net::NONE, T::ZERO);
        let mut mesh = |(kind, i): (usize, usize), position: T| {
            let law = &laws[kind][i];
            let MeshWave { stiffness, error, error_rate } = self.wave((kind, i), beat);
            let overlap = position - error - law.offset;
            let room = law.side * overlap;
            trespass += room.abs() - room;
            let spring = &tables.springs[kind];
            spring.stiffness * position - stiffness * overlap + spring.damping * error_rate
        };
        for i in 0..N {
            let sun = place.planets[i];
            net.add(i, mesh((0, i), sun), mesh((1, i), place.gap - sun));
        }
        (Push::of(tables.planet_share, &net), trespass)
    }
}

/// A pseudo-force as the flow's inputs take it.
struct Push<T, const N: usize> {
    /// Sums over planets: sun-planet, ring-planet.
    sums: [T; 2],
    /// Sun-planet less ring-planet force of every planet, less their mean.
    deviations: [T; N],
}

impl<T: Real, const N: usize> Push<T, N> {
    #[inline(always)]
    fn of(share: T, net: &Net<T, N>) -> Self {
        let mean = share * net.difference();
        let mut deviations = [T::ZERO; N];
        each_planet!(N, i => {
            deviations[i] = net.apart(i) - mean;
        });
        Self { sums: net.sums(), deviations }
    }
}

/// Where the meshes are; no more than the pseudo-force asks for.
struct Place<T, const N: usize> {
    planets: [T; N],
    gap: T,
}

/// Positions on the way: mean planet and gap, and every planet's deviation from the mean.
struct Positions<T, const N: usize> {
    in_phase: [T; 2],
    deviations: [T; N],
}

/// Motion split into what the planets do together (mean planet, gap, wind-up; then their rates) and what each does
/// apart (deviation, rate), which the flow keeps apart.
struct Modes<T, const N: usize, const K: usize> {
    in_phase: [[T; K]; 2],
    deviations: [[T; 2]; N],
}

impl<T: Real, const N: usize, const K: usize> Modes<T, N, K> {
    #[inline]
    fn of(share: T, motion: &Motion<T, N>) -> Self {
        let means = [&motion.position, &motion.rate].map(|part| share * total(&part.planets));
        let part = |half: usize, part: &Relative<T, N>| {
            let all = [means[half], part.gap, part.wind_up];
            array::from_fn(|k| all[k])
        };
        let (position, rate) = (&motion.position, &motion.rate);
        Self {
            in_phase: [part(0, position), part(1, rate)],
            deviations: array::from_fn(|i| [position.planets[i] - means[0], rate.planets[i] - means[1]]),
        }
    }

    /// Linear flow of one in-phase coordinate under constant torques.
    #[inline(always)]
    fn coordinate(&self, transition: &Transition<T>, torques: &[T; 3], half: usize, k: usize) -> T {
        let row = 3 * half + k;
        let mut change = T::ZERO;
        for from in 0..2 {
            for other in 0..K {
                change += entry(&transition.in_phase, row, 3 * from + other) * self.in_phase[from][other];
            }
        }
        // Without compliance the load acts on the carrier, with it on the link.
        for torque in [0, K - 1] {
            change += entry(&transition.torques, row, torque) * torques[torque];
        }
        self.in_phase[half][k] + change
    }

    /// Linear flow of one deviation.
    #[inline(always)]
    fn deviation(&self, transition: &Transition<T>, i: usize, half: usize) -> T {
        let [position, rate] = self.deviations[i];
        self.deviations[i][half]
            + (entry(&transition.deviation, half, 0) * position + entry(&transition.deviation, half, 1) * rate)
    }

    /// Linear flow of the positions that the meshes see.
    #[inline]
    fn place(&self, transition: &Transition<T>, torques: &[T; 3]) -> Positions<T, N> {
        let in_phase = [self.coordinate(transition, torques, 0, 0), self.coordinate(transition, torques, 0, 1)];
        let mut deviations = [T::ZERO; N];
        each_planet!(N, i => {
            deviations[i] = self.deviation(transition, i, 0);
        });
        Positions { in_phase, deviations }
    }

    /// Linear flow of everything.
    #[inline]
    fn flow(&self, transition: &Transition<T>, torques: &[T; 3]) -> Self {
        let (mut in_phase, mut deviations) = ([[T::ZERO; K]; 2], [[T::ZERO; 2]; N]);
        for half in 0..2 {
            for k in 0..K {
                in_phase[half][k] = self.coordinate(transition, torques, half, k);
            }
            each_planet!(N, i => {
                deviations[i][half] = self.deviation(transition, i, half);
            });
        }
        Self { in_phase, deviations }
    }

    /// Plus the response to pseudo-forces, each under its time weight.
    #[inline]
    fn with<const M: usize>(mut self, terms: [(&Inputs<T>, &Push<T, N>); M]) -> Self {
        for (inputs, push) in terms {
            for half in 0..2 {
                for k in 0..K {
                    self.in_phase[half][k] += together(inputs, push, 3 * half + k);
                }
            }
            for i in 0..N {
                for half in 0..2 {
                    self.deviations[i][half] += inputs.deviation[half] * push.deviations[i];
                }
            }
        }
        self
    }

    #[inline]
    fn motion(&self) -> Motion<T, N> {
        let part = |half: usize| {
            let in_phase = &self.in_phase[half];
            Relative {
                planets: array::from_fn(|i| in_phase[0] + self.deviations[i][half]),
                gap: in_phase[1],
                wind_up: if K > 2 { in_phase[K - 1] } else { T::ZERO },
            }
        };
        Motion { position: part(0), rate: part(1) }
    }
}

impl<T: Real, const N: usize> Positions<T, N> {
    /// Plus the response to pseudo-forces, each under its time weight.
    #[inline]
    fn with<const M: usize>(mut self, terms: [(&Inputs<T>, &Push<T, N>); M]) -> Place<T, N> {
        for (inputs, push) in terms {
            for k in 0..2 {
                self.in_phase[k] += together(inputs, push, k);
            }
            for i in 0..N {
                self.deviations[i] += inputs.deviation[0] * push.deviations[i];
            }
        }
        let [mean, gap] = self.in_phase;
        Place { planets: self.deviations.map(|deviation| mean + deviation), gap }
    }
}

/// In-phase response to the sums of the mesh forces.
#[inline(always)]
fn together<T: Real, const N: usize>(inputs: &Inputs<T>, push: &Push<T, N>, row: usize) -> T {
    let [sun_planet, ring_planet] = push.sums;
    entry(&inputs.in_phase, row, 0) * sun_planet + entry(&inputs.in_phase, row, 1) * ring_planet
}

#[inline(always)]
fn entry<T: Real, const R: usize, const C: usize>(block: &Block<T, R, C>, row: usize, column: usize) -> T {
    block.0.data.0[column][row]
}

fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}
