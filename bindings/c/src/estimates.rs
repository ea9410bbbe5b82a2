//! Inputs and outputs of the observer, with units in the names.

use model_core::observer::{
    Estimate, Estimates, MotorFault, OutputFault, Reading, Samples, Shaft, Source, TorqueResponse,
};
use parameters::ContactState;

use crate::status::JointStatus;

/// Reading of an encoder.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointReading {
    /// Raw counts of the encoder, wrapping as stated in the joint file.
    pub counts: u32,
    /// Time of the reading, in ticks of the samples' clock; wraps at 2^32.
    pub time_ticks: u32,
}

/// Measurements of one control period.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointSamples {
    /// Time of the samples, in ticks of the clock that the tables were made for (joint_tables_facts); wraps at 2^32.
    pub time_ticks: u32,
    /// Encoder on the motor.
    pub motor: JointReading,
    /// Encoder on the link.
    pub output: JointReading,
    /// 0 if there is no output encoder, or no reading of it in this period; `output` is then ignored. Otherwise
    /// nonzero.
    pub has_output: u32,
    /// Torque at the motor's shaft that was commanded last, after every limit: current times torque constant.
    pub motor_torque_Nm: f32,
}

impl JointSamples {
    /// Converts samples to the core's form.
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

    /// Converts samples to the caller's form.
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

/// Value with its variance and validity. Value and variance are always finite.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointEstimate {
    /// Estimate, in the unit of the field's name.
    pub value: f32,
    /// Variance, in the square of the unit.
    pub variance: f32,
    /// 1 if the value may be used, 0 if it is only a guess.
    pub valid: u32,
}

impl From<Estimate<f32>> for JointEstimate {
    fn from(of: Estimate<f32>) -> Self {
        Self { value: of.value, variance: of.variance, valid: of.valid.into() }
    }
}

/// Angle and speed of a shaft.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointShaft {
    /// Whole turns since the start of the observer, wrapping.
    pub turns: i32,
    /// Remaining fraction of a turn, from 0 to 1.
    pub fraction_turns: f32,
    /// Speed.
    pub speed_rad_per_s: f32,
}

impl From<Shaft<f32>> for JointShaft {
    fn from(of: Shaft<f32>) -> Self {
        Self { turns: of.turns, fraction_turns: of.fraction, speed_rad_per_s: of.speed }
    }
}

/// Flank that carries the force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointContact {
    /// No flank: the teeth are in the gap, or the contact is unknown.
    Separated = 0,
    /// Drive side: the motor drives the load forwards; deflection, force and torque are positive.
    DriveSide = 1,
    /// Back side: deflection, force and torque are negative.
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

/// Encoders on which the estimates are based.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointSource {
    /// No encoder: nothing is valid, and values without measurements are held.
    Nothing = 0,
    /// Motor encoder only: the load cannot be observed while the gap is open.
    MotorOnly = 1,
    /// Motor and output encoder.
    Both = 2,
}

/// Reason for which an encoder is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointFault {
    /// No fault: the encoder is used.
    None = 0,
    /// No such encoder in the design.
    Absent = 1,
    /// No new readings.
    Silent = 2,
    /// Readings are late repeatedly.
    Late = 3,
    /// Counts stand still while the joint turns.
    Frozen = 4,
    /// Counts of the motor encoder jumped further than the motor can turn.
    Jumped = 5,
    /// Counts of the output encoder imply an impossible gap coordinate.
    OutOfRange = 6,
    /// No reading of the output encoder yet: the compensation gives no torque before the first one.
    Unheard = 7,
}

/// In `notices`: the torque exceeded twice the motor's limit and was replaced by zero.
pub const JOINT_NOTICE_TORQUE_UNKNOWN: u32 = 1;
/// In `notices`: the period was too short or too long, or time went backwards.
pub const JOINT_NOTICE_OUT_OF_TIME: u32 = 2;
/// In `notices`: the motor's counts were further away than the motor can turn, and were rejected.
pub const JOINT_NOTICE_MOTOR_IMPLAUSIBLE: u32 = 4;
/// In `notices`: the motor's counts were implausible repeatedly.
pub const JOINT_NOTICE_MOTOR_JUMPED: u32 = 8;
/// In `notices`, until the observer is restarted: the motor moved against its torque. Torque or motor encoder has the
/// wrong sign.
pub const JOINT_NOTICE_TORQUE_REVERSED: u32 = 16;

/// All estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointEstimates {
    /// Encoders on which the estimates are based.
    pub source: JointSource,
    /// Reason for which the motor encoder is not used.
    pub motor_fault: JointFault,
    /// Reason for which the output encoder is not used.
    pub output_fault: JointFault,
    /// Defects of the samples: a sum of JOINT_NOTICE_ bits.
    pub notices: u32,
    /// Gap coordinate along the line of action: from -2 b to 2 b while every mesh is free.
    pub gap_m: JointEstimate,
    /// Rate of the gap coordinate.
    pub gap_rate_m_per_s: f32,
    /// Contact from the mesh force alone: later, but independent of the half-backlash.
    pub contact_by_force: JointContact,
    /// Contact from force and gap coordinate, for use in a controller.
    pub contact: JointContact,
    /// 1 if `contact` may be used, else 0.
    pub contact_valid: u32,
    /// 1 if contact has held long enough, with enough force, for parameters to be estimated; else 0.
    pub settled: u32,
    /// Torque transmitted by the meshes, at the carrier.
    pub mesh_torque_Nm: JointEstimate,
    /// Torque that brakes the link: friction, weight, contact.
    pub load_torque_Nm: JointEstimate,
    /// Half-backlash b of each mesh.
    pub half_backlash_m: JointEstimate,
    /// Lead of the motor encoder over the output encoder with every tooth centred, relative to the start; at the
    /// output.
    pub encoder_offset_rad: JointEstimate,
    /// Torsional compliance from sun to link, at the output.
    pub compliance_rad_per_Nm: JointEstimate,
    /// Delay of output readings not covered by their time stamps, minus the corresponding delay of the motor encoder.
    pub skew_s: JointEstimate,
    /// Torque that the motor loses in either direction.
    pub torque_bias_Nm: JointEstimate,
    /// Dry friction of the motor.
    pub motor_friction_Nm: JointEstimate,
    /// Inertia of link and carrier over the joint file's value.
    pub link_inertia_ratio: JointEstimate,
    /// Motor shaft, corrected for estimated encoder errors.
    pub motor: JointShaft,
    /// Link, corrected for estimated encoder errors. With the motor encoder alone, computed from it.
    pub link: JointShaft,
}

impl JointEstimates {
    /// Converts estimates to the caller's form.
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
