//! Which law each mesh is under, and what the meshes do to the joint while these laws hold. A law is affine in
//! deflection and rate, so a frozen contact set makes the joint linear; crossings are corrected elsewhere.

use crate::mesh::{ContactState, DampingLaw};
use crate::real::Real;
use crate::realtime::excitation::{Instant, PerMesh};
use crate::realtime::runge_kutta::Motion;
use crate::realtime::state::Relative;
use crate::tables::Tables;

/// Force of each mesh while its contact does not change: closed * stiffness * (deflection - offset) + damping * rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laws<T, const N: usize> {
    /// One where teeth press, zero where they do not.
    pub closed: PerMesh<T, N>,
    /// +b on the drive side, -b on the back side, 0 where open.
    pub offset: PerMesh<T, N>,
    /// Damping that acts in this contact state.
    pub damping: PerMesh<T, N>,
}

/// Forces of frozen laws at one instant: stiffness * coordinate + damping * rate - load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frozen<T, const N: usize> {
    /// Stiffness that acts.
    pub stiffness: PerMesh<T, N>,
    /// What offset and imposed error take off.
    pub load: PerMesh<T, N>,
}

/// Accelerations of the bodies other than by mesh forces, in units of b_c omega_n^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive<T> {
    /// Of the sun, by the drive torque.
    pub sun: T,
    /// Of the carrier, by the load torque when there is no compliance (negative for a positive load).
    pub carrier: T,
    /// Of the link, by the load torque when there is compliance.
    pub link: T,
}

impl<T: Real> Drive<T> {
    /// None at all: what is left is the response to forces.
    pub const NONE: Self = Self { sun: T::ZERO, carrier: T::ZERO, link: T::ZERO };
}

/// Contact state by geometry alone: d against b. At d = b the teeth touch without force and count as in contact, so
/// that a mesh without backlash is never separated.
#[inline]
pub fn contact<T: Real>(deflection: T, half_backlash: T) -> ContactState {
    if deflection >= half_backlash {
        ContactState::DriveSide
    } else if deflection <= -half_backlash {
        ContactState::BackSide
    } else {
        ContactState::Separated
    }
}

/// Mesh coordinate of eq. 4 without imposed error: a planet's own (sun-planet), or what the gap leaves (ring-planet).
#[inline]
pub fn spread<T: Real, const N: usize>(motion: &Relative<T, N>) -> PerMesh<T, N> {
    let mut meshes = [motion.planets; 2];
    for ring in &mut meshes[1] {
        *ring = motion.gap - *ring;
    }
    meshes
}

/// The law of one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law<T> {
    /// One where teeth press, zero where they do not.
    pub closed: T,
    /// +b on the drive side, -b on the back side, 0 where open.
    pub offset: T,
    /// Damping that acts in this contact state.
    pub damping: T,
}

/// What the meshes do at the end of a step under frozen laws.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed<T, const N: usize> {
    /// Deflection d.
    pub deflection: PerMesh<T, N>,
    /// Its rate.
    pub speed: PerMesh<T, N>,
    /// Mesh force under the frozen law, right or not.
    pub force: PerMesh<T, N>,
}

impl<T: Real> Law<T> {
    /// The law that holds at a deflection and rate (eq. 12 with the damping of the joint's law).
    #[inline]
    pub fn of<const N: usize>(
        tables: &Tables<T, N>,
        (kind, planet): (usize, usize),
        deflection: T,
        speed: T,
        stiffness: T,
    ) -> Self {
        let pushes_only = tables.damping_law == DampingLaw::Contact;
        let damping = tables.springs[kind].damping;
        let half_backlash = tables.meshes[kind][planet].half_backlash;
        let drive_side = deflection >= half_backlash;
        let offset = if drive_side { half_backlash } else { -half_backlash };
        let mut closed = drive_side || deflection <= -half_backlash;
        if pushes_only {
            // Teeth only push: a force against the side of contact is no force.
            let force = stiffness * (deflection - offset) + damping * speed;
            closed &= if drive_side { force > T::ZERO } else { force < T::ZERO };
        }
        if closed {
            Self { closed: T::ONE, offset, damping }
        } else {
            Self { closed: T::ZERO, offset: T::ZERO, damping: if pushes_only { T::ZERO } else { damping } }
        }
    }
}

impl<T: Real, const N: usize> Laws<T, N> {
    /// The laws that hold at a motion.
    #[inline]
    pub fn of(
        tables: &Tables<T, N>,
        position: &Relative<T, N>,
        rate: &Relative<T, N>,
        instant: &Instant<T, N>,
    ) -> Self {
        let (positions, rates) = (spread(position), spread(rate));
        let mut laws = Self { closed: [[T::ZERO; N]; 2], offset: [[T::ZERO; N]; 2], damping: [[T::ZERO; N]; 2] };
        for kind in 0..2 {
            for i in 0..N {
                let deflection = positions[kind][i] - instant.error[kind][i];
                let speed = rates[kind][i] - instant.error_rate[kind][i];
                laws.set(kind, i, Law::of(tables, (kind, i), deflection, speed, instant.stiffness[kind][i]));
            }
        }
        laws
    }

    /// Whether teeth press in every mesh.
    #[inline]
    pub fn all_closed(&self) -> bool {
        let mut all = T::ONE;
        for i in 0..N {
            all *= self.closed[0][i] * self.closed[1][i];
        }
        all > T::ZERO
    }

    /// The law of one mesh.
    #[inline]
    pub fn get(&self, kind: usize, i: usize) -> Law<T> {
        Law { closed: self.closed[kind][i], offset: self.offset[kind][i], damping: self.damping[kind][i] }
    }

    /// Puts one mesh under another law.
    #[inline]
    pub fn set(&mut self, kind: usize, i: usize, law: Law<T>) {
        self.closed[kind][i] = law.closed;
        self.offset[kind][i] = law.offset;
        self.damping[kind][i] = law.damping;
    }

    /// What the meshes do under these laws.
    #[inline]
    pub fn observe(&self, frozen: &Frozen<T, N>, motion: &Motion<T, N>, instant: &Instant<T, N>) -> Observed<T, N> {
        let (mut deflection, mut speed) = (spread(&motion.position), spread(&motion.rate));
        let mut force = deflection;
        for kind in 0..2 {
            for i in 0..N {
                force[kind][i] = frozen.stiffness[kind][i] * deflection[kind][i]
                    + self.damping[kind][i] * speed[kind][i]
                    - frozen.load[kind][i];
                deflection[kind][i] -= instant.error[kind][i];
                speed[kind][i] -= instant.error_rate[kind][i];
            }
        }
        Observed { deflection, speed, force }
    }

    /// Whether every mesh is still under its law.
    #[inline]
    pub fn hold(&self, tables: &Tables<T, N>, observed: &Observed<T, N>) -> bool {
        let pushes_only = tables.damping_law == DampingLaw::Contact;
        let mut hold = true;
        for kind in 0..2 {
            for i in 0..N {
                let deflection = observed.deflection[kind][i];
                let offset = self.offset[kind][i];
                let half_backlash = tables.meshes[kind][i].half_backlash;
                hold &= if self.closed[kind][i] > T::ZERO {
                    // Overlap, and under the law `contact` force too, must point away from the gap. Without backlash
                    // both flanks are one.
                    let back_side = offset < T::ZERO || (half_backlash == T::ZERO && deflection < T::ZERO);
                    let overlap = deflection - offset;
                    let force = if pushes_only { observed.force[kind][i] } else { overlap };
                    if back_side {
                        overlap <= T::ZERO && force <= T::ZERO
                    } else {
                        overlap >= T::ZERO && force >= T::ZERO
                    }
                } else {
                    deflection < half_backlash && deflection > -half_backlash
                };
            }
        }
        hold
    }

    /// These laws at an instant.
    #[inline]
    pub fn at(&self, instant: &Instant<T, N>) -> Frozen<T, N> {
        let mut frozen = Frozen { stiffness: [[T::ZERO; N]; 2], load: [[T::ZERO; N]; 2] };
        for kind in 0..2 {
            for i in 0..N {
                let stiffness = self.closed[kind][i] * instant.stiffness[kind][i];
                frozen.stiffness[kind][i] = stiffness;
                frozen.load[kind][i] = stiffness * (self.offset[kind][i] + instant.error[kind][i])
                    + self.damping[kind][i] * instant.error_rate[kind][i];
            }
        }
        frozen
    }
}

/// Relative accelerations under frozen laws (eqs 1-3 in the coordinates of eqs 16 and 17).
#[inline(always)]
pub fn frozen_acceleration<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    damping: &PerMesh<T, N>,
    frozen: &Frozen<T, N>,
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
) -> Relative<T, N> {
    let mut forces = [[T::ZERO; N]; 2];
    for i in 0..N {
        let (sun, sun_rate) = (position.planets[i], rate.planets[i]);
        let (ring, ring_rate) = (position.gap - sun, rate.gap - sun_rate);
        forces[0][i] = frozen.stiffness[0][i] * sun + damping[0][i] * sun_rate - frozen.load[0][i];
        forces[1][i] = frozen.stiffness[1][i] * ring + damping[1][i] * ring_rate - frozen.load[1][i];
    }
    acceleration(tables, drive, &forces, wind_up_force(tables, position, rate))
}

/// Relative accelerations under mesh forces and the force between carrier and link.
#[inline(always)]
pub fn acceleration<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    mesh_forces: &PerMesh<T, N>,
    wind_up_force: T,
) -> Relative<T, N> {
    let mobility = &tables.mobility;
    let [sun_planet, ring_planet] = mesh_forces;
    let (mut sun_sum, mut ring_sum) = (T::ZERO, T::ZERO);
    for i in 0..N {
        sun_sum += sun_planet[i];
        ring_sum += ring_planet[i];
    }
    let sun = drive.sun - mobility.sun * sun_sum;
    let carrier = drive.carrier + mobility.carrier * (sun_sum + ring_sum - wind_up_force);
    let link = drive.link + mobility.link * wind_up_force;
    let apart = sun - carrier;
    let mut planets = [T::ZERO; N];
    for i in 0..N {
        planets[i] = apart - mobility.planet * (sun_planet[i] - ring_planet[i]);
    }
    Relative { planets, gap: apart - carrier, wind_up: mobility.wind_up * (carrier - link) }
}

/// Force between carrier and link.
#[inline(always)]
pub fn wind_up_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
) -> T {
    tables.mobility.wind_up_stiffness * position.wind_up + tables.mobility.wind_up_damping * rate.wind_up
}
