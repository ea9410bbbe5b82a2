//! A tick in sub-steps, the path that is taken when contacts may change: each sub-step freezes the contact set, so
//! that its right-hand side is smooth, takes a Runge-Kutta step, and is corrected for every crossing that its end
//! reveals. The tanh dead zone has nothing to freeze: see `unfrozen`.

use crate::real::Real;
use crate::realtime::contact::{Drive, Laws, frozen_acceleration};
use crate::realtime::crossing::FrozenStep;
use crate::realtime::excitation::{Instant, MeshPhase, instant};
use crate::realtime::runge_kutta::{self, Motion};
use crate::tables::Tables;

/// One tick.
pub fn advance<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    start: &Instant<T, N>,
    laws: &Laws<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.over(tables.half_part);
    let (mut motion, mut rotor, mut laws) = (*motion, phase.start, *laws);
    let mut at_start = laws.at(start);
    for _ in 0..tables.substeps {
        rotor = rotor.turned(&half);
        let at_middle = laws.at(&instant(tables, &rotor, phase.rate));
        rotor = rotor.turned(&half);
        let end = instant(tables, &rotor, phase.rate);
        let at_end = laws.at(&end);
        let nodes = [&at_start, &at_middle, &at_end];
        motion = runge_kutta::step(tables.substep, &motion, |node, position, rate| {
            frozen_acceleration(tables, drive, &laws.damping, nodes[node], position, rate)
        });
        let observed = laws.observe(&at_end, &motion, &end);
        if laws.hold(tables, &observed) {
            at_start = at_end;
        } else {
            let step = FrozenStep { step: tables.substep, phase_rate: phase.rate, observed: &observed };
            motion = step.correct(tables, drive, &end, &mut laws, &motion);
            at_start = laws.at(&end);
        }
    }
    motion
}
