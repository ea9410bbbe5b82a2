//! A tick of a joint whose planets are so light that they ring within a tick: leapfrog sub-steps with the mean of the
//! sharp dead zone along each sub-step's path, in place of a frozen contact set and corrections for its crossings.
//! Ticks in which every tooth keeps pressing are left to `flow`.

use crate::mesh::DampingLaw;
use crate::real::Real;
use crate::realtime::contact::Drive;
use crate::realtime::excitation::Instant;
use crate::realtime::runge_kutta::Motion;
use crate::tables::{Light, Tables};

/// One tick; `middle` is the excitation half-way.
#[inline(never)]
pub fn advance<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    middle: &Instant<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let light = if squeezes(tables, motion) { &tables.light[1] } else { &tables.light[0] };
    match tables.damping_law {
        DampingLaw::Contact => path::<T, N, true>(tables, light, drive, middle, motion),
        DampingLaw::Paper => path::<T, N, false>(tables, light, drive, middle, motion),
    }
}

/// Whether a planet may be pressed from both sides within the tick, where it rings fastest.
fn squeezes<T: Real, const N: usize>(tables: &Tables<T, N>, motion: &Motion<T, N>) -> bool {
    let reach = motion.position.gap.abs() + tables.flow.step * motion.rate.gap.abs();
    let mut squeezes = false;
    for i in 0..N {
        squeezes |= reach > tables.light_gap[i];
    }
    squeezes
}

#[inline(always)]
fn path<T: Real, const N: usize, const PUSHES_ONLY: bool>(
    tables: &Tables<T, N>,
    light: &Light<T>,
    drive: &Drive<T>,
    middle: &Instant<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let h = light.substep;
    let mobility = &light.mobility;
    let (mut wind_up, mut gap) = (motion.position.wind_up, motion.position.gap);
    let (mut wind_up_way, mut gap_way) = (h * motion.rate.wind_up, h * motion.rate.gap);
    let mut deflection = [[T::ZERO; N]; 2];
    let mut way = deflection;
    let mut soft = deflection;
    let mut release = deflection;
    for i in 0..N {
        let (x, u) = (motion.position.planets[i], h * motion.rate.planets[i]);
        let (y, v) = (gap - x, gap_way - u);
        for (kind, position, rate) in [(0, x, u), (1, y, v)] {
            let error_way = h * middle.error_rate[kind][i];
            way[kind][i] = rate - error_way;
            deflection[kind][i] = position - middle.error[kind][i] + light.half_count * error_way + T::HALF * way[kind][i];
            soft[kind][i] = light.softness[kind][0] * middle.stiffness[kind][i] + light.softness[kind][1];
            release[kind][i] = light.release[kind][0] - light.release[kind][1] * middle.stiffness[kind][i];
        }
    }
    wind_up += T::HALF * wind_up_way;
    let constant = Drive { sun: light.square * drive.sun, carrier: light.square * drive.carrier, link: light.square * drive.link };
    for _ in 0..light.substeps {
        let mut forces = [[T::ZERO; N]; 2];
        let mut yielding = forces;
        let mut touched = false;
        for kind in 0..2 {
            for i in 0..N {
                let (d, w) = (deflection[kind][i], way[kind][i]);
                let half_backlash = tables.meshes[kind][i].half_backlash;
                let speed = w.abs();
                let over = d.abs() - half_backlash;
                if over + speed <= T::ZERO {
                    if !PUSHES_ONLY { forces[kind][i] = light.damping[kind] * w; }
                    continue;
                }
                touched = true;
                let offset = if d < T::ZERO { -half_backlash } else { half_backlash };
                let stiffness = middle.stiffness[kind][i];
                if over >= speed * release[kind][i] {
                    forces[kind][i] = stiffness * (d - offset) + light.damping[kind] * w;
                    yielding[kind][i] = soft[kind][i];
                } else {
                    (forces[kind][i], yielding[kind][i]) = grazing::<T, PUSHES_ONLY>(d, w, over, half_backlash, stiffness, light.damping[kind], release[kind][i], light.softness[kind][1], soft[kind][i]);
                }
            }
        }
        let wind = mobility.wind_up_stiffness * wind_up + mobility.wind_up_damping * wind_up_way;
        let [mut sun_sum, mut ring_sum] = [total(&forces[0]), total(&forces[1])];
        if touched {
            let carrier = constant.carrier + mobility.carrier * (sun_sum + ring_sum - wind);
            let apart = constant.sun - mobility.sun * sun_sum - carrier;
            let across = apart - carrier;
            for i in 0..N {
                let own = apart - mobility.planet * (forces[0][i] - forces[1][i]);
                let before = [forces[0][i], forces[1][i]];
                forces[0][i] += yielding[0][i] * own;
                forces[1][i] += yielding[1][i] * (across - own);
                for kind in 0..2 { if PUSHES_ONLY && forces[kind][i] * before[kind] < T::ZERO { forces[kind][i] = T::ZERO; } }
            }
            [sun_sum, ring_sum] = [total(&forces[0]), total(&forces[1])];
        }
        let sun = constant.sun - mobility.sun * sun_sum;
        let carrier = constant.carrier + mobility.carrier * (sun_sum + ring_sum);
        let bending = light.wind_up_yield * (carrier - constant.link - (mobility.carrier + mobility.link) * wind);
        let wind = wind + bending;
        let carrier = carrier - mobility.carrier * wind;
        let link = constant.link + mobility.link * wind;
        let apart = sun - carrier;
        gap += gap_way;
        let across = apart - carrier;
        gap_way += across;
        gap += T::HALF * across;
        wind_up_way += mobility.wind_up * (carrier - link);
        wind_up += wind_up_way;
        for i in 0..N {
            let planet = apart - mobility.planet * (forces[0][i] - forces[1][i]);
            way[0][i] += planet;
            way[1][i] += across - planet;
            deflection[0][i] += way[0][i];
            deflection[1][i] += way[1][i];
        }
    }
    let mut end = *motion;
    let rate = light.per_substep;
    for i in 0..N {
        let error_way = h * middle.error_rate[0][i];
        end.position.planets[i] = deflection[0][i] - T::HALF * way[0][i] + middle.error[0][i] + light.half_count * error_way;
        end.rate.planets[i] = rate * (way[0][i] + error_way);
    }
    end.position.gap = gap;
    end.rate.gap = rate * gap_way;
    end.position.wind_up = wind_up - T::HALF * wind_up_way;
    end.rate.wind_up = rate * wind_up_way;
    end
}

/// Mean force of a mesh whose contact begins or ends within the sub-step.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn grazing<T: Real, const PUSHES_ONLY: bool>(d: T, w: T, over: T, half_backlash: T, stiffness: T, damping: T, release: T, half_damped: T, yielding: T) -> (T, T) {
    let back = d < T::ZERO;
    let closing = if back { -w } else { w };
    let half_way = T::HALF * w.abs();
    let mut over = over;
    let mut viscous = damping * closing;
    if PUSHES_ONLY && closing < T::ZERO {
        over += (release - T::HALF) * closing;
        viscous = T::ZERO;
    }
    let reach = over + half_way;
    if reach <= T::ZERO { return (if PUSHES_ONLY { T::ZERO } else { damping * w }, T::ZERO); }
    let (mean, part);
    if over >= half_way { return (signed(back, stiffness * over + viscous), yielding); } else {
        part = reach.over(half_way + half_way);
        let other = half_way - d.abs() - half_backlash;
        let both = reach * part;
        mean = T::HALF * if other > T::ZERO { both - other * other.over(half_way + half_way) } else { both };
    }
    let force = stiffness * mean + if PUSHES_ONLY { part * viscous } else { viscous };
    (signed(back, force), half_damped * part)
}

#[inline(always)]
fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}

#[inline(always)]
fn signed<T: Real>(back: bool, value: T) -> T { if back { -value } else { value } }
