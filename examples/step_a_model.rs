//! The gears of a joint, stepped at 20 kHz as on a board. The motor's torque reverses: the teeth leave their flank, cross the gap, bounce
//! off the other flank and settle on it.
//!
//! `cargo run -p examples --example step_a_model`

use std::error::Error;

use model_core::gears::design::design;
use model_core::gears::{Model, Tables, Torques};
use parameters::ContactState;

const TICK_RATE_HZ: u32 = 20_000;
const REVERSAL_TICK: u32 = 4000;
const LAST_TICK: u32 = 8000;
const SHOWN_TICKS: u32 = 400;
const MOTOR_TORQUE_N_M: f32 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    let text = joint_file::preset("q1").ok_or("no such joint")?;
    let joint = joint_file::read(text).expect("a joint that comes with the program").parameters;
    let tables: Tables<f32, 3> = design(&joint, TICK_RATE_HZ)?;
    let mut model = Model::new(&tables);

    println!("time_ms  motor_N_m  gap_um  link_speed_rad_per_s  first_sun_mesh");
    let (mut before, mut landings_ms) = (ContactState::Separated, vec![]);
    for tick in 0..LAST_TICK {
        let drive = if tick < REVERSAL_TICK { MOTOR_TORQUE_N_M } else { -MOTOR_TORQUE_N_M };
        model.step(Torques { drive, load: 0.0 });
        let motion = model.outputs();
        let contact = motion.contacts[0][0];
        let time_ms = 1e3 * (f64::from(tick + 1) - f64::from(REVERSAL_TICK)) / f64::from(TICK_RATE_HZ);
        if time_ms > 0.0 && contact == ContactState::BackSide && before != contact {
            landings_ms.push(time_ms);
        }
        before = contact;
        if tick.abs_diff(REVERSAL_TICK) < SHOWN_TICKS && (tick + 1) % 10 == 0 {
            let (gap_um, speed) = (1e6 * motion.gap, motion.carrier_speed);
            println!("{time_ms:7.2}  {drive:9.2}  {gap_um:6.1}  {speed:20.4}  {contact:?}");
        }
    }
    let half_um = 2e6 * joint.sun_planet.half_backlash[0];
    let (first, last) = (landings_ms.first().ok_or("no landing")?, landings_ms.last().ok_or("no landing")?);
    println!("\nTeeth are free while the gap coordinate is between -{half_um:.0} and {half_um:.0} um.");
    println!("After the reversal they are across in {first:.2} ms, touch {} times, and", landings_ms.len());
    println!("stay on the flank from {last:.2} ms on.");
    Ok(())
}
