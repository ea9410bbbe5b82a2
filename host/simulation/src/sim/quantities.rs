//! Quantities of a snapshot in a history, except its meshes: one list for CSV and log, in SI.

use parameters::{ContactState, JointParameters};
use report::contacts::Contact;

use super::snapshot::Snapshot;

/// A quantity of a snapshot.
pub struct Quantity {
    /// Name of the CSV column and of the log's field.
    pub column: &'static str,
    /// Meaning, with the unit.
    pub meaning: &'static str,
    /// Accessor of the number in SI.
    pub value: Value,
}

/// Accessor of a quantity.
type Value = fn(&Snapshot, &JointParameters) -> f64;

/// All quantities except the time.
pub const QUANTITIES: [Quantity; 11] = [
    quantity("drive_torque_Nm", "torque that drives the gears at the motor [N m]", |snapshot, _| snapshot.drive),
    quantity("load_torque_Nm", "torque that brakes the link [N m]", |snapshot, _| snapshot.load),
    quantity("motor_angle_rad", "[rad]", Snapshot::motor_angle),
    quantity("link_angle_rad", "[rad]", |snapshot, _| snapshot.link_angle()),
    quantity("twist_rad", "motor angle over ratio, less link angle [rad]", Snapshot::twist),
    quantity("carrier_speed_rad_per_s", "of the rigid body [rad/s]", |snapshot, _| snapshot.carrier_speed),
    quantity("mesh_periods", "mesh phase [periods]", |snapshot, _| snapshot.mesh_periods),
    quantity("gap_m", "gap coordinate u_s - 2 u_c [m]", |snapshot, _| snapshot.gap),
    quantity("gap_rate_m_per_s", "[m/s]", |snapshot, _| snapshot.gap_rate),
    quantity("wind_up_m", "carrier less link along the line of action [m]", |snapshot, _| snapshot.wind_up),
    quantity("wind_up_rate_m_per_s", "[m/s]", |snapshot, _| snapshot.wind_up_rate),
];

const fn quantity(column: &'static str, meaning: &'static str, value: Value) -> Quantity {
    Quantity { column, meaning, value }
}

/// Word for a contact state in files.
pub fn contact_word(contact: ContactState) -> &'static str {
    match contact {
        ContactState::Separated => Contact::Separated,
        ContactState::DriveSide => Contact::DriveSide,
        ContactState::BackSide => Contact::BackSide,
    }
    .word()
}
