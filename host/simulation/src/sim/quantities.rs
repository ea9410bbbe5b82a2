//! The quantities of a snapshot beside its meshes that a history holds: one list for CSV and log. CSV is in SI; the log
//! has the units that a viewer likes, and names that ROS 2 accepts.

use parameters::{ContactState, JointParameters};

use super::snapshot::Snapshot;

/// A quantity of a snapshot.
pub struct Quantity {
    /// Name of its CSV column.
    pub column: &'static str,
    /// Name of its field in the log.
    pub field: &'static str,
    /// What it means, with the log's unit.
    pub meaning: &'static str,
    /// The log's number for one in SI.
    pub scale: f64,
    /// The number in SI.
    pub value: Value,
}

/// How a quantity is read from a snapshot.
type Value = fn(&Snapshot, &JointParameters) -> f64;

/// All but the time.
pub const QUANTITIES: [Quantity; 11] = [
    quantity("drive_torque_Nm", "drive_torque_nm", "torque on the sun shaft [N m]", 1.0, |snapshot, _| snapshot.drive),
    quantity("load_torque_Nm", "load_torque_nm", "torque that brakes the link [N m]", 1.0, |snapshot, _| snapshot.load),
    quantity("motor_angle_rad", "motor_angle_rad", "[rad]", 1.0, Snapshot::motor_angle),
    quantity("link_angle_rad", "link_angle_rad", "[rad]", 1.0, |snapshot, _| snapshot.link_angle()),
    quantity("twist_rad", "twist_rad", "motor angle over ratio, less link angle [rad]", 1.0, Snapshot::twist),
    quantity("carrier_speed_rad_per_s", "carrier_speed_rad_per_s", "of the rigid body [rad/s]", 1.0, |snapshot, _| {
        snapshot.carrier_speed
    }),
    quantity("mesh_periods", "mesh_periods", "mesh phase [periods]", 1.0, |snapshot, _| snapshot.mesh_periods),
    quantity("gap_m", "gap_um", "gap coordinate u_s - 2 u_c [um]", 1e6, |snapshot, _| snapshot.gap),
    quantity("gap_rate_m_per_s", "gap_rate_mm_per_s", "[mm/s]", 1e3, |snapshot, _| snapshot.gap_rate),
    quantity("wind_up_m", "wind_up_um", "carrier less link along the line of action [um]", 1e6, |snapshot, _| {
        snapshot.wind_up
    }),
    quantity("wind_up_rate_m_per_s", "wind_up_rate_mm_per_s", "[mm/s]", 1e3, |snapshot, _| snapshot.wind_up_rate),
];

const fn quantity(
    column: &'static str,
    field: &'static str,
    meaning: &'static str,
    scale: f64,
    value: Value,
) -> Quantity {
    Quantity { column, field, meaning, scale, value }
}

/// Number of a contact state in files: 0 parted, 1 drive side, 2 back side.
pub fn code(contact: ContactState) -> u8 {
    match contact {
        ContactState::Separated => 0,
        ContactState::DriveSide => 1,
        ContactState::BackSide => 2,
    }
}
