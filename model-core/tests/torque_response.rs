//! Loops that are closed with a motor encoder or a torque of the wrong sign: the torque is taken away for good, soon, and with a name.
//! Loops that are rightly wired never lose it, whatever pulls at the link.

use model_core::compensation::design::{compensation_settings, design_compensation, good_bandwidth};
use model_core::compensation::{Command, ImpedancePoint, Motion, Position, Stage};
use model_core::controller::Controller;
use model_core::gears::{Kinematics, Tables, design::design};
use model_core::numbers::random::splitmix64;
use model_core::observer::design::design_usual_probe;
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{OutputFault, Samples, Source, TorqueResponse};
use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};
use model_core::width_probe::{Probe, ProbeProgress, ProbeRefusal};
use parameters::{JointParameters, Surroundings};

const PRESETS: [&str; 5] = ["q1", "s1", "c1", "d2", "l1"];

/// Wrong signs between controller and joint.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Wiring {
    Right,
    MotorReversed,
    TorqueReversed,
    OutputReversed,
}

/// Task of the loop.
#[derive(Debug, Clone, Copy)]
enum Task {
    /// A sine of 1 Hz about where the link is, from peak to peak [turns].
    Swing(f32),
    /// A spring and damper that is pushed with a tenth of what the motor can hold.
    Impedance,
    /// A hold against a pull, over what the motor can hold, that begins at a time [s] and swings so often a second [Hz].
    Pulled(f32, f32, f32),
}

/// Outcome of a loop.
#[derive(Debug)]
struct Outcome {
    /// When the torque was taken away [s], and how far the link had gone by then [rad].
    reversed: Option<(f64, f64)>,
    /// Largest torque after that [N m].
    torque_after: f32,
    /// Verdict of the observer at the end.
    response: TorqueResponse,
    source: Source,
    /// Largest travel of the link [rad].
    furthest: f64,
    /// Progress of a width probe that begins at the end.
    probe: Option<ProbeProgress<f32>>,
}

fn loops(name: &str, wiring: Wiring, task: Task, seconds: f64) -> Outcome {
    let file = joint_file::read(joint_file::preset(name).expect("a preset")).expect("a joint");
    match file.parameters.geometry.planets {
        1 => closed::<1>(&file.parameters, &file.surroundings, wiring, task, seconds),
        3 => closed::<3>(&file.parameters, &file.surroundings, wiring, task, seconds),
        4 => closed::<4>(&file.parameters, &file.surroundings, wiring, task, seconds),
        planets => panic!("{planets} planets"),
    }
}

fn closed<const N: usize>(
    joint: &JointParameters,
    around: &Surroundings,
    wiring: Wiring,
    task: Task,
    seconds: f64,
) -> Outcome {
    let rate = f64::from(around.control_rate);
    let gears: Tables<f32, N> = design(joint, around.control_rate).expect("tables");
    let surroundings = design_surroundings(joint, around, &gears).expect("tables");
    let observer = design_observer(joint, &observer_settings(around)).expect("tables");
    let bandwidth = good_bandwidth(joint, around).expect("a bandwidth");
    let compensation = design_compensation(joint, &compensation_settings(around, bandwidth)).expect("tables");
    let mut plant = VirtualJoint::new(&gears, &surroundings);
    let mut controller = Controller::<f32>::with_tables(&observer, &compensation);
    let last = around.motor_encoder.counts_per_turn as u32 - 1;
    let sign = if wiring == Wiring::TorqueReversed { -1.0 } else { 1.0 };
    let holds = (around.torque_limit * joint.geometry.ratio_by_teeth()) as f32;
    let (mut torque, mut start, mut furthest) = (0.0_f32, None, 0.0_f64);
    let mut outcome = Outcome {
        reversed: None,
        torque_after: 0.0,
        response: TorqueResponse::Unknown,
        source: Source::default(),
        furthest: 0.0,
        probe: None,
    };
    let probe = design_usual_probe(joint, &observer_settings(around)).expect("a design");
    for period in 0..(seconds * rate) as u32 {
        let time = f64::from(period) / rate;
        let mut samples = Samples { torque, ..plant.samples() };
        if wiring == Wiring::MotorReversed {
            samples.motor.counts = last - samples.motor.counts;
        }
        if let (Wiring::OutputReversed, Some(output)) = (wiring, samples.output.as_mut()) {
            output.counts = around.output_encoder.counts_per_turn as u32 - 1 - output.counts;
        }
        let origin = start.unwrap_or_default();
        let command = command(task, origin, time as f32, holds);
        let answer = controller.step(&samples, &command);
        let link = &answer.estimates.link;
        let _ = start.get_or_insert(Position { turns: link.turns, fraction: link.fraction });
        torque = answer.shaped.torque;
        let outputs = plant.outputs();
        let place = (i64::from(outputs.carrier_turns) << 32) | i64::from(outputs.carrier_fraction);
        furthest = furthest.max((place as f64 / 2_f64.powi(32) * std::f64::consts::TAU).abs());
        if outcome.reversed.is_some() {
            outcome.torque_after = outcome.torque_after.max(torque.abs());
        } else if answer.shaped.stage == Stage::Reversed {
            outcome.reversed = Some((time, furthest));
        }
        (outcome.response, outcome.source) = (answer.estimates.torque_response, answer.estimates.source);
        outcome.furthest = furthest;
        outcome.probe = probe.as_ref().map(|table| Probe::new(table).step(&answer.estimates).1);
        let load = match task {
            Task::Swing(_) => 0.0,
            Task::Impedance => 0.1 * holds,
            Task::Pulled(over, from, frequency) => {
                let since = time as f32 - from;
                let share = if since > 0.0 { (std::f32::consts::TAU * frequency * since).cos() } else { 0.0 };
                over * holds * share
            }
        };
        plant.advance(sign * torque, load);
    }
    outcome
}

fn command(task: Task, origin: Position<f32>, time: f32, holds: f32) -> Command<f32> {
    const TURN: f32 = std::f32::consts::TAU;
    let still = Motion { position: origin, speed: 0.0, acceleration: 0.0 };
    match task {
        Task::Swing(turns) => {
            let (sine, cosine) = (TURN * time).sin_cos();
            let position = Position { fraction: origin.fraction + 0.5 * turns * (1.0 - cosine), ..origin };
            let speed = 0.5 * turns * TURN * TURN * sine;
            let acceleration = 0.5 * turns * TURN * TURN * TURN * cosine;
            Command::Position { now: Motion { position, speed, acceleration }, ahead: None }
        }
        Task::Pulled(..) => Command::Position { now: still, ahead: None },
        Task::Impedance => Command::Impedance(ImpedancePoint {
            position: origin,
            speed: 0.0,
            torque: 0.0,
            stiffness: holds,
            damping: 0.02 * holds,
        }),
    }
}

#[test]
fn a_reversed_loop_loses_its_torque() {
    for name in PRESETS {
        for wiring in [Wiring::MotorReversed, Wiring::TorqueReversed] {
            for task in [Task::Swing(0.03), Task::Impedance] {
                let outcome = loops(name, wiring, task, 1.5);
                println!("{name} {wiring:?} {task:?}: {outcome:?}");
                let (time, travel) = outcome.reversed.unwrap_or((f64::INFINITY, f64::INFINITY));
                assert!(time < 0.5 && travel < 1.2, "{name} {wiring:?} {task:?}: {outcome:?}");
                assert_eq!((outcome.torque_after, outcome.response), (0.0, TorqueResponse::Reversed), "{name}");
                let refused = outcome.probe.is_none_or(|said| said == ProbeProgress::Refused(ProbeRefusal::BadSamples));
                assert!(refused, "{name}: {outcome:?}");
            }
        }
    }
}

/// The link follows the motor, whose sign is right, and the observer goes on without the output encoder.
#[test]
fn a_reversed_output_encoder_is_given_up() {
    for name in PRESETS {
        let outcome = loops(name, Wiring::OutputReversed, Task::Swing(0.03), 1.5);
        println!("{name}: {outcome:?}");
        assert_eq!(outcome.source, Source::MotorOnly(OutputFault::OutOfRange), "{name}");
        assert!(outcome.reversed.is_none() && outcome.furthest < 0.3, "{name}: {outcome:?}");
    }
}

#[test]
fn a_right_loop_keeps_its_torque() {
    let pulls: u64 = std::env::var("PULLS").ok().and_then(|number| number.parse().ok()).unwrap_or(6);
    let (mut all, mut known, mut lost) = (0, 0, 0);
    for name in PRESETS {
        let drawn = (0..pulls).map(|seed| {
            let mut state = seed.wrapping_mul(0x9e37_79b9) + 1;
            let mut share = || (splitmix64(&mut state) >> 40) as f32 / (1_u64 << 24) as f32;
            let (over, from, swings) = (0.3 + 1.7 * share(), 0.3 * share(), share() < 0.5);
            Task::Pulled(over, from, if swings { 30.0 * share() } else { 0.0 })
        });
        for task in [Task::Swing(0.03), Task::Swing(0.3), Task::Impedance].into_iter().chain(drawn) {
            let outcome = loops(name, Wiring::Right, task, 0.8);
            all += 1;
            known += u32::from(outcome.response == TorqueResponse::Right);
            if outcome.reversed.is_some() {
                lost += 1;
                println!("{name} {task:?}: {outcome:?}");
            }
        }
    }
    println!("{known} of {all} loops were found right, {lost} lost their torque");
    assert_eq!(lost, 0);
    assert!(10 * known > all, "{known} of {all}");
}
