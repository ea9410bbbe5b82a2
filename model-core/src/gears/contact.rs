//! The contact law of each mesh, and the accelerations that mesh forces cause. A law is affine in deflection and rate, so
//! the joint is linear while the contact set is fixed (`fixed_contact_set`).

use crate::gears::excitation::PerMesh;
use crate::gears::state::Relative;
use crate::gears::tables::{Mobility, Tables};
use crate::numbers::Real;
use parameters::{ContactState, DampingLaw};

/// Accelerations of the bodies by the applied torques alone, without mesh forces, in units of b_c omega_n^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedAcceleration<T> {
    /// Of the sun, by the drive torque.
    pub sun: T,
    /// Of the carrier, by the load torque when there is no compliance (negative for a positive load).
    pub carrier: T,
    /// Of the link, by the load torque when there is compliance.
    pub link: T,
}

impl<T: Real> AppliedAcceleration<T> {
    /// No torque: what remains is the response to mesh forces.
    pub const NONE: Self = Self { sun: T::ZERO, carrier: T::ZERO, link: T::ZERO };

    /// The difference to another.
    pub fn minus(&self, other: &Self) -> Self {
        Self { sun: self.sun - other.sun, carrier: self.carrier - other.carrier, link: self.link - other.link }
    }

    /// Relative accelerations where planets feel no force.
    #[inline(always)]
    pub fn relative<const N: usize>(&self, mobility: &Mobility<T>) -> Relative<T, N> {
        let apart = self.sun - self.carrier;
        Relative {
            planets: [apart; N],
            gap: apart - self.carrier,
            wind_up: mobility.wind_up * (self.carrier - self.link),
        }
    }

    /// All of them times a factor.
    pub fn times(&self, scale: T) -> Self {
        Self { sun: scale * self.sun, carrier: scale * self.carrier, link: scale * self.link }
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

/// Mesh coordinates of eq. 4 without imposed error: the planet's own (sun-planet), the gap less that (ring-planet).
#[inline]
pub fn mesh_coordinates<T: Real, const N: usize>(motion: &Relative<T, N>) -> PerMesh<T, N> {
    let mut meshes = [motion.planets; 2];
    for ring in &mut meshes[1] {
        *ring = motion.gap - *ring;
    }
    meshes
}

/// Force of one mesh while its contact does not change: closed * stiffness * (deflection - offset) + damping * rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law<T> {
    /// Where teeth press; separated also where overlapping teeth would have to pull.
    pub contact: ContactState,
    /// One where teeth press, zero where they do not.
    pub closed: T,
    /// +b on the drive side, -b on the back side, 0 where open.
    pub offset: T,
    /// Damping that acts in this contact state, over h.
    pub damping: T,
    /// +1 on the drive side, -1 on the back side, 0 where open.
    pub side: T,
    /// 1 - closed.
    pub open: T,
}

/// The law of every mesh.
pub type Laws<T, const N: usize> = PerMesh<Law<T>, N>;

impl<T: Real> Law<T> {
    /// All zeros: no law yet.
    pub const ZERO: Self = Self {
        contact: ContactState::DriveSide,
        closed: T::ZERO,
        offset: T::ZERO,
        damping: T::ZERO,
        side: T::ZERO,
        open: T::ZERO,
    };

    /// No force at all.
    pub const OPEN: Self = Self { contact: ContactState::Separated, open: T::ONE, ..Self::ZERO };

    /// The law that holds at a deflection and rate (eq. 12 with the damping of the joint's law); the rate counts a
    /// sub-step as the unit of time.
    #[inline]
    pub fn of<const N: usize>(
        tables: &Tables<T, N>,
        (kind, planet): (usize, usize),
        deflection: T,
        speed: T,
        stiffness: T,
    ) -> Self {
        let contact_law = tables.damping_law == DampingLaw::Contact;
        let damping = tables.stage.damping[kind];
        let half_backlash = tables.meshes[kind][planet].half_backlash;
        let drive_side = deflection >= half_backlash;
        let offset = if drive_side { half_backlash } else { -half_backlash };
        let mut closed = drive_side || deflection <= -half_backlash;
        if contact_law {
            // Teeth only push: a force against the side of contact is no force.
            let force = stiffness * (deflection - offset) + damping * speed;
            closed &= if drive_side { force > T::ZERO } else { force < T::ZERO };
        }
        if closed {
            let (contact, side) =
                if drive_side { (ContactState::DriveSide, T::ONE) } else { (ContactState::BackSide, -T::ONE) };
            Self { contact, closed: T::ONE, offset, damping, side, open: T::ZERO }
        } else {
            Self { damping: if contact_law { T::ZERO } else { damping }, ..Self::OPEN }
        }
    }
}

/// Mesh forces summed up as the bodies feel them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetForces<T, const N: usize> {
    sun_planet: T,
    ring_planet: T,
    /// Sun-planet force less ring-planet force of every planet.
    differences: [T; N],
}

impl<T: Real, const N: usize> NetForces<T, N> {
    /// No force.
    pub const NONE: Self = Self { sun_planet: T::ZERO, ring_planet: T::ZERO, differences: [T::ZERO; N] };

    /// All mesh forces.
    #[inline(always)]
    pub fn of<M>(meshes: &PerMesh<M, N>, force: impl Fn(&M) -> T) -> Self {
        let mut net = Self::NONE;
        for i in 0..N {
            net.add(i, force(&meshes[0][i]), force(&meshes[1][i]));
        }
        net
    }

    /// Both forces on a planet that had none.
    #[inline(always)]
    pub fn add(&mut self, i: usize, sun_planet: T, ring_planet: T) {
        self.sun_planet += sun_planet;
        self.ring_planet += ring_planet;
        self.differences[i] = sun_planet - ring_planet;
    }

    /// Sums over planets: sun-planet, ring-planet.
    #[inline(always)]
    pub fn sums(&self) -> [T; 2] {
        [self.sun_planet, self.ring_planet]
    }

    /// Sum over planets of sun-planet less ring-planet.
    #[inline(always)]
    pub fn difference(&self) -> T {
        self.sun_planet - self.ring_planet
    }

    /// Sun-planet less ring-planet force of one planet.
    #[inline(always)]
    pub fn difference_of(&self, i: usize) -> T {
        self.differences[i]
    }

    /// The force of one more mesh.
    #[inline(always)]
    pub fn add_one(&mut self, (kind, i): (usize, usize), force: T) {
        if kind == 0 {
            self.sun_planet += force;
            self.differences[i] += force;
        } else {
            self.ring_planet += force;
            self.differences[i] -= force;
        }
    }

    /// Relative accelerations (eqs 1-3 in the coordinates of eqs 16 and 17).
    #[inline(always)]
    pub fn accelerations(
        &self,
        mobility: &Mobility<T>,
        applied: &AppliedAcceleration<T>,
        wind_up_force: T,
    ) -> Relative<T, N> {
        let own = self.body_accelerations(mobility, wind_up_force);
        let all = AppliedAcceleration {
            sun: applied.sun + own.sun,
            carrier: applied.carrier + own.carrier,
            link: applied.link + own.link,
        };
        self.relative(mobility, &all)
    }

    /// What these forces alone cause.
    #[inline(always)]
    pub fn response(&self, mobility: &Mobility<T>, wind_up_force: T) -> Relative<T, N> {
        self.relative(mobility, &self.body_accelerations(mobility, wind_up_force))
    }

    /// Accelerations of all bodies but the planets.
    #[inline(always)]
    fn body_accelerations(&self, mobility: &Mobility<T>, wind_up_force: T) -> AppliedAcceleration<T> {
        AppliedAcceleration {
            sun: -(mobility.sun * self.sun_planet),
            carrier: mobility.carrier * (self.sun_planet + self.ring_planet - wind_up_force),
            link: mobility.link * wind_up_force,
        }
    }

    #[inline(always)]
    fn relative(&self, mobility: &Mobility<T>, all: &AppliedAcceleration<T>) -> Relative<T, N> {
        let mut relative = all.relative(mobility);
        for (planet, apart) in relative.planets.iter_mut().zip(&self.differences) {
            *planet -= mobility.planet * *apart;
        }
        relative
    }
}

/// Relative accelerations under mesh forces and the force between carrier and link.
#[inline(always)]
pub fn acceleration<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    mesh_forces: &PerMesh<T, N>,
    wind_up_force: T,
) -> Relative<T, N> {
    NetForces::of(mesh_forces, |force| *force).accelerations(&tables.mobility, applied, wind_up_force)
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
