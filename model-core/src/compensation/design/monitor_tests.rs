//! Tests of the loop monitor with designed tables.

use crate::compensation::loop_state::LoopState;
use crate::compensation::monitor::{LoopMonitor, MonitorInput};
use crate::compensation::set_point::{CommandRef, Motion};
use crate::compensation::tables::CompensationTables;
use crate::compensation::test_bench::q1 as tables;
use crate::gears::Flank;
use crate::observer::Estimates;

/// Returns a state with an error of a part of half the lost motion.
fn state(tables: &CompensationTables<f32>, part: f32) -> LoopState<f32> {
    let mut estimates = Estimates::default();
    estimates.half_backlash.value = 40e-6;
    let mut state =
        LoopState::new(tables, &estimates, 0.0, CommandRef::Position { now: &Motion::default(), ahead: None });
    state.error = part * state.half_gap;
    state
}

/// Control periods between two judgements.
const TURN: usize = 3;

/// Control periods in which an error grows to its final size; too slow to count as a jump of the set-point.
const GROWS: u32 = 500;

/// Returns a monitor after a second of good control: the tolerance for the takeover has ended.
fn settled(tables: &CompensationTables<f32>) -> LoopMonitor<f32> {
    let (good, mut watch) = (state(tables, 0.0), LoopMonitor::new(tables));
    let watched = MonitorInput { planned: 1.0, load: 0.0, has_error: true, external_impact: false };
    (0..10_000).step_by(TURN).for_each(|_| watch.step(tables, &good, &watched, Some(Flank::Drive)));
    watch
}

/// Returns the control period in which the monitor trips; `None` if it does not within 10 s. The error grows to `part`
/// of half the lost motion, the flank changes every `dwell` periods, and `planned` is the demand on each flank.
fn trips_after(part: f32, dwell: u32, planned: impl Fn(Flank) -> f32) -> Option<u32> {
    let tables = tables();
    let mut watch = settled(&tables);
    (0..100_000).step_by(TURN).find(|&period: &u32| {
        let flank = if (period / dwell).is_multiple_of(2) { Flank::Drive } else { Flank::Back };
        let watched = MonitorInput { planned: planned(flank), load: 0.0, has_error: true, external_impact: false };
        let state = state(&tables, part * (period.min(GROWS) as f32 / GROWS as f32));
        watch.step(&tables, &state, &watched, Some(flank));
        watch.is_tripped()
    })
}

#[test]
fn explained_changes_never_trip() {
    assert_eq!(trips_after(0.9, 250, |flank| flank.sign::<f32>()), None);
}

#[test]
fn unexplained_changes_trip_in_half_a_second() {
    // A payload mode of 20 Hz: forty changes per second.
    let tripped = trips_after(0.9, 250, |_| 0.0).expect("hunting");
    assert!(tripped < 5000, "{tripped}");
}

#[test]
fn load_changes_flanks_eight_times_a_second() {
    // Two changes in 0.2 s, like a gait, and forty per second, like a payload mode that is measured as a load.
    let [gait, mode] = [1000, 250].map(|dwell| {
        let (tables, good) = (tables(), state(&tables(), 0.9));
        let mut watch = settled(&tables);
        (0..100_000).step_by(TURN).find(|&period: &u32| {
            let flank = if (period / dwell).is_multiple_of(2) { Flank::Drive } else { Flank::Back };
            // Large enough to pass the smoothing of the load.
            let watched = MonitorInput {
                planned: 0.0,
                load: 100.0 * flank.sign::<f32>(),
                has_error: true,
                external_impact: false,
            };
            watch.step(&tables, &good, &watched, Some(flank));
            watch.is_tripped()
        })
    });
    assert!(gait.is_none() && mode.is_some_and(|periods| periods < 20_000), "{gait:?} {mode:?}");
}

#[test]
fn small_error_permits_a_drift_between_flanks() {
    // Fifteen changes per second.
    let [calm, rough] = [0.1, 0.9].map(|part| trips_after(part, 667, |_| 0.0));
    assert!(calm.is_none() && rough.is_some_and(|periods| periods < 6000), "{calm:?} {rough:?}");
}

#[test]
fn error_of_plain_control_does_not_trip() {
    assert_eq!(trips_after(1.0, 1_000_000, |_| 1.0), None);
    assert!(trips_after(3.0, 1_000_000, |_| 1.0).expect("worse than plain") < 1500);
}

#[test]
fn error_found_at_takeover_does_not_trip() {
    let (tables, trips) = (tables(), |watch: &mut LoopMonitor<f32>| {
        let tables = tables();
        let watched = MonitorInput { planned: 1.0, load: 0.0, has_error: true, external_impact: false };
        (0..10_000).step_by(TURN).any(|period| {
            // Ten times half the lost motion, which plain control reduces in a few time constants.
            let state = state(&tables, 10.0 * (-0.006 * period as f32).exp());
            watch.step(&tables, &state, &watched, Some(Flank::Drive));
            watch.is_tripped()
        })
    });
    assert!(!trips(&mut LoopMonitor::new(&tables)), "found when it was switched on");
    assert!(!trips(&mut settled(&tables)), "a jump of the set-point");
}

#[test]
fn retry_time_grows_and_returns() {
    let tables = tables();
    let good = state(&tables, 0.0);
    let watched = MonitorInput { planned: 1.0, load: 0.0, has_error: true, external_impact: false };
    let mut watch = settled(&tables);
    let mut step = |state: &LoopState<f32>| {
        watch.step(&tables, state, &watched, Some(Flank::Drive));
        watch.is_tripped()
    };
    let bad = |period: u32| state(&tables, 4.0 * (period.min(GROWS) as f32 / GROWS as f32));
    let mut seconds_away = || {
        let trips = (0..2000).step_by(TURN).find(|&period| step(&bad(period))).expect("worse than plain control");
        let periods = (0..2_000_000).step_by(TURN).find(|_| !step(&good)).expect("the compensation tries again");
        assert!(trips < 1500, "{trips}");
        (0..5000).step_by(TURN).for_each(|_| assert!(!step(&good)));
        periods as f32 * tables.clock.period
    };
    let [first, second] = [(); 2].map(|()| seconds_away());
    assert!((9.9..10.1).contains(&first) && (39.8..40.2).contains(&second), "{first} {second}");
    (0..1_700_000).step_by(TURN).for_each(|_| assert!(!step(&good)));
    let mut seconds_away = || {
        let _ = (0..2000).step_by(TURN).find(|&period| step(&bad(period)));
        let periods = (0..2_000_000).step_by(TURN).find(|_| !step(&good)).expect("the compensation tries again");
        periods as f32 * tables.clock.period
    };
    assert!((9.9..10.1).contains(&seconds_away()), "forgiven");
}

#[test]
fn error_beyond_plain_control_trips_after_a_trip() {
    let tables = tables();
    let watched = MonitorInput { planned: 0.0, load: 0.0, has_error: true, external_impact: false };
    // If plain control recently left an error of twice half the lost motion, no smaller error trips; if not, a smaller
    // error does.
    let trips_at = |left: f32, part: f32| {
        let acts = |watch: &mut LoopMonitor<f32>, part: f32| {
            watch.step(&tables, &state(&tables, part), &watched, Some(Flank::Drive));
            watch.is_tripped()
        };
        let mut watch = settled(&tables);
        assert!(
            !(0..GROWS).step_by(TURN).any(|period| acts(&mut watch, 2.2 * period as f32 / GROWS as f32)),
            "at first"
        );
        assert!((0..10_000).any(|_| acts(&mut watch, 4.0)));
        while watch.is_tripped() {
            watch.step(&tables, &state(&tables, left), &watched, None);
        }
        // The error found at takeover is granted first; the grant decays.
        assert!((0..4000).step_by(TURN).all(|_| !acts(&mut watch, 0.0)));
        // Grows over 50 ms: too slow for a jump of the set-point, too fast for the mean.
        (0..GROWS).step_by(TURN).any(|period| acts(&mut watch, part * period as f32 / GROWS as f32))
    };
    assert!(!trips_at(0.0, 1.4) && trips_at(0.0, 1.7), "of a law that serves well");
    assert!(!trips_at(2.0, 1.7) && trips_at(2.0, 2.2), "of a law that does not");
}

#[test]
fn load_that_is_no_number_leaves_the_monitor() {
    let tables = tables();
    let (state, mut watch) = (state(&tables, 0.1), LoopMonitor::new(&tables));
    watch.step(
        &tables,
        &state,
        &MonitorInput { planned: 1.0, load: f32::NAN, has_error: true, external_impact: false },
        Some(Flank::Drive),
    );
    let watched = MonitorInput { planned: 1.0, load: 0.0, has_error: true, external_impact: false };
    (0..1000).step_by(TURN).for_each(|_| watch.step(&tables, &state, &watched, Some(Flank::Drive)));
    assert!(!watch.is_tripped());
    // The monitor still judges.
    let bad = self::state(&tables, 9.0);
    assert!((0..100_000).step_by(TURN).any(|_| {
        watch.step(&tables, &bad, &watched, Some(Flank::Drive));
        watch.is_tripped()
    }));
}
