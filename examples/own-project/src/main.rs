//! On a host, the model stands for the joint: the link swings by 0.1 rad twice a second, and the gap is found on the way.

mod control;

use control::{Control, MY_JOINT};
use model_core::{Motion, Position, VirtualJoint};
use table_blob::{Blob, Gears};

fn main() {
    let tables = Blob::open(&MY_JOINT).expect("tables that the build script wrote");
    let (Gears::One(gears), around) = tables.plant().expect("a plant") else {
        panic!("an equivalent gear has one planet")
    };
    let mut joint = VirtualJoint::new(gears, around);
    let mut control = Control::new().expect("an observer and a compensation");
    let rate = tables.header().control_rate;
    println!("  time_s  error_mrad  lost_motion_arcmin");
    for period in 0..8 * rate {
        let time = period as f32 / rate as f32;
        let (angle, turns_per_radian) = (std::f32::consts::TAU * 2.0 * time, 0.1 / std::f32::consts::TAU);
        let rad_per_s = std::f32::consts::TAU * 2.0;
        let now = Motion {
            position: Position { turns: 0, fraction: turns_per_radian * (1.0 - angle.cos()) },
            speed: 0.1 * rad_per_s * angle.sin(),
            acceleration: 0.1 * rad_per_s * rad_per_s * angle.cos(),
        };
        let torque = control.step(&joint.samples(), now);
        joint.advance(torque, 0.0);
        if (period + 1) % rate == 0 {
            let estimates = control.estimates();
            let error_turns = now.position.difference(estimates.link.turns, estimates.link.fraction);
            let half_backlash = estimates.half_backlash;
            // The half-gap of an equivalent gear is stated 1 m from the axis, so that it is half the lost motion in radians.
            println!(
                "{time:8.2}  {:10.3}  {:18.2}{}",
                1e3 * std::f32::consts::TAU * error_turns,
                (2.0 * half_backlash.value).to_degrees() * 60.0,
                if half_backlash.valid { "" } else { " (not yet valid)" }
            );
        }
    }
}
