//! One control period of joint, drive and supply.

use drives::Drive;
use drives::drive::{Fault, Sensors, VirtualPower};
use model_core::virtual_joint::VirtualJoint;

/// Runs one control period: reads the sensors, steps the drive, and advances the joint under the drive's torque. The
/// measured torque of the motor is that of the air gap in the period before. A joint whose state is not finite restarts
/// at rest, and the drive declares its motor encoder lost.
#[inline(never)]
pub fn step<const N: usize>(joint: &mut VirtualJoint<'_, f32, N>, drive: &mut Drive, power: &mut VirtualPower) {
    let samples = joint.samples();
    let mut sensors = Sensors {
        motor_counts: Some(samples.motor.counts),
        output_counts: samples.output.map(|reading| reading.counts),
        motor_torque: joint.acting().air_gap,
        ..Sensors::default()
    };
    power.read(&mut sensors);
    let torque = drive.step(&sensors, None);
    joint.advance(torque, 0.0);
    power.step(drive.settings(), joint.acting().air_gap, joint.motor_speed());
    if !joint.model().is_finite() {
        joint.reset();
        drive.declare(Fault::MotorEncoder);
    }
}
