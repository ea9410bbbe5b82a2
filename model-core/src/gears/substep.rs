//! Tick in sub-steps (S9), for ticks in which contacts may change. A fixed contact set makes the right-hand side of a
//! sub-step smooth; a law violated at the end of the sub-step triggers the crossing correction (S10). The tanh dead zone
//! has no contact set: see `full_forces`.

use crate::gears::contact::Laws;
use crate::gears::crossing::StepEnd;
use crate::gears::excitation::{MeshPhase, PerMesh, PhaseHarmonics, Phasor};
use crate::gears::fixed_contact_set::FixedContactSet;
use crate::gears::stages::SubstepState;
use crate::numbers::Real;

/// Advances the motion by one tick from the laws and accelerations at the start of the tick; updates both.
#[inline(never)]
pub fn advance<T: Real, const N: usize, const OVERTONES: usize>(
    fixed: &FixedContactSet<T, N, OVERTONES>,
    phase: &MeshPhase<T>,
    laws: &mut Laws<T, N>,
    state: &mut SubstepState<T, N>,
) {
    let tables = fixed.tables;
    let compliant = tables.mobility.wind_up > T::ZERO;
    let half = phase.phasor_over(tables.half_substep_share);
    let rate = tables.substep * phase.rate;
    let mut phasor = Phasor::at(phase.start);
    let mut violations: PerMesh<T, N> = [[T::ZERO; N]; 2];
    for _ in 0..tables.substeps {
        phasor = phasor.turned(&half);
        let harmonics_now = PhaseHarmonics::new(phasor, rate, tables.excitation.harmonics);
        let gap = state.gap.middle();
        let wind_up = if compliant { fixed.wind_up_force(state.wind_up.middle()) } else { T::ZERO };
        let middle = fixed.accelerations(laws, &harmonics_now, gap, wind_up, |i| state.planets[i].middle(), |_, _| {});

        phasor = phasor.turned(&half);
        let harmonics_now = PhaseHarmonics::new(phasor, rate, tables.excitation.harmonics);
        let gap = state.gap.predict(middle.gap);
        let wind_up = if compliant { fixed.wind_up_force(state.wind_up.predict(middle.wind_up)) } else { T::ZERO };
        let planets = &mut state.planets;
        let mut violation = T::ZERO;
        let last = fixed.accelerations(
            laws,
            &harmonics_now,
            gap,
            wind_up,
            |i| planets[i].predict(middle.planets[i]),
            |(kind, i), mesh| {
                let by = fixed.violation(&laws[kind][i], (kind, i), mesh);
                violations[kind][i] = by;
                violation += by;
            },
        );
        for (planet, last) in state.planets.iter_mut().zip(last.planets) {
            planet.finish(last);
        }
        state.gap.finish(last.gap);
        if compliant {
            state.wind_up.finish(last.wind_up);
        }
        if violation > T::ZERO {
            StepEnd { fixed, rate, harmonics_now: &harmonics_now, violations: &violations }.correct(laws, state);
        }
    }
}

/// Evaluates the accelerations at the start of a tick (cold start): `now` at the start, and `before` by extrapolation from
/// an evaluation in the middle of the first sub-step. Without exponential ticks a cold start occurs only after the motion
/// was set from outside, and `before` equals `now`.
#[inline(never)]
pub fn begin<T: Real, const N: usize, const OVERTONES: usize>(
    fixed: &FixedContactSet<T, N, OVERTONES>,
    phase: &MeshPhase<T>,
    harmonics_now: &PhaseHarmonics<T, OVERTONES>,
    laws: &Laws<T, N>,
    state: &mut SubstepState<T, N>,
) {
    let tables = fixed.tables;
    let wind_up = fixed.wind_up_force(state.wind_up.point());
    let gap = state.gap.point();
    let now = fixed.accelerations(laws, harmonics_now, gap, wind_up, |i| state.planets[i].point(), |_, _| {});
    state.for_each(&now, |coordinate, now| (coordinate.now, coordinate.before) = (now, now));
    if !tables.flow.takes_whole_ticks() {
        return;
    }
    let phasor = phase.at(tables.half_substep_share);
    let middle = PhaseHarmonics::new(phasor, harmonics_now.rate, tables.excitation.harmonics);
    let wind_up = fixed.wind_up_force(state.wind_up.middle());
    let gap = state.gap.middle();
    let seen = fixed.accelerations(laws, &middle, gap, wind_up, |i| state.planets[i].middle(), |_, _| {});
    state.for_each(&seen, |coordinate, seen| coordinate.before = coordinate.now + coordinate.now - seen);
}
