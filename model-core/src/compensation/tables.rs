//! What the compensation needs as plain numbers, made by `compensation::design`, a struct for each of its subjects. Angles,
//! torques and inertias are referred to the link.

use crate::numbers::Real;

/// Tables of the compensation of one joint at one control rate and bandwidth.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CompensationTables<T: Real> {
    /// The control clock.
    pub clock: ClockTable<T>,
    /// From motor to link, and from lengths along the line of action to angles.
    pub gear: GearTable<T>,
    /// Inertias and compliance of the joint.
    pub body: BodyTable<T>,
    /// Limits of motor and teeth.
    pub limits: LimitTable<T>,
    /// Gains of the control laws.
    pub law: LawTable<T>,
    /// The way through the gap.
    pub crossing: CrossingTable<T>,
    /// Meeting a flank, and losing it.
    pub landing: LandingTable<T>,
    /// When the flank is changed.
    pub switching: SwitchingTable<T>,
    /// A joint at rest whose flank hunts.
    pub rest: RestTable<T>,
    /// Learner of the load.
    pub load: LoadTable<T>,
    /// Monitor of the loop.
    pub watch: WatchTable<T>,
}

/// The control clock.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct ClockTable<T: Real> {
    /// Control periods a second [Hz].
    pub rate: T,
    /// Control period [s].
    pub period: T,
}

/// From motor to link, and from lengths along the line of action to angles.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct GearTable<T: Real> {
    /// Motor turns over link turns.
    pub motor_per_link: T,
    /// Its inverse.
    pub link_per_motor: T,
    /// A whole turn [rad].
    pub turn: T,
    /// 1 / (r_c cos alpha): from half-backlash to half the lost motion [1/m].
    pub inverse_lever: T,
    /// Mesh phase for each radian of the link [2^-32 periods].
    pub mesh_phase_per_radian: T,
    /// Radians of the link for each radian of the mesh phase.
    pub radians_per_mesh: T,
    /// Periods of the motor's cogging in a turn of the motor.
    pub cogging_periods: u32,
    /// Cogging phase for each radian of the link [2^-32 periods].
    pub cogging_phase_per_radian: T,
    /// What the gears lose over what the teeth pass on, while the motor drives and while the load does.
    pub losses: [T; 2],
}

/// Inertias and compliance of the joint.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct BodyTable<T: Real> {
    /// What turns with the motor while the gap is open [kg m^2].
    pub motor_inertia: T,
    /// The rest [kg m^2].
    pub load_inertia: T,
    /// Its inverse.
    pub inverse_load_inertia: T,
    /// Load inertia over all inertia.
    pub load_share: T,
    /// Its inverse.
    pub inverse_load_share: T,
    /// Of motor against load [kg m^2].
    pub reduced_inertia: T,
    /// Largest and smallest compliance that is believed [rad/(N m)].
    pub compliances: [T; 2],
    /// Half the lost motion is never taken for more than this [rad].
    pub widest_half: T,
}

/// Limits of motor and teeth.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LimitTable<T: Real> {
    /// Largest torque [N m].
    pub motor: T,
    /// Most that the teeth shall pass on in position mode [N m].
    pub teeth: T,
    /// What is left to that, at least, as far as a swing is divided by it [N m].
    pub least_room: T,
    /// The most that they may be asked to pass on where the motion asks for twice the motor's torque [N m].
    pub teeth_at_most: T,
    /// Part of the torque at hand that braking is planned with [-].
    pub braking: T,
}

/// Gains of the control laws.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LawTable<T: Real> {
    /// Spring of the loop [N m/rad].
    pub position: T,
    /// Damper of the loop, on the link [N m s/rad].
    pub damping: T,
    /// Spring over damper [1/s].
    pub rate: T,
    /// Damper on the motor against the link, and on the way through the gap [N m s/rad].
    pub motor_damping: T,
    /// Share of that damper in impedance mode.
    pub impedance_damping: T,
    /// Integral of the plain loop over one period [N m/rad].
    pub integral: T,
    /// Share of what the limit cut off that the integral gives back each period.
    pub back_calculation: T,
    /// Change of the trust in the estimates in one period.
    pub trust_step: T,
    /// How long an impedance set-point may be held before it counts as standing still [s].
    pub longest_hold: T,
}

/// The way through the gap.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct CrossingTable<T: Real> {
    /// How far ahead set-points are wanted [s].
    pub lead: T,
    /// From deciding to the torque's effect [s].
    pub reaction: T,
    /// Spring on the way through the gap [N m/rad].
    pub stiffness: T,
    /// Speed against the link at which planets that are struck stand for a torque, for each N m of it [rad/s/(N m)].
    pub strike_speed_per_torque: T,
    /// That torque at little demand [N m].
    pub strike_torque: T,
    /// The same however much is demanded [N m].
    pub hardest_strike: T,
    /// Shortest ramp of a crossing's speed that delays allow [s].
    pub shortest_ramp: T,
    /// Time that torque needs on the ramp for each rad/s [s^2/rad].
    pub ramp_per_speed: T,
    /// Longest crossing [s].
    pub longest: T,
    /// A way through the gap is laid anew when less than this share of what is left of it would do.
    pub shorten: T,
}

/// Meeting a flank, and losing it.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LandingTable<T: Real> {
    /// Speed against the load at which a flank is met [rad/s].
    pub speed: T,
    /// The same for each N m that the flank will carry, if that is more [rad/s/(N m)].
    pub speed_per_torque: T,
    /// By how much a landing quickens while it finds nothing [rad/s^2].
    pub acceleration: T,
    /// Its highest speed [rad/s].
    pub fastest: T,
    /// Rise of the law's torque after a landing, in one period.
    pub rise: T,
    /// Rate at which a missed impulse is made good [1/s].
    pub repayment: T,
    /// Share of the half-gap that has to open before the loss of a flank is believed.
    pub opening: T,
    /// Share of the half-gap within which a flank is as good as touched.
    pub landed: T,
}

/// When the flank is changed.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct SwitchingTable<T: Real> {
    /// Demand beyond which a change of its sign counts [N m].
    pub planned: T,
    /// Measured torque below which no flank is changed for it soon after a change, for each unit of switching hysteresis [N m].
    pub measured: T,
    /// How much of it is left when nothing has changed for long.
    pub least: T,
    /// The most that switching hysteresis grows by, for each radian of half the lost motion [N m/rad].
    pub most_growth: T,
    /// What is left after one period of what a transient of the loop leaves behind: grown hysteresis, the hardest push,
    /// a torque that was cut off.
    pub transient_left: T,
    /// The most switching hysteresis, in units of `measured` [-].
    pub most_factor: T,
    /// Share of news that the measured torque takes up in one period.
    pub smoothing: T,
    /// Inverse of the news from which on they are taken up faster [1/(N m)].
    pub inverse_step: T,
}

/// A joint at rest whose flank hunts.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct RestTable<T: Real> {
    /// A joint at rest that asks for the other flank within this time hunts [s].
    pub hunting: T,
    /// Error let be while nothing hunts, over half the lost motion.
    pub first_deadband: T,
    /// The most that is let be, over half the lost motion.
    pub largest_deadband: T,
    /// What is left of it after one period.
    pub deadband_left: T,
}

/// Monitor of the compensated loop.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct WatchTable<T: Real> {
    /// Share of the load that the slow load takes up in one period, twice [-].
    pub smoothing: T,
    /// Demand that explains a flank, at least [N m].
    pub least_demand: T,
    /// Unexplained flank changes that are forgotten in a second, and while the error is small [1/s].
    pub leaks: [T; 2],
    /// Unexplained flank changes beyond which the loop hunts [-].
    pub most: T,
    /// Root of the mean squared error that is small, over half the lost motion [-].
    pub calm_per_half: T,
    /// Share of the squared error that its mean takes up in one period [-].
    pub memory: T,
    /// Root of the mean squared error beyond which the loop hunts, over half the lost motion [-].
    pub error_per_half: T,
    /// Part of that bound for each N m of the demand [rad/(N m)].
    pub error_per_demand: T,
    /// Time for which plain control takes over at the first trip [s].
    pub first_away: T,
    /// The longest such time [s].
    pub longest_away: T,
    /// Growth of that time with each trip [-].
    pub longer: T,
}

/// Learner of the load.
#[derive(Debug, Clone, PartialEq)]
#[repr(C)]
pub struct LoadTable<T: Real> {
    /// Learner of the load: growth of variances in one period (even part, friction), variance of a reading.
    pub variances: [T; 3],
    /// Share of a reading that the even part takes up in the long run.
    pub gain: T,
    /// Rate of the load for each N m by which its even part is moved [1/s].
    pub rate_gain: T,
    /// What is left of the load's rate after one period.
    pub rate_left: T,
    /// The load's greatest rate [N m/s].
    pub fastest: T,
    /// Inverse of the speed at which friction has its full size [s/rad].
    pub friction_slope: T,
    /// The same for a speed that is planned [s/rad].
    pub planned_friction_slope: T,
    /// Dry friction of the motor and of the link, as far as they are known beforehand [N m].
    pub frictions: [T; 2],
}
