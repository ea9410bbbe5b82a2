//! What goes in and out of the observer, with units in the names.

use model_core::observer::{
    Estimate, Estimates, MotorFault, OutputFault, Reading, Samples, Shaft, Source, TorqueResponse,
};
use parameters::ContactState;

use crate::status::JointStatus;

/// One reading of an encoder.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointReading {
    /// Raw counts as the encoder gives them, wrapping as the joint file says.
    pub counts: u32,
    /// When they were taken, in ticks of the samples' clock; wraps at 2^32.
    pub time_ticks: u32,
}

/// Everything that is measured in one control period.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointSamples {
    /// Now, in ticks of the clock that the tables were made for (joint_tables_facts); wraps at 2^32.
    pub time_ticks: u32,
    /// Encoder on the motor.
    pub motor: JointReading,
    /// Encoder on the link.
    pub output: JointReading,
    /// 0: there is no output encoder, or it gave nothing in this period; `output` is not looked at. Anything else: there is.
    pub has_output: u32,
    /// Torque at the motor's shaft that was commanded last, after every limit: current times torque constant.
    pub motor_torque_Nm: f32,
}

impl JointSamples {
    /// As the core has them.
    #[inline(always)]
    pub fn samples(&self) -> Result<Samples<f32>, JointStatus> {
        let reading = |it: &JointReading| Reading { counts: it.counts, time: it.time_ticks };
        if !self.motor_torque_Nm.is_finite() {
            return Err(JointStatus::NotFinite);
        }
        Ok(Samples {
            time: self.time_ticks,
            motor: reading(&self.motor),
            output: (self.has_output != 0).then(|| reading(&self.output)),
            torque: self.motor_torque_Nm,
        })
    }

    /// As the caller has them.
    pub fn new(of: &Samples<f32>) -> Self {
        let reading = |it: Reading| JointReading { counts: it.counts, time_ticks: it.time };
        Self {
            time_ticks: of.time,
            motor: reading(of.motor),
            output: reading(of.output.unwrap_or_default()),
            has_output: of.output.is_some().into(),
            motor_torque_Nm: of.torque,
        }
    }
}

/// A value, how uncertain it is, and whether the observer stands by it. Value and variance are always finite.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointEstimate {
    /// Best guess, in the unit that its holder's name ends with.
    pub value: f32,
    /// Variance, in the square of that unit.
    pub variance: f32,
    /// 0: the value is only a guess. 1: use it.
    pub valid: u32,
}

impl From<Estimate<f32>> for JointEstimate {
    fn from(of: Estimate<f32>) -> Self {
        Self { value: of.value, variance: of.variance, valid: of.valid.into() }
    }
}

/// A shaft: where it is and how fast it turns.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointShaft {
    /// Whole turns since the observer began, wrapping.
    pub turns: i32,
    /// What is left, from 0 to 1.
    pub fraction_turns: f32,
    /// Speed.
    pub speed_rad_per_s: f32,
}

impl From<Shaft<f32>> for JointShaft {
    fn from(of: Shaft<f32>) -> Self {
        Self { turns: of.turns, fraction_turns: of.fraction, speed_rad_per_s: of.speed }
    }
}

/// Which flank carries the force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointContact {
    /// None: the teeth are in the gap, or it is not known where.
    Separated = 0,
    /// The motor drives the load forwards: deflection, force and torque are positive.
    DriveSide = 1,
    /// The other one: they are negative.
    BackSide = 2,
}

impl From<ContactState> for JointContact {
    fn from(of: ContactState) -> Self {
        match of {
            ContactState::Separated => Self::Separated,
            ContactState::DriveSide => Self::DriveSide,
            ContactState::BackSide => Self::BackSide,
        }
    }
}

/// Which encoders the estimates rest on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointSource {
    /// None: nothing is valid, and what is not heard of is held.
    Nothing = 0,
    /// The motor encoder alone: the load cannot be seen while the gap is open.
    MotorOnly = 1,
    /// Motor and output encoder.
    Both = 2,
}

/// Why an encoder is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointFault {
    /// It is used.
    None = 0,
    /// There is none by design.
    Absent = 1,
    /// Nothing fresh is heard of it.
    Silent = 2,
    /// Its readings are late time after time.
    Late = 3,
    /// Its counts stand still while the joint turns.
    Frozen = 4,
    /// The motor's counts are where no motor could go.
    Jumped = 5,
    /// The output's counts put the gap coordinate where it cannot be.
    OutOfRange = 6,
    /// The output encoder has given no reading yet: the compensation gives no torque until it does.
    Unheard = 7,
}

/// In `notices`: the torque was more than twice what the motor can give; none was assumed.
pub const JOINT_NOTICE_TORQUE_UNKNOWN: u32 = 1;
/// In `notices`: the period was too short or too long, or time went backwards.
pub const JOINT_NOTICE_OUT_OF_TIME: u32 = 2;
/// In `notices`: the motor's counts were further away than it can turn, and were not believed.
pub const JOINT_NOTICE_MOTOR_IMPLAUSIBLE: u32 = 4;
/// In `notices`: the motor's counts are elsewhere time after time.
pub const JOINT_NOTICE_MOTOR_JUMPED: u32 = 8;
/// In `notices`, until the observer is started anew: the motor ran against its torque. Torque or motor encoder has the wrong sign.
pub const JOINT_NOTICE_TORQUE_REVERSED: u32 = 16;

/// All estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointEstimates {
    /// What the rest stands on.
    pub source: JointSource,
    /// Why the motor encoder is not used.
    pub motor_fault: JointFault,
    /// Why the output encoder is not used.
    pub output_fault: JointFault,
    /// What was wrong with the samples: a sum of JOINT_NOTICE_ bits.
    pub notices: u32,
    /// Gap coordinate along the line of action: from -2 b to 2 b while every mesh is free.
    pub gap_m: JointEstimate,
    /// Its rate.
    pub gap_rate_m_per_s: f32,
    /// Contact by the mesh force alone: late, but needs no width.
    pub contact_by_force: JointContact,
    /// Contact by force and gap coordinate: what a controller should use.
    pub contact: JointContact,
    /// Whether `contact` may be used.
    pub contact_valid: u32,
    /// Contact has held for long enough, with enough force, that the observer learns from it.
    pub settled: u32,
    /// Torque that the meshes pass on, at the carrier.
    pub mesh_torque_Nm: JointEstimate,
    /// Everything that brakes the link: friction, weight, what it touches.
    pub load_torque_Nm: JointEstimate,
    /// Half-backlash b of each mesh.
    pub half_backlash_m: JointEstimate,
    /// By how much the motor encoder leads the output encoder with every tooth centred, beyond where they were at the
    /// start; at the output.
    pub encoder_offset_rad: JointEstimate,
    /// Torsional compliance from sun to link, at the output.
    pub compliance_rad_per_Nm: JointEstimate,
    /// How old output readings are beyond what their time says, less the same of the motor's.
    pub skew_s: JointEstimate,
    /// Torque that the motor loses whatever its direction.
    pub torque_bias_Nm: JointEstimate,
    /// Dry friction of the motor.
    pub motor_friction_Nm: JointEstimate,
    /// Inertia of link and carrier over what the joint file has.
    pub link_inertia_ratio: JointEstimate,
    /// Motor shaft; encoder errors that were learnt are taken out.
    pub motor: JointShaft,
    /// Link; likewise. With the motor encoder alone, what that implies.
    pub link: JointShaft,
}

impl JointEstimates {
    /// As the caller has them.
    pub fn new(of: &Estimates<f32>) -> Self {
        let (source, motor_fault, output_fault) = match of.source {
            Source::Both => (JointSource::Both, JointFault::None, JointFault::None),
            Source::MotorOnly(fault) => {
                let fault = match fault {
                    OutputFault::Absent => JointFault::Absent,
                    OutputFault::Unheard => JointFault::Unheard,
                    OutputFault::Silent => JointFault::Silent,
                    OutputFault::Frozen => JointFault::Frozen,
                    OutputFault::OutOfRange => JointFault::OutOfRange,
                };
                (JointSource::MotorOnly, JointFault::None, fault)
            }
            Source::Nothing(fault) => {
                let fault = match fault {
                    MotorFault::Silent => JointFault::Silent,
                    MotorFault::Late => JointFault::Late,
                    MotorFault::Frozen => JointFault::Frozen,
                    MotorFault::Jumped => JointFault::Jumped,
                };
                (JointSource::Nothing, fault, JointFault::None)
            }
        };
        let bit = |is: bool, bit: u32| if is { bit } else { 0 };
        let notices = bit(of.notices.torque_unknown, JOINT_NOTICE_TORQUE_UNKNOWN)
            | bit(of.notices.out_of_time, JOINT_NOTICE_OUT_OF_TIME)
            | bit(of.notices.motor_implausible, JOINT_NOTICE_MOTOR_IMPLAUSIBLE)
            | bit(of.notices.motor_jumped, JOINT_NOTICE_MOTOR_JUMPED)
            | bit(of.torque_response == TorqueResponse::Reversed, JOINT_NOTICE_TORQUE_REVERSED);
        Self {
            source,
            motor_fault,
            output_fault,
            notices,
            gap_m: of.gap.into(),
            gap_rate_m_per_s: of.gap_rate,
            contact_by_force: of.contact.into(),
            contact: of.reported_contact.into(),
            contact_valid: of.contact_valid.into(),
            settled: of.settled.into(),
            mesh_torque_Nm: of.mesh_torque.into(),
            load_torque_Nm: of.load_torque.into(),
            half_backlash_m: of.half_backlash.into(),
            encoder_offset_rad: of.encoder_offset.into(),
            compliance_rad_per_Nm: of.compliance.into(),
            skew_s: of.skew.into(),
            torque_bias_Nm: of.torque_bias.into(),
            motor_friction_Nm: of.motor_friction.into(),
            link_inertia_ratio: of.link_inertia_ratio.into(),
            motor: of.motor.into(),
            link: of.link.into(),
        }
    }
}
