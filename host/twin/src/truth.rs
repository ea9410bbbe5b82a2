//! True state of a joint.

/// True state of a joint, beside what its drive reports.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    /// Angle of the link on the scale of the raw output encoder [rad].
    pub link: f64,
    /// Speed of the link [rad/s].
    pub link_speed: f64,
    /// Angle of the motor [rad].
    pub motor: f64,
    /// Gap coordinate [m].
    pub gap: f64,
    /// Half-backlash of every mesh [m].
    pub half_backlash: f64,
    /// Net force between the flanks at the motor's side [N].
    pub mesh_force: f64,
    /// Torque that brakes the link [N m].
    pub load_torque: f64,
    /// Torque in the air gap of the motor [N m].
    pub motor_torque: f64,
}
