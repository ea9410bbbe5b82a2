//! Tables of the observer, computed offline by `observer::design`: flows over one control period, gains, priors and
//! thresholds. SI units; lengths along the line of action.

mod cogging;
mod inertia;
mod probe;

use crate::numbers::Real;
pub use cogging::CoggingTable;
pub use inertia::InertiaTable;
pub use probe::ProbeTable;

/// Largest number of estimated parameters.
pub const MOST_PARAMETERS: usize = 14;

/// Length of the command delay line [control periods].
pub const MOST_DELAY: usize = 4;
const _: () = assert!(MOST_DELAY.is_power_of_two());

/// Tables of one joint's observer for its encoders and control rate.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ObserverTables<T: Real> {
    /// Digest of name, gears, encoders and priors; a saved memory must have an equal digest.
    pub identity: u64,
    /// Control rate [Hz].
    pub control_rate: u32,
    /// Control period [s].
    pub period: T,
    /// Clock of the samples.
    pub clock: ClockTable<T>,
    /// Conversion of counts to an integer difference and to angles.
    pub counts: CountTable<T>,
    /// Levers.
    pub levers: LeverTable<T>,
    /// Conversion of commanded torque to air-gap torque.
    pub current: CurrentTable<T>,
    /// Filter of the motor side.
    pub drive: DriveTable<T>,
    /// Filter of the load side.
    pub load: LoadTable<T>,
    /// Estimation of the link's inertia.
    pub inertia: InertiaTable<T>,
    /// Estimation of the motor's cogging.
    pub cogging: CoggingTable<T>,
    /// Contact and torque bias.
    pub contact: ContactTable<T>,
    /// Estimation of the joint's parameters.
    pub learner: LearnerTable<T>,
    /// Exclusion and readmission of the encoders.
    pub supervisor: SupervisorTable<T>,
    /// Check of the signs of torque and motor encoder.
    pub response: ResponseTable<T>,
}

impl<T: Real> ObserverTables<T> {
    /// Largest rounding error of the deflection at rest [m]: half an output count; the motor's rounding is small beside
    /// it. Averaging does not reduce this error, and the variances, which hold for turning shafts, do not contain it.
    pub fn rounding(&self) -> T {
        T::HALF * self.counts.output.angle * self.levers.output
    }
}

/// Clock of the samples, and limits of intervals in its ticks.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ClockTable<T: Real> {
    /// Length of a tick [s].
    pub tick: T,
    /// Control period [ticks].
    pub period: u32,
    /// Shortest accepted control period [ticks].
    pub shortest: u32,
    /// Longest less shortest accepted control period [ticks].
    pub longer: u32,
    /// Age above which a reading counts as lost [ticks].
    pub oldest: u32,
}

/// Resolution and limits of one encoder.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct EncoderTable<T: Real> {
    /// Counts per turn.
    pub turn: u32,
    /// Modulus of the raw counts; 0 stands for 2^32.
    pub wraps_at: u32,
    /// Largest raw count.
    pub last: u32,
    /// 2^64 over the counts per turn; converts a position in the turn to a phase.
    pub phase: u64,
    /// Travel per control period above which a reading is rejected [counts].
    pub fastest: u32,
    /// Angle per count [rad/count].
    pub angle: T,
    /// Turns per count [turns/count].
    pub fraction: T,
    /// Turns per radian [turns/rad].
    pub turns: T,
}

/// Integer difference of motor less ratio times output (O1).
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CountTable<T: Real> {
    /// Motor encoder.
    pub motor: EncoderTable<T>,
    /// Output encoder; a copy of the motor encoder on joints without an output encoder.
    pub output: EncoderTable<T>,
    /// True on joints with an output encoder.
    pub has_output: bool,
    /// True if both encoders are absolute within a turn.
    pub absolute: bool,
    /// Units of the difference per motor count.
    pub motor_weight: i64,
    /// Units of the difference per output count.
    pub output_weight: i64,
    /// Modulus of the difference [units]: whole turns of either shaft change the difference by a multiple of the
    /// modulus.
    pub modulus: i64,
    /// Mesh periods per output turn: teeth of the ring.
    pub meshes: u32,
    /// Mesh periods per output turn, as a real number.
    pub mesh_periods: T,
    /// Deflection along the line of action per unit of the difference [m].
    pub length: T,
}

/// Levers of the joint.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LeverTable<T: Real> {
    /// Base radius of the sun [m].
    pub sun: T,
    /// 1 over the sun's base radius [1/m].
    pub per_sun: T,
    /// Ratio by teeth times the sun's base radius: carrier torque per mesh force, and deflection per output angle [m].
    pub output: T,
    /// 1 over `output` [1/m].
    pub per_output: T,
    /// Motor turns per output turn, by teeth.
    pub ratio: T,
    /// 1 over `ratio`.
    pub per_ratio: T,
}

/// Conversion of commanded torque to air-gap torque.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CurrentTable<T: Real> {
    /// Whole control periods of the torque delay.
    pub whole_delay: u32,
    /// Remainder of the torque delay [control periods].
    pub part_delay: T,
    /// Share of the torque error that the current loop removes per period [-].
    pub rise: T,
    /// Torque above which a sample is rejected [N m].
    pub believed: T,
    /// Periods without parameter updates after a rejected torque sample, whose effect on the filters must fade.
    pub unsure_for: u16,
}

/// Filter of the motor side (O2, O3). State: angle, speed, torque taken by meshes and friction. Input: air-gap torque.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct DriveTable<T: Real> {
    /// Change of angle over a period per unit of speed, taken torque, air-gap torque at the start, wanted torque.
    pub angle: [T; 4],
    /// Change of speed over a period per unit of taken torque, air-gap torque at the start, wanted torque.
    pub speed: [T; 3],
    /// Gains of angle, speed and taken torque per radian of innovation.
    pub gain: [T; 3],
    /// Gains for readings older than a period.
    pub late_gain: [T; 3],
    /// Steady-state variances of angle and taken torque.
    pub variance: [T; 2],
}

/// Filter of the load side (O4). State: angle, speed, load torque. Input: mesh torque.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LoadTable<T: Real> {
    /// Change of angle over a period per unit of speed, and of mesh torque less load torque.
    pub angle: [T; 2],
    /// Change of speed over a period per newton metre of mesh torque less load torque.
    pub speed: T,
    /// Gains of angle, speed and load torque per radian of innovation.
    pub gain: [T; 3],
    /// Steady-state variances of angle and load torque.
    pub variance: [T; 2],
    /// Gains without output encoder, where the wind-up of the mesh force measures the link.
    pub motor_only_gain: [T; 3],
    /// Steady-state variances of speed and load torque without output encoder.
    pub motor_only_variance: [T; 2],
    /// Deflection along the line of action per newton metre of load torque, one second after rest [m/(N m)].
    pub deflection_per_torque: T,
}

/// Contact detection and torque bias.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ContactTable<T: Real> {
    /// Noise variance of the motor side's mesh force, at constant force [N^2].
    pub force_variance: T,
    /// Variance of cogging and torque ripple, as mesh force [N^2].
    pub ripple_variance: T,
    /// Noise variance of the deflection, at constant torques [m^2].
    pub deflection_variance: T,
    /// Variance of one bias measurement of a millisecond, correlation included [N^2].
    pub bias_noise: T,
    /// Initial variance of bias and of dry friction [N^2].
    pub bias_prior: T,
    /// Growth of these variances per learning interval [N^2].
    pub bias_drift: T,
    /// Largest bias and largest dry friction [N].
    pub bias_limit: T,
    /// Standard deviation of the deflection rate [m/s].
    pub rate_deviation: T,
    /// Lag of the measured deflection: sampling and filtering of the output [s].
    pub lag: T,
    /// Smoothing factor per period of a mean over a few learning intervals [-].
    pub smoothing: T,
    /// Change of the deflection per learning interval that noise alone can cause [m].
    pub still: T,
    /// Change of the deflection per radian of the motor that unknown error maps can cause [m/rad].
    pub still_per_speed: T,
    /// 1 over the motor speed above which dry friction acts fully [s/rad].
    pub per_turning: T,
    /// Standard deviation of an edge, over the half-gap, below which positions decide on contact [-].
    pub known_part: T,
    /// Loss factor while the motor drives: efficiency less 1 [-].
    pub loss_driving: T,
    /// Loss factor while the motor is driven: 1 over the efficiency, less 1 [-].
    pub loss_driven: T,
}

/// Parameter estimation (O11): deflection = side * half-gap + offset + compliance * force + skew * speed + error maps.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LearnerTable<T: Real> {
    /// Length of a learning interval [control periods].
    pub periods: u16,
    /// 1 over `periods`.
    pub per_periods: T,
    /// Middle period of an interval, counted from 1.
    pub middle: u16,
    /// Learning intervals per block; a block gives one deflection for the estimation.
    pub block: u32,
    /// 1 over `block`.
    pub per_block: T,
    /// Length of a learning interval [s].
    pub span: T,
    /// Prior mean of each parameter.
    pub mean: [T; MOST_PARAMETERS],
    /// Prior standard deviation of each parameter.
    pub deviation: [T; MOST_PARAMETERS],
    /// 1 over `noise` [1/m].
    pub weight: T,
    /// Standard deviation of the deflection of one update: encoder noise, force noise and ripple as wind-up, unmodelled
    /// encoder errors [m].
    pub noise: T,
    /// Variance of the force of one update [N^2].
    pub force_noise: T,
    /// Lag of the motor side's force behind a steadily changing force, over the length of an interval [-].
    pub force_lag: T,
    /// Growth of the variances per learning interval, for wear and temperature [-].
    pub forgetting: T,
    /// Compliance of the meshes alone [m/N].
    pub mesh_compliance: T,
}

/// Stopping time of a shaft.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct StopTable<T: Real> {
    /// Shortest time in which an obstacle stops the shaft [control periods].
    pub stop: u8,
    /// Time after which unchanged readings are judged by the deflection alone [control periods].
    pub forgotten: u8,
    /// 1 over twice `stop`.
    pub per_stops: T,
}

/// Exclusion and readmission of encoders (O21 to O24).
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SupervisorTable<T: Real> {
    /// Stopping time of the link.
    pub output: StopTable<T>,
    /// Stopping time of the motor.
    pub motor: StopTable<T>,
    /// Half of the link's deceleration by twice the motor's largest torque [counts/period^2].
    pub output_brake: T,
    /// Half of the motor's deceleration per newton metre [counts/(period^2 N m)].
    pub motor_brake: T,
    /// Braking torque on the motor by bias and dry friction, in addition to the commanded torque [N m].
    pub motor_drag: T,
    /// Motor counts per output count.
    pub motor_counts: T,
    /// Time of unchanged motor counts above which chance is excluded [control periods].
    pub motor_unmoved_after: u16,
    /// Time for which the readings of an excluded motor encoder must be plausible, and agree with the output encoder,
    /// before readmission [control periods].
    pub motor_trusted_after: u16,
    /// Time of plausible readings before readmission if the counts stand still or disagree with the output encoder
    /// [control periods].
    pub motor_slipped_after: u16,
    /// Time without a fresh reading after which the output encoder is silent [control periods].
    pub silent_after: u16,
    /// Time of the deflection outside its possible range after which a fault of the output encoder is declared [control
    /// periods].
    pub failed_after: u16,
    /// Consecutive learning intervals of settled contact within the range before the output encoder is readmitted.
    pub trusted_after: u16,
    /// Least travel of an output encoder that proves motion [2^-32 turns].
    pub moved: u32,
    /// Margin on either side of the possible range, for dynamics and estimation errors [m].
    pub margin: T,
    /// Largest standard deviation of a valid gap coordinate, over the gap 4b [-].
    pub widest_part: T,
}

/// Check of the signs of torque and motor encoder (O25).
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ResponseTable<T: Real> {
    /// Length of a block [control periods].
    pub block: u16,
    /// 1 over `block`.
    pub per_block: T,
    /// Inertia of motor and link, at the motor, over the squared length of a block [N m/rad].
    pub inertia: T,
    /// Torque, and change of torque, that suffices for a vote [N m].
    pub large: T,
    /// Largest acceleration torque of a block over its torque [-]: twice the response of the motor alone. Teeth cause
    /// larger accelerations.
    pub alone: T,
}
