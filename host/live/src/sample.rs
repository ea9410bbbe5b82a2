//! State of a joint at one control period, and its quantities by name.

use std::f64::consts::TAU;

use parameters::{ContactState, MAX_PLANETS};

/// Largest number of meshes: two at each planet.
const MAX_MESHES: usize = 2 * MAX_PLANETS;

/// State of a joint at one control period. Quantities that a run does not have are NaN.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Time of the run [s].
    pub time: f64,
    /// Desired angle of the link [rad].
    pub wanted: f64,
    /// Angle of the link [rad].
    pub link: f64,
    /// Speed of the link [rad/s].
    pub link_speed: f64,
    /// Angle of the motor [rad].
    pub motor: f64,
    /// Gap coordinate [m]; the flanks are at plus and minus twice the half-backlash.
    pub gap: f64,
    /// Half-backlash of every mesh [m].
    pub half_backlash: f64,
    /// Gap coordinate by the observer [m].
    pub estimated_gap: f64,
    /// Net force between the flanks at the motor's side [N].
    pub mesh_force: f64,
    /// Torque that brakes the link [N m].
    pub load_torque: f64,
    /// Torque of the motor [N m].
    pub motor_torque: f64,
    /// Contact and force of every mesh.
    pub meshes: Meshes,
}

/// Contact and force of every mesh: sun-planet meshes of every planet first, then ring-planet meshes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Meshes {
    count: usize,
    contacts: [i8; MAX_MESHES],
    forces: [f32; MAX_MESHES],
}

/// Quantity with its name, its meaning and its accessor.
type Number = (&'static str, &'static str, fn(&Sample) -> f64);

/// Quantities under the names of the logs, in SI.
pub const NUMBERS: [Number; 14] = [
    ("time_s", "since the start of the run [s]", |sample| sample.time),
    ("wanted_rad", "desired angle of the link [rad]", |sample| sample.wanted),
    ("link_rad", "angle of the link [rad]", |sample| sample.link),
    ("error_rad", "desired less actual angle of the link [rad]", |sample| sample.wanted - sample.link),
    ("link_speed_rad_per_s", "speed of the link [rad/s]", |sample| sample.link_speed),
    ("motor_turns", "angle of the motor [turns]", |sample| sample.motor / TAU),
    ("gap_m", "gap coordinate [m]", |sample| sample.gap),
    ("drive_flank_m", "gap coordinate at which the drive flanks touch [m]", |sample| 2.0 * sample.half_backlash),
    ("back_flank_m", "gap coordinate at which the back flanks touch [m]", |sample| -2.0 * sample.half_backlash),
    ("estimated_gap_m", "gap coordinate by the observer [m]", |sample| sample.estimated_gap),
    ("half_backlash_m", "half-backlash of every mesh [m]", |sample| sample.half_backlash),
    ("mesh_force_N", "net force between the flanks at the motor's side [N]", |sample| sample.mesh_force),
    ("load_torque_Nm", "torque that brakes the link [N m]", |sample| sample.load_torque),
    ("motor_torque_Nm", "torque of the motor [N m]", |sample| sample.motor_torque),
];

/// Lists with one number for each mesh of a family, with their meanings.
pub const LISTS: [(&str, &str); 2] =
    [("contact", "1 on the drive flank, -1 on the back flank, 0 separated"), ("force_N", "[N]")];

impl Sample {
    /// Sample at a time [s] without any quantity.
    pub fn at(time: f64) -> Self {
        Self {
            time,
            wanted: f64::NAN,
            link: f64::NAN,
            link_speed: f64::NAN,
            motor: f64::NAN,
            gap: f64::NAN,
            half_backlash: f64::NAN,
            estimated_gap: f64::NAN,
            mesh_force: f64::NAN,
            load_torque: f64::NAN,
            motor_torque: f64::NAN,
            meshes: Meshes::default(),
        }
    }
}

impl Meshes {
    /// Adds contact and force [N] of the next mesh; a joint has at most ten.
    pub fn add(&mut self, contact: ContactState, force: f64) {
        if let (Some(own), Some(own_force)) = (self.contacts.get_mut(self.count), self.forces.get_mut(self.count)) {
            *own = match contact {
                ContactState::DriveSide => 1,
                ContactState::BackSide => -1,
                ContactState::Separated => 0,
            };
            *own_force = force as f32;
            self.count += 1;
        }
    }

    /// Contacts of all meshes: 1 on the drive flank, -1 on the back flank, 0 separated.
    pub fn contacts(&self) -> &[i8] {
        &self.contacts[..self.count]
    }

    /// Lists of [`LISTS`] for each of the two mesh families.
    pub fn lists(&self) -> [[Vec<f64>; LISTS.len()]; 2] {
        let half = self.count / 2;
        [0..half, half..self.count].map(|family| {
            let contacts = self.contacts[family.clone()].iter().map(|contact| f64::from(*contact));
            let forces = self.forces[family].iter().map(|force| f64::from(*force));
            [contacts.collect(), forces.collect()]
        })
    }
}
