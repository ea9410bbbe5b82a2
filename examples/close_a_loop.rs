//! A closed loop: a virtual joint is measured, the observer says where the gap is, the compensation gives the torque. The
//! link swings about where its weight turns over, so that the teeth change flanks twice a swing; with and without it.
//!
//! `cargo run -p examples --example close_a_loop`

use std::{error::Error, f64::consts::TAU};

use model_core::compensation::design::{compensation_settings, design_compensation};
use model_core::compensation::{Command, Compensation, Motion, Position};
use model_core::gears::{Flank, Tables, design::design};
use model_core::observer::{MAPPED, Observer, design::design_observer, design::observer_settings};
use model_core::virtual_joint::{VirtualJoint, design::design_surroundings};

const BANDWIDTH_RAD_PER_S: f64 = 60.0;
const SWING_TURNS: f64 = 0.05;
const SWING_RAD_PER_S: f64 = TAU * 0.5;
const LEARNING_S: f64 = 5.0;
const DURATION_S: f64 = 15.0;

fn main() -> Result<(), Box<dyn Error>> {
    let q1 = joint_file::preset("q1").map(joint_file::read).and_then(Result::ok).ok_or("no such joint")?;
    let gears: Tables<f32, 3> = design(&q1.parameters, q1.surroundings.control_rate)?;
    let surroundings = design_surroundings(&q1.parameters, &q1.surroundings, &gears)?;
    let observer_tables = design_observer(&q1.parameters, &observer_settings(&q1.surroundings))?;
    let tables = design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, BANDWIDTH_RAD_PER_S))?;
    let (period_s, lead_s) = (1.0 / f64::from(q1.surroundings.control_rate), f64::from(tables.crossing.lead));
    println!("compensation  crossings  lost_motion_ms  largest_error_mrad");
    for compensates in [false, true] {
        let (mut joint, mut compensation) = (VirtualJoint::new(&gears, &surroundings), Compensation::new(&tables));
        let mut observer = Observer::<f32, MAPPED>::new(&observer_tables);
        let (mut touched, mut crossings, mut lost_s, mut error_turns) = (None, 0.0, 0.0, 0.0_f32);
        for time_s in (0..(DURATION_S / period_s) as u32).map(|period| period_s * f64::from(period)) {
            let mut estimates = *observer.step(&joint.samples());
            // The compensation makes no use of a gap that the observer does not stand by.
            estimates.contact_valid &= compensates;
            let now = motion(time_s);
            let command = Command::Position { now, ahead: Some(motion(time_s + lead_s)) };
            joint.advance(compensation.step(&estimates, &command).torque, 0.0);
            let error = now.position.difference(estimates.link.turns, estimates.link.fraction).abs();
            error_turns = if time_s < LEARNING_S { 0.0 } else { error_turns.max(error) };
            if let Some(flank) = Flank::touched(joint.outputs().contacts[0][0]).filter(|_| time_s >= LEARNING_S) {
                let (before, left_s) = touched.replace((flank, time_s)).unwrap_or((flank, time_s));
                let crossed = f64::from(u8::from(flank != before));
                (crossings, lost_s) = (crossings + crossed, lost_s + crossed * (time_s - left_s));
            }
        }
        let (lost_ms, error_mrad) = (1e3 * lost_s / crossings, 1e3 * TAU * f64::from(error_turns));
        println!("{compensates:12}  {crossings:9}  {lost_ms:14.2}  {error_mrad:18.2}");
    }
    Ok(())
}

/// Where the link shall be.
fn motion(time_s: f64) -> Motion<f32> {
    let (sine, cosine) = (SWING_RAD_PER_S * time_s).sin_cos();
    let (turns, speed) = (SWING_TURNS * sine, TAU * SWING_TURNS * SWING_RAD_PER_S * cosine);
    let acceleration = (-TAU * turns * SWING_RAD_PER_S.powi(2)) as f32;
    Motion { position: Position { turns: 0, fraction: turns as f32 }, speed: speed as f32, acceleration }
}
