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

use crate::numbers::{Real, thresholds};

thresholds! {
    /// Bounds of estimated parameters.
    EstimateBounds<T> {
        /// Smallest and largest link inertia over the designed one [-]. Chosen, as for the compliance.
        link_inertia_ratio: [T; 2] = [T::QUARTER, T::FOUR],
        /// Error of the link from which on set-point or reading is implausible [rad]. Chosen: far above every gap; the
        /// monitor detects a loop that runs away long before.
        implausible_error: T = T::ONE,
    }
}

thresholds! {
    /// Position law (K1), (K4), (K15).
    PositionThresholds<T> {
        /// Rate at which the first dead band opens, over its size [1/s]: slow against a load that passes through zero,
        /// fast against an integral that winds up until the motor breaks loose. Tuned on `hil/disturbed-hold.toml`:
        /// opened at once, RMS 0.093 instead of 0.060 mrad.
        deadband_opening_rate: T = T::ONE,
        /// Excess over the motor's torque limit that the law may command while the link is pushed hard, over that limit
        /// [-]: the excess outweighs part of the damper between motor and link, so that the link is pushed back sooner.
        /// Tuned on `hil/impact.toml`: with all torque, force 2.9 instead of 2.0 times the rated.
        impact_excess_torque: T = T::QUARTER,
        /// Smoothing rate of the set-point's jerk over the smoothing rate of measured torque [-]: planners send coarse
        /// steps, but no noise. Tuned.
        jerk_smoothing_ratio: i32 = 8,
        /// Reduction of the smoothing rate of the measured demand with a preview [-]: 22.5 instead of 15 T_r. Tuned on
        /// `hil/t2b-slow.toml`: one instead of 9 of 150 runs spend more than 10 ms in the gap.
        preview_smoothing_cut: T = T::THIRD,
        /// Largest share of a change that the measured demand follows in a period [-]. Chosen: half the step of a
        /// filter without memory.
        max_smoothing: T = T::HALF,
    }
}

thresholds! {
    /// Braking (K12).
    BrakingThresholds<T> {
        /// Error over e_0 up to which the linear law always applies [-]. Tuned on sines, moves and random motions that
        /// ask for 0.5 to 3 times the torque: 1/8 changes the figures by less than a tenth, 1 makes the peaks of short
        /// moves up to 1.5 times larger.
        linear_error_share: T = T::QUARTER,
        /// Smallest braking torque assumed, over the motor's limit [-]: a weight that the motor cannot hold is
        /// approached with this torque. Tuned.
        min_torque_share: T = T::EIGHTH,
    }
}

thresholds! {
    /// Flank control (K5), (K13).
    FlankThresholds<T> {
        /// Time without need of a flank after which the motor moves to the middle of the gap, over `rest.hunting` [-]:
        /// a load that passes through zero is absent for a shorter time. Tuned on `hil/disturbed-hold.toml`.
        unneeded_time: T = T::HALF,
        /// Closing speed below which a motor on a path counts as braked [landing speeds]. Derived: the force of a blow
        /// is proportional to the speed, and planets struck on the way cause four times the force of a landing.
        braked_speed: i32 = 4,
        /// Travel of a landing motor below which the flank has stopped it, over the travel at the landing speed [-].
        /// Tuned.
        stopped_travel: T = T::HALF,
        /// Opening above which a flank counts as lost and the motor is moved back to it, over the half-gap [-]. Tuned.
        lost_opening: T = T::HALF,
    }
}

thresholds! {
    /// Prediction of the next start.
    StartThresholds<T> {
        /// Time of standing still after which friction holds the link, over `rest.hunting` [-]. Tuned.
        standstill_time: T = T::QUARTER,
        /// Travel below which the link stands still, over the half-gap [-]. Derived: an encoder's last count flickers
        /// within it; the speed is too coarse.
        standstill_travel: T = T::EIGHTH,
    }
}

thresholds! {
    /// Easing of a load at rest.
    EasingThresholds<T> {
        /// Largest error of a steady load, and travel by which the link gives way, over the first dead band [-].
        /// Derived: two counts of a good encoder.
        max_travel: T = T::HALF,
        /// Share of the load that is held while the load is eased [-]. Derived: the load fades as fast as it is
        /// followed.
        held_share: T = T::HALF,
    }
}

thresholds! {
    /// Load model (K6).
    LoadThresholds<T> {
        /// Share of the speed of a creeping link that must exceed the creeping speed before the link counts as moving
        /// [-]. Measured: noise reaches three times the creeping speed.
        creep_release_share: T = T::THIRD,
        /// Gain for a load that may swing, over the gain for other loads [-]: time constant of 25 ms, half the period
        /// of 20 Hz. Tuned on `hil/real-any.toml`: followed in 10 ms, 2 runs instead of 1 have an RMS above 1.1.
        swing_gain_share: T = T::EIGHTH,
        /// Decaying mark of a torque that the limit has cut off, above which friction is not estimated [-]. Derived:
        /// half, 0.7 transients after the last cut.
        saturation: T = T::HALF,
    }
}

thresholds! {
    /// Detector of a swinging payload (K7).
    PayloadSwingThresholds<T> {
        /// Changes of the side that make a swing [-]. Derived: a step with its transient makes one or two.
        changes: T = T::THREE,
        /// Half the period of the slowest swing [s]. Chosen: modes of payloads are above 8 Hz, motions and loads by
        /// people below 4 Hz.
        longest_half_period: T = T::EIGHTH,
        /// Time without a swing after which the load no longer counts as swinging; also the time at the start during
        /// which it may swing [s]. Tuned.
        memory: T = T::ONE,
    }
}

thresholds! {
    /// Detector of a swinging torque.
    TorqueSwingThresholds<T> {
        /// Torque above which a swinging torque counts as large, over the motor's limit [-]. Tuned on
        /// `hil/never-worse.toml`.
        large_torque: T = T::HALF,
        /// Time constant of the loop over the time within which a swinging torque changes from side to side [-]: faster
        /// than any motion that the loop can follow. Tuned on `hil/never-worse.toml`.
        side_change_rate: T = T::FOUR,
    }
}

thresholds! {
    /// Plain control while the link is not seen.
    PlainThresholds<T> {
        /// Speed of the link against the set-point above which the link counts as pushed, and the distance between motor
        /// and link is no longer taken from the flank in use; as travel in a time constant of the loop, over the half-gap
        /// [-]. Tuned.
        pushed_link_travel: T = T::QUARTER,
        /// Smoothing rate of motor less link, over the rate of the loop [-]. Tuned.
        lead_smoothing: T = T::QUARTER,
        /// Growth of the damper of a motor that swings or whose link is pushed, over D_m [-]: the damper then acts on
        /// the motor, not between motor and link. Tuned on `hil/never-worse.toml` and `hil/impact.toml`.
        damping_growth: T = T::HALF,
        /// Part of the remaining damper that acts on a link that is pushed hard [-]. Tuned on `hil/impact.toml`: 0
        /// gives force 1.139, 2/3 gives 1.352 of PID's, 1/2 gives 1.078.
        pushed_link_damping: T = T::HALF,
    }
}

thresholds! {
    /// Inverse of the backlash (K18), (K21).
    InverseThresholds<T> {
        /// Part of the lost motion that is not inverted [-]. An unforeseen change of the flank causes an error of half
        /// the lost motion without an inverse, of all of it with a full inverse. Tuned.
        uninverted_share: T = T::QUARTER,
        /// Double pole of the path of the shift, over the bandwidth [-]: a crossing takes little more than a time
        /// constant of the loop, and less torque than the limit of the bandwidth leaves. Tuned.
        shift_pole_ratio: T = T::THREE,
        /// Rate at which an edge is followed, over the bandwidth [-]: slower than any payload swings. Tuned.
        edge_rate_ratio: T = T::EIGHTH,
        /// Time for which a flank is pressed before its edge is measured [time constants of the loop]. Derived: a
        /// crossing and its transient.
        settling_time: T = T::TWO,
        /// Saturation of the time for which a flank is pressed [time constants of the loop]. Chosen.
        longest_pressed_time: T = T::THREE,
        /// Opening of the teeth, and lag of the link, above which the link counts as moving to the other flank, over the
        /// half-gap [-]. Tuned.
        flank_left_opening: T = T::HALF,
    }
}

thresholds! {
    /// Demand estimated from the torque (K19), (K20).
    DemandThresholds<T> {
        /// Rate at which the inertia estimate follows [1/s]: a few swings of a motion. Tuned.
        inertia_rate: T = T::TWO,
        /// Rates at which gravity torque and friction follow once they are known [1/s]. Tuned on `hil/real-any.toml`:
        /// at 8 the gravity torque follows a loop that swings at 5 Hz, and its sign sustains the swing (RMS 3.1 instead
        /// of 0.56).
        load_rates: [T; 2] = [T::THREE, T::HALF],
        /// Smallest accelerating torque for estimating the inertia, over the motor's limit [-]: friction hides smaller
        /// torques. Tuned.
        inertia_min_torque: T = T::TWENTIETH,
        /// Standard deviation of torque that inertia, gravity and friction do not explain, over the motor's limit [-].
        /// Tuned.
        torque_deviation: T = T::TWENTIETH,
        /// Standard deviation of an unknown load, over the motor's limit [-]. Chosen: of ten measurements the
        /// first then weigh most.
        unknown_load_deviation: T = T::EIGHTH,
        /// Standard deviation of the friction on a data sheet, over that friction [-]. Chosen.
        friction_deviation: T = T::THIRD,
        /// Standard deviation of a friction that the data sheet omits, over `torque_deviation` [-]. Chosen.
        omitted_friction_deviation: T = T::QUARTER,
        /// Transmitted torque above which the torque counts as having reached the teeth, over the demand [-]. Tuned.
        transmitted_share: T = T::HALF,
        /// Bound of the estimated friction, over the motor's limit [-]. Chosen.
        max_friction: T = T::HALF,
    }
}

thresholds! {
    /// Monitor of the loop (K22) to (K24).
    MonitorThresholds<T> {
        /// Change of the error between two checks, less the change by the rate of the error, above which the set-point has
        /// jumped, over half the lost motion [-]. Tuned.
        set_point_jump: T = T::QUARTER,
        /// Time after takeover in which the error is granted [time constants of the loop]. Derived: the observer first
        /// has to estimate the link's speed.
        takeover_time: T = T::SIX,
        /// Amount that a flank change explained by the load adds to the count [-]. Derived: with the decay of 1/s a
        /// load may change flanks eight times per second.
        load_change_weight: T = T::EIGHTH,
        /// Decay rate of the largest error [1/s]. Tuned.
        worst_error_decay: T = T::HALF,
    }
}

#[cfg(feature = "design")]
thresholds! {
    LIMITS: LimitDesign {
        /// Torque through the teeth that the law may ask for, over the peak torque [-]. Derived: torque constant,
        /// efficiency and the swing within the loop's delays each take a few hundredths.
        teeth_per_peak: f64 = 0.88,
        /// Lower bound of the room P - F over P in (K11) [-]. Derived: smaller than the uncertainty of the torques.
        least_room: f64 = 0.1,
        /// Share of the available torque that braking is planned with (K12) [-]. Tuned on moves, sines and random
        /// motions near the torque limit: 0.85 or 0.95 give a peak of 1.29.
        braking: f64 = 0.9,
        /// Peak torque over rated torque if neither settings nor motor give less [-]. Data sheet: the least that gear
        /// catalogues allow.
        peak_per_rated: f64 = 2.0,
        /// Largest factor between the estimated compliance and the compliance in the joint file [-]; larger factors are
        /// clamped. Chosen.
        compliance_ratio: f64 = 4.0,
        /// Largest estimate of half the lost motion, over the guess [-]. Chosen.
        widest_gap_ratio: f64 = 5.0,
    }
}

#[cfg(feature = "design")]
thresholds! {
    LAW: LawDesign {
        /// Share of D_m in impedance mode (K3) [-]: the part of a commanded damper that the loop's delays take. Tuned
        /// on `hil/impedance-soft.toml`: 0, 0.3, 0.6 give torque errors of 1.06, 1.07, 1.14 instead of 1.04.
        impedance_damping: f64 = 0.1,
        /// Time in which the damper on the motor slows the motor by 1/e [reaction times] (K2). Derived: with fewer the
        /// motor swings against the delays of the loop.
        motor_damping_time: f64 = 2.5,
        /// Longest time between impedance set-points of a moving stream [s]. Data sheet: streams send at least 200 per
        /// second.
        longest_hold: f64 = 5e-3,
        /// Time of blending from plain to compensated control [1/w]; the other way takes one period. Tuned.
        trust_time: f64 = 1.2,
    }
}

#[cfg(feature = "design")]
thresholds! {
    CROSSING: CrossingDesign {
        /// Force on planets struck in the gap, over the rated force [-]. Derived: planets struck repeatedly take up to
        /// one and a half times the estimated first blow, which leaves three fifths.
        strike_per_rated: f64 = 0.4,
        /// Largest force on planets struck in the gap, over the peak torque, at any demand [-]: a planet caught between
        /// sun and flank is struck harder each time. Tuned: 0.68 makes forces and median RMS gain 10 % larger.
        strike_per_peak: f64 = 0.56,
        /// Share of the largest torque for the path of a crossing [-]; feedback along the path has the rest. Chosen.
        torque_share: f64 = 0.8,
        /// Shortest crossing [reaction times]. Derived: feedback has no effect in a shorter crossing.
        shortest: f64 = 8.0,
        /// Longest crossing, over the crossing of the guessed gap [-]: allows for a wider gap. Chosen.
        longest: f64 = 3.0,
        /// Share of the remaining time of a path below which a new path replaces it [-]: small increases of the demand
        /// do not. Tuned.
        shorten: f64 = 0.8,
    }
}

#[cfg(feature = "design")]
thresholds! {
    LANDING: LandingDesign {
        /// Force of a landing at the end of a path, over the rated torque [-]. Tuned.
        force_per_rated: f64 = 0.03,
        /// Force of a landing over the torque that the flank will carry, where that is more [-]. Tuned.
        force_per_demand: f64 = 0.4,
        /// Rise time of the law's torque after a landing [reaction times]; the limit (K11) bounds the torque reached.
        /// Chosen.
        rise_time: f64 = 1.0,
        /// Time in which a missed impulse is returned, over the time of a crossing (K16) [-]. Tuned.
        recovery_time: f64 = 1.15,
        /// Opening above which a flank counts as open, over the half-gap [-]. Derived: several times the observer's error.
        opening: f64 = 0.3,
        /// Opening below which a flank counts as touched, over the half-gap [-]. Derived: the residual of the observer's
        /// errors.
        landed: f64 = 0.03,
    }
}

#[cfg(feature = "design")]
thresholds! {
    SWITCHING: SwitchingDesign {
        /// Planned torque above which a change of its sign counts, over the largest torque [-]. Tuned.
        planned: f64 = 0.005,
        /// Uncertainty M of a measured torque after an impact, over the largest torque [-]. Tuned.
        measured: f64 = 0.02,
        /// Hysteresis long after the last flank change, over M [-]. Tuned at 0.5 Hz: half the hysteresis, 16 ms in the
        /// gap; none, a flank change every 20 ms.
        least: f64 = 0.3,
        /// Largest factor g of the hysteresis after several changes [-]. Tuned.
        most_factor: f64 = 6.0,
        /// Largest growth of the hysteresis, over the torque that an error of half the lost motion asks for [-]:
        /// waiting longer for a flank costs more than a change in vain. Tuned.
        most_growth: f64 = 0.3,
        /// Time constant of a transient of the loop [1/w]. Derived: by then the new flank has corrected the error of an
        /// early crossing. Grown hysteresis, memory of a push and of cut torque decay over it.
        transient: f64 = 6.0,
        /// Smoothing time of measured torque before decisions [reaction times]. Tuned on `hil/t2b-slow.toml` (15 or
        /// 23): the observer's torques are wrong for a few milliseconds after every impact.
        smoothing_time: f64 = 15.0,
        /// Change of a torque above which the torque is smoothed faster, over the largest torque [-]. Tuned.
        large_step: f64 = 0.05,
    }
}

#[cfg(feature = "design")]
thresholds! {
    REST: RestDesign {
        /// Time between requests for opposite flanks below which a joint at rest hunts [1/w]. Tuned.
        hunting: f64 = 15.0,
        /// First dead band at rest without a load, over half the lost motion [-]. Tuned on `hil/never-worse.toml`.
        first_deadband: f64 = 0.05,
        /// Largest dead band, over half the lost motion [-]. Derived: the joint rests within half of its lost motion.
        largest_deadband: f64 = 0.5,
        /// Time constant with which a grown dead band decays [s]. Derived: long against the hunting that it ends.
        deadband_memory: f64 = 30.0,
    }
}

#[cfg(feature = "design")]
thresholds! {
    LOAD: LoadDesign {
        /// Square of the time constant of the gravity torque [s^2]: 3 ms. Tuned: always in 32 ms, median error a third
        /// larger without a payload.
        gravity_time_squared: f64 = 1e-5,
        /// Square of the time constant of the friction estimate [s^2]: friction is found within a few reversals, then
        /// kept for seconds. Tuned.
        friction_time_squared: f64 = 1e-2,
        /// Time constant of the estimated rate of the load [s]: a weight swings in a second. Tuned.
        rate_time: f64 = 0.03,
        /// Time constant with which the rate of the load decays while no flank carries [s]. Tuned.
        rate_memory: f64 = 0.1,
        /// Speed at which dry friction reaches its full size [rad/s]. Derived: the resolution of encoders, for want of
        /// a better number.
        friction_speed: f64 = 0.01,
        /// Planned speed at which dry friction reaches its full size [rad/s]: a motion passes it in a few control
        /// periods. Chosen.
        planned_friction_speed: f64 = 1e-3,
    }
}

#[cfg(feature = "design")]
thresholds! {
    MONITOR: MonitorDesign {
        /// Corner of the slow load that explains a flank [rad/s]: below the modes of flexible payloads (8 Hz and more),
        /// above loads by people and steps. Chosen.
        slow_load_corner: f64 = 25.0,
        /// Decay of the count of unexplained flank changes in general [1/s]. Tuned.
        leak: f64 = 1.0,
        /// Decay of the count while the error is small [1/s]. Measured: a link without friction drifts from flank to
        /// flank fifteen times per second, at a tenth of the error of plain control.
        calm_leak: f64 = 20.0,
        /// Count of unexplained flank changes above which the loop counts as hunting [-]. Tuned on `hil/never-worse.toml`:
        /// a joint that follows an alternating load leaves a flank as often as some joints that hunt.
        changes: f64 = 4.0,
        /// RMS error that is small, over half the lost motion [-]. Derived: a third of the error without compensation.
        calm_error: f64 = 0.35,
        /// Averaging time of the squared error [s]. Tuned.
        averaging_time: f64 = 0.15,
        /// RMS error above which the loop counts as hunting, over half the lost motion [-]. Derived: control that ignores
        /// the gap leaves the link on either flank, at half the lost motion.
        hunting_error: f64 = 1.5,
        /// Additional permitted error, over the deflection of the loop's spring by the demand [-]. Derived: inertia and
        /// load that are 30 % wrong.
        error_per_deflection: f64 = 0.3,
        /// Time of plain control after the first trip [s]. Tuned.
        first_retry: f64 = 10.0,
        /// Longest time of plain control after a trip [s]. Tuned.
        longest_retry: f64 = 120.0,
        /// Growth of the time of plain control with each trip [-]. Tuned.
        retry_growth: f64 = 4.0,
    }
}

#[cfg(feature = "design")]
thresholds! {
    BANDWIDTH: BandwidthDesign {
        /// Default bandwidth, where the joint permits it [rad/s]. Chosen.
        default: f64 = 60.0,
        /// Smallest phase margin of the motor alone in the open gap [degrees]. Measured on joints with up to a fifth
        /// more lag than on the data sheet: down to 4.7 degrees the gap was estimated on as many joints as at any rate;
        /// below zero it was not estimated on a third to nearly all of them.
        phase_margin: f64 = 3.0,
        /// Smallest number of control periods per time constant 1/w [-]. Measured: from 33 on the gap was estimated on
        /// as many joints as at any rate; at 28 and below, not on all of them.
        periods: f64 = 33.0,
        /// Smallest frequency of the first swing of motor against link, over the bandwidth [-]. Tuned on one strain
        /// wave gear in motion T2: hunting at 3.9, none at 5; inertias 30 % off move the swing by 15 %. No test holds
        /// it yet.
        swing_ratio: f64 = 5.0,
        /// Largest crossing time from rest to rest at the largest torque, over the time constant of the loop [-]. Tuned
        /// on one joint with 80 mrad of play in a sine of 1 Hz: the link is thrown from flank to flank at 0.56, not at
        /// 0.42; the guess of the gap may be half of the gap. No test holds it yet.
        crossing_ratio: f64 = 0.3,
        /// Highest control rate considered [Hz]. Chosen.
        fastest_rate: f64 = 1e5,
    }
}

#[cfg(feature = "sensitivity")]
pub(crate) fn list() -> std::vec::Vec<crate::numbers::sensitivity::Threshold> {
    [
        EstimateBounds::<f64>::TUNED.list(),
        PositionThresholds::<f64>::TUNED.list(),
        BrakingThresholds::<f64>::TUNED.list(),
        FlankThresholds::<f64>::TUNED.list(),
        StartThresholds::<f64>::TUNED.list(),
        EasingThresholds::<f64>::TUNED.list(),
        LoadThresholds::<f64>::TUNED.list(),
        PayloadSwingThresholds::<f64>::TUNED.list(),
        TorqueSwingThresholds::<f64>::TUNED.list(),
        PlainThresholds::<f64>::TUNED.list(),
        InverseThresholds::<f64>::TUNED.list(),
        DemandThresholds::<f64>::TUNED.list(),
        MonitorThresholds::<f64>::TUNED.list(),
        LIMITS.list(),
        LAW.list(),
        CROSSING.list(),
        LANDING.list(),
        SWITCHING.list(),
        REST.list(),
        LOAD.list(),
        MONITOR.list(),
        BANDWIDTH.list(),
    ]
    .concat()
}
