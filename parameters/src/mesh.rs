//! Parameters of the sun-planet or ring-planet meshes: stiffness and stiffness ripple (eq. 7), damping, transmission error
//! (eq. 11), backlash, dead zone and phases.

use crate::planets::PerPlanet;

/// Kind of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshKind {
    /// Mesh of sun and planet, external.
    SunPlanet,
    /// Mesh of fixed ring and planet, internal.
    RingPlanet,
}

/// Both kinds in the order of every table per mesh: sun-planet, ring-planet.
pub const MESH_KINDS: [MeshKind; 2] = [MeshKind::SunPlanet, MeshKind::RingPlanet];

/// Parameters of the meshes of one kind. Lists hold one value for each planet.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Mean stiffness K_m along the line of action [N/m].
    pub mean_stiffness: f64,
    /// Variation of the stiffness over a mesh period.
    pub stiffness_wave: StiffnessWave,
    /// Damping ratio zeta of eqs 8-10 [-].
    pub damping_ratio: f64,
    /// Half-backlash b: a mesh is free over 2b [m].
    pub half_backlash: PerPlanet,
    /// Amplitude E of the transmission error (eq. 11) [m].
    pub transmission_error: PerPlanet,
    /// Phases of ripple and error.
    pub phases: MeshPhases,
}

/// Stiffness over one mesh period, relative to the mean stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StiffnessWave {
    /// Harmonic wave of eq. 7: 1 + ratio sin(phase).
    Harmonic {
        /// K_a / K_m [-].
        stiffness_ratio: f64,
    },
    /// Rectangular wave of Fig. 3. The wave is high for the fraction `contact_ratio - 1` of a period.
    Rectangular {
        /// (K_max - K_min) / (2 K_m) [-].
        stiffness_ratio: f64,
        /// Contact ratio of the pair, between 1 and 2 [-].
        contact_ratio: f64,
        /// Highest Fourier harmonic of the wave.
        order: usize,
    },
}

/// Phase of each planet's mesh [rad].
#[derive(Debug, Clone, PartialEq)]
pub enum MeshPhases {
    /// Phases given for each planet.
    Given {
        /// Phase phi_0 of the stiffness ripple, per planet [rad].
        stiffness: PerPlanet,
        /// Phase of the transmission error, per planet [rad].
        error: PerPlanet,
    },
    /// Phases from tooth counts for equally spaced planets: planet i leads planet 0 by 2 pi Zs i/n in the sun-planet mesh
    /// and lags by 2 pi Zr i/n in the ring-planet mesh.
    FromTeeth {
        /// Phase of planet 0's stiffness ripple [rad].
        stiffness: f64,
        /// Phase of planet 0's transmission error [rad].
        error: f64,
    },
}

/// Damping law of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum DampingLaw {
    /// Force F = K f(d, b) + C d', as in the paper: damping also acts in the gap.
    Paper,
    /// Force max(0, K (d - b) + C d') for d > b, min(0, K (d + b) + C d') for d < -b, else 0: teeth only push.
    Contact,
}

/// Law of the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DeadZone {
    /// Sharp dead zone, eq. 12.
    Sharp,
    /// Smoothed dead zone, eq. 13 corrected. The sharpness multiplies the dimensionless deflection.
    Tanh {
        /// Sharpness sigma of eq. 13 [-].
        sharpness: f64,
    },
}

/// Flank in contact; telemetry, link and files carry its code.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ContactState {
    /// No contact: -b < d < b.
    #[default]
    Separated = 0,
    /// Contact on the drive flank: d >= b.
    DriveSide = 1,
    /// Contact on the back flank: d <= -b.
    BackSide = 2,
}

impl ContactState {
    /// Returns the code: 0 separated, 1 drive side, 2 back side.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Returns the contact state of a code; `None` above 2.
    pub const fn of_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Separated),
            1 => Some(Self::DriveSide),
            2 => Some(Self::BackSide),
            _ => None,
        }
    }
}

/// Largest number of Fourier harmonics of a stiffness wave.
pub const MAX_HARMONICS: usize = 8;

impl StiffnessWave {
    /// Returns the number of harmonics.
    pub fn order(&self) -> usize {
        match self {
            Self::Harmonic { .. } => 1,
            Self::Rectangular { order, .. } => *order,
        }
    }
}
