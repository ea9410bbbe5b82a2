//! One family of gear meshes, sun-planet or ring-planet: stiffness and its ripple (eq. 7), damping, transmission
//! error (eq. 11), backlash and phases. Forces are computed elsewhere: in f32 by `realtime`, in f64 by `design`.

use crate::joint::{JointParameters, PerPlanet};

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
pub enum DampingLaw {
    /// F = K f(d, b) + C d' always, as in the paper: it also acts in the gap.
    Paper,
    /// d > b: max(0, K (d - b) + C d'); d < -b: min(0, K (d + b) + C d'); otherwise 0. Teeth only push.
    Contact,
}

/// Which flank carries the force.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ContactState {
    /// d > b.
    DriveSide,
    /// -b <= d <= b.
    #[default]
    Separated,
    /// d < -b.
    BackSide,
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

    /// Largest swing about the mean that the harmonics kept can add up to, relative to the mean.
    pub fn swing(&self) -> f64 {
        (1..=self.order()).map(|harmonic| self.coefficients(harmonic)).map(|(a, b)| libm::hypot(a, b)).sum()
    }

    /// Fourier coefficients (a_m, b_m) of harmonic m >= 1: K/K_m = 1 + sum a_m sin(m phase) + b_m cos(m phase).
    ///
    /// The rectangular wave (Fig. 3) is high for a fraction d of the period, centred at phase pi/2 so that d = 1/2
    /// rises at phase 0 as the sine of eq. 7 does; levels are placed so that the mean is 1.
    pub fn coefficients(&self, harmonic: usize) -> (f64, f64) {
        match *self {
            Self::Harmonic { stiffness_ratio } => (if harmonic == 1 { stiffness_ratio } else { 0.0 }, 0.0),
            Self::Rectangular { stiffness_ratio, contact_ratio, .. } => {
                let duty = contact_ratio - libm::floor(contact_ratio);
                let m = harmonic as f64;
                let amplitude =
                    4.0 * stiffness_ratio * libm::sin(core::f64::consts::PI * m * duty) / (core::f64::consts::PI * m);
                // cos(m (phase - pi/2)) split into sine and cosine of m phase.
                let (sine, cosine) = libm::sincos(m * core::f64::consts::FRAC_PI_2);
                (amplitude * sine, amplitude * cosine)
            }
        }
    }
}

impl JointParameters {
    /// Phase of the stiffness ripple of a planet's mesh [rad].
    pub fn stiffness_phase(&self, kind: MeshKind, planet: usize) -> f64 {
        match &self.mesh(kind).phases {
            MeshPhases::Given { stiffness, .. } => stiffness[planet],
            MeshPhases::FromTeeth { stiffness, .. } => stiffness + self.tooth_phase(kind, planet),
        }
    }

    /// Phase of the transmission error of a planet's mesh [rad].
    pub fn error_phase(&self, kind: MeshKind, planet: usize) -> f64 {
        match &self.mesh(kind).phases {
            MeshPhases::Given { error, .. } => error[planet],
            MeshPhases::FromTeeth { error, .. } => error + self.tooth_phase(kind, planet),
        }
    }

    /// 2 pi gamma with gamma_si = Zs psi_i / 2 pi, gamma_ri = -Zr psi_i / 2 pi, psi_i = 2 pi i / n, reduced to one turn
    /// in whole numbers so that meshes in phase are exactly in phase [rad].
    fn tooth_phase(&self, kind: MeshKind, planet: usize) -> f64 {
        let planets = self.geometry.planets as u64;
        let turns = |teeth: u32| (u64::from(teeth) * planet as u64) % planets;
        let numerator = match kind {
            MeshKind::SunPlanet => turns(self.geometry.sun_teeth),
            MeshKind::RingPlanet => (planets - turns(self.geometry.ring_teeth)) % planets,
        };
        core::f64::consts::TAU * numerator as f64 / planets as f64
    }
}
