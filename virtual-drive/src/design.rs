//! Numbers of a drive from the parameters of a joint, and their text for a build script.

extern crate std;

use std::format;
use std::string::String;

use drives::turns::Ratio;
use joint_file::sheet;
use model_core::gears::Kinematics;
use parameters::{JointParameters, Surroundings};

use model_core::gears::design::{DesignError, Effort, Processor, design_scheme};
use model_core::gears::{Scheme, Tables};
use model_core::virtual_joint::VirtualJointDesign;
use model_core::virtual_joint::design::design_surroundings;

use crate::numbers::DriveDesign;

/// Tables of a joint at the control rate of its surroundings, as the image for a processor has them.
pub fn joint_tables<const N: usize>(
    joint: &JointParameters,
    around: &Surroundings,
    processor: &Processor,
) -> Result<VirtualJointDesign<N>, DesignError> {
    let gears: Tables<f32, N> =
        design_scheme(joint, around.control_rate, Scheme::Realtime, Effort::Within(*processor))?;
    Ok(VirtualJointDesign { surroundings: design_surroundings(joint, around, &gears)?, gears })
}

/// Largest bandwidth of the drive's position loop [rad/s]. Assumed: a drive that nobody tuned for the joint.
const MAX_BANDWIDTH: f64 = 40.0;
/// Largest torque that a motor without a limit has [N m].
const MAX_TORQUE: f64 = 1e6;

impl DriveDesign {
    /// Numbers of a drive that fits the joint, at the control rate of its surroundings. `bandwidth` is that of the
    /// joint's controllers [rad/s]; the drive has 40 rad/s at most.
    pub fn new(joint: &JointParameters, around: &Surroundings, bandwidth: f64, has_output_encoder: bool) -> Self {
        let ratio = joint.geometry.ratio_by_teeth();
        let inertia = sheet::inertia_at_link(joint) as f32;
        Self {
            ratio: Ratio::new(ratio),
            control_rate: around.control_rate,
            motor_counts_per_turn: around.motor_encoder.counts_per_turn as u32,
            output_counts_per_turn: has_output_encoder.then_some(around.output_encoder.counts_per_turn as u32),
            inertia,
            rotor_share: (joint.rotor_inertia * ratio * ratio) as f32 / inertia,
            bandwidth: bandwidth.min(MAX_BANDWIDTH) as f32,
            rated_torque: (joint.rated_output_torque / ratio) as f32,
            torque_limit: around.torque_limit.min(MAX_TORQUE) as f32,
            max_velocity: (around.speed_limit / ratio) as f32,
        }
    }

    /// Expression of Rust with the same bits.
    pub fn rust_source(&self) -> String {
        let real = |value: f32| format!("f32::from_bits({:#010x})", value.to_bits());
        let (numerator, denominator) = self.ratio.parts();
        format!(
            "virtual_drive::DriveDesign {{\n\
             ratio: drives::turns::Ratio::of({numerator}, {denominator}),\n\
             control_rate: {},\nmotor_counts_per_turn: {},\noutput_counts_per_turn: {:?},\n\
             inertia: {},\nrotor_share: {},\nbandwidth: {},\nrated_torque: {},\ntorque_limit: {},\nmax_velocity: {},\n}}",
            self.control_rate,
            self.motor_counts_per_turn,
            self.output_counts_per_turn,
            real(self.inertia),
            real(self.rotor_share),
            real(self.bandwidth),
            real(self.rated_torque),
            real(self.torque_limit),
            real(self.max_velocity),
        )
    }
}
