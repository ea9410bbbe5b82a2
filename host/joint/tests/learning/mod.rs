//! Parameters that an observer estimates without a board, from motions through the gap of the core's own virtual joint.

use joint_file::JointFile;
use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, CompensationTables, Motion, Position};
use model_core::controller::Controller;
use model_core::gears::design::{Effort, Processor, design_scheme};
use model_core::gears::{Scheme, Tables};
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimates, Memory, ObserverTables};
use model_core::virtual_joint::design::design_surroundings;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};

/// Bandwidth of the control loop [rad/s].
const BANDWIDTH: f64 = 60.0;

/// Preset q1 with changed values.
pub fn joint(changes: &[(&str, &str)]) -> JointFile {
    let mut text = joint_file::preset("q1").expect("the default preset").to_owned();
    for (key, value) in changes {
        text = joint_file::change(&text, key, value).expect("a key of joint files");
    }
    joint_file::read(&text).expect("a good joint")
}

/// Controller of a joint.
pub fn controller(joint: &JointFile) -> Controller<'static, f32> {
    let around = joint.surroundings;
    let observer: ObserverTables<f32> =
        design_observer(&joint.parameters, &observer_settings(&around)).expect("an observer");
    let compensation: CompensationTables<f32> =
        design_compensation(&joint.parameters, &compensation_settings(&around, BANDWIDTH)).expect("a compensation");
    Controller::with_tables(Box::leak(Box::new(observer)), Box::leak(Box::new(compensation)))
}

/// Memory and estimates of a controller after motions through the gap: tables of one joint (`told`), plant of another
/// (`truth`).
pub fn learnt(told: &JointFile, truth: &JointFile, periods: u32) -> (Memory, Estimates<f32>) {
    let around = truth.surroundings;
    let effort = Effort::Within(Processor::STM32F405);
    let tables: Tables<f32, 3> =
        design_scheme(&truth.parameters, around.control_rate, Scheme::Realtime, effort).expect("tables");
    let table: SurroundingsTable<f32> = design_surroundings(&truth.parameters, &around, &tables).expect("surroundings");
    let mut virtual_joint = VirtualJoint::<f32, 3>::new(&tables, &table);
    let mut controller = controller(told);
    let mut estimates = Estimates::default();
    for period in 0..periods {
        let (sine, cosine) = (core::f32::consts::TAU * 2.0 / around.control_rate as f32 * period as f32).sin_cos();
        let position = Position { turns: virtual_joint.output_turn(0), fraction: 0.02 * sine };
        let now = Motion { position, speed: 1.6 * cosine, acceleration: -20.0 * sine };
        let answer = controller.step(&virtual_joint.samples(), &Command::Position { now, ahead: None });
        virtual_joint.advance(answer.shaped.torque, 0.0);
        estimates = answer.estimates;
    }
    (controller.save(), estimates)
}
