//! Values of the joint file before a log is read: ratio in whole teeth, lever, inertias on either side of the gap,
//! expected compliance.

use std::f64::consts::TAU;

use joint_file::{JointFile, sheet};
use model_core::gears::{Kinematics, Mechanics};
use parameters::{AbsoluteEncoder, Mesh, MeshKind, StiffnessWave, Surroundings};
use report::failure::Outcome;

use super::arguments::{Arguments, INERTIA_ERROR};
use super::harmonic::Harmonic;
use super::load_sharing::LoadSharing;
use joint_file::named::Loaded;

/// Standard deviation of the losses stated by the joint file, relative to the losses.
const STATED_LOSS_DEVIATION: f64 = 0.5;
/// Share of the load that a log may mimic as lost.
const MIMICKED_LOSS: f64 = 2e-3;
/// Standard deviations, beside MIMICKED_LOSS, within which estimated and stated losses agree.
const LOSS_AGREEMENT_SIGMA: f64 = 4.0;

/// Knowledge of the gears' losses; standard deviations are shares of the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Losses {
    /// Stated by the joint file, with this standard deviation.
    Stated(f64),
    /// Unknown; to be estimated from the log.
    Unknown,
    /// Estimated from the log, with this standard deviation.
    Estimated(f64),
}

/// A joint as known from its file.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorModel {
    /// Name of the joint.
    pub name: String,
    /// Teeth of the sun, and of sun and ring together: the ratio is the second over the first.
    pub teeth: [u32; 2],
    /// Teeth of the ring: mesh periods in a turn of the output.
    pub ring_teeth: u32,
    /// Counts of the motor encoder per turn.
    pub motor_turn: u64,
    /// Counts of the output encoder per turn.
    pub output_turn: u64,
    /// Base radius of the carrier r_c cos(alpha) [m].
    pub lever: f64,
    /// Inertia of rotor and sun [kg m^2].
    pub sun_inertia: f64,
    /// Inertia of planets and carrier, referred to the motor, times the share of the compliance behind them [kg m^2].
    pub carrier_inertia: f64,
    /// Inertia that turns with the motor, referred to the motor [kg m^2].
    pub motor_inertia: f64,
    /// Inertia that turns with the link [kg m^2].
    pub link_inertia: f64,
    /// Compliance of the teeth alone, at the output [rad/(N m)].
    pub mesh_compliance: f64,
    /// Mean stiffness of a mesh [N/m].
    pub mesh_stiffness: f64,
    /// Time by which the torque of the teeth leads their twist, for a damping ratio of 1 [s].
    pub mesh_relaxation_per_ratio: f64,
    /// Compliance from motor to link that the joint file states [rad/(N m)].
    pub compliance: f64,
    /// Free motion of the output with the motor standing [rad].
    pub lost_motion: f64,
    /// Knowledge of the gears' losses.
    pub losses: Losses,
    /// Encoder errors of more than twice a turn, as far as the log has shown them.
    pub harmonics: Vec<Harmonic>,
    /// The link hangs on its own compliance behind the carrier.
    pub compliant: bool,
    /// Reduction of the gap by errors of the teeth; `None` if all planets touch at once.
    pub sharing: Option<LoadSharing>,
    /// The gear is an equivalent gear, without teeth whose errors could show.
    pub equivalent: bool,
    /// Drive train around the gears.
    pub surroundings: Surroundings,
    /// Standard deviation of the motor's torque scale, relative.
    pub torque_error: f64,
    /// Standard deviation of each inertia, relative.
    pub inertia_error: f64,
}

impl PriorModel {
    /// Joint of a file, with the values of the command line.
    pub fn new(loaded: &Loaded, arguments: &Arguments) -> Outcome<Self> {
        let mut prior = Self::from_file(&loaded.file);
        prior.motor_turn = arguments.motor_bits.map_or(prior.motor_turn, AbsoluteEncoder::counts_of_bits);
        prior.output_turn = arguments.output_bits.map_or(prior.output_turn, AbsoluteEncoder::counts_of_bits);
        prior.torque_error = arguments.torque_error.map_or(prior.torque_error, |percent| percent / 100.0);
        prior.inertia_error = arguments.inertia_error / 100.0;
        Ok(prior)
    }

    /// Joint of a file alone.
    pub fn from_file(file: &JointFile) -> Self {
        let joint = &file.parameters;
        let around = &file.surroundings;
        let geometry = &joint.geometry;
        let lever = geometry.carrier_base_radius();
        let planets = geometry.planets as f64;
        let ratio = geometry.ratio_by_teeth();
        // Each planet in turn carries 1/n; the ripple softens a mesh as the mean of 1/k does.
        let softened = |mesh: &Mesh| {
            let (StiffnessWave::Harmonic { stiffness_ratio: ripple }
            | StiffnessWave::Rectangular { stiffness_ratio: ripple, .. }) = mesh.stiffness_wave;
            mesh.mean_stiffness * (1.0 - ripple * ripple).sqrt()
        };
        let softened = [&joint.sun_planet, &joint.ring_planet].map(softened);
        let soft = softened.map(f64::recip);
        let mesh_compliance = sheet::teeth_compliance(geometry, softened);
        // The mesh kinds are in series: each contributes its share of the twist and of its rate.
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
        // Without a separate compliance the teeth are the spring: the planets are in its middle, the carrier behind it.
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
            losses: Losses::Stated(STATED_LOSS_DEVIATION * (1.0 - around.efficiency).abs()),
            harmonics: Vec::new(),
            compliant,
            sharing: LoadSharing::new(joint, softened),
            equivalent: joint.equivalent_gear().is_some(),
            torque_error: around.torque_constant_error_ratio.abs(),
            inertia_error: INERTIA_ERROR,
            surroundings: *around,
        }
    }

    /// Returns true if losses and dry friction of the motor's side are zero.
    pub fn is_ideal(&self) -> bool {
        self.surroundings.efficiency >= 1.0 && self.surroundings.motor_friction.coulomb == 0.0
    }

    /// Returns the joint with other knowledge of the losses.
    pub fn with_losses(&self, losses: Losses) -> Self {
        Self { losses, ..self.clone() }
    }

    /// Returns the joint after an estimate of `more` lost share of the load. If the estimate agrees with the stated
    /// losses, they count as estimated; otherwise the losses grow by `more`, to be estimated again.
    pub fn with_estimated_losses(&self, more: f64, deviation: f64) -> Self {
        if more.abs() < LOSS_AGREEMENT_SIGMA * deviation + MIMICKED_LOSS {
            return self.with_losses(Losses::Estimated(more.hypot(deviation)));
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

    /// Inertia of the swing on the compliance: motor and link in series, referred to the output [kg m^2].
    pub fn swinging_inertia(&self) -> f64 {
        self.motor_at_output() * self.link_inertia / self.total_inertia()
    }

    /// Period of the swing on the compliance, by the joint file [s].
    pub fn swing_period(&self) -> f64 {
        TAU * (self.swinging_inertia() * self.compliance).sqrt()
    }
}
