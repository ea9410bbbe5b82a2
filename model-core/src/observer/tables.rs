//! What the observer needs as plain numbers, made by `observer::design`: flows over one control period, gains, priors
//! and thresholds. SI, lengths along the line of action.

mod cogging;
mod inertia;
mod probe;

use crate::numbers::Real;
pub use cogging::CoggingTable;
pub use inertia::InertiaTable;
pub use probe::ProbeTable;

/// The most parameters that the learner may have.
pub const MOST_PARAMETERS: usize = 14;

/// Commands that may be on their way to the motor.
pub const MOST_DELAY: usize = 4;
const _: () = assert!(MOST_DELAY.is_power_of_two());

/// Tables of the observer of one joint with its encoders at one control rate.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ObserverTables<T: Real> {
    /// Digest of what a learnt memory must agree with: gears, encoders and joint.
    pub identity: u64,
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Control period [s].
    pub period: T,
    /// The clock that says when samples were taken.
    pub clock: ClockTable<T>,
    /// From counts to one whole number and to angles.
    pub counts: CountTable<T>,
    /// Levers.
    pub levers: LeverTable<T>,
    /// From commanded torque to torque.
    pub current: CurrentTable<T>,
    /// The motor side.
    pub drive: DriveTable<T>,
    /// The load side.
    pub load: LoadTable<T>,
    /// The link's inertia.
    pub inertia: InertiaTable<T>,
    /// The motor's cogging.
    pub cogging: CoggingTable<T>,
    /// Contact and torque bias.
    pub contact: ContactTable<T>,
    /// What is learnt.
    pub learner: LearnerTable<T>,
    /// When the output encoder is given up and taken back.
    pub supervisor: SupervisorTable<T>,
    /// Whether the motor goes where the torque drives it.
    pub response: ResponseTable<T>,
}

impl<T: Real> ObserverTables<T> {
    /// By what the deflection of shafts that stand still may be off at most [m]: half a count of the output, beside which the
    /// motor's is small. No mean takes that away, nor has it a place among the variances, which are those of shafts that turn.
    pub fn rounding(&self) -> T {
        T::HALF * self.counts.output.angle * self.levers.output
    }
}

/// The clock that says when samples were taken, and what its ticks mean.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ClockTable<T: Real> {
    /// Length of a tick [s].
    pub tick: T,
    /// Control period [ticks].
    pub period: u32,
    /// Shortest one that is expected [ticks].
    pub shortest: u32,
    /// By how much longer than that one may last [ticks].
    pub longer: u32,
    /// Age beyond which a reading counts as lost [ticks].
    pub oldest: u32,
}

/// One encoder.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct EncoderTable<T: Real> {
    /// Counts in a turn.
    pub turn: u32,
    /// Raw counts are modulo this; 0 stands for 2^32.
    pub wraps_at: u32,
    /// The largest raw count.
    pub last: u32,
    /// 2^64 over the counts in a turn, from which a place in the turn becomes a phase.
    pub phase: u64,
    /// Counts in a control period beyond which a reading is not believed.
    pub fastest: u32,
    /// [rad/count].
    pub angle: T,
    /// [turns/count].
    pub fraction: T,
    /// [turns/rad].
    pub turns: T,
}

/// Motor less ratio times output as a whole number.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CountTable<T: Real> {
    /// On the motor.
    pub motor: EncoderTable<T>,
    /// On the link; a copy of the motor's when there is none.
    pub output: EncoderTable<T>,
    /// Whether there is an output encoder.
    pub has_output: bool,
    /// Whether both encoders know their place in the turn when they begin.
    pub absolute: bool,
    /// Units of the difference in a motor count.
    pub motor_weight: i64,
    /// Units of the difference in an output count.
    pub output_weight: i64,
    /// Whole turns of either shaft change the difference by a multiple of this.
    pub modulus: i64,
    /// Mesh periods in a turn of the output: teeth of the ring.
    pub meshes: u32,
    /// The same as a number.
    pub mesh_periods: T,
    /// Deflection along the line of action in a unit of the difference [m].
    pub length: T,
}

/// Levers of the joint.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LeverTable<T: Real> {
    /// Base radius of the sun [m].
    pub sun: T,
    /// 1 over it [1/m].
    pub per_sun: T,
    /// Ratio by teeth times the sun's base radius: torque at the carrier over mesh force, and deflection over output angle
    /// [m].
    pub output: T,
    /// 1 over it [1/m].
    pub per_output: T,
    /// Motor turns in an output turn, by teeth.
    pub ratio: T,
    /// 1 over it.
    pub per_ratio: T,
}

/// From commanded torque to torque in the air gap.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CurrentTable<T: Real> {
    /// Whole control periods of delay.
    pub whole_delay: u32,
    /// What is left of it, as a part of a period.
    pub part_delay: T,
    /// Part of the lacking torque that the current loop makes good in a period.
    pub rise: T,
    /// Torque beyond which a sample is none [N m].
    pub believed: T,
    /// Periods after a sample that was none for which what it has left in the filters is not learnt from.
    pub unsure_for: u16,
}

/// The motor side: state angle, speed, torque taken by the meshes (and friction); air-gap torque known.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct DriveTable<T: Real> {
    /// Change of angle over a period for each unit of: speed, taken torque, air-gap torque at the start, wanted torque.
    pub angle: [T; 4],
    /// Change of speed for each unit of: taken torque, air-gap torque at the start, wanted torque.
    pub speed: [T; 3],
    /// Corrections of angle, speed and taken torque for a radian of innovation.
    pub gain: [T; 3],
    /// The same for readings that are older than a period.
    pub late_gain: [T; 3],
    /// Variances of angle and taken torque once settled.
    pub variance: [T; 2],
}

/// The load side: state angle, speed, load torque; torque from the meshes known.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LoadTable<T: Real> {
    /// Change of angle over a period for each unit of: speed, torque from the meshes less load torque.
    pub angle: [T; 2],
    /// Change of speed for each N m of torque from the meshes less load torque.
    pub speed: T,
    /// Corrections of angle, speed and load torque for a radian of innovation.
    pub gain: [T; 3],
    /// Variances of angle and load torque once settled.
    pub variance: [T; 2],
    /// The same with the motor encoder only, where the wind-up of the mesh force tells where the link is.
    pub motor_only_gain: [T; 3],
    /// Variances of speed and load torque then, once settled.
    pub motor_only_variance: [T; 2],
    /// Deflection along the line of action in a second from rest under one newton metre [m/(N m)].
    pub deflection_per_torque: T,
}

/// Contact and torque bias.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ContactTable<T: Real> {
    /// Variance of the mesh force from the motor side while it holds still: what noise leaves [N^2].
    pub force_variance: T,
    /// Variance of cogging and torque ripple as force [N^2].
    pub ripple_variance: T,
    /// Variance of the deflection while torques hold still [m^2].
    pub deflection_variance: T,
    /// Variance of one millisecond's bias reading [N^2].
    pub bias_noise: T,
    /// Variance with which bias and dry friction begin [N^2].
    pub bias_prior: T,
    /// Growth of that variance in one learning interval [N^2].
    pub bias_drift: T,
    /// Neither bias nor dry friction goes beyond this [N].
    pub bias_limit: T,
    /// Standard deviation of the rate of the deflection [m/s].
    pub rate_deviation: T,
    /// By how much what is measured lags behind: the output's sampling and filtering [s].
    pub lag: T,
    /// Part of its change in a period by which a mean over a few learning intervals follows [-].
    pub smoothing: T,
    /// Deflection in a learning interval that noise alone can show [m].
    pub still: T,
    /// Likewise for each radian that the motor turns while the error maps are unknown [m/rad].
    pub still_per_speed: T,
    /// 1 over the motor speed above which dry friction has its full size [s/rad].
    pub per_turning: T,
    /// Positions decide about contact once an edge is known to this part of the half-gap [-].
    pub known_part: T,
    /// Part of the torque that the gears add while the motor drives: efficiency less one [-].
    pub loss_driving: T,
    /// The same while it is driven [-].
    pub loss_driven: T,
}

/// What is learnt: deflection = side * half-gap + offset + compliance * force + skew * speed + error maps.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LearnerTable<T: Real> {
    /// Control periods between updates.
    pub periods: u16,
    /// 1 over them.
    pub per_periods: T,
    /// The period in their middle, from 1.
    pub middle: u16,
    /// Intervals that make up one deflection to learn from.
    pub block: u32,
    /// 1 over them.
    pub per_block: T,
    /// How long an interval of so many periods lasts [s].
    pub span: T,
    /// Mean of each parameter beforehand.
    pub mean: [T; MOST_PARAMETERS],
    /// Standard deviation of each parameter beforehand.
    pub deviation: [T; MOST_PARAMETERS],
    /// 1 over the standard deviation of one update's deflection, all that repeats from update to update included [1/m].
    pub weight: T,
    /// Standard deviation of one update's deflection by itself [m].
    pub noise: T,
    /// Variance of one update's force [N^2].
    pub force_noise: T,
    /// By how much the motor side's force lags behind a force that changes steadily, over the span of an interval [-].
    pub force_lag: T,
    /// Growth of variances in one update, for what wears and warms [-].
    pub forgetting: T,
    /// Deflection under one newton in the meshes alone [m/N].
    pub mesh_compliance: T,
}

/// How soon a shaft can stop.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct StopTable<T: Real> {
    /// Periods in which whatever the shaft runs into may stop it.
    pub stop: u8,
    /// Periods after which readings that stay the same are judged by the deflection alone.
    pub forgotten: u8,
    /// Half of 1 over the periods in which it may be stopped.
    pub per_stops: T,
}

/// When encoders are given up and taken back.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SupervisorTable<T: Real> {
    /// How soon the link stops.
    pub output: StopTable<T>,
    /// How soon the motor stops.
    pub motor: StopTable<T>,
    /// Half of the counts by which the largest torque may slow the link down in a period, for each period.
    pub output_brake: T,
    /// Half of the counts by which each N m of its torque slows the motor down in a period, for each period.
    pub motor_brake: T,
    /// Torque that may brake the motor beside what it gives itself [N m].
    pub motor_drag: T,
    /// Motor counts in one of the output.
    pub motor_counts: T,
    /// Periods in which the motor's counts stand still before that is more than chance.
    pub motor_unmoved_after: u16,
    /// Periods for which readings of the motor must be such as a motor can give, and agree with the output's, before they are
    /// used again.
    pub motor_trusted_after: u16,
    /// The same for readings that stand still, or do not agree.
    pub motor_slipped_after: u16,
    /// Periods without a fresh reading after which it is silent.
    pub silent_after: u16,
    /// Periods in a row outside the possible range after which it has failed.
    pub failed_after: u16,
    /// Learning intervals in a row in settled contact within the range after which it is taken back.
    pub trusted_after: u16,
    /// Angle by which an output has turned for sure [2^-32 turns].
    pub moved: u32,
    /// Distance beyond the possible range that dynamics alone can bring [m].
    pub margin: T,
    /// Estimates of the gap are given out up to this standard deviation, as a part of the gap 4b [-].
    pub widest_part: T,
}

/// Whether the motor goes where the torque drives it.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ResponseTable<T: Real> {
    /// Control periods of a block.
    pub block: u16,
    /// 1 over them.
    pub per_block: T,
    /// Inertia of motor and link at the motor, over the square of a block's length [N m/rad].
    pub inertia: T,
    /// Torque, and change of torque, that shows [N m].
    pub large: T,
    /// The most that a change of torque can be felt as, over itself: by the motor alone, twice [-].
    pub alone: T,
}
