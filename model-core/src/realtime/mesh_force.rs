//! Mesh deflections, the affine force law of a frozen contact set, and the motion that mesh forces cause. Which law a
//! mesh is under is decided once (`Law::of`) and then held; crossings are corrected elsewhere.

use core::array;

use crate::dead_zone;
use crate::mesh::{ContactState, DampingLaw};
use crate::real::Real;
use crate::realtime::excitation::{Instant, Instants};
use crate::realtime::state::Relative;
use crate::tables::Tables;

/// One value for each mesh: sun-planet of every planet, then ring-planet.
pub type PerMesh<T, const N: usize> = [[T; N]; 2];

/// Deflection and its rate of one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection<T> {
    /// Along the line of action.
    pub value: T,
    /// Its rate.
    pub rate: T,
}

/// The force of one mesh while its contact does not change: stiffness * (deflection - offset) + damping * rate, the
/// stiffness counted only when `closed`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law<T> {
    /// Teeth press: the spring acts.
    pub closed: bool,
    /// +b on the drive side, -b on the back side, 0 in the gap.
    pub offset: T,
    /// Damping that acts in this contact state.
    pub damping: T,
}

impl<T: Real> Law<T> {
    /// The law that holds at a deflection (eq. 12 with the damping of the joint's law).
    #[inline]
    pub fn of<const N: usize>(
        tables: &Tables<T, N>,
        kind: usize,
        planet: usize,
        deflection: Deflection<T>,
        instant: &Instant<T>,
    ) -> Self {
        let half_backlash = tables.meshes[kind][planet].half_backlash;
        let damping = tables.springs[kind].damping;
        let open = Self {
            closed: false,
            offset: T::ZERO,
            damping: match tables.damping_law {
                DampingLaw::Paper => damping,
                DampingLaw::Contact => T::ZERO,
            },
        };
        let offset = match contact(deflection.value, half_backlash) {
            ContactState::DriveSide => half_backlash,
            ContactState::BackSide => -half_backlash,
            ContactState::Separated => return open,
        };
        let closed = Self { closed: true, offset, damping };
        let pushes = match tables.damping_law {
            DampingLaw::Paper => true,
            // Teeth only push: a force against the side of contact is no force.
            DampingLaw::Contact => {
                let force = closed.force(deflection, instant);
                if deflection.value > T::ZERO { force > T::ZERO } else { force < T::ZERO }
            }
        };
        if pushes { closed } else { open }
    }

    /// The force under this law.
    #[inline]
    pub fn force(&self, deflection: Deflection<T>, instant: &Instant<T>) -> T {
        let stiffness = if self.closed { instant.stiffness } else { T::ZERO };
        stiffness * (deflection.value - self.offset) + self.damping * deflection.rate
    }
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

/// Deflections of all meshes (eq. 4) without imposed errors: planets[i] and gap - planets[i].
#[inline]
pub fn kinematic_deflections<T: Real, const N: usize>(
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
) -> PerMesh<Deflection<T>, N> {
    [
        array::from_fn(|i| Deflection { value: position.planets[i], rate: rate.planets[i] }),
        array::from_fn(|i| Deflection { value: position.gap - position.planets[i], rate: rate.gap - rate.planets[i] }),
    ]
}

/// Deflections of all meshes (eq. 4), imposed errors taken off.
#[inline]
pub fn deflections<T: Real, const N: usize>(
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
    instants: &Instants<T, N>,
) -> PerMesh<Deflection<T>, N> {
    let mut deflections = kinematic_deflections(position, rate);
    for (family, instants) in deflections.iter_mut().zip(instants) {
        for (deflection, instant) in family.iter_mut().zip(instants) {
            deflection.value -= instant.error;
            deflection.rate -= instant.error_rate;
        }
    }
    deflections
}

/// Smoothed force of one mesh (eq. 13): no contact set to freeze.
pub fn smoothed_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    kind: usize,
    planet: usize,
    deflection: Deflection<T>,
    instant: &Instant<T>,
) -> T {
    let half_backlash = tables.meshes[kind][planet].half_backlash;
    let elastic = instant.stiffness * dead_zone::smoothed(deflection.value, half_backlash, tables.sharpness);
    elastic + tables.springs[kind].damping * deflection.rate
}

/// Accelerations of the bodies other than by mesh forces: drive and load, in units of b_c omega_n^2.
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

/// Relative accelerations (eqs 1-3 in the coordinates of eqs 16 and 17).
#[inline]
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
    Relative {
        planets: array::from_fn(|i| apart - mobility.planet * (sun_planet[i] - ring_planet[i])),
        gap: apart - carrier,
        wind_up: mobility.wind_up * (carrier - link),
    }
}

/// Force between carrier and link.
#[inline]
pub fn wind_up_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
) -> T {
    tables.mobility.wind_up_stiffness * position.wind_up + tables.mobility.wind_up_damping * rate.wind_up
}
