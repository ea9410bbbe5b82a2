//! What is known of the joint before a log is read, from its joint file: ratio in whole teeth, lever arms, inertias on
//! either side of the gap, the expected compliance.

use std::f64::consts::TAU;

use joint_file::{JointFile, sheet};
use model_core::gears::{Kinematics, Mechanics};
use parameters::{AbsoluteEncoder, Mesh, MeshKind, StiffnessWave, Surroundings};
use report::failure::Outcome;

use super::arguments::{Arguments, INERTIA_ERROR};
use super::higher::Higher;
use super::load_sharing::LoadSharing;
use joint_file::named::Loaded;

/// How well losses are known by what the joint file states of them, as a share: one standard deviation.
const OWN_LOSS: f64 = 0.5;
/// Share of the load that a log may feign as lost.
const FEIGNED: f64 = 2e-3;
/// What a log tells of losses agrees with what is stated within so many deviations, beside that.
const AGREES: f64 = 4.0;

/// What is known of the gears' losses, by standard deviations that are shares of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Losses {
    /// They are what the joint file states, within so much.
    Stated(f64),
    /// They are unknown: the log is to tell them.
    Open,
    /// The log has told them, within so much.
    Told(f64),
}

/// The joint as known from its file.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorModel {
    /// Name of the joint.
    pub name: String,
    /// Sun's teeth, and sun's and ring's together: the ratio is the second over the first.
    pub teeth: [u32; 2],
    /// Ring's teeth: mesh periods in a turn of the output.
    pub ring_teeth: u32,
    /// Counts of the motor encoder in a turn.
    pub motor_turn: u64,
    /// Counts of the output encoder in a turn.
    pub output_turn: u64,
    /// r_c cos(alpha) [m].
    pub lever: f64,
    /// Rotor and sun [kg m^2].
    pub sun_inertia: f64,
    /// Planets and carrier, at the motor, as far as they bend the joint: their torque passes the teeth's compliance only
    /// [kg m^2].
    pub carrier_inertia: f64,
    /// All that turns with the motor, at the motor [kg m^2].
    pub motor_inertia: f64,
    /// What turns with the link [kg m^2].
    pub link_inertia: f64,
    /// Compliance of the teeth alone, at the output [rad/(N m)].
    pub mesh_compliance: f64,
    /// Mean stiffness of a mesh [N/m].
    pub mesh_stiffness: f64,
    /// How far the torque of the teeth runs ahead of their twist, for a damping ratio of 1 [s].
    pub mesh_relaxation_per_ratio: f64,
    /// Compliance from motor to link that the joint file states [rad/(N m)].
    pub compliance: f64,
    /// What the output moves freely while the motor stands [rad].
    pub lost_motion: f64,
    /// What is known of the gears' losses.
    pub losses: Losses,
    /// Errors of encoders that come more than twice a turn, as far as the log has shown them.
    pub higher: Vec<Higher>,
    /// The link hangs on a compliance of its own behind the carrier.
    pub compliant: bool,
    /// What errors of the teeth take of the gap; nothing where all planets touch at once.
    pub sharing: Option<LoadSharing>,
    /// The gear is an equivalent one: it has no teeth whose errors could show.
    pub equivalent: bool,
    /// What surrounds the gears.
    pub surroundings: Surroundings,
    /// How wrong the motor's torque may be, as a ratio: one standard deviation.
    pub torque_error: f64,
    /// How wrong each inertia may be, likewise.
    pub inertia_error: f64,
}

impl PriorModel {
    /// Of a joint file and the command line.
    pub fn new(loaded: &Loaded, arguments: &Arguments) -> Outcome<Self> {
        let mut prior = Self::of(&loaded.file);
        prior.motor_turn = arguments.motor_bits.map_or(prior.motor_turn, AbsoluteEncoder::counts_of_bits);
        prior.output_turn = arguments.output_bits.map_or(prior.output_turn, AbsoluteEncoder::counts_of_bits);
        prior.torque_error = arguments.torque_error.map_or(prior.torque_error, |percent| percent / 100.0);
        prior.inertia_error = arguments.inertia_error / 100.0;
        Ok(prior)
    }

    /// Of a joint file alone.
    pub fn of(file: &JointFile) -> Self {
        let joint = &file.parameters;
        let around = &file.surroundings;
        let geometry = &joint.geometry;
        let lever = geometry.carrier_base_radius();
        let planets = geometry.planets as f64;
        let ratio = geometry.ratio_by_teeth();
        // One planet after the other carries 1/n; softening by the ripple is that of a mean over 1/k.
        let softened = |mesh: &Mesh| {
            let (StiffnessWave::Harmonic { stiffness_ratio: ripple }
            | StiffnessWave::Rectangular { stiffness_ratio: ripple, .. }) = mesh.stiffness_wave;
            mesh.mean_stiffness * (1.0 - ripple * ripple).sqrt()
        };
        let softened = [&joint.sun_planet, &joint.ring_planet].map(softened);
        let soft = softened.map(f64::recip);
        let mesh_compliance = sheet::teeth_compliance(geometry, softened);
        // In series each kind takes its part of the twist, and of its rate.
        let relaxation = |kind: MeshKind| joint.damping_coefficient(kind) / joint.mesh(kind).damping_ratio;
        let relaxations = [MeshKind::SunPlanet, MeshKind::RingPlanet].map(relaxation);
        let mesh_relaxation_per_ratio =
            soft.iter().zip(relaxations).map(|(soft, time)| soft * soft * time).sum::<f64>() / (soft[0] + soft[1]);
        let own = joint.compliance.map_or(0.0, |compliance| 1.0 / compliance.stiffness);
        // Along the line of action of the carrier the sun moves twice as far.
        let sun = 4.0 * (joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass());
        let gears = planets * joint.bodies.planet_equivalent_mass;
        let carrier = joint.carrier_equivalent_mass();
        let gaps = [&joint.sun_planet, &joint.ring_planet].map(|mesh| &mesh.half_backlash[..geometry.planets]);
        let half_backlash = gaps.iter().copied().flatten().sum::<f64>() / (2.0 * planets);
        let compliant = joint.compliance.is_some();
        // Without a compliance the teeth are the spring: planets stand in its middle, the carrier behind it.
        let [before, behind] =
            if compliant { [sun + gears + carrier, 0.0] } else { [sun + 0.5 * gears, 0.5 * gears + carrier] };
        Self {
            name: joint.name.as_str().to_owned(),
            teeth: [geometry.sun_teeth, geometry.sun_teeth + geometry.ring_teeth],
            ring_teeth: geometry.ring_teeth,
            motor_turn: around.motor_encoder.counts_per_turn,
            output_turn: around.output_encoder.counts_per_turn,
            lever,
            sun_inertia: sun * lever * lever / (ratio * ratio),
            carrier_inertia: (before - sun) * lever * lever / (ratio * ratio)
                * if compliant { own / (own + mesh_compliance) } else { 1.0 },
            motor_inertia: before * lever * lever / (ratio * ratio),
            link_inertia: joint.link_inertia + behind * lever * lever,
            mesh_compliance,
            mesh_stiffness: joint.sun_planet.mean_stiffness,
            mesh_relaxation_per_ratio,
            compliance: mesh_compliance + own,
            lost_motion: 2.0 * half_backlash / lever,
            losses: Losses::Stated(OWN_LOSS * (1.0 - around.efficiency).abs()),
            higher: Vec::new(),
            compliant,
            sharing: LoadSharing::of(joint, softened),
            equivalent: joint.equivalent_gear().is_some(),
            torque_error: around.torque_constant_error_ratio.abs(),
            inertia_error: INERTIA_ERROR,
            surroundings: *around,
        }
    }

    /// Whether nothing brakes its motor's side.
    pub fn is_ideal(&self) -> bool {
        self.surroundings.efficiency >= 1.0 && self.surroundings.motor_friction.coulomb == 0.0
    }

    /// The same with other knowledge of the losses.
    pub fn with_losses(&self, losses: Losses) -> Self {
        Self { losses, ..self.clone() }
    }

    /// Where a log says, with this deviation, that so much more of the load is lost than is stated, as a share: what it has
    /// told if the two agree, else with losses that are as much larger, to be told again.
    pub fn with_losses_told(&self, more: f64, deviation: f64) -> Self {
        if more.abs() < AGREES * deviation + FEIGNED {
            return self.with_losses(Losses::Told(more.hypot(deviation)));
        }
        let mut prior = self.clone();
        prior.surroundings.efficiency *= 1.0 - more;
        prior
    }

    /// Motor over output angle.
    pub fn ratio(&self) -> f64 {
        f64::from(self.teeth[1]) / f64::from(self.teeth[0])
    }

    /// Inertia of the motor side, referred to the output [kg m^2].
    pub fn motor_at_output(&self) -> f64 {
        self.motor_inertia * self.ratio() * self.ratio()
    }

    /// Inertia of motor and link together, referred to the output [kg m^2].
    pub fn total_inertia(&self) -> f64 {
        self.motor_at_output() + self.link_inertia
    }

    /// Share of the joint's inertia that turns with the motor.
    pub fn motor_share(&self) -> f64 {
        self.motor_at_output() / self.total_inertia()
    }

    /// Inertia that swings against the compliance: motor and link in series, at the output [kg m^2].
    pub fn swinging_inertia(&self) -> f64 {
        self.motor_at_output() * self.link_inertia / self.total_inertia()
    }

    /// Period of the swing that the joint file promises [s].
    pub fn swing(&self) -> f64 {
        TAU * (self.swinging_inertia() * self.compliance).sqrt()
    }
}
