//! The history of a run as CSV: one row a sample, units in the names of the columns, numbers that read back to the same
//! bits. Figures derived from the history are not in it.

use std::io::{self, Write};

use parameters::{ContactState, JointParameters};

use super::moment::Moment;

/// Number of a contact state in files: 0 parted, 1 drive side, 2 back side.
pub fn code(contact: ContactState) -> u8 {
    match contact {
        ContactState::Separated => 0,
        ContactState::DriveSide => 1,
        ContactState::BackSide => 2,
    }
}

/// Names of the columns that do not belong to a mesh.
const COLUMNS: [&str; 12] = [
    "time_s",
    "drive_torque_Nm",
    "load_torque_Nm",
    "motor_angle_rad",
    "link_angle_rad",
    "twist_rad",
    "carrier_speed_rad_per_s",
    "mesh_periods",
    "gap_m",
    "gap_rate_m_per_s",
    "wind_up_m",
    "wind_up_rate_m_per_s",
];

/// Writes rows.
pub struct CsvFile<'a, W> {
    out: W,
    joint: &'a JointParameters,
}

impl<'a, W: Write> CsvFile<'a, W> {
    /// Begins with the names of the columns.
    pub fn begin(mut out: W, joint: &'a JointParameters) -> io::Result<Self> {
        let mut names: Vec<String> = COLUMNS.iter().map(ToString::to_string).collect();
        for kind in ["sun_planet", "ring_planet"] {
            for planet in 1..=joint.geometry.planets {
                let quantities = ["deflection_m", "deflection_rate_m_per_s", "force_N", "contact"];
                names.extend(quantities.map(|quantity| format!("{kind}_{planet}_{quantity}")));
            }
        }
        writeln!(out, "{}", names.join(","))?;
        Ok(Self { out, joint })
    }

    /// One row.
    pub fn write(&mut self, moment: &Moment) -> io::Result<()> {
        let joint = self.joint;
        write!(self.out, "{:?},{:?},{:?}", moment.time, moment.drive, moment.load)?;
        let rest = [
            moment.motor_angle(joint),
            moment.link_angle(),
            moment.twist(joint),
            moment.carrier_speed,
            moment.mesh_periods,
            moment.gap,
            moment.gap_rate,
            moment.wind_up,
            moment.wind_up_rate,
        ];
        for value in rest {
            write!(self.out, ",{value:?}")?;
        }
        for teeth in &moment.teeth {
            write!(self.out, ",{:?},{:?},{:?},{}", teeth.deflection, teeth.rate, teeth.force, code(teeth.contact))?;
        }
        writeln!(self.out)
    }

    /// Nothing more comes.
    pub fn finish(mut self) -> io::Result<W> {
        self.out.flush()?;
        Ok(self.out)
    }
}
