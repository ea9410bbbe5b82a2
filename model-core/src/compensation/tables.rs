//! Tables of the compensation as plain numbers, made by `compensation::design`, with a struct for each subject. Angles,
//! torques and inertias are referred to the link. Symbols and equation numbers (K1) to (K25):
//! `docs/theory/compensation.md`.

use crate::numbers::Real;

/// Tables of the compensation of one joint at one control rate and bandwidth.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CompensationTables<T: Real> {
    /// Control clock.
    pub clock: ControlClockTable<T>,
    /// Conversions from motor to link, and from lengths along the line of action to angles.
    pub gear: GearTable<T>,
    /// Inertias and compliance of the joint.
    pub body: BodyTable<T>,
    /// Limits of motor and teeth.
    pub limits: LimitTable<T>,
    /// Gains of the control laws.
    pub law: LawTable<T>,
    /// Path through the gap.
    pub crossing: CrossingTable<T>,
    /// Landing on a flank, and loss of a flank.
    pub landing: LandingTable<T>,
    /// Conditions of a flank change.
    pub switching: SwitchingTable<T>,
    /// Hunting and dead band of a joint at rest.
    pub rest: RestTable<T>,
    /// Load model (K6).
    pub load: LoadModelTable<T>,
    /// Monitor of the compensated loop.
    pub watch: MonitorTable<T>,
}

/// Control clock.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ControlClockTable<T: Real> {
    /// Control periods per second [Hz].
    pub rate: T,
    /// Control period [s].
    pub period: T,
}

/// Conversions from motor to link, and from lengths along the line of action to angles.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct GearTable<T: Real> {
    /// Ratio of motor turns to link turns [-].
    pub motor_per_link: T,
    /// Inverse of `motor_per_link` [-].
    pub link_per_motor: T,
    /// Full turn, 2 pi [rad].
    pub turn: T,
    /// 1 / (r_c cos alpha): from half-backlash to half the lost motion [1/m].
    pub inverse_lever: T,
    /// Mesh phase per radian of the link [2^-32 periods].
    pub mesh_phase_per_radian: T,
    /// Angle of the link per radian of the mesh phase [-].
    pub radians_per_mesh: T,
    /// Periods of the motor's cogging per motor turn [-].
    pub cogging_periods: u32,
    /// Cogging phase per radian of the link [2^-32 periods].
    pub cogging_phase_per_radian: T,
    /// Gear loss over the torque passed on, while the motor drives and while the load drives [-].
    pub losses: [T; 2],
}

/// Inertias and compliance of the joint.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct BodyTable<T: Real> {
    /// Inertia that turns with the motor in the open gap, J_m [kg m^2].
    pub motor_inertia: T,
    /// Remaining inertia, J_l [kg m^2].
    pub load_inertia: T,
    /// Inverse of `load_inertia` [1/(kg m^2)].
    pub inverse_load_inertia: T,
    /// Share of the load in the inertia, J_l/J [-].
    pub load_share: T,
    /// Inverse of `load_share` [-].
    pub inverse_load_share: T,
    /// Reduced inertia J_m J_l/J, I [kg m^2].
    pub reduced_inertia: T,
    /// Bounds of the estimated compliance: largest, smallest [rad/(N m)].
    pub compliances: [T; 2],
    /// Upper bound of the estimated half of the lost motion [rad].
    pub widest_half: T,
}

/// Limits of motor and teeth.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LimitTable<T: Real> {
    /// Largest torque of the motor, M_max [N m].
    pub motor: T,
    /// Largest torque through the teeth in position mode, P in (K11) [N m].
    pub teeth: T,
    /// Lower bound of P - F, the divisor of the swing's term in (K11) [N m].
    pub least_room: T,
    /// Value of P while the law asks for 2 M_max or more [N m].
    pub teeth_at_most: T,
    /// Share of the available torque that braking is planned with (K12) [-].
    pub braking: T,
}

/// Gains of the control laws.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LawTable<T: Real> {
    /// Spring of the loop, K [N m/rad].
    pub position: T,
    /// Damper of the loop, on the link, D [N m s/rad].
    pub damping: T,
    /// Spring over damper, equal to the bandwidth w [1/s].
    pub rate: T,
    /// Damper on the motor, D_m, against the link and against the path through the gap [N m s/rad].
    pub motor_damping: T,
    /// Share of `motor_damping` used in impedance mode (K3) [-].
    pub impedance_damping: T,
    /// Integral gain of plain control times the control period [N m/rad].
    pub integral: T,
    /// Share of the torque cut off by the limit that the integral gives back per period, w T [-].
    pub back_calculation: T,
    /// Change of the compensation's share in the torque per period [-].
    pub trust_step: T,
    /// Time after which an unchanged impedance set-point counts as standing still [s].
    pub longest_hold: T,
}

/// Path through the gap.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CrossingTable<T: Real> {
    /// Preview time: set-points are wanted this far ahead [s].
    pub lead: T,
    /// Reaction time from a decision to the effect of its torque, T_r [s].
    pub reaction: T,
    /// Spring on the path through the gap (K9) [N m/rad].
    pub stiffness: T,
    /// Speed at which loose planets may be struck per torque of the blow, 1/Z in (K8) [rad/s/(N m)].
    pub strike_speed_per_torque: T,
    /// Torque of the blow at small demand, lower bound of M_x in (K8) [N m].
    pub strike_torque: T,
    /// Upper bound of M_x in (K8) at any demand [N m].
    pub hardest_strike: T,
    /// Shortest ramp of a path that the delays allow [s].
    pub shortest_ramp: T,
    /// Duration of a ramp per speed, q in (K8) [s^2/rad].
    pub ramp_per_speed: T,
    /// Longest crossing [s].
    pub longest: T,
    /// Share of the remaining time of a path below which a new path replaces it [-].
    pub shorten: T,
}

/// Landing on a flank, and loss of a flank.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LandingTable<T: Real> {
    /// Smallest landing speed against the link [rad/s].
    pub speed: T,
    /// Landing speed per torque that the flank will carry, if larger than `speed` [rad/s/(N m)].
    pub speed_per_torque: T,
    /// Acceleration of a landing until the flank is met [rad/s^2].
    pub acceleration: T,
    /// Largest landing speed [rad/s].
    pub fastest: T,
    /// Rise of the law's torque per control period after a landing [-].
    pub rise: T,
    /// Rate at which a missed impulse is returned (K16) [1/s].
    pub repayment: T,
    /// Opening above which a flank counts as lost, over the half-gap [-].
    pub opening: T,
    /// Opening below which a flank counts as touched, over the half-gap [-].
    pub landed: T,
}

/// Conditions of a flank change.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SwitchingTable<T: Real> {
    /// Planned demand above which a change of its sign counts [N m].
    pub planned: T,
    /// Uncertainty of a measured torque, M in (K13): unit of the switching hysteresis [N m].
    pub measured: T,
    /// Hysteresis long after the last flank change, over `measured` [-].
    pub least: T,
    /// Largest growth of the switching hysteresis per radian of half the lost motion [N m/rad].
    pub most_growth: T,
    /// Share of a transient that is left after one period: grown hysteresis, hardest push, torque cut off [-].
    pub transient_left: T,
    /// Largest factor g of the switching hysteresis (K13) [-].
    pub most_factor: T,
    /// Share of a change that the smoothed measured torque follows per period [-].
    pub smoothing: T,
    /// Inverse of the torque change above which the torque is smoothed faster [1/(N m)].
    pub inverse_step: T,
}

/// Hunting and dead band of a joint at rest.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct RestTable<T: Real> {
    /// Time between two requests for opposite flanks below which a joint at rest hunts [s].
    pub hunting: T,
    /// First dead band of a joint at rest, over half the lost motion (K15) [-].
    pub first_deadband: T,
    /// Largest dead band, over half the lost motion [-].
    pub largest_deadband: T,
    /// Share of a grown dead band that is left after one period [-].
    pub deadband_left: T,
}

/// Monitor of the compensated loop.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct MonitorTable<T: Real> {
    /// Gain per period of the two smoothing stages that yield the slow load [-].
    pub smoothing: T,
    /// Smallest demand that explains a flank [N m].
    pub least_demand: T,
    /// Decay of the count of unexplained flank changes: in general, and while the error is small [1/s].
    pub leaks: [T; 2],
    /// Count of unexplained flank changes above which the loop counts as hunting [-].
    pub most: T,
    /// RMS error below which the error is small, over half the lost motion [-].
    pub calm_per_half: T,
    /// Gain per period of the mean squared error [-].
    pub memory: T,
    /// RMS error above which the loop counts as hunting, over half the lost motion [-].
    pub error_per_half: T,
    /// Growth of the bound of the RMS error per demand [rad/(N m)].
    pub error_per_demand: T,
    /// Time of plain control after the first trip [s].
    pub first_away: T,
    /// Longest time of plain control after a trip [s].
    pub longest_away: T,
    /// Factor by which the time of plain control grows with each trip [-].
    pub longer: T,
}

/// Load model (K6).
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LoadModelTable<T: Real> {
    /// Growth of the variances of gravity torque and friction per period, variance of a measurement [-].
    pub variances: [T; 3],
    /// Steady gain of the gravity torque [-].
    pub gain: T,
    /// Gain from a correction of the gravity torque to its rate [1/s].
    pub rate_gain: T,
    /// Share of the load's rate that is left after one period in which no flank carries [-].
    pub rate_left: T,
    /// Largest rate of the load [N m/s].
    pub fastest: T,
    /// Inverse of the speed at which friction reaches its full size [s/rad].
    pub friction_slope: T,
    /// Inverse of the planned speed at which friction reaches its full size [s/rad].
    pub planned_friction_slope: T,
    /// Dry friction of motor and link from the settings [N m].
    pub frictions: [T; 2],
}
