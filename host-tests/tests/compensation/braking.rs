//! Motions that need more torque than the motor has: random plants on minimum-jerk moves, jumps, sines and trapezoids, with the
//! compensation and with PID. PID drives the motor into the teeth at full torque; the compensation limits the impact and crosses the gap
//! some milliseconds later. The long form runs 1,000 plants: `cargo test --release -p host-tests --test compensation -- --ignored
//! --nocapture thousand`.

use std::f64::consts::TAU;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use host_tests::tolerance::compensation::{
    NEAR_LIMIT_PEAK, NEAR_LIMIT_RMS, SHORT_LATE, SHORT_PEAK, SHORT_PEAK_UNFORESEEN, SHORT_RMS, SHORT_RMS_UNFORESEEN,
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
const LEARNT: f64 = 1.0;

/// Start of the motion [s].
const BEGINS: f64 = 1.5;

/// Shape of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    MinimumJerk,
    Jump,
    Sine,
    Trapezoid,
}

const KINDS: [Kind; 4] = [Kind::MinimumJerk, Kind::Jump, Kind::Sine, Kind::Trapezoid];

/// Motion that needs more torque than the motor has.
#[derive(Debug, Clone, Copy)]
struct Excessive {
    kind: Kind,
    /// [rad].
    height: f64,
    /// Largest acceleration of the set-point [rad/s^2].
    acceleration: f64,
}

impl Excessive {
    /// Duration [s]; for a sine four periods, the first with rising amplitude.
    fn lasts(&self) -> f64 {
        let time = (self.height / self.acceleration).sqrt();
        match self.kind {
            Kind::MinimumJerk => (10.0 / 3.0_f64.sqrt()).sqrt() * time,
            Kind::Jump => 0.0,
            Kind::Sine => 4.0 * TAU * time,
            Kind::Trapezoid => 3.0 * time / 2.0_f64.sqrt(),
        }
    }

    /// Time at which the link should be at rest again [s].
    fn ends(&self) -> f64 {
        BEGINS + self.lasts()
    }

    /// Set-point during the motion, at a time since its start [s].
    fn moving(&self, time: f64) -> Motion {
        let Self { kind, height, acceleration } = *self;
        let lasts = self.lasts();
        match kind {
            Kind::Jump => Motion { position: height, ..Motion::default() },
            Kind::MinimumJerk => {
                let [place, speed, acceleration] = minimum_jerk(time / lasts);
                Motion {
                    position: height * place,
                    speed: height * speed / lasts,
                    acceleration: height * acceleration / (lasts * lasts),
                }
            }
            Kind::Sine => {
                let rate = (acceleration / height).sqrt();
                let (sine, cosine) = (rate * time).sin_cos();
                let motion = Motion {
                    position: height * sine,
                    speed: height * rate * cosine,
                    acceleration: -height * rate * rate * sine,
                };
                swelling(time, TAU / rate, motion)
            }
            Kind::Trapezoid => {
                let ramp = lasts / 3.0;
                let top = acceleration * ramp;
                let left = lasts - time;
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

impl MotionProfile for Excessive {
    fn at(&self, time: f64) -> Motion {
        if time < LEARNT {
            let rate = 2.0 * TAU / LEARNT;
            let (sine, cosine) = (rate * time).sin_cos();
            return Motion {
                position: 0.1 * (1.0 - cosine),
                speed: 0.1 * rate * sine,
                acceleration: 0.1 * rate * rate * cosine,
            };
        }
        let since = time - BEGINS;
        if since <= 0.0 {
            Motion::default()
        } else if since < self.lasts() {
            self.moving(since)
        } else {
            Motion { position: if self.kind == Kind::Sine { 0.0 } else { self.height }, ..Motion::default() }
        }
    }
}

/// Capability of the motor on a plant, referred to the link.
struct Strength {
    /// Inertia of link and motor [kg m^2].
    inertia: f64,
    /// Largest torque [N m].
    torque: f64,
}

impl Strength {
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
fn asked(kind: Kind, case: &Case, seed: u64) -> (Excessive, f64) {
    let mut random = RandomStream::new(seed, "braking");
    let times = 1.0 + 2.0 * random.uniform();
    let Strength { inertia, torque } = Strength::of(case);
    let acceleration = times * torque / inertia;
    let height = match kind {
        Kind::MinimumJerk | Kind::Trapezoid => 0.05 + random.uniform(),
        // Height whose spring torque, three times inertia and bandwidth squared, gives the acceleration.
        Kind::Jump => acceleration / (3.0 * 60.0 * 60.0),
        Kind::Sine => 0.05 + 0.4 * random.uniform(),
    };
    (Excessive { kind, height, acceleration }, times)
}

/// Errors, times and forces of a motion.
struct Course {
    kind: Kind,
    times: f64,
    /// Largest error with the compensation and with PID.
    peaks: [f64; 2],
    /// RMS error over PID's [-].
    rms: f64,
    /// Time from the end of the motion until the link stays within the lost motion, and shortest time in which the motor could have brought
    /// the link to rest there [s].
    late: f64,
    best: f64,
    /// Largest force of the sun's meshes [N].
    forces: [f64; 2],
}

impl Course {
    fn of(kind: Kind, mode: ControllerName, seed: u64) -> Self {
        let test = from_text("braking.toml", PLANTS, Path::new("."), PlantName::Core).expect("a good test");
        let mut case = test.case(seed).expect("a case of the test");
        let (motion, times) = asked(kind, &case, seed);
        case.motion = Arc::new(motion);
        let [ours, pid] = [mode, MotorPid].map(|controller| run_in(&test, &case, seed, on_core(controller)).run);
        let [with, without] = [&ours, &pid].map(|run| Figures::between(run, BEGINS, f64::INFINITY));
        let geometry = &case.truth.parameters.geometry;
        let lost_motion = 4.0 * case.half_backlash() / (geometry.ratio_by_teeth() * geometry.sun_base_radius);
        Self {
            kind,
            times,
            peaks: [with.peak, without.peak],
            rms: with.rms / without.rms,
            late: late(&ours, motion.ends(), lost_motion),
            best: time_optimal(&ours, &case, &motion),
            forces: [with.peak_mesh_force, without.peak_mesh_force],
        }
    }

    /// Largest error over PID's.
    fn peak(&self) -> f64 {
        self.peaks[0] / self.peaks[1]
    }

    /// Settling time beyond a time-optimal stop [s].
    fn beyond_best(&self) -> f64 {
        self.late - self.best
    }
}

impl fmt::Display for Course {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ours, pid] = self.peaks.map(|peak| 1e3 * peak);
        let [force, of_pid] = self.forces;
        write!(
            to,
            "{:?} at {:.2} times the torque: peak {ours:.1} mrad, {:.3} of PID's {pid:.1}, RMS {:.3} of PID's, there after {:.0} ms, at best {:.0}, \
             {force:.0} N, PID {of_pid:.0} N",
            self.kind,
            self.times,
            self.peak(),
            self.rms,
            1e3 * self.late,
            1e3 * self.best,
        )
    }
}

/// Time from the motion's end until the link stays within the lost motion [s].
fn late(run: &Run, ends: f64, lost_motion: f64) -> f64 {
    let outside = run.samples.iter().rev().find(|sample| (sample.wanted - sample.link).abs() > lost_motion);
    outside.map_or(0.0, |sample| (sample.time - ends).max(0.0))
}

/// Shortest time in which the motor could have brought the link from its angle at the end of the motion to rest at the set-point [s]: full
/// torque toward the set-point, then full torque against it, with weight and dry friction.
fn time_optimal(run: &Run, case: &Case, motion: &Excessive) -> f64 {
    /// Step of the integration [s].
    const STEP: f64 = 1e-4;
    /// Tolerances of the arrival [rad], [rad/s].
    const NEAR: f64 = 1e-3;
    const SLOW: f64 = 0.1;
    /// End of the search [s].
    const LONGEST: f64 = 3.0;
    let Strength { inertia, torque } = Strength::of(case);
    let around = &case.train.surroundings;
    let Some(end) = run.samples.iter().find(|sample| sample.time >= motion.ends()) else { return 0.0 };
    let weight = around.gravity_torque * end.wanted.sin();
    let (mut left, mut speed, mut time) = (end.wanted - end.link, end.link_speed, 0.0);
    while (left.abs() > NEAR || speed.abs() > SLOW) && time < LONGEST {
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
fn moves_that_ask_for_up_to_three_times_the_torque_end_in_time_and_go_no_farther_astray_than_with_pid() {
    let runs = [Preview, NoPreview].map(|mode| (0..8).map(move |seed| (mode, seed)));
    let runs: Vec<_> = runs.into_iter().flatten().collect();
    let courses: Vec<_> =
        runs.par_iter().map(|&(mode, seed)| (mode, seed, Course::of(Kind::MinimumJerk, mode, seed))).collect();
    for (mode, seed, course) in courses {
        println!("{mode:?}, seed {seed}: {course}");
        let (peak, rms) =
            if mode == Preview { (SHORT_PEAK, SHORT_RMS) } else { (SHORT_PEAK_UNFORESEEN, SHORT_RMS_UNFORESEEN) };
        peak.check(course.peak());
        rms.check(course.rms);
        SHORT_LATE.check(course.beyond_best());
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
fn sine_near_the_torque_limit_follows() {
    let test = from_text("near-limit.toml", NEAR_LIMIT, Path::new("."), PlantName::Core).expect("a good test");
    let ratios: Vec<_> = (1..9)
        .into_par_iter()
        .map(|seed| {
            let case = test.case(seed).expect("a case of the test");
            let [ours, pid] = [NoPreview, MotorPid].map(|controller| {
                Figures::between(&run_in(&test, &case, seed, on_core(controller)).run, BEGINS, f64::INFINITY)
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
fn plants() -> u64 {
    std::env::var("BRAKING_PLANTS").map_or(250, |number| number.parse().expect("a number of plants"))
}

/// Prints quantiles of error and settling time over random plants for each kind of motion.
#[test]
#[ignore = "ten minutes of computing"]
fn a_thousand_plants_are_asked_for_more_torque_than_there_is() {
    for mode in [NoPreview, Preview] {
        for kind in KINDS {
            let mut courses: Vec<_> =
                (0..plants()).into_par_iter().map(|seed| (seed, Course::of(kind, mode, seed))).collect();
            let share = |beyond: &dyn Fn(&Course) -> bool| {
                courses.iter().filter(|(_, course)| beyond(course)).count() as f64 / courses.len() as f64 * 100.0
            };
            let [peak, rms, late] =
                [share(&|of| of.peak() > 1.0), share(&|of| of.rms > 1.0), share(&|of| of.beyond_best() > 0.1)];
            println!("{mode:?}, {kind:?}: peak beyond PID's in {peak:.1} %, RMS in {rms:.1} %, late in {late:.1} %");
            for (name, of) in
                [("peak", Course::peak as fn(&Course) -> f64), ("RMS", |of| of.rms), ("late", Course::beyond_best)]
            {
                courses.sort_by(|(_, one), (_, other)| of(one).total_cmp(&of(other)));
                let at = |part: usize| of(&courses[part * (courses.len() - 1) / 100].1);
                println!(
                    "  {name}: median {:.3}, 90 % {:.3}, 99 % {:.3}, worst {:.3}",
                    at(50),
                    at(90),
                    at(99),
                    at(100)
                );
            }
            courses.sort_by(|(_, one), (_, other)| other.peak().total_cmp(&one.peak()));
            courses.iter().take(3).for_each(|(seed, course)| println!("  seed {seed}: {course}"));
        }
    }
}
