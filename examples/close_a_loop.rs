//! Closes a control loop around a virtual joint. The link swings about the angle at which its weight changes sides, so
//! that the teeth change flanks twice a swing. The controller is designed for a gap half as wide again as the true one:
//! it begins in plain control, estimates the gap from the first changes of flanks, and then compensates the gap.
//!
//! `cargo run -p examples --example close_a_loop`

use std::{error::Error, f64::consts::TAU};

use model_core::{Command, Controller, ControllerDesign, Motion, Position, VirtualJointDesign};

const RATE_HZ: u32 = 10_000;
const SWING_TURNS: f64 = 0.05;
const SWING_RAD_PER_S: f64 = TAU * 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let q1 = joint_file::preset("q1").map(joint_file::read).and_then(Result::ok).ok_or("no such joint")?;
    let mut nominal = q1.clone();
    nominal.parameters.sun_planet.half_backlash.iter_mut().for_each(|half_backlash| *half_backlash *= 1.5);
    let design = ControllerDesign::new(&nominal, RATE_HZ)?;
    let mut controller = Controller::new(&design);
    let lead_s = f64::from(design.compensation.crossing.lead);

    let plant = VirtualJointDesign::<3>::new(&q1, RATE_HZ)?;
    let mut joint = plant.joint();
    println!("seconds  half_backlash_um  deviation_um  largest_error_mrad");
    for second in 1..=10 {
        let mut largest_turns = 0.0_f32;
        for period in (second - 1) * RATE_HZ..second * RATE_HZ {
            let time_s = f64::from(period) / f64::from(RATE_HZ);
            let (now, ahead) = (motion(time_s), Some(motion(time_s + lead_s)));
            let answer = controller.step(&joint.samples(), &Command::Position { now, ahead });
            joint.advance(answer.shaped.torque, 0.0);
            let link = answer.estimates.link;
            largest_turns = largest_turns.max(now.position.difference(link.turns, link.fraction).abs());
        }
        let gap = controller.estimates().half_backlash;
        let (width_um, deviation_um) = (1e6 * gap.value, 1e6 * gap.variance.sqrt());
        println!("{second:7}  {width_um:16.1}  {deviation_um:12.1}  {:18.2}", 1e3 * TAU * f64::from(largest_turns));
    }
    Ok(())
}

/// Set-point of the link.
fn motion(time_s: f64) -> Motion {
    let (sine, cosine) = (SWING_RAD_PER_S * time_s).sin_cos();
    let (turns, speed) = (SWING_TURNS * sine, TAU * SWING_TURNS * SWING_RAD_PER_S * cosine);
    let acceleration = (-TAU * turns * SWING_RAD_PER_S.powi(2)) as f32;
    Motion { position: Position { turns: 0, fraction: turns as f32 }, speed: speed as f32, acceleration }
}
