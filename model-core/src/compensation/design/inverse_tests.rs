//! Tests of the adaptive inverse of the backlash with designed tables, in control of a motor and a link with play.

use crate::compensation::inverse::BacklashInverse;
use crate::compensation::loop_state::LoopState;
use crate::compensation::set_point::{CommandRef, Motion, Position};
use crate::compensation::tables::CompensationTables;
use crate::compensation::test_bench::q1 as tables;
use crate::observer::{Estimates, Source};

/// Half of the play [rad].
const HALF: f64 = 2e-3;

/// Motor and link without compliance; teeth meet without a rebound. Referred to the link.
struct Rig {
    tables: CompensationTables<f32>,
    inverse: BacklashInverse<f32>,
    /// Inertia of the link over the designed inertia [-].
    ratio: f64,
    friction: f64,
    /// External torque on the link [N m].
    push: f64,
    /// Guess of half the play [rad].
    guess: f64,
    /// Motor less link in the middle of the play, without transmission error [rad].
    middle: f64,
    /// Amplitude of a transmission error that shifts both flanks 72 times per turn [rad].
    error: f64,
    /// Motor and `link`: position [rad] and speed [rad/s].
    motor: [f64; 2],
    link: [f64; 2],
    period: u32,
}

impl Rig {
    /// Starts at rest in the middle of the play.
    fn new(ratio: f64, friction: f64) -> Self {
        let (tables, middle) = (tables(), 0.05);
        Self {
            inverse: BacklashInverse::new(&tables),
            tables,
            ratio,
            friction,
            push: 0.0,
            guess: HALF,
            middle,
            error: 0.0,
            motor: [middle, 0.0],
            link: [0.0; 2],
            period: 0,
        }
    }

    /// Shift of both flanks by the transmission error [rad].
    fn moved(&self) -> f64 {
        self.error * libm::sin(72.0 * self.link[0])
    }

    /// Returns the state for a set-point.
    fn state(&self, now: &Motion<f32>) -> LoopState<f32> {
        let turns = |radians: f64| (radians / core::f64::consts::TAU) as f32;
        let mut estimates = Estimates {
            source: Source::Both,
            motor_lead: (self.motor[0] - self.link[0]) as f32,
            ..Estimates::default()
        };
        estimates.half_backlash.value = self.guess as f32 / self.tables.gear.inverse_lever;
        estimates.flank_shift = (2.0 * self.moved()) as f32 / self.tables.gear.inverse_lever;
        estimates.link.fraction = turns(self.link[0]);
        estimates.link.speed = self.link[1] as f32;
        estimates.motor.speed = self.motor[1] as f32 / self.tables.gear.link_per_motor;
        LoopState::new(&self.tables, &estimates, 0.0, CommandRef::Position { now, ahead: None })
    }

    /// Simulates a period; returns the error of the link [rad] and the torque [N m].
    fn step(&mut self, now: &Motion<f32>) -> (f64, f64) {
        let state = self.state(now);
        if self.period.is_multiple_of(3) {
            self.inverse.update_edges(&self.tables, &state, now);
        }
        let torque = self.inverse.torque(&self.tables, &state, now, false);
        self.inverse.update_integral(&self.tables, &state, Some(0.0));
        if self.period % 3 == 1 {
            self.inverse.estimate(&self.tables, torque);
        }
        self.period += 1;
        self.advance(f64::from(torque));
        (f64::from(state.error), f64::from(torque))
    }

    fn advance(&mut self, torque: f64) {
        let period = f64::from(self.tables.clock.period);
        let (heavy, light) =
            (self.ratio * f64::from(self.tables.body.load_inertia), f64::from(self.tables.body.motor_inertia));
        let brakes = period * self.friction / heavy;
        self.motor[1] += period * torque / light;
        self.link[1] += period * self.push / heavy;
        self.link[1] -= self.link[1].clamp(-brakes, brakes);
        for [place, speed] in [&mut self.motor, &mut self.link] {
            *place += period * *speed;
        }
        let middle = self.middle + self.moved();
        for side in [-1.0, 1.0] {
            let beyond = side * (self.motor[0] - self.link[0] - middle) - HALF;
            if beyond >= 0.0 {
                self.link[0] += side * beyond;
                if side * (self.motor[1] - self.link[1]) > 0.0 {
                    let both = (light * self.motor[1] + heavy * self.link[1]) / (light + heavy);
                    (self.motor[1], self.link[1]) = (both, both);
                }
            }
        }
    }

    /// Returns the RMS error of the link [rad] over a time [s] of a sine that begins at rest.
    fn sine(&mut self, amplitude: f64, frequency: f64, time: f64) -> f64 {
        let rate = core::f64::consts::TAU * frequency;
        let periods = (time * f64::from(self.tables.clock.rate)) as u32;
        let squares: f64 = (0..periods)
            .map(|_| {
                let phase = rate * f64::from(self.period) * f64::from(self.tables.clock.period);
                let now = Motion {
                    position: Position {
                        turns: 0,
                        fraction: (amplitude * (1.0 - libm::cos(phase)) / core::f64::consts::TAU) as f32,
                    },
                    speed: (amplitude * rate * libm::sin(phase)) as f32,
                    acceleration: (amplitude * rate * rate * libm::cos(phase)) as f32,
                };
                self.step(&now).0.powi(2)
            })
            .sum();
        libm::sqrt(squares / f64::from(periods))
    }
}

#[test]
fn pressed_edges_remove_most_of_the_lost_motion() {
    // The flank in the direction of motion carries a link with friction: without an inverse the link lags by half the
    // play.
    let mut rig = Rig { guess: 0.4 * HALF, ..Rig::new(1.0, 2.0) };
    let [first, last] = [(); 2].map(|()| rig.sine(0.3, 0.5, 2.0));
    assert!(last < 0.3 * HALF && last < first, "{first} rad at first, {last} rad then");
}

#[test]
fn wrong_inertia_is_estimated_from_the_torque() {
    let rig = Rig::new(1.0, 0.0);
    let total = rig.tables.body.motor_inertia + rig.tables.body.load_inertia;
    for ratio in [0.7, 1.6] {
        let mut inverse = BacklashInverse::new(&rig.tables);
        // The other law gives the torque that the joint needs.
        for period in 0..60_000_u32 {
            let phase = core::f32::consts::TAU * 3.0 * rig.tables.clock.period * period as f32;
            let now = Motion { acceleration: 20.0 * libm::sinf(phase), ..Motion::default() };
            let state = rig.state(&now);
            inverse.update_edges(&rig.tables, &state, &now);
            inverse.update_integral(&rig.tables, &state, None);
            inverse.estimate(&rig.tables, ratio * total * now.acceleration);
        }
        let [some, none] = [20.0, 0.0].map(|acceleration| {
            let now = Motion { acceleration, ..Motion::default() };
            inverse.clone().torque(&rig.tables, &rig.state(&now), &now, false)
        });
        let fed_forward = (some - none) / (20.0 * total);
        assert!((fed_forward - ratio).abs() < 0.03, "{fed_forward} of what was designed, {ratio} in truth");
    }
}

#[test]
fn joint_at_rest_with_unknown_gap_stays() {
    let mut rig = Rig::new(1.0, 0.5);
    rig.motor[0] += 0.8 * HALF;
    for _ in 0..10_000 {
        let (error, torque) = rig.step(&Motion::default());
        assert!(error == 0.0 && torque.abs() < 1e-3, "{error} rad, {torque} N m");
    }
}

#[test]
fn takeover_holds_position_and_load() {
    let mut rig = Rig::new(1.0, 0.5);
    // The other law pushes with 3 N m against a held link.
    for _ in 0..30_000 {
        let state = rig.state(&Motion::default());
        rig.inverse.update_edges(&rig.tables, &state, &Motion::default());
        rig.inverse.update_integral(&rig.tables, &state, None);
        rig.inverse.estimate(&rig.tables, 3.0);
    }
    let state = rig.state(&Motion::default());
    let torque = rig.inverse.torque(&rig.tables, &state, &Motion::default(), false);
    assert!((torque - 3.0).abs() < 0.15, "{torque} N m");
}

#[test]
fn pushed_link_is_met_on_its_way() {
    let mut rig = Rig::new(1.0, 0.5);
    let mut peak = |push: f64| {
        rig.push = push;
        (0..10_000).map(|_| rig.step(&Motion::default()).0.abs()).fold(0.0, f64::max)
    };
    // The second edge is not measured yet when the push first reverses; by then the link rests at its set-point.
    let [_, first, second] = [1.5, -1.5, 1.5].map(&mut peak);
    let lost_motion = 2.0 * HALF;
    assert!(first < 0.8 * lost_motion, "{first} rad as the push turns round first");
    assert!(second < 0.8 * lost_motion, "{second} rad the second time");
}

#[test]
fn transmission_error_is_followed_before_any_edge() {
    let mut rig = Rig { error: 2.0 * HALF, ..Rig::new(1.0, 2.0) };
    let rms = rig.sine(0.3, 0.5, 2.0);
    assert!(rms < HALF, "{rms} rad of an error of {} rad", rig.error);
}
