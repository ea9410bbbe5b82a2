//! Tick of a joint with light planets, which ring several times in a tick: one exponential while every mesh stays in
//! contact (`linear_contact`), otherwise position-Verlet (leapfrog) sub-steps (S11), (S12). Contact events are not located:
//! on the straight path of a sub-step the mean force of a sharp dead zone has a closed form.
//!
//! Runge-Kutta methods damp modes that they do not resolve; the Verlet method does not, so bouncing planets keep their
//! energy. Force, rate and position are of second order. The two largest errors, from the curvature of the path and from
//! the time at which damping is evaluated, are proportional to the acceleration of the mesh. `yielding` removes both for
//! the planet's own acceleration. The errors by the accelerations of sun and carrier and, under the law `paper`, of damping
//! in the gap remain: mesh damping is therefore of first order, with a small factor.

use core::hint::black_box;

use crate::gears::contact::AppliedAcceleration;
use crate::gears::excitation::{MeshPhase, PerMesh, Phasor, stiffnesses};
use crate::gears::linear_contact;
use crate::gears::state::MotionInPlace;
use crate::gears::tables::Tables;
use crate::numbers::Real;
use parameters::DampingLaw;

/// Advances the motion in place by one tick.
#[inline(always)]
pub fn tick<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    mut motion: MotionInPlace<T, N>,
) {
    let middle = phase.at(T::HALF);
    let stiffness = stiffnesses(tables, &middle);
    if linear_contact::tick(tables, applied, phase, &middle, &stiffness, &mut motion) {
        return;
    }
    match tables.damping_law {
        DampingLaw::Contact => verlet::<T, N, true>(tables, applied, &middle, phase.rate, &stiffness, &mut motion),
        DampingLaw::Paper => verlet::<T, N, false>(tables, applied, &middle, phase.rate, &stiffness, &mut motion),
    }
}

/// Advances the motion by position-Verlet sub-steps (S11): drift by half a sub-step, forces there, drift by the new rate.
/// The loop carries deflections from middle to middle of sub-steps; the unit of time is a sub-step. Imposed errors are
/// linear in time through value and rate in the middle of the tick; one phasor, linear in time, serves all meshes.
#[inline(never)]
fn verlet<T: Real, const N: usize, const CONTACT_LAW: bool>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    middle: &Phasor<T>,
    phase_rate: T,
    stiffness: &PerMesh<T, N>,
    motion: &mut MotionInPlace<T, N>,
) {
    let verlet = &tables.verlet;
    let h = verlet.substep;
    let turning = middle.rates(h * phase_rate);
    let first = middle.moved(T::HALF - verlet.half_count, &turning);
    let (mut wind_up, mut gap) = (motion.position.wind_up, motion.position.gap);
    let (mut wind_up_travel, mut gap_travel) = (h * motion.rate.wind_up, h * motion.rate.gap);
    wind_up += T::HALF * wind_up_travel;
    gap += T::HALF * gap_travel;
    let mut deflection = [[T::ZERO; N]; 2];
    let mut travel = deflection;
    for i in 0..N {
        let u = h * motion.rate.planets[i];
        let x = motion.position.planets[i] + T::HALF * u;
        for (kind, position, rate) in [(0, x, u), (1, gap - x, gap_travel - u)] {
            let mesh = &tables.meshes[kind][i];
            deflection[kind][i] = position - mesh.error_at(&first);
            travel[kind][i] = rate - mesh.error_at(&turning);
        }
    }
    let substep = Substep {
        tables,
        stiffness,
        sun: verlet.square * applied.sun,
        carrier: verlet.square * applied.carrier,
        link: verlet.square * applied.link,
    };

    for _ in 0..verlet.substeps {
        // `black_box` keeps the compiler from moving loads of constants in front of the loop: from there they would pass
        // through the stack, three instructions in place of one.
        let Substep { tables, stiffness, sun: sun_drive, carrier: carrier_drive, link: link_drive } =
            black_box(&substep);
        let (verlet, sun_drive, carrier_drive, link_drive) = (&tables.verlet, *sun_drive, *carrier_drive, *link_drive);
        let mobility = &verlet.mobility;
        let (mut sun_sum, mut ring_sum) = (T::ZERO, T::ZERO);
        let mut planets = [T::ZERO; N];
        for i in 0..N {
            let mut force = [T::ZERO; 2];
            let mut yielding = [T::ZERO; 2];
            for kind in 0..2 {
                let (d, w) = (deflection[kind][i], travel[kind][i]);
                let half_backlash = tables.meshes[kind][i].half_backlash;
                let (over, speed) = (d.abs() - half_backlash, w.abs());
                if over + speed <= T::ZERO {
                    if !CONTACT_LAW {
                        force[kind] = verlet.damping[kind] * w;
                    }
                    continue;
                }
                let stiffness = stiffness[kind][i];
                let soft = verlet.curvature * stiffness + verlet.half_damped[kind];
                let release = verlet.release[kind][0] - verlet.release[kind][1] * stiffness;
                if over >= release * speed {
                    let offset = if d < T::ZERO { -half_backlash } else { half_backlash };
                    force[kind] = stiffness * (d - offset) + verlet.damping[kind] * w;
                    yielding[kind] = soft;
                } else {
                    let mesh = Grazing {
                        over,
                        closing: if d < T::ZERO { -w } else { w },
                        half_travel: T::HALF * speed,
                        width: half_backlash + half_backlash,
                        early: release - T::HALF,
                        stiffness,
                        damping: verlet.damping[kind],
                    };
                    let (value, part) = mesh.mean_force::<CONTACT_LAW>();
                    force[kind] = if d < T::ZERO { -value } else { value };
                    yielding[kind] = if part < T::ONE { verlet.half_damped[kind] * part } else { soft };
                }
            }
            // The planet's own acceleration reduces its two forces.
            let own = mobility.planet * (force[0] - force[1]);
            let sun = force[0] - yielding[0] * own;
            let ring = force[1] + yielding[1] * own;
            planets[i] = mobility.planet * (sun - ring);
            sun_sum += sun;
            ring_sum += ring;
        }
        let sun = sun_drive - mobility.sun * sun_sum;
        let carrier = carrier_drive + mobility.carrier * (sun_sum + ring_sum);
        let mut wind = mobility.wind_up_stiffness * wind_up + mobility.wind_up_damping * wind_up_travel;
        wind += verlet.wind_up_yield * (carrier - link_drive - verlet.wind_up_mobility * wind);
        let carrier = carrier - mobility.carrier * wind;
        let link = link_drive + mobility.link * wind;
        let apart = sun - carrier;
        let across = apart - carrier;
        gap_travel += across;
        gap += gap_travel;
        wind_up_travel += mobility.wind_up * (carrier - link);
        wind_up += wind_up_travel;
        for i in 0..N {
            let planet = apart - planets[i];
            travel[0][i] += planet;
            travel[1][i] += across - planet;
            deflection[0][i] += travel[0][i];
            deflection[1][i] += travel[1][i];
        }
    }

    let last = middle.moved(verlet.half_count, &turning);
    let rate = verlet.per_substep;
    for i in 0..N {
        let mesh = &tables.meshes[0][i];
        let (d, w) = (deflection[0][i], travel[0][i]);
        motion.position.planets[i] = d - T::HALF * w + mesh.error_at(&last);
        motion.rate.planets[i] = rate * (w + mesh.error_at(&turning));
    }
    motion.position.gap = gap - T::HALF * gap_travel;
    motion.rate.gap = rate * gap_travel;
    motion.position.wind_up = wind_up - T::HALF * wind_up_travel;
    motion.rate.wind_up = rate * wind_up_travel;
}

/// Constants over the sub-steps of a tick.
struct Substep<'a, T: Real, const N: usize> {
    tables: &'a Tables<T, N>,
    stiffness: &'a PerMesh<T, N>,
    /// Change of the sun's travel per sub-step by the drive torque; `carrier` and `link` by the load torque.
    sun: T,
    carrier: T,
    link: T,
}

/// Mesh whose contact begins or ends within a sub-step; the side of contact is positive.
struct Grazing<T> {
    /// Overlap in the middle of the sub-step; negative within the gap.
    over: T,
    /// Distance by which the teeth approach within the sub-step; negative for parting teeth.
    closing: T,
    /// Half the magnitude of `closing`.
    half_travel: T,
    /// Distance between the flanks, 2b.
    width: T,
    /// Damping over stiffness: overlap per unit of speed at which parting teeth lose contact (law `contact`).
    early: T,
    stiffness: T,
    damping: T,
}

impl<T: Real> Grazing<T> {
    /// Returns the mean force over the sub-step (S12) and the fraction of the sub-step in contact.
    #[inline(always)]
    fn mean_force<const CONTACT_LAW: bool>(&self) -> (T, T) {
        let parts = CONTACT_LAW && self.closing < T::ZERO;
        let (over, viscous) = if parts {
            (self.over + self.early * self.closing, T::ZERO)
        } else {
            (self.over, self.damping * self.closing)
        };
        let reach = over + self.half_travel;
        let travel = self.half_travel + self.half_travel;
        if reach <= T::ZERO {
            return (if CONTACT_LAW { T::ZERO } else { viscous }, T::ZERO);
        }
        if reach >= travel {
            return (self.stiffness * over + viscous, T::ONE);
        }
        // Here 0 < reach < travel.
        let part = reach / travel;
        let mut square = reach * part;
        // If the path crosses the whole gap, the other flank pushes back.
        let other = self.half_travel - self.over - self.width;
        if other > T::ZERO {
            square -= other * (other / travel);
        }
        let viscous = if CONTACT_LAW { part * viscous } else { viscous };
        (self.stiffness * (T::HALF * square) + viscous, part)
    }
}
