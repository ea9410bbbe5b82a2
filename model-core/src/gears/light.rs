//! A tick of a joint whose planets are so light that they ring several times within it: one exact exponential while
//! every tooth keeps pressing (`pressed`), leapfrog sub-steps through contacts otherwise. Nothing is located: along a
//! sub-step's straight path the mean force of a sharp dead zone is a closed form.
//!
//! A leapfrog does not damp what it cannot resolve, which Runge-Kutta methods do: bouncing planets keep their energy.
//! Force, rate and position are exact to second order; the two largest remainders, curvature of the path and the rate
//! at which damping is taken, are both proportional to the acceleration and are taken off together (`yielding`), as far
//! as the planet's own acceleration goes. What sun and carrier add to it is left, as is damping in the gap under the law
//! `paper`: mesh damping is therefore of first order, with a small factor.

use crate::gears::contact::Drive;
use crate::gears::excitation::{Beat, Instant, MOST_OVERTONES, MeshPhase, instant};
use crate::gears::pressed;
use crate::gears::runge_kutta::Motion;
use crate::gears::tables::Tables;
use crate::numbers::Real;
use parameters::DampingLaw;

/// One tick.
#[inline(never)]
pub fn tick<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let middle = instant(
        tables,
        &Beat::<T, MOST_OVERTONES>::new(
            phase.start.turned(&phase.over(T::HALF)),
            phase.rate,
            tables.excitation.harmonics,
        ),
    );
    if let Some(end) = pressed::hold(tables, drive, phase, &middle, motion) {
        return end;
    }
    match tables.damping_law {
        DampingLaw::Contact => leap::<T, N, true>(tables, drive, &middle, motion),
        DampingLaw::Paper => leap::<T, N, false>(tables, drive, &middle, motion),
    }
}

/// Leapfrog sub-steps: half a sub-step of drift, then forces in its middle and a drift by the new rate. Deflections
/// are carried from middle to middle, in a unit of time in which a sub-step lasts one.
#[inline(never)]
fn leap<T: Real, const N: usize, const PUSHES_ONLY: bool>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    middle: &Instant<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let light = &tables.light;
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
            // Imposed errors go straight through their value and rate in the middle of the tick.
            let error_way = h * middle.error_rate[kind][i];
            way[kind][i] = rate - error_way;
            let error = middle.error[kind][i] - light.half_count * error_way;
            deflection[kind][i] = position - error + T::HALF * way[kind][i];
            let stiffness = middle.stiffness[kind][i];
            soft[kind][i] = light.curvature * stiffness + light.half_damped[kind];
            release[kind][i] = light.release[kind][0] - light.release[kind][1] * stiffness;
        }
    }
    wind_up += T::HALF * wind_up_way;
    gap += T::HALF * gap_way;
    let sun_drive = light.square * drive.sun;
    let carrier_drive = light.square * drive.carrier;
    let link_drive = light.square * drive.link;

    for _ in 0..light.substeps {
        let (mut sun_sum, mut ring_sum) = (T::ZERO, T::ZERO);
        let mut planets = [T::ZERO; N];
        for i in 0..N {
            let mut force = [T::ZERO; 2];
            let mut yielding = [T::ZERO; 2];
            for kind in 0..2 {
                let (d, w) = (deflection[kind][i], way[kind][i]);
                let half_backlash = tables.meshes[kind][i].half_backlash;
                let (over, speed) = (d.abs() - half_backlash, w.abs());
                if over + speed <= T::ZERO {
                    if !PUSHES_ONLY {
                        force[kind] = light.damping[kind] * w;
                    }
                } else if over >= release[kind][i] * speed {
                    let offset = if d < T::ZERO { -half_backlash } else { half_backlash };
                    force[kind] = middle.stiffness[kind][i] * (d - offset) + light.damping[kind] * w;
                    yielding[kind] = soft[kind][i];
                } else {
                    let mesh = Grazing {
                        over,
                        closing: if d < T::ZERO { -w } else { w },
                        half_way: T::HALF * speed,
                        width: half_backlash + half_backlash,
                        early: release[kind][i] - T::HALF,
                        stiffness: middle.stiffness[kind][i],
                        damping: light.damping[kind],
                    };
                    let (value, part) = mesh.mean_force::<PUSHES_ONLY>();
                    force[kind] = if d < T::ZERO { -value } else { value };
                    yielding[kind] = if part < T::ONE { light.half_damped[kind] * part } else { soft[kind][i] };
                }
            }
            // What the planet's own acceleration takes off its two forces.
            let own = mobility.planet * (force[0] - force[1]);
            let sun = force[0] - yielding[0] * own;
            let ring = force[1] + yielding[1] * own;
            planets[i] = mobility.planet * (sun - ring);
            sun_sum += sun;
            ring_sum += ring;
        }
        let sun = sun_drive - mobility.sun * sun_sum;
        let carrier = carrier_drive + mobility.carrier * (sun_sum + ring_sum);
        let mut wind = mobility.wind_up_stiffness * wind_up + mobility.wind_up_damping * wind_up_way;
        wind += light.wind_up_yield * (carrier - link_drive - light.wind_up_mobility * wind);
        let carrier = carrier - mobility.carrier * wind;
        let link = link_drive + mobility.link * wind;
        let apart = sun - carrier;
        let across = apart - carrier;
        gap_way += across;
        gap += gap_way;
        wind_up_way += mobility.wind_up * (carrier - link);
        wind_up += wind_up_way;
        for i in 0..N {
            let planet = apart - planets[i];
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
        let error = middle.error[0][i] + light.half_count * error_way;
        end.position.planets[i] = deflection[0][i] - T::HALF * way[0][i] + error;
        end.rate.planets[i] = rate * (way[0][i] + error_way);
    }
    end.position.gap = gap - T::HALF * gap_way;
    end.rate.gap = rate * gap_way;
    end.position.wind_up = wind_up - T::HALF * wind_up_way;
    end.rate.wind_up = rate * wind_up_way;
    end
}

/// A mesh whose contact begins or ends within a sub-step, its side of contact taken as positive.
struct Grazing<T> {
    /// Overlap in the middle of the sub-step; negative within the gap.
    over: T,
    /// How far the teeth approach within the sub-step.
    closing: T,
    /// Half of that, whatever its sign.
    half_way: T,
    /// From flank to flank, 2b.
    width: T,
    /// Damping over stiffness: parting teeth let go at this overlap for each unit of speed (law `contact`).
    early: T,
    stiffness: T,
    damping: T,
}

impl<T: Real> Grazing<T> {
    /// Mean force over the sub-step, and the part of it in contact.
    #[inline(always)]
    fn mean_force<const PUSHES_ONLY: bool>(&self) -> (T, T) {
        let parts = PUSHES_ONLY && self.closing < T::ZERO;
        let (over, viscous) = if parts {
            (self.over + self.early * self.closing, T::ZERO)
        } else {
            (self.over, self.damping * self.closing)
        };
        let reach = over + self.half_way;
        let way = self.half_way + self.half_way;
        if reach <= T::ZERO {
            return (if PUSHES_ONLY { T::ZERO } else { viscous }, T::ZERO);
        }
        if reach >= way {
            return (self.stiffness * over + viscous, T::ONE);
        }
        // Here 0 < reach < way.
        let part = reach.over(way);
        let mut square = reach * part;
        // Across the whole gap within the sub-step: the other flank pushes back.
        let other = self.half_way - self.over - self.width;
        if other > T::ZERO {
            square -= other * other.over(way);
        }
        let viscous = if PUSHES_ONLY { part * viscous } else { viscous };
        (self.stiffness * (T::HALF * square) + viscous, part)
    }
}
