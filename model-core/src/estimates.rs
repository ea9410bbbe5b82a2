//! Published estimates of the observer, once per control period: value, variance and validity of each quantity.

use crate::numbers::Real;
use crate::numbers::state_words::{Layout, Reader, StateWords, Writer, state_words};
use parameters::ContactState;

/// Estimated quantity with its variance and validity flag.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate<T: Real = f32> {
    /// Estimated value; always finite.
    pub value: T,
    /// Variance in the square of the value's unit; always finite.
    pub variance: T,
    /// False if the estimate must not be used: the value is then the last valid or the designed value.
    pub valid: bool,
}
state_words! { struct Estimate<T> { value, variance, valid } }

/// Position and speed of a shaft.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shaft<T: Real> {
    /// Whole turns since the first reading, wrapping.
    pub turns: i32,
    /// Position within the turn, from 0 to 1 [turns].
    pub fraction: T,
    /// Speed [rad/s].
    pub speed: T,
}
state_words! { struct Shaft<T> { turns, fraction, speed } }

/// Encoders on which the estimates are based.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Motor encoder and output encoder.
    Both,
    /// Motor encoder alone, with the fault of the output encoder. The load is not observable while the gap is open.
    MotorOnly(OutputFault),
    /// Neither encoder, with the fault of the motor encoder: no estimate is valid, every value is held.
    Nothing(MotorFault),
}

impl StateWords for Source {
    const LAYOUT: Layout = Layout::EMPTY
        .with("source", u32::LAYOUT)
        .with("output_fault", OutputFault::LAYOUT)
        .with("motor_fault", MotorFault::LAYOUT);

    fn write(&self, to: &mut Writer) {
        let (source, output_fault, motor_fault) = match *self {
            Self::Both => (0, OutputFault::Absent, MotorFault::Silent),
            Self::MotorOnly(fault) => (1, fault, MotorFault::Silent),
            Self::Nothing(fault) => (2, OutputFault::Absent, fault),
        };
        to.word(source);
        output_fault.write(to);
        motor_fault.write(to);
    }

    fn read(from: &mut Reader) -> Self {
        let (source, output_fault, motor_fault) = (from.word(), OutputFault::read(from), MotorFault::read(from));
        match source {
            0 => Self::Both,
            1 => Self::MotorOnly(output_fault),
            _ => Self::Nothing(motor_fault),
        }
    }
}

impl Default for Source {
    /// Source before the first sample.
    fn default() -> Self {
        Self::Nothing(MotorFault::Silent)
    }
}

impl Source {
    /// Returns whether the motor may be driven: the motor's position and the link's position on the scale of the
    /// set-points are known.
    pub fn allows_control(self) -> bool {
        match self {
            Self::MotorOnly(OutputFault::Unheard) => false,
            Self::Both | Self::MotorOnly(_) | Self::Nothing(MotorFault::Late) => true,
            Self::Nothing(MotorFault::Silent | MotorFault::Frozen | MotorFault::Jumped) => false,
        }
    }
}

/// Reason for which the motor encoder is excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorFault {
    /// No reading, or the last reading is more than ten control periods old.
    Silent,
    /// Readings are late repeatedly. The delayed position suffices for control without compensation.
    Late,
    /// Counts froze while the motor turned, or while the output moved beyond gap and wind-up.
    Frozen,
    /// Counts moved farther than the motor can turn: a jump, a slip or random readings.
    Jumped,
}
state_words! { enum MotorFault { Silent, Late, Frozen, Jumped } }

/// Reason for which the output encoder is excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputFault {
    /// The joint has no output encoder by design.
    Absent,
    /// No reading since the observer started: the link's position on the scale of the set-points is unknown, and the
    /// compensation gives no torque.
    Unheard,
    /// No fresh reading for 10 ms.
    Silent,
    /// Counts froze while the link or the motor moved.
    Frozen,
    /// Counts imply an impossible deflection: jump, offset, slip or defect.
    OutOfRange,
}
state_words! { enum OutputFault { Absent, Unheard, Silent, Frozen, OutOfRange } }

/// Result of the sign check of torque and motor encoder (O25).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TorqueResponse {
    /// Large torques have not revealed the signs yet.
    #[default]
    Unknown,
    /// Signs not revealed yet; the motor accelerates against its torque, possibly driven by a load. The compensation
    /// gives no torque for a moment to decide.
    Tested,
    /// A positive torque increases the motor's counts.
    Right,
    /// A positive torque decreases the motor's counts: torque or motor encoder has the wrong sign. Published until the
    /// observer restarts; the compensation gives no torque.
    Reversed,
}
state_words! { enum TorqueResponse { Unknown, Tested, Right, Reversed } }

/// Defects of the last samples. The observer continues with its previous state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Notices {
    /// The torque was not a number or exceeded twice the motor's limit; the observer used zero. For the next 20 ms no
    /// parameter is updated, and gap, contact and torques are invalid.
    pub torque_unknown: bool,
    /// The period was too short or too long, or time ran backwards.
    pub out_of_time: bool,
    /// The motor's counts moved farther than the motor can turn; the reading was rejected.
    pub motor_implausible: bool,
    /// Four motor readings in a row were too far away. The encoder is excluded until its readings agree with the output
    /// encoder. Without agreement the encoder has slipped, and the offset is estimated anew.
    pub motor_jumped: bool,
}
state_words! { struct Notices { torque_unknown, out_of_time, motor_implausible, motor_jumped } }

/// Estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimates<T: Real = f32> {
    /// Encoders in use.
    pub source: Source,
    /// Defects of the samples.
    pub notices: Notices,
    /// Result of the sign check. Messages to a host carry only whether the result is `Reversed`.
    pub torque_response: TorqueResponse,
    /// Gap coordinate X = u_s - 2 u_c: from -2b to 2b while every mesh is free [m].
    pub gap: Estimate<T>,
    /// Rate of the gap coordinate; zero in contact [m/s].
    pub gap_rate: T,
    /// Shift of both flanks along the gap coordinate by the estimated transmission error [m].
    pub flank_shift: T,
    /// Change of the flank shift per radian of the link [m/rad].
    pub flank_shift_slope: T,
    /// Contact by the mesh force alone, with hysteresis and persistence: late, but independent of the half-gap.
    /// `Separated` also stands for unknown when `contact_valid` is false.
    pub contact: ContactState,
    /// Contact by force and gap coordinate, for use by a controller.
    pub reported_contact: ContactState,
    /// Validity of the reported contact: false if the contact is unknown, or if the transmission error shifts a flank
    /// over the middle of the gap.
    pub contact_valid: bool,
    /// The last learning interval was in settled contact, from which the observer estimates parameters.
    pub settled: bool,
    /// Torque through the meshes, referred to the carrier [N m].
    pub mesh_torque: Estimate<T>,
    /// Load torque on the link: friction, weight and external forces, positive if it brakes [N m].
    pub load_torque: Estimate<T>,
    /// Half-backlash b of each mesh, equal in all meshes [m].
    pub half_backlash: Estimate<T>,
    /// Permission for a controller to use the half-backlash: its variance is small at the angle where it was estimated.
    /// `half_backlash.valid` also requires a small variance at the link's present angle. Messages to a host leave this
    /// field out.
    pub half_backlash_usable: bool,
    /// Lead of the motor encoder over the output encoder with every tooth centred, relative to the positions at the
    /// start; at the output [rad].
    pub encoder_offset: Estimate<T>,
    /// Torsional compliance from sun to link, meshes included, referred to the output [rad/(N m)].
    pub compliance: Estimate<T>,
    /// Delay of output readings not covered by their time stamps, minus the corresponding delay of the motor's readings
    /// [s].
    pub skew: Estimate<T>,
    /// Torque bias of the motor: commanded less delivered torque, independent of the direction [N m].
    pub torque_bias: Estimate<T>,
    /// Dry friction of the motor, without the part that grows with the load [N m].
    pub motor_friction: Estimate<T>,
    /// Estimated cogging of the motor, referred to the link: a and b of the driving torque a sin(n theta) + b cos(n
    /// theta), with the motor angle theta and n the joint file's `cogging_periods_per_turn` [N m]. Messages to a host
    /// leave this field out.
    pub cogging: [T; 2],
    /// Inertia of link and carrier over the joint file's value. An error of the motor's torque constant scales this
    /// ratio, as it scales the torques [-].
    pub link_inertia_ratio: Estimate<T>,
    /// Lead of the motor over the link since the first reading of the output encoder, at the output, without the
    /// estimated encoder errors [rad]. With every tooth centred, `motor_lead` equals `encoder_offset`. The zeros of the
    /// encoders have no influence. Messages to a host leave this field out.
    pub motor_lead: T,
    /// Motor shaft, without the estimated encoder errors.
    pub motor: Shaft<T>,
    /// Link, without the estimated encoder errors. Without an output encoder the link is inferred from the motor.
    pub link: Shaft<T>,
}
state_words! {
    struct Estimates<T> {
        source, notices, torque_response, gap, gap_rate, flank_shift, flank_shift_slope, contact, reported_contact,
        contact_valid, settled, mesh_torque, load_torque, half_backlash, half_backlash_usable, encoder_offset,
        compliance, skew, torque_bias, motor_friction, cogging, link_inertia_ratio, motor_lead, motor, link,
    }
}
