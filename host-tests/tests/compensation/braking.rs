//! Motions that need more torque than the motor has: random plants on minimum-jerk moves, jumps, sines and trapezoids, with the
//! compensation and with PID. PID drives the motor into the teeth at full torque; the compensation limits the impact and crosses the gap
//! some milliseconds later. The long form runs 1,000 plants: `cargo test --release -p host-tests --test compensation -- --ignored
//! --nocapture thousand`.

use std::f64::consts::TAU;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use host_tests::extent::short_or_long;
use host_tests::tolerance::compensation::{
    LOW_TORQUE_PEAK, LOW_TORQUE_PEAK_NO_PREVIEW, LOW_TORQUE_RMS, LOW_TORQUE_RMS_NO_PREVIEW, LOW_TORQUE_SETTLING,
    NEAR_LIMIT_PEAK, NEAR_LIMIT_RMS,
};
use model_core::gears::{Kinematics, Mechanics};
use rayon::prelude::*;
use reference::closed_loop::{Figures, Motion, MotionProfile, Run, minimum_jerk, swelling};
use scenario::case::Case;
use scenario::controller::ControllerName::{self, MotorPid, NoPreview, Preview};
use scenario::plant::PlantName;
use scenario::random::RandomStream;
use scenario::suite::from_text;

use super::{on_core, run_in};

/// Plants without identified parameters; the link's inertia is known to 10 %.
const PLANTS: &str = r#"
title = "More torque than there is"
profile = "steps"
duration_s = 4.0

[known]
link_inertia_kg_m2 = [0.05, 0.45]

[plant]
link_inertia_kg_m2 = { times = [0.9, 1.1] }
gravity_torque_N_m = [0, 5]
load_coulomb_friction_N_m = [0, 1.5]
half_backlash_um = [20, 60]
torque_constant_error_ratio = [-0.02, 0.02]

[controller]
rivals = ["motor_pid"]
width_guess_ratio = [0.5, 1.5]

[assert]
rms_gain_over_pid = ">= 1"
"#;

/// End of the slow swing in which the joint's parameters are estimated [s].
const ESTIMATION_END: f64 = 1.0;

/// Start of the motion [s].
const MOTION_START: f64 = 1.5;

/// Shape of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MotionKind {
    MinimumJerk,
    Jump,
    Sine,
    Trapezoid,
}

const MOTION_KINDS: [MotionKind; 4] =
    [MotionKind::MinimumJerk, MotionKind::Jump, MotionKind::Sine, MotionKind::Trapezoid];

/// Motion that needs more torque than the motor has.
#[derive(Debug, Clone, Copy)]
struct LowTorqueMotion {
    kind: MotionKind,
    /// [rad].
    height: f64,
    /// Largest acceleration of the set-point [rad/s^2].
    acceleration: f64,
}

impl LowTorqueMotion {
    /// Duration [s]; for a sine four periods, the first with rising amplitude.
    fn duration(&self) -> f64 {
        let time = (self.height / self.acceleration).sqrt();
        match self.kind {
            MotionKind::MinimumJerk => (10.0 / 3.0_f64.sqrt()).sqrt() * time,
            MotionKind::Jump => 0.0,
            MotionKind::Sine => 4.0 * TAU * time,
            MotionKind::Trapezoid => 3.0 * time / 2.0_f64.sqrt(),
        }
    }

    /// Time at which the link should be at rest again [s].
    fn end_time(&self) -> f64 {
        MOTION_START + self.duration()
    }

    /// Set-point during the motion, at a time since its start [s].
    fn set_point(&self, time: f64) -> Motion {
        let Self { kind, height, acceleration } = *self;
        let duration = self.duration();
        match kind {
            MotionKind::Jump => Motion { position: height, ..Motion::default() },
            MotionKind::MinimumJerk => {
                let [place, speed, acceleration] = minimum_jerk(time / duration);
                Motion {
                    position: height * place,
                    speed: height * speed / duration,
                    acceleration: height * acceleration / (duration * duration),
                }
            }
            MotionKind::Sine => {
                let rate = (acceleration / height).sqrt();
                let (sine, cosine) = (rate * time).sin_cos();
                let motion = Motion {
                    position: height * sine,
                    speed: height * rate * cosine,
                    acceleration: -height * rate * rate * sine,
                };
                swelling(time, TAU / rate, motion)
            }
            MotionKind::Trapezoid => {
                let ramp = duration / 3.0;
                let top = acceleration * ramp;
                let left = duration - time;
                let place = acceleration / 2.0;
                if time < ramp {
                    Motion { position: place * time * time, speed: acceleration * time, acceleration }
                } else if left > ramp {
                    Motion { position: top * (time - ramp / 2.0), speed: top, acceleration: 0.0 }
                } else {
                    let position = height - place * left * left;
                    Motion { position, speed: acceleration * left, acceleration: -acceleration }
                }
            }
        }
    }
}

impl MotionProfile for LowTorqueMotion {
    fn at(&self, time: f64) -> Motion {
        if time < ESTIMATION_END {
            let rate = 2.0 * TAU / ESTIMATION_END;
            let (sine, cosine) = (rate * time).sin_cos();
            return Motion {
                position: 0.1 * (1.0 - cosine),
                speed: 0.1 * rate * sine,
                acceleration: 0.1 * rate * rate * cosine,
            };
        }
        let since = time - MOTION_START;
        if since <= 0.0 {
            Motion::default()
        } else if since < self.duration() {
            self.set_point(since)
        } else {
            Motion { position: if self.kind == MotionKind::Sine { 0.0 } else { self.height }, ..Motion::default() }
        }
    }
}

/// Capability of the motor on a plant, referred to the link.
struct MotorCapability {
    /// Inertia of link and motor [kg m^2].
    inertia: f64,
    /// Largest torque [N m].
    torque: f64,
}

impl MotorCapability {
    fn of(case: &Case) -> Self {
        let joint = &case.truth.parameters;
        let geometry = &joint.geometry;
        let ratio = geometry.ratio_by_teeth();
        let sun = joint.bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2) + joint.rotor_inertia;
        let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass;
        let carrier = (joint.carrier_equivalent_mass() + planets) * geometry.carrier_base_radius().powi(2);
        Self {
            inertia: sun * ratio * ratio + carrier + joint.link_inertia,
            torque: case.train.surroundings.torque_limit * ratio,
        }
    }
}

/// Motion for a plant and a seed, and its acceleration torque over the torque limit.
fn draw_motion(kind: MotionKind, case: &Case, seed: u64) -> (LowTorqueMotion, f64) {
    let mut random = RandomStream::new(seed, "braking");
    let torque_ratio = 1.0 + 2.0 * random.uniform();
    let MotorCapability { inertia, torque } = MotorCapability::of(case);
    let acceleration = torque_ratio * torque / inertia;
    let height = match kind {
        MotionKind::MinimumJerk | MotionKind::Trapezoid => 0.05 + random.uniform(),
        // Height whose spring torque, three times inertia and bandwidth squared, gives the acceleration.
        MotionKind::Jump => acceleration / (3.0 * 60.0 * 60.0),
        MotionKind::Sine => 0.05 + 0.4 * random.uniform(),
    };
    (LowTorqueMotion { kind, height, acceleration }, torque_ratio)
}

/// Errors, times and forces of a motion.
struct Outcome {
    kind: MotionKind,
    torque_ratio: f64,
    /// Largest error with the compensation and with PID.
    peak_errors: [f64; 2],
    /// RMS error over PID's [-].
    rms: f64,
    /// Time from the end of the motion until the link stays within the lost motion, and shortest time in which the motor could have brought
    /// the link to rest there [s].
    settling_time: f64,
    optimal_time: f64,
    /// Largest force of the sun's meshes [N].
    forces: [f64; 2],
}

impl Outcome {
    fn of(kind: MotionKind, mode: ControllerName, seed: u64) -> Self {
        let test = from_text("braking.toml", PLANTS, Path::new("."), PlantName::Core).expect("a good test");
        let mut case = test.case(seed).expect("a case of the test");
        let (motion, torque_ratio) = draw_motion(kind, &case, seed);
        case.motion = Arc::new(motion);
        let [ours, pid] = [mode, MotorPid].map(|controller| run_in(&test, &case, seed, on_core(controller)).run);
        let [with, without] = [&ours, &pid].map(|run| Figures::between(run, MOTION_START, f64::INFINITY));
        let geometry = &case.truth.parameters.geometry;
        let lost_motion = 4.0 * case.half_backlash() / (geometry.ratio_by_teeth() * geometry.sun_base_radius);
        Self {
            kind,
            torque_ratio,
            peak_errors: [with.peak, without.peak],
            rms: with.rms / without.rms,
            settling_time: settling_time(&ours, motion.end_time(), lost_motion),
            optimal_time: time_optimal(&ours, &case, &motion),
            forces: [with.peak_mesh_force, without.peak_mesh_force],
        }
    }

    /// Largest error over PID's.
    fn peak(&self) -> f64 {
        self.peak_errors[0] / self.peak_errors[1]
    }

    /// Settling time beyond a time-optimal stop [s].
    fn excess_settling_time(&self) -> f64 {
        self.settling_time - self.optimal_time
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ours, pid] = self.peak_errors.map(|peak| 1e3 * peak);
        let [force, pid_force] = self.forces;
        write!(
            to,
            "{:?} at {:.2} times the torque: peak {ours:.1} mrad, {:.3} of PID's {pid:.1}, RMS {:.3} of PID's, there after {:.0} ms, at best {:.0}, \
             {force:.0} N, PID {pid_force:.0} N",
            self.kind,
            self.torque_ratio,
            self.peak(),
            self.rms,
            1e3 * self.settling_time,
            1e3 * self.optimal_time,
        )
    }
}

/// Time from the motion's end until the link stays within the lost motion [s].
fn settling_time(run: &Run, end_time: f64, lost_motion: f64) -> f64 {
    let outside = run.samples.iter().rev().find(|sample| (sample.wanted - sample.link).abs() > lost_motion);
    outside.map_or(0.0, |sample| (sample.time - end_time).max(0.0))
}

/// Shortest time in which the motor could have brought the link from its angle at the end of the motion to rest at the set-point [s]: full
/// torque toward the set-point, then full torque against it, with weight and dry friction.
fn time_optimal(run: &Run, case: &Case, motion: &LowTorqueMotion) -> f64 {
    /// Step of the integration [s].
    const STEP: f64 = 1e-4;
    /// Tolerances of the arrival [rad], [rad/s].
    const ANGLE_TOLERANCE: f64 = 1e-3;
    const SPEED_TOLERANCE: f64 = 0.1;
    /// End of the search [s].
    const TIME_MAX: f64 = 3.0;
    let MotorCapability { inertia, torque } = MotorCapability::of(case);
    let around = &case.train.surroundings;
    let Some(end) = run.samples.iter().find(|sample| sample.time >= motion.end_time()) else { return 0.0 };
    let weight = around.gravity_torque * end.wanted.sin();
    let (mut left, mut speed, mut time) = (end.wanted - end.link, end.link_speed, 0.0);
    while (left.abs() > ANGLE_TOLERANCE || speed.abs() > SPEED_TOLERANCE) && time < TIME_MAX {
        let load = weight + around.load_friction.coulomb * speed.signum();
        let braking = (torque + load * speed.signum()) / inertia;
        let towards = (left - speed * speed.abs() / (2.0 * braking)).signum();
        speed += STEP * (torque * towards - load) / inertia;
        left -= STEP * speed;
        time += STEP;
    }
    time
}

/// Moves that need up to three times the torque limit end in time, with errors close to PID's.
#[test]
fn moves_short_of_torque_end_in_time() {
    let runs = [Preview, NoPreview].map(|mode| (0..short_or_long(3, 8)).map(move |seed| (mode, seed)));
    let runs: Vec<_> = runs.into_iter().flatten().collect();
    let outcomes: Vec<_> =
        runs.par_iter().map(|&(mode, seed)| (mode, seed, Outcome::of(MotionKind::MinimumJerk, mode, seed))).collect();
    for (mode, seed, outcome) in outcomes {
        println!("{mode:?}, seed {seed}: {outcome}");
        let (peak, rms) = if mode == Preview {
            (LOW_TORQUE_PEAK, LOW_TORQUE_RMS)
        } else {
            (LOW_TORQUE_PEAK_NO_PREVIEW, LOW_TORQUE_RMS_NO_PREVIEW)
        };
        peak.check(outcome.peak());
        rms.check(outcome.rms);
        LOW_TORQUE_SETTLING.check(outcome.excess_settling_time());
    }
}

/// Sine near the torque limit, on links whose inertia is known to 30 %.
const NEAR_LIMIT: &str = r#"
title = "A sine near the torque limit"
duration_s = 4.0

[profile]
kind = "sine"
amplitude_rad = 0.9
frequency_Hz = 2.0

[plant]
half_backlash_um = [10, 100]
link_inertia_kg_m2 = { times = [0.7, 1.3] }
rotor_inertia_kg_m2 = { times = [0.7, 1.3] }

[controller]
rivals = ["motor_pid"]
width_guess_ratio = [0.5, 1.5]

[assert]
rms_gain_over_pid = ">= 1"
"#;

/// Braking planned with too high an inertia begins too early at each reversal of a sine: the link then lags by several times PID's error
/// although the torque suffices.
#[test]
fn sine_near_torque_limit_follows() {
    let test = from_text("near-limit.toml", NEAR_LIMIT, Path::new("."), PlantName::Core).expect("a good test");
    let ratios: Vec<_> = (1..short_or_long(4, 9))
        .into_par_iter()
        .map(|seed| {
            let case = test.case(seed).expect("a case of the test");
            let [ours, pid] = [NoPreview, MotorPid].map(|controller| {
                Figures::between(&run_in(&test, &case, seed, on_core(controller)).run, MOTION_START, f64::INFINITY)
            });
            (seed, ours.peak / pid.peak, ours.rms / pid.rms)
        })
        .collect();
    for (seed, peak, rms) in ratios {
        println!("seed {seed}: peak {peak:.3}, RMS {rms:.3} of PID's");
        NEAR_LIMIT_PEAK.check(peak);
        NEAR_LIMIT_RMS.check(rms);
    }
}

/// Number of plants for each kind of motion in the long form.
fn plants_per_kind() -> u64 {
    std::env::var("BRAKING_PLANTS").map_or(250, |number| number.parse().expect("a number of plants"))
}

/// Prints quantiles of error and settling time over random plants for each kind of motion.
#[test]
#[ignore = "ten minutes of computing"]
fn thousand_plants_short_of_torque() {
    for mode in [NoPreview, Preview] {
        for kind in MOTION_KINDS {
            let mut outcomes: Vec<_> =
                (0..plants_per_kind()).into_par_iter().map(|seed| (seed, Outcome::of(kind, mode, seed))).collect();
            let share = |beyond: &dyn Fn(&Outcome) -> bool| {
                outcomes.iter().filter(|(_, outcome)| beyond(outcome)).count() as f64 / outcomes.len() as f64 * 100.0
            };
            let [peak, rms, settling_time] =
                [share(&|of| of.peak() > 1.0), share(&|of| of.rms > 1.0), share(&|of| of.excess_settling_time() > 0.1)];
            println!(
                "{mode:?}, {kind:?}: peak beyond PID's in {peak:.1} %, RMS in {rms:.1} %, late in {settling_time:.1} %"
            );
            for (name, of) in [
                ("peak", Outcome::peak as fn(&Outcome) -> f64),
                ("RMS", |of| of.rms),
                ("late", Outcome::excess_settling_time),
            ] {
                outcomes.sort_by(|(_, one), (_, other)| of(one).total_cmp(&of(other)));
                let at = |part: usize| of(&outcomes[part * (outcomes.len() - 1) / 100].1);
                println!(
                    "  {name}: median {:.3}, 90 % {:.3}, 99 % {:.3}, worst {:.3}",
                    at(50),
                    at(90),
                    at(99),
                    at(100)
                );
            }
            outcomes.sort_by(|(_, one), (_, other)| other.peak().total_cmp(&one.peak()));
            outcomes.iter().take(3).for_each(|(seed, outcome)| println!("  seed {seed}: {outcome}"));
        }
    }
}
