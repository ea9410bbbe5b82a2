//! Gear mesh by eqs 5-7 and 11 of the paper: stiffness wave, transmission error and mesh force. The zone of the dead
//! zone is constant between events.
//!
//! Equations: (P3), (P4), (P6), (P7) in docs/theory/paper.md.

use std::f64::consts::{FRAC_PI_2, PI};

use parameters::{ContactState, DampingLaw, StiffnessWave};

use crate::integrator::Guards;

/// Branch of the force law that holds until the next event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Zone {
    /// No backlash and permanent damping: a single branch.
    Joined,
    /// Within the dead zone.
    Free,
    /// Drive-side flanks push.
    DrivePush,
    /// Overlap on the drive side, but the flanks separate faster than they can push (law `contact`).
    DriveSlack,
    /// Back-side flanks push.
    BackPush,
    /// Overlap on the back side without force (law `contact`).
    BackSlack,
}

/// Phase of the excitation, common to all meshes up to their own phases.
#[derive(Debug, Clone, Copy)]
pub(super) struct Phase {
    pub angle: f64,
    pub rate: f64,
    pub acceleration: f64,
}

/// Constants of one mesh, in SI.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshConstants {
    pub mean_stiffness: f64,
    pub wave: StiffnessWave,
    pub stiffness_phase: f64,
    pub damping: f64,
    pub law: DampingLaw,
    pub half_backlash: f64,
    /// Half-backlash without variation around the turn or over time.
    pub nominal_half_backlash: f64,
    pub error_amplitude: f64,
    pub error_phase: f64,
}

/// State of a mesh at one time. Deflection d = displacement - e.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MeshState {
    pub deflection: f64,
    pub deflection_rate: f64,
    pub stiffness: f64,
    pub stiffness_rate: f64,
    pub error_rate: f64,
    /// f(d, b), the overlapping part of the deflection.
    pub overlap: f64,
    pub force: f64,
}

impl MeshConstants {
    /// e, e', e'' (eq. 11); the phase rate is part of both derivatives.
    pub fn transmission_error(&self, phase: Phase) -> [f64; 3] {
        if self.error_amplitude == 0.0 {
            return [0.0; 3];
        }
        let (sine, cosine) = (phase.angle + self.error_phase).sin_cos();
        [
            self.error_amplitude * sine,
            self.error_amplitude * cosine * phase.rate,
            self.error_amplitude * (cosine * phase.acceleration - sine * phase.rate * phase.rate),
        ]
    }

    /// K and K' (eq. 7, or Fig. 3 as a Fourier series).
    ///
    /// The rectangular wave is high over the fraction D of the period (fractional part of the contact ratio), centred
    /// at phase pi/2; its levels differ by 2 ratio K_m and its mean is K_m. Hence K / K_m = 1 + sum over m of 4 ratio
    /// sin(pi m D) / (pi m) cos(m (phase - pi/2)).
    pub fn stiffness(&self, phase: Phase) -> (f64, f64) {
        let angle = phase.angle + self.stiffness_phase;
        let (value, slope) = match self.wave {
            StiffnessWave::Harmonic { stiffness_ratio: 0.0 } => (1.0, 0.0),
            StiffnessWave::Harmonic { stiffness_ratio } => {
                let (sine, cosine) = angle.sin_cos();
                (1.0 + stiffness_ratio * sine, stiffness_ratio * cosine)
            }
            StiffnessWave::Rectangular { stiffness_ratio, contact_ratio, order } => {
                let high = contact_ratio.fract();
                let (mut value, mut slope) = (1.0, 0.0);
                for harmonic in 1..=order {
                    let m = harmonic as f64;
                    let amplitude = 4.0 * stiffness_ratio * (PI * m * high).sin() / (PI * m);
                    let (sine, cosine) = (m * (angle - FRAC_PI_2)).sin_cos();
                    value += amplitude * cosine;
                    slope -= amplitude * m * sine;
                }
                (value, slope)
            }
        };
        (self.mean_stiffness * value, self.mean_stiffness * slope * phase.rate)
    }

    /// State of the mesh in a zone.
    pub fn state(&self, zone: Zone, displacement: f64, displacement_rate: f64, phase: Phase) -> MeshState {
        let [error, error_rate, _] = self.transmission_error(phase);
        let (stiffness, stiffness_rate) = self.stiffness(phase);
        let deflection = displacement - error;
        let deflection_rate = displacement_rate - error_rate;
        let overlap = match zone {
            Zone::Joined => deflection,
            Zone::Free => 0.0,
            Zone::DrivePush | Zone::DriveSlack => deflection - self.half_backlash,
            Zone::BackPush | Zone::BackSlack => deflection + self.half_backlash,
        };
        let line = stiffness * overlap + self.damping * deflection_rate;
        let force = match (zone, self.law) {
            (Zone::DriveSlack | Zone::BackSlack, _) | (Zone::Free, DampingLaw::Contact) => 0.0,
            _ => line,
        };
        MeshState { deflection, deflection_rate, stiffness, stiffness_rate, error_rate, overlap, force }
    }

    /// Mesh force, with the zone determined by the deflection.
    pub fn force(&self, deflection: f64, deflection_rate: f64, stiffness: f64) -> f64 {
        let overlap = if deflection > self.half_backlash {
            deflection - self.half_backlash
        } else if deflection < -self.half_backlash {
            deflection + self.half_backlash
        } else {
            0.0
        };
        let line = stiffness * overlap + self.damping * deflection_rate;
        match self.law {
            DampingLaw::Paper => line,
            DampingLaw::Contact if overlap > 0.0 => line.max(0.0),
            DampingLaw::Contact if overlap < 0.0 => line.min(0.0),
            DampingLaw::Contact => 0.0,
        }
    }

    /// Zone of a mesh, from the deflection and, under the law `contact`, the sign of the force line.
    pub fn zone(&self, deflection: f64, deflection_rate: f64, stiffness: f64) -> Zone {
        let contact = self.law == DampingLaw::Contact;
        let line = |overlap: f64| stiffness * overlap + self.damping * deflection_rate;
        if !contact && self.half_backlash == 0.0 {
            Zone::Joined
        } else if deflection > self.half_backlash {
            if contact && line(deflection - self.half_backlash) <= 0.0 { Zone::DriveSlack } else { Zone::DrivePush }
        } else if deflection < -self.half_backlash {
            if contact && line(deflection + self.half_backlash) >= 0.0 { Zone::BackSlack } else { Zone::BackPush }
        } else {
            Zone::Free
        }
    }

    /// Adds guards: lengths that stay positive while `zone` holds.
    pub fn watch(&self, zone: Zone, mesh: &MeshState, deflection_acceleration: f64, guards: &mut Guards) {
        let rate = mesh.deflection_rate;
        // The force line is expressed as a length, so that all guards have one resolution.
        let line = mesh.overlap + self.damping / mesh.stiffness * rate;
        let line_rate = rate + self.damping / mesh.stiffness * deflection_acceleration
            - self.damping * rate * mesh.stiffness_rate / (mesh.stiffness * mesh.stiffness);
        let contact = self.law == DampingLaw::Contact;
        match zone {
            Zone::Joined => {}
            Zone::Free => {
                guards.watch(self.half_backlash - mesh.deflection, -rate);
                guards.watch(self.half_backlash + mesh.deflection, rate);
            }
            // Under `contact` the force always vanishes before the teeth part.
            Zone::DrivePush if contact => guards.watch(line, line_rate),
            Zone::BackPush if contact => guards.watch(-line, -line_rate),
            Zone::DrivePush => guards.watch(mesh.overlap, rate),
            Zone::BackPush => guards.watch(-mesh.overlap, -rate),
            Zone::DriveSlack => {
                guards.watch(mesh.overlap, rate);
                guards.watch(-line, -line_rate);
            }
            Zone::BackSlack => {
                guards.watch(-mesh.overlap, -rate);
                guards.watch(line, line_rate);
            }
        }
    }

    /// Flanks in contact, by the deflection alone.
    pub fn contact(&self, deflection: f64) -> ContactState {
        if deflection > self.half_backlash {
            ContactState::DriveSide
        } else if deflection < -self.half_backlash {
            ContactState::BackSide
        } else {
            ContactState::Separated
        }
    }
}
