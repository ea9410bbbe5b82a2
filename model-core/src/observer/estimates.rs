//! What the observer gives out once a control period: each value with its variance and with whether it may be used.

use crate::numbers::Real;
use parameters::ContactState;

/// A value, how uncertain it is, and whether the observer stands by it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate<T: Real> {
    /// Best guess; always finite.
    pub value: T,
    /// Variance, in the square of the value's unit; always finite.
    pub variance: T,
    /// False where the observer refuses: the value is then the last or the designed one, and only a guess.
    pub valid: bool,
}

/// A shaft: where it is and how fast it turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shaft<T: Real> {
    /// Whole turns since the observer began, wrapping.
    pub turns: i32,
    /// What is left, from 0 to 1 [turns].
    pub fraction: T,
    /// [rad/s].
    pub speed: T,
}

/// Which encoders the estimates rest on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Motor and output encoder.
    Both,
    /// The motor encoder alone, and why. The load cannot be seen while the gap is open.
    MotorOnly(OutputFault),
    /// No motor encoder either, and why: nothing is valid, and what is not heard of is held.
    Nothing(MotorFault),
}

impl Default for Source {
    /// Nothing has been heard yet.
    fn default() -> Self {
        Self::Nothing(MotorFault::Silent)
    }
}

impl Source {
    /// Returns whether the motor may be driven: the motor's place is known, and so is the link's on the scale of the set-points.
    pub fn allows_control(self) -> bool {
        match self {
            Self::MotorOnly(OutputFault::Unheard) => false,
            Self::Both | Self::MotorOnly(_) | Self::Nothing(MotorFault::Late) => true,
            Self::Nothing(MotorFault::Silent | MotorFault::Frozen | MotorFault::Jumped) => false,
        }
    }
}

/// Why the motor encoder is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotorFault {
    /// Nothing is heard of it, or its last reading is more than ten control periods old.
    Silent,
    /// Its readings are late time after time: it is known where the motor was, which serves for control without compensation.
    Late,
    /// Its counts stood still at once while it turned, or while the output went on by more than teeth let it.
    Frozen,
    /// Its counts are where no motor could go from where they were: jumped, slipped, or anything.
    Jumped,
}

/// Why the output encoder is not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputFault {
    /// There is none by design.
    Absent,
    /// It has given no reading since the observer began: the link's place on the scale of the set-points is not known yet, and the
    /// compensation gives no torque.
    Unheard,
    /// It has given no fresh reading for 10 ms.
    Silent,
    /// Its counts stand still while the motor turns.
    Frozen,
    /// It puts the gap coordinate where it cannot be: jumped, offset, slipping or failing.
    OutOfRange,
}

/// What is known of the signs of torque and motor encoder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TorqueResponse {
    /// Large torques have not shown it yet.
    #[default]
    Unknown,
    /// Likewise, and the motor runs against its torque, faster and faster: that may be a load. A moment without torque
    /// tells: the compensation gives none.
    Tested,
    /// A positive torque drives the motor the way in which its counts go up.
    Right,
    /// A positive torque drives the motor the way in which its counts go down: torque or motor encoder has the wrong sign. The observer
    /// says so until it is started anew, and the compensation gives no torque.
    Reversed,
}

/// What was wrong with the last samples. The observer goes on, with what it had.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Notices {
    /// The torque was not a number, or more than twice what the motor can give; none was assumed. Until 20 ms after it nothing
    /// is learnt, and gap and torques are not valid.
    pub torque_unknown: bool,
    /// The period was too short or too long, or time went backwards.
    pub out_of_time: bool,
    /// The motor's counts were further away than it can turn, and were not believed.
    pub motor_implausible: bool,
    /// The motor's counts are elsewhere time after time: they are not used until they agree with the output's again. Where
    /// they do not, the encoder has slipped, and the offset is learnt anew.
    pub motor_jumped: bool,
}

/// All estimates of one control period. A positive gap coordinate, force or torque drives the load forwards.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimates<T: Real> {
    /// What the rest stands on.
    pub source: Source,
    /// What was wrong with the samples.
    pub notices: Notices,
    /// What is known of the signs of torque and motor encoder. Messages to a host carry whether it is `Reversed`.
    pub torque_response: TorqueResponse,
    /// Gap coordinate X = u_s - 2 u_c: from -2b to 2b while every mesh is free [m].
    pub gap: Estimate<T>,
    /// Its rate [m/s].
    pub gap_rate: T,
    /// By how much the gears' transmission error, as far as it is learnt, shifts both flanks along the gap coordinate now
    /// [m].
    pub flank_shift: T,
    /// By how much that grows for each radian of the link [m/rad].
    pub flank_shift_slope: T,
    /// Contact by the mesh force alone, with hysteresis and persistence: late, but needs no width. `Separated` also
    /// stands for unknown when `contact_valid` is false.
    pub contact: ContactState,
    /// Contact by force and gap coordinate: what a controller should use.
    pub reported_contact: ContactState,
    /// Whether the reported contact may be used: not where it is unknown, nor on teeth whose transmission error shifts a
    /// flank over the middle of the gap.
    pub contact_valid: bool,
    /// Contact has held for long enough, with enough force, that the observer learns from it.
    pub settled: bool,
    /// Torque that the meshes pass on, referred to the carrier [N m].
    pub mesh_torque: Estimate<T>,
    /// Everything that brakes the link: friction, weight, what it touches [N m].
    pub load_torque: Estimate<T>,
    /// Half-backlash b of each mesh, all meshes alike [m].
    pub half_backlash: Estimate<T>,
    /// Whether a controller may use the half-backlash: it is known where it was learnt. `half_backlash.valid` also requires that the
    /// half-backlash can hardly differ where the link is now. Messages to a host leave this field out.
    pub half_backlash_usable: bool,
    /// By how much the motor encoder leads the output encoder with every tooth centred, beyond where they were at the
    /// start; at the output [rad].
    pub encoder_offset: Estimate<T>,
    /// Torsional compliance from sun to link, meshes included, referred to the output [rad/(N m)].
    pub compliance: Estimate<T>,
    /// How old output readings are beyond what their time says, less the same of the motor's [s].
    pub skew: Estimate<T>,
    /// Torque that the motor loses whatever its direction: what was commanded less what it gives [N m].
    pub torque_bias: Estimate<T>,
    /// Dry friction of the motor, as far as it does not grow with the load [N m].
    pub motor_friction: Estimate<T>,
    /// Cogging of the motor as far as it is learnt, referred to the link: a and b of the driving torque a sin(n theta) + b cos(n
    /// theta), with theta the motor's angle and n the joint file's `cogging_periods_per_turn` [N m]. Messages to a host leave it out.
    pub cogging: [T; 2],
    /// Inertia of link and carrier over what the joint file has; the motor's torque constant is in it, as it is in the
    /// torques [-].
    pub link_inertia_ratio: Estimate<T>,
    /// Angle by which the motor leads the link, referred to the output, counted from where both stood at the first reading of the
    /// output encoder; encoder errors that were learnt are taken out [rad]. `encoder_offset` is its value with every tooth centred.
    /// Where the zeros of the two encoders lie does not enter. Messages to a host leave it out.
    pub motor_lead: T,
    /// Motor shaft; encoder errors that were learnt are taken out.
    pub motor: Shaft<T>,
    /// Link; likewise. Motor only, this is what the motor implies.
    pub link: Shaft<T>,
}
