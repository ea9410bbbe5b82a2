//! Contact law of a mesh (S2) and the accelerations caused by mesh forces (S4). A law is affine in deflection and rate, so
//! the joint is linear while the contact set is fixed (`fixed_contact_set`).
//!
//! Equations: (P1), (P3) in docs/theory/paper.md.
//! Equations: (S1) in docs/theory/step.md.

use crate::gears::excitation::PerMesh;
use crate::gears::state::Relative;
use crate::gears::tables::{Mobility, Tables};
use crate::numbers::Real;
use parameters::{ContactState, DampingLaw};

/// Accelerations of the bodies caused by the applied torques alone, in units of b_c omega_n^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedAcceleration<T> {
    /// Acceleration of the sun by the drive torque.
    pub sun: T,
    /// Acceleration of the carrier by the load torque in a joint without compliance (negative for a positive load).
    pub carrier: T,
    /// Acceleration of the link by the load torque in a joint with compliance (negative for a positive load).
    pub link: T,
}

impl<T: Real> AppliedAcceleration<T> {
    /// Zero torques.
    pub const NONE: Self = Self { sun: T::ZERO, carrier: T::ZERO, link: T::ZERO };

    /// Returns `self - other`.
    pub fn minus(&self, other: &Self) -> Self {
        Self { sun: self.sun - other.sun, carrier: self.carrier - other.carrier, link: self.link - other.link }
    }

    /// Converts body accelerations to relative accelerations; planets have no acceleration of their own.
    #[inline(always)]
    pub fn relative<const N: usize>(&self, mobility: &Mobility<T>) -> Relative<T, N> {
        let apart = self.sun - self.carrier;
        Relative {
            planets: [apart; N],
            gap: apart - self.carrier,
            wind_up: mobility.wind_up * (self.carrier - self.link),
        }
    }

    /// Returns all accelerations times a factor.
    pub fn times(&self, scale: T) -> Self {
        Self { sun: scale * self.sun, carrier: scale * self.carrier, link: scale * self.link }
    }
}

/// Returns the contact state from the deflection d and half-backlash b alone. At d = b the teeth touch without force and
/// count as in contact, so that a mesh without backlash is never separated.
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

/// Returns the mesh coordinates of eq. 4 without imposed error: p_i for sun-planet, g - p_i for ring-planet.
#[inline]
pub fn mesh_coordinates<T: Real, const N: usize>(motion: &Relative<T, N>) -> PerMesh<T, N> {
    let mut meshes = [motion.planets; 2];
    for ring in &mut meshes[1] {
        *ring = motion.gap - *ring;
    }
    meshes
}

/// Force law of one mesh in one contact state: closed * stiffness * (deflection - offset) + damping * rate (S2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law<T> {
    /// Flank on which the teeth press; `Separated` also if overlapping teeth would have to pull.
    pub contact: ContactState,
    /// 1 if the teeth press, else 0.
    pub closed: T,
    /// +b on the drive side, -b on the back side, 0 if open.
    pub offset: T,
    /// Damping in this contact state, over h.
    pub damping: T,
    /// +1 on the drive side, -1 on the back side, 0 if open.
    pub side: T,
    /// 1 - closed.
    pub open: T,
}

/// Laws of all meshes.
pub type Laws<T, const N: usize> = PerMesh<Law<T>, N>;

impl<T: Real> Law<T> {
    /// Placeholder before the first law is found.
    pub const ZERO: Self = Self {
        contact: ContactState::DriveSide,
        closed: T::ZERO,
        offset: T::ZERO,
        damping: T::ZERO,
        side: T::ZERO,
        open: T::ZERO,
    };

    /// Law of an open mesh without damping: no force.
    pub const OPEN: Self = Self { contact: ContactState::Separated, open: T::ONE, ..Self::ZERO };

    /// Finds the law at a deflection and speed: sharp dead zone (eq. 12) with the joint's damping law. The unit of time of
    /// `speed` is a sub-step.
    #[inline]
    pub fn at_deflection<const N: usize>(
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
            // Teeth only push: a force that would pull opens the mesh.
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

/// Sums of mesh forces that act on the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetForces<T, const N: usize> {
    sun_planet: T,
    ring_planet: T,
    /// Sun-planet force minus ring-planet force of every planet.
    differences: [T; N],
}

impl<T: Real, const N: usize> NetForces<T, N> {
    /// Zero force.
    pub const NONE: Self = Self { sun_planet: T::ZERO, ring_planet: T::ZERO, differences: [T::ZERO; N] };

    /// Sums the forces of all meshes.
    #[inline(always)]
    pub fn sum_over<M>(meshes: &PerMesh<M, N>, force: impl Fn(&M) -> T) -> Self {
        let mut net = Self::NONE;
        for i in 0..N {
            net.add(i, force(&meshes[0][i]), force(&meshes[1][i]));
        }
        net
    }

    /// Adds both forces of planet `i`; the planet must not have a force yet.
    #[inline(always)]
    pub fn add(&mut self, i: usize, sun_planet: T, ring_planet: T) {
        self.sun_planet += sun_planet;
        self.ring_planet += ring_planet;
        self.differences[i] = sun_planet - ring_planet;
    }

    /// Returns the sums over planets: sun-planet, ring-planet.
    #[inline(always)]
    pub fn sums(&self) -> [T; 2] {
        [self.sun_planet, self.ring_planet]
    }

    /// Returns the sun-planet sum minus the ring-planet sum.
    #[inline(always)]
    pub fn difference(&self) -> T {
        self.sun_planet - self.ring_planet
    }

    /// Returns the sun-planet force minus the ring-planet force of one planet.
    #[inline(always)]
    pub fn difference_of(&self, i: usize) -> T {
        self.differences[i]
    }

    /// Adds the force of one mesh.
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

    /// Returns the relative accelerations by mesh forces and applied torques (S4).
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

    /// Returns the relative accelerations by the mesh forces and the wind-up force alone.
    #[inline(always)]
    pub fn response(&self, mobility: &Mobility<T>, wind_up_force: T) -> Relative<T, N> {
        self.relative(mobility, &self.body_accelerations(mobility, wind_up_force))
    }

    /// Returns the accelerations of sun, carrier and link by the mesh forces and the wind-up force.
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

/// Returns the relative accelerations under torques, mesh forces and the force between carrier and link.
#[inline(always)]
pub fn acceleration<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    mesh_forces: &PerMesh<T, N>,
    wind_up_force: T,
) -> Relative<T, N> {
    NetForces::sum_over(mesh_forces, |force| *force).accelerations(&tables.mobility, applied, wind_up_force)
}

/// Returns the force between carrier and link.
#[inline(always)]
pub fn wind_up_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
) -> T {
    tables.mobility.wind_up_stiffness * position.wind_up + tables.mobility.wind_up_damping * rate.wind_up
}
