//! One family of gear meshes, sun-planet or ring-planet: stiffness and its ripple (eq. 7), damping, transmission error
//! (eq. 11), backlash, dead zone and phases.

use crate::planets::PerPlanet;

/// Which of the two mesh families.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshKind {
    /// Sun with planet, external.
    SunPlanet,
    /// Fixed ring with planet, internal.
    RingPlanet,
}

/// Sun-planet first, ring-planet second: the order of every per-mesh table.
pub const MESH_KINDS: [MeshKind; 2] = [MeshKind::SunPlanet, MeshKind::RingPlanet];

/// Parameters of the meshes of one kind. Lists hold one value for each planet.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Mean stiffness K_m along the line of action [N/m].
    pub mean_stiffness: f64,
    /// How the stiffness varies over a mesh period.
    pub stiffness_wave: StiffnessWave,
    /// Damping ratio zeta of eqs 8-10 [-].
    pub damping_ratio: f64,
    /// Half-backlash b: the teeth are free over 2b [m].
    pub half_backlash: PerPlanet,
    /// Amplitude E of the transmission error (eq. 11) [m].
    pub transmission_error: PerPlanet,
    /// Phases of ripple and error.
    pub phases: MeshPhases,
}

/// K(t) over one mesh period, relative to the mean stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StiffnessWave {
    /// Eq. 7: 1 + ratio sin(phase).
    Harmonic {
        /// K_a / K_m [-].
        stiffness_ratio: f64,
    },
    /// Fig. 3: a rectangular wave whose first harmonic is the ripple of eq. 7. The duty of the higher level is the
    /// contact ratio less its whole part.
    Rectangular {
        /// (K_max - K_min) / (2 K_m) [-].
        stiffness_ratio: f64,
        /// Contact ratio of the pair, between 1 and 2 [-].
        contact_ratio: f64,
        /// Highest Fourier harmonic kept.
        order: usize,
    },
}

/// Phase of each planet's mesh [rad].
#[derive(Debug, Clone, PartialEq)]
pub enum MeshPhases {
    /// Stated one by one.
    Given {
        /// Phase phi_0 of the stiffness ripple, per planet [rad].
        stiffness: PerPlanet,
        /// Phase of the transmission error, per planet [rad].
        error: PerPlanet,
    },
    /// From tooth counts for equally spaced planets: planet i is ahead by 2 pi Zs i/n (sun) or -2 pi Zr i/n (ring).
    FromTeeth {
        /// Phase of planet 0's stiffness ripple [rad].
        stiffness: f64,
        /// Phase of planet 0's transmission error [rad].
        error: f64,
    },
}

/// What the mesh damping does once the teeth part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum DampingLaw {
    /// F = K f(d, b) + C d' always, as in the paper: it also acts in the gap.
    Paper,
    /// d > b: max(0, K (d - b) + C d'); d < -b: min(0, K (d + b) + C d'); otherwise 0. Teeth only push.
    Contact,
}

/// How the dead zone is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DeadZone {
    /// Eq. 12.
    Sharp,
    /// Eq. 13, corrected. The sharpness multiplies the dimensionless deflection.
    Tanh {
        /// sigma of eq. 13 [-].
        sharpness: f64,
    },
}

/// Which flank carries the force; its number stands for it in telemetry, on the wire and in files.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ContactState {
    /// -b <= d <= b.
    #[default]
    Separated = 0,
    /// d > b.
    DriveSide = 1,
    /// d < -b.
    BackSide = 2,
}

impl ContactState {
    /// Its number: 0 parted, 1 drive side, 2 back side.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The state of a number; none has a number above 2.
    pub const fn of_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Separated),
            1 => Some(Self::DriveSide),
            2 => Some(Self::BackSide),
            _ => None,
        }
    }
}

/// The most Fourier harmonics that a stiffness wave may keep.
pub const MAX_HARMONICS: usize = 8;

impl StiffnessWave {
    /// How many harmonics the wave has.
    pub fn order(&self) -> usize {
        match self {
            Self::Harmonic { .. } => 1,
            Self::Rectangular { order, .. } => *order,
        }
    }
}
