//! Constants that decide something, a struct for each subject with one instance: unit, meaning and origin of each.
//!
//! Constants that the tick uses as they are follow first; they are small fractions, exact in every scalar type, so that
//! no conversion runs in the tick. Constants of the design follow: `design` turns them into the tables. Constants that
//! follow from an equation (K) or count elements of an array stand where they are used.
//!
//! Origin: *derived* (formula), *data sheet*, *measured* (test), *chosen* (reason), *tuned* (test; RMS errors and peaks
//! are over those of the motor PID). Where no test is named, no sensitivity is recorded.
//! `docs/decisions/compensation-modelled-joints.md` and `docs/decisions/compensation-real-joints.md` have the figures of
//! the rejected values.

use crate::numbers::Real;

/// Bounds of estimated parameters.
pub(super) struct EstimateBounds<T> {
    /// Smallest and largest link inertia over the designed one [-]. Chosen, as for the compliance.
    pub link_inertia_ratio: [T; 2],
    /// Error of the link from which on set-point or reading is implausible [rad]. Chosen: far above every gap; the
    /// monitor detects a loop that runs away long before.
    pub implausible_error: T,
}

impl<T: Real> EstimateBounds<T> {
    pub const VALUES: Self = Self { link_inertia_ratio: [T::QUARTER, T::FOUR], implausible_error: T::ONE };
}

/// Position law (K1), (K4), (K15).
pub(super) struct PositionThresholds<T> {
    /// Rate at which the first dead band opens, over its size [1/s]: slow against a load that passes through zero, fast
    /// against an integral that winds up until the motor breaks loose. Tuned on `hil/disturbed-hold.toml`: opened at
    /// once, RMS 0.093 instead of 0.060 mrad.
    pub deadband_opening_rate: T,
    /// Excess over the motor's torque limit that the law may command while the link is pushed hard, over that limit
    /// [-]: the excess outweighs part of the damper between motor and link, so that the link is pushed back sooner.
    /// Tuned on `hil/impact.toml`: with all torque, force 2.9 instead of 2.0 times the rated.
    pub impact_excess_torque: T,
    /// Smoothing rate of the set-point's jerk over the smoothing rate of measured torque [-]: planners send coarse
    /// steps, but no noise. Tuned.
    pub jerk_smoothing_ratio: i32,
    /// Reduction of the smoothing rate of the measured demand with a preview [-]: 22.5 instead of 15 T_r. Tuned on
    /// `hil/t2b-slow.toml`: one instead of 9 of 150 runs spend more than 10 ms in the gap.
    pub preview_smoothing_cut: T,
    /// Largest share of a change that the measured demand follows in a period [-]. Chosen: half the step of a filter
    /// without memory.
    pub max_smoothing: T,
}

impl<T: Real> PositionThresholds<T> {
    pub const VALUES: Self = Self {
        deadband_opening_rate: T::ONE,
        impact_excess_torque: T::QUARTER,
        jerk_smoothing_ratio: 8,
        preview_smoothing_cut: T::THIRD,
        max_smoothing: T::HALF,
    };
}

/// Braking (K12).
pub(super) struct BrakingThresholds<T> {
    /// Error over e_0 up to which the linear law always applies [-]. Tuned on sines, moves and random motions that ask
    /// for 0.5 to 3 times the torque: 1/8 changes the figures by less than a tenth, 1 makes the peaks of short moves up
    /// to 1.5 times larger.
    pub linear_error_share: T,
    /// Smallest braking torque assumed, over the motor's limit [-]: a weight that the motor cannot hold is approached
    /// with this torque. Tuned.
    pub min_torque_share: T,
}

impl<T: Real> BrakingThresholds<T> {
    pub const VALUES: Self = Self { linear_error_share: T::QUARTER, min_torque_share: T::EIGHTH };
}

/// Flank control (K5), (K13).
pub(super) struct FlankThresholds<T> {
    /// Time without need of a flank after which the motor moves to the middle of the gap, over `rest.hunting` [-]: a
    /// load that passes through zero is absent for a shorter time. Tuned on `hil/disturbed-hold.toml`.
    pub unneeded_time: T,
    /// Closing speed below which a motor on a path counts as braked [landing speeds]. Derived: the force of a blow is
    /// proportional to the speed, and planets struck on the way cause four times the force of a landing.
    pub braked_speed: i32,
    /// Travel of a landing motor below which the flank has stopped it, over the travel at the landing speed [-]. Tuned.
    pub stopped_travel: T,
    /// Opening above which a flank counts as lost and the motor is moved back to it, over the half-gap [-]. Tuned.
    pub lost_opening: T,
}

impl<T: Real> FlankThresholds<T> {
    pub const VALUES: Self =
        Self { unneeded_time: T::HALF, braked_speed: 4, stopped_travel: T::HALF, lost_opening: T::HALF };
}

/// Prediction of the next start.
pub(super) struct StartThresholds<T> {
    /// Time of standing still after which friction holds the link, over `rest.hunting` [-]. Tuned.
    pub standstill_time: T,
    /// Travel below which the link stands still, over the half-gap [-]. Derived: an encoder's last count flickers
    /// within it; the speed is too coarse.
    pub standstill_travel: T,
}

impl<T: Real> StartThresholds<T> {
    pub const VALUES: Self = Self { standstill_time: T::QUARTER, standstill_travel: T::EIGHTH };
}

/// Easing of a load at rest.
pub(super) struct EasingThresholds<T> {
    /// Largest error of a steady load, and travel by which the link gives way, over the first dead band [-]. Derived:
    /// two counts of a good encoder.
    pub max_travel: T,
    /// Share of the load that is held while the load is eased [-]. Derived: the load fades as fast as it is followed.
    pub held_share: T,
}

impl<T: Real> EasingThresholds<T> {
    pub const VALUES: Self = Self { max_travel: T::HALF, held_share: T::HALF };
}

/// Load model (K6).
pub(super) struct LoadThresholds<T> {
    /// Share of the speed of a creeping link that must exceed the creeping speed before the link counts as moving [-].
    /// Measured: noise reaches three times the creeping speed.
    pub creep_release_share: T,
    /// Gain for a load that may swing, over the gain for other loads [-]: time constant of 25 ms, half the period of 20
    /// Hz. Tuned on `hil/real-any.toml`: followed in 10 ms, 2 runs instead of 1 have an RMS above 1.1.
    pub swing_gain_share: T,
    /// Decaying mark of a torque that the limit has cut off, above which friction is not estimated [-]. Derived: half,
    /// 0.7 transients after the last cut.
    pub saturation: T,
}

impl<T: Real> LoadThresholds<T> {
    pub const VALUES: Self = Self { creep_release_share: T::THIRD, swing_gain_share: T::EIGHTH, saturation: T::HALF };
}

/// Detector of a swinging payload (K7).
pub(super) struct PayloadSwingThresholds<T> {
    /// Changes of the side that make a swing [-]. Derived: a step with its transient makes one or two.
    pub changes: T,
    /// Half the period of the slowest swing [s]. Chosen: modes of payloads are above 8 Hz, motions and loads by people
    /// below 4 Hz.
    pub longest_half_period: T,
    /// Time without a swing after which the load no longer counts as swinging; also the time at the start during which
    /// it may swing [s]. Tuned.
    pub memory: T,
}

impl<T: Real> PayloadSwingThresholds<T> {
    pub const VALUES: Self = Self { changes: T::THREE, longest_half_period: T::EIGHTH, memory: T::ONE };
}

/// Detector of a swinging torque.
pub(super) struct TorqueSwingThresholds<T> {
    /// Torque above which a swinging torque counts as large, over the motor's limit [-]. Tuned on
    /// `hil/never-worse.toml`.
    pub large_torque: T,
    /// Time constant of the loop over the time within which a swinging torque changes from side to side [-]: faster
    /// than any motion that the loop can follow. Tuned on `hil/never-worse.toml`.
    pub side_change_rate: T,
}

impl<T: Real> TorqueSwingThresholds<T> {
    pub const VALUES: Self = Self { large_torque: T::HALF, side_change_rate: T::FOUR };
}

/// Plain control while the link is not seen.
pub(super) struct PlainThresholds<T> {
    /// Speed of the link against the set-point above which the link counts as pushed, and the distance between motor
    /// and link is no longer taken from the flank in use; as travel in a time constant of the loop, over the half-gap
    /// [-]. Tuned.
    pub pushed_link_travel: T,
    /// Smoothing rate of motor less link, over the rate of the loop [-]. Tuned.
    pub lead_smoothing: T,
    /// Growth of the damper of a motor that swings or whose link is pushed, over D_m [-]: the damper then acts on the
    /// motor, not between motor and link. Tuned on `hil/never-worse.toml` and `hil/impact.toml`.
    pub damping_growth: T,
    /// Part of the remaining damper that acts on a link that is pushed hard [-]. Tuned on `hil/impact.toml`: 0 gives
    /// force 1.139, 2/3 gives 1.352 of PID's, 1/2 gives 1.078.
    pub pushed_link_damping: T,
}

impl<T: Real> PlainThresholds<T> {
    pub const VALUES: Self = Self {
        pushed_link_travel: T::QUARTER,
        lead_smoothing: T::QUARTER,
        damping_growth: T::HALF,
        pushed_link_damping: T::HALF,
    };
}

/// Inverse of the backlash (K18), (K21).
pub(super) struct InverseThresholds<T> {
    /// Part of the lost motion that is not inverted [-]. An unforeseen change of the flank causes an error of half the
    /// lost motion without an inverse, of all of it with a full inverse. Tuned.
    pub uninverted_share: T,
    /// Double pole of the path of the shift, over the bandwidth [-]: a crossing takes little more than a time constant
    /// of the loop, and less torque than the limit of the bandwidth leaves. Tuned.
    pub shift_pole_ratio: T,
    /// Rate at which an edge is followed, over the bandwidth [-]: slower than any payload swings. Tuned.
    pub edge_rate_ratio: T,
    /// Time for which a flank is pressed before its edge is measured [time constants of the loop]. Derived: a crossing
    /// and its transient.
    pub settling_time: T,
    /// Saturation of the time for which a flank is pressed [time constants of the loop]. Chosen.
    pub longest_pressed_time: T,
    /// Opening of the teeth, and lag of the link, above which the link counts as moving to the other flank, over the
    /// half-gap [-]. Tuned.
    pub flank_left_opening: T,
}

impl<T: Real> InverseThresholds<T> {
    pub const VALUES: Self = Self {
        uninverted_share: T::QUARTER,
        shift_pole_ratio: T::THREE,
        edge_rate_ratio: T::EIGHTH,
        settling_time: T::TWO,
        longest_pressed_time: T::THREE,
        flank_left_opening: T::HALF,
    };
}

/// Demand estimated from the torque (K19), (K20).
pub(super) struct DemandThresholds<T> {
    /// Rate at which the inertia estimate follows [1/s]: a few swings of a motion. Tuned.
    pub inertia_rate: T,
    /// Rates at which gravity torque and friction follow once they are known [1/s]. Tuned on `hil/real-any.toml`: at 8
    /// the gravity torque follows a loop that swings at 5 Hz, and its sign sustains the swing (RMS 3.1 instead of
    /// 0.56).
    pub load_rates: [T; 2],
    /// Smallest accelerating torque for estimating the inertia, over the motor's limit [-]: friction hides smaller
    /// torques. Tuned.
    pub inertia_min_torque: T,
    /// Standard deviation of torque that inertia, gravity and friction do not explain, over the motor's limit [-].
    /// Tuned.
    pub torque_deviation: T,
    /// Standard deviation of an unknown load, over the motor's limit [-]. Chosen: of ten measurements the
    /// first then weigh most.
    pub unknown_load_deviation: T,
    /// Standard deviation of the friction on a data sheet, over that friction [-]. Chosen.
    pub friction_deviation: T,
    /// Standard deviation of a friction that the data sheet omits, over `torque_deviation` [-]. Chosen.
    pub omitted_friction_deviation: T,
    /// Transmitted torque above which the torque counts as having reached the teeth, over the demand [-]. Tuned.
    pub transmitted_share: T,
    /// Bound of the estimated friction, over the motor's limit [-]. Chosen.
    pub max_friction: T,
}

impl<T: Real> DemandThresholds<T> {
    pub const VALUES: Self = Self {
        inertia_rate: T::TWO,
        load_rates: [T::THREE, T::HALF],
        inertia_min_torque: T::TWENTIETH,
        torque_deviation: T::TWENTIETH,
        unknown_load_deviation: T::EIGHTH,
        friction_deviation: T::THIRD,
        omitted_friction_deviation: T::QUARTER,
        transmitted_share: T::HALF,
        max_friction: T::HALF,
    };
}

/// Monitor of the loop (K22) to (K24).
pub(super) struct MonitorThresholds<T> {
    /// Change of the error between two checks, less the change by the rate of the error, above which the set-point has
    /// jumped, over half the lost motion [-]. Tuned.
    pub set_point_jump: T,
    /// Time after takeover in which the error is granted [time constants of the loop]. Derived: the observer first has
    /// to estimate the link's speed.
    pub takeover_time: T,
    /// Amount that a flank change explained by the load adds to the count [-]. Derived: with the decay of 1/s a load
    /// may change flanks eight times per second.
    pub load_change_weight: T,
    /// Decay rate of the largest error [1/s]. Tuned.
    pub worst_error_decay: T,
}

impl<T: Real> MonitorThresholds<T> {
    pub const VALUES: Self = Self {
        set_point_jump: T::QUARTER,
        takeover_time: T::SIX,
        load_change_weight: T::EIGHTH,
        worst_error_decay: T::HALF,
    };
}

/// Limits of motor and teeth (K11), (K12), at design.
#[cfg(feature = "design")]
pub(super) struct LimitDesign {
    /// Torque through the teeth that the law may ask for, over the peak torque [-]. Derived: torque constant,
    /// efficiency and the swing within the loop's delays each take a few hundredths.
    pub teeth_per_peak: f64,
    /// Lower bound of the room P - F over P in (K11) [-]. Derived: smaller than the uncertainty of the torques.
    pub least_room: f64,
    /// Share of the available torque that braking is planned with (K12) [-]. Tuned on moves, sines and random motions
    /// near the torque limit: 0.85 or 0.95 give a peak of 1.29.
    pub braking: f64,
    /// Peak torque over rated torque if neither settings nor motor give less [-]. Data sheet: the least that gear
    /// catalogues allow.
    pub peak_per_rated: f64,
    /// Largest factor between the estimated compliance and the compliance in the joint file [-]; larger factors are
    /// clamped. Chosen.
    pub compliance_ratio: f64,
    /// Largest estimate of half the lost motion, over the guess [-]. Chosen.
    pub widest_gap_ratio: f64,
}

#[cfg(feature = "design")]
pub(super) const LIMITS: LimitDesign = LimitDesign {
    teeth_per_peak: 0.88,
    least_room: 0.1,
    braking: 0.9,
    peak_per_rated: 2.0,
    compliance_ratio: 4.0,
    widest_gap_ratio: 5.0,
};

/// Gains of the laws (K2), (K3), at design.
#[cfg(feature = "design")]
pub(super) struct LawDesign {
    /// Share of D_m in impedance mode (K3) [-]: the part of a commanded damper that the loop's delays take. Tuned on
    /// `hil/impedance-soft.toml`: 0, 0.3, 0.6 give torque errors of 1.06, 1.07, 1.14 instead of 1.04.
    pub impedance_damping: f64,
    /// Time in which the damper on the motor slows the motor by 1/e [reaction times] (K2). Derived: with fewer the
    /// motor swings against the delays of the loop.
    pub motor_damping_time: f64,
    /// Longest time between impedance set-points of a moving stream [s]. Data sheet: streams send at least 200 per
    /// second.
    pub longest_hold: f64,
    /// Time of blending from plain to compensated control [1/w]; the other way takes one period. Tuned.
    pub trust_time: f64,
}

#[cfg(feature = "design")]
pub(super) const LAW: LawDesign =
    LawDesign { impedance_damping: 0.1, motor_damping_time: 2.5, longest_hold: 5e-3, trust_time: 1.2 };

/// Path through the gap (K8), at design.
#[cfg(feature = "design")]
pub(super) struct CrossingDesign {
    /// Force on planets struck in the gap, over the rated force [-]. Derived: planets struck repeatedly take up to one
    /// and a half times the estimated first blow, which leaves three fifths.
    pub strike_per_rated: f64,
    /// Largest force on planets struck in the gap, over the peak torque, at any demand [-]: a planet caught between sun
    /// and flank is struck harder each time. Tuned: 0.68 makes forces and median RMS gain 10 % larger.
    pub strike_per_peak: f64,
    /// Share of the largest torque for the path of a crossing [-]; feedback along the path has the rest. Chosen.
    pub torque_share: f64,
    /// Shortest crossing [reaction times]. Derived: feedback has no effect in a shorter crossing.
    pub shortest: f64,
    /// Longest crossing, over the crossing of the guessed gap [-]: allows for a wider gap. Chosen.
    pub longest: f64,
    /// Share of the remaining time of a path below which a new path replaces it [-]: small increases of the demand do
    /// not. Tuned.
    pub shorten: f64,
}

#[cfg(feature = "design")]
pub(super) const CROSSING: CrossingDesign = CrossingDesign {
    strike_per_rated: 0.4,
    strike_per_peak: 0.56,
    torque_share: 0.8,
    shortest: 8.0,
    longest: 3.0,
    shorten: 0.8,
};

/// Landing on a flank (K10), (K16), at design.
#[cfg(feature = "design")]
pub(super) struct LandingDesign {
    /// Force of a landing at the end of a path, over the rated torque [-]. Tuned.
    pub force_per_rated: f64,
    /// Force of a landing over the torque that the flank will carry, where that is more [-]. Tuned.
    pub force_per_demand: f64,
    /// Rise time of the law's torque after a landing [reaction times]; the limit (K11) bounds the torque reached.
    /// Chosen.
    pub rise_time: f64,
    /// Time in which a missed impulse is returned, over the time of a crossing (K16) [-]. Tuned.
    pub recovery_time: f64,
    /// Opening above which a flank counts as open, over the half-gap [-]. Derived: several times the observer's error.
    pub opening: f64,
    /// Opening below which a flank counts as touched, over the half-gap [-]. Derived: the residual of the observer's
    /// errors.
    pub landed: f64,
}

#[cfg(feature = "design")]
pub(super) const LANDING: LandingDesign = LandingDesign {
    force_per_rated: 0.03,
    force_per_demand: 0.4,
    rise_time: 1.0,
    recovery_time: 1.15,
    opening: 0.3,
    landed: 0.03,
};

/// Conditions of a flank change (K13), at design.
#[cfg(feature = "design")]
pub(super) struct SwitchingDesign {
    /// Planned torque above which a change of its sign counts, over the largest torque [-]. Tuned.
    pub planned: f64,
    /// Uncertainty M of a measured torque after an impact, over the largest torque [-]. Tuned.
    pub measured: f64,
    /// Hysteresis long after the last flank change, over M [-]. Tuned at 0.5 Hz: half the hysteresis, 16 ms in the
    /// gap; none, a flank change every 20 ms.
    pub least: f64,
    /// Largest factor g of the hysteresis after several changes [-]. Tuned.
    pub most_factor: f64,
    /// Largest growth of the hysteresis, over the torque that an error of half the lost motion asks for [-]: waiting
    /// longer for a flank costs more than a change in vain. Tuned.
    pub most_growth: f64,
    /// Time constant of a transient of the loop [1/w]. Derived: by then the new flank has corrected the error of an
    /// early crossing. Grown hysteresis, memory of a push and of cut torque decay over it.
    pub transient: f64,
    /// Smoothing time of measured torque before decisions [reaction times]. Tuned on `hil/t2b-slow.toml` (15 or 23):
    /// the observer's torques are wrong for a few milliseconds after every impact.
    pub smoothing_time: f64,
    /// Change of a torque above which the torque is smoothed faster, over the largest torque [-]. Tuned.
    pub large_step: f64,
}

#[cfg(feature = "design")]
pub(super) const SWITCHING: SwitchingDesign = SwitchingDesign {
    planned: 0.005,
    measured: 0.02,
    least: 0.3,
    most_factor: 6.0,
    most_growth: 0.3,
    transient: 6.0,
    smoothing_time: 15.0,
    large_step: 0.05,
};

/// Rest (K14), (K15), at design.
#[cfg(feature = "design")]
pub(super) struct RestDesign {
    /// Time between requests for opposite flanks below which a joint at rest hunts [1/w]. Tuned.
    pub hunting: f64,
    /// First dead band at rest without a load, over half the lost motion [-]. Tuned on `hil/never-worse.toml`.
    pub first_deadband: f64,
    /// Largest dead band, over half the lost motion [-]. Derived: the joint rests within half of its lost motion.
    pub largest_deadband: f64,
    /// Time constant with which a grown dead band decays [s]. Derived: long against the hunting that it ends.
    pub deadband_memory: f64,
}

#[cfg(feature = "design")]
pub(super) const REST: RestDesign =
    RestDesign { hunting: 15.0, first_deadband: 0.05, largest_deadband: 0.5, deadband_memory: 30.0 };

/// Load model (K6), at design.
#[cfg(feature = "design")]
pub(super) struct LoadDesign {
    /// Square of the time constant of the gravity torque [s^2]: 3 ms. Tuned: always in 32 ms, median error a third
    /// larger without a payload.
    pub gravity_time_squared: f64,
    /// Square of the time constant of the friction estimate [s^2]: friction is found within a few reversals, then kept
    /// for seconds. Tuned.
    pub friction_time_squared: f64,
    /// Time constant of the estimated rate of the load [s]: a weight swings in a second. Tuned.
    pub rate_time: f64,
    /// Time constant with which the rate of the load decays while no flank carries [s]. Tuned.
    pub rate_memory: f64,
    /// Speed at which dry friction reaches its full size [rad/s]. Derived: the resolution of encoders, for want of a
    /// better number.
    pub friction_speed: f64,
    /// Planned speed at which dry friction reaches its full size [rad/s]: a motion passes it in a few control periods.
    /// Chosen.
    pub planned_friction_speed: f64,
}

#[cfg(feature = "design")]
pub(super) const LOAD: LoadDesign = LoadDesign {
    gravity_time_squared: 1e-5,
    friction_time_squared: 1e-2,
    rate_time: 0.03,
    rate_memory: 0.1,
    friction_speed: 0.01,
    planned_friction_speed: 1e-3,
};

/// Monitor of the loop (K22) to (K24), at design.
#[cfg(feature = "design")]
pub(super) struct MonitorDesign {
    /// Corner of the slow load that explains a flank [rad/s]: below the modes of flexible payloads (8 Hz and more),
    /// above loads by people and steps. Chosen.
    pub slow_load_corner: f64,
    /// Decay of the count of unexplained flank changes in general [1/s]. Tuned.
    pub leak: f64,
    /// Decay of the count while the error is small [1/s]. Measured: a link without friction drifts from flank to flank
    /// fifteen times per second, at a tenth of the error of plain control.
    pub calm_leak: f64,
    /// Count of unexplained flank changes above which the loop counts as hunting [-]. Tuned on `hil/never-worse.toml`:
    /// a joint that follows an alternating load leaves a flank as often as some joints that hunt.
    pub changes: f64,
    /// RMS error that is small, over half the lost motion [-]. Derived: a third of the error without compensation.
    pub calm_error: f64,
    /// Averaging time of the squared error [s]. Tuned.
    pub averaging_time: f64,
    /// RMS error above which the loop counts as hunting, over half the lost motion [-]. Derived: control that ignores
    /// the gap leaves the link on either flank, at half the lost motion.
    pub hunting_error: f64,
    /// Additional permitted error, over the deflection of the loop's spring by the demand [-]. Derived: inertia and
    /// load that are 30 % wrong.
    pub error_per_deflection: f64,
    /// Time of plain control after the first trip [s]. Tuned.
    pub first_retry: f64,
    /// Longest time of plain control after a trip [s]. Tuned.
    pub longest_retry: f64,
    /// Growth of the time of plain control with each trip [-]. Tuned.
    pub retry_growth: f64,
}

#[cfg(feature = "design")]
pub(super) const MONITOR: MonitorDesign = MonitorDesign {
    slow_load_corner: 25.0,
    leak: 1.0,
    calm_leak: 20.0,
    changes: 4.0,
    calm_error: 0.35,
    averaging_time: 0.15,
    hunting_error: 1.5,
    error_per_deflection: 0.3,
    first_retry: 10.0,
    longest_retry: 120.0,
    retry_growth: 4.0,
};

/// Limits of the bandwidth (K25), at design.
#[cfg(feature = "design")]
pub(super) struct BandwidthDesign {
    /// Default bandwidth, where the joint permits it [rad/s]. Chosen.
    pub default: f64,
    /// Smallest phase margin of the motor alone in the open gap [degrees]. Measured on joints with up to a fifth more
    /// lag than on the data sheet: down to 4.7 degrees the gap was estimated on as many joints as at any rate; below
    /// zero it was not estimated on a third to nearly all of them.
    pub phase_margin: f64,
    /// Smallest number of control periods per time constant 1/w [-]. Measured: from 33 on the gap was estimated on as
    /// many joints as at any rate; at 28 and below, not on all of them.
    pub periods: f64,
    /// Smallest frequency of the first swing of motor against link, over the bandwidth [-]. Tuned on one strain wave
    /// gear in motion T2: hunting at 3.9, none at 5; inertias 30 % off move the swing by 15 %. No test holds it yet.
    pub swing_ratio: f64,
    /// Largest crossing time from rest to rest at the largest torque, over the time constant of the loop [-]. Tuned on
    /// one joint with 80 mrad of play in a sine of 1 Hz: the link is thrown from flank to flank at 0.56, not at 0.42;
    /// the guess of the gap may be half of the gap. No test holds it yet.
    pub crossing_ratio: f64,
    /// Highest control rate considered [Hz]. Chosen.
    pub fastest_rate: f64,
}

#[cfg(feature = "design")]
pub(super) const BANDWIDTH: BandwidthDesign = BandwidthDesign {
    default: 60.0,
    phase_margin: 3.0,
    periods: 33.0,
    swing_ratio: 5.0,
    crossing_ratio: 0.3,
    fastest_rate: 1e5,
};
