//! Variables of an FMU: names, units, descriptions. A value reference is a variable's place in the list; the C sources get
//! the list as `description.h`, the importer as modelDescription.xml.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Real number with its unit.
    Real(Unit),
    /// Whole number.
    Integer,
    /// Truth value.
    Boolean,
}

/// Role of a variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// Time of the simulation.
    Independent,
    /// Input with its start value.
    Input(f64),
    /// Output.
    Output,
}

/// Unit: its name, and its exponents of kg, m, s, rad.
pub type Unit = (&'static str, [i8; 4]);

/// One [1].
pub const ONE: Unit = ("1", [0, 0, 0, 0]);
const S: Unit = ("s", [0, 0, 1, 0]);
const M: Unit = ("m", [0, 1, 0, 0]);
const M2: Unit = ("m2", [0, 2, 0, 0]);
const M_PER_S: Unit = ("m/s", [0, 1, -1, 0]);
const RAD: Unit = ("rad", [0, 0, 0, 1]);
const RAD_PER_S: Unit = ("rad/s", [0, 0, -1, 1]);
const RAD_PER_S2: Unit = ("rad/s2", [0, 0, -2, 1]);
const N: Unit = ("N", [1, 1, -2, 0]);
const NM: Unit = ("N.m", [1, 2, -2, 0]);
const N2M2: Unit = ("N2.m2", [2, 4, -4, 0]);
const NM_PER_RAD: Unit = ("N.m/rad", [1, 2, -2, -1]);
const NMS_PER_RAD: Unit = ("N.m.s/rad", [1, 2, -1, -1]);

/// Variable of an FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name, unique in the FMU; `[1]` and so on for a planet.
    pub name: String,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub role: Role,
    /// Description.
    pub description: String,
}

/// Turns of a set-point on either side of zero: the core counts whole turns in 32 bits.
const MAX_TURNS: f64 = 2_147_483_647.0;

impl Variable {
    /// Numbers that an input accepts; the core computes in 32 bits.
    pub fn range(&self) -> RangeInclusive<f64> {
        let largest = f64::from(f32::MAX);
        match self.kind {
            Kind::Real(RAD) => -MAX_TURNS * TAU..=MAX_TURNS * TAU,
            Kind::Real(_) => -largest..=largest,
            Kind::Integer => 0.0..=f64::from(i32::MAX),
            Kind::Boolean => 0.0..=1.0,
        }
    }
}

fn variable(name: impl Into<String>, kind: Kind, role: Role, description: impl Into<String>) -> Variable {
    Variable { name: name.into(), kind, role, description: description.into() }
}

fn time() -> Variable {
    variable("time", Kind::Real(S), Role::Independent, "Time of the simulation")
}

/// Contacts as numbers.
const SIDES: &str = "1 drive side, -1 back side, 0 in the gap";

/// Variables of the plant.
pub fn of_plant(planets: usize) -> Vec<Variable> {
    let input = |name, unit, text: &str| variable(name, Kind::Real(unit), Role::Input(0.0), text);
    let output = |name, unit, text: &str| variable(name, Kind::Real(unit), Role::Output, text);
    let count = |name, text: &str| variable(name, Kind::Integer, Role::Output, text);
    let mut all = vec![
        time(),
        input("motor_torque", NM, "Torque command to the motor, at its shaft; rounded to 32 bits"),
        input("external_torque", NM, "Torque that brakes the link from outside; rounded to 32 bits"),
        output("motor_angle", RAD, "Angle of the motor's shaft, all turns"),
        output("link_angle", RAD, "Angle of the link, all turns"),
        output("motor_speed", RAD_PER_S, "Speed of the motor's shaft"),
        output("link_speed", RAD_PER_S, "Speed of the link"),
        output("carrier_speed", RAD_PER_S, "Speed of the carrier's rigid-body motion"),
        output("gap", M, "Gap coordinate along the line of action"),
        output("wind_up", M, "Wind-up between carrier and link along the line of action"),
        output("air_gap_torque", NM, "Torque in the motor's air gap, mean of the last control period"),
        output("drive_torque", NM, "Torque on the sun, friction and cogging included, in the last control period"),
        output("braking_torque", NM, "Torque that brakes the link: friction, weight, external_torque"),
        count("motor_counts", "Reading of the motor encoder"),
        count("motor_age", "Age of the reading motor_counts, in ticks of the encoders' clock"),
        variable("output_valid", Kind::Boolean, Role::Output, "True if the output encoder has a reading"),
        count("output_counts", "Reading of the output encoder"),
        count("output_age", "Age of the reading output_counts, in ticks of the encoders' clock"),
    ];
    for (name, mesh) in [("sun", "sun and planet"), ("ring", "planet and ring")] {
        let force = |planet| {
            let text =
                format!("Force between {mesh} {planet} by the mean stiffness of the mesh, without damping and ripple");
            variable(format!("{name}_force[{planet}]"), Kind::Real(N), Role::Output, text)
        };
        let contact = |planet| {
            let text = format!("Contact between {mesh} {planet}: {SIDES}");
            variable(format!("{name}_contact[{planet}]"), Kind::Integer, Role::Output, text)
        };
        all.extend((1..=planets).map(force));
        all.extend((1..=planets).map(contact));
    }
    all
}

/// Variables of observer and compensation, whose motion ahead is a time `lead` [s] after now.
pub fn of_controller(lead: f32) -> Vec<Variable> {
    let input = |name, unit, text: &str| variable(name, Kind::Real(unit), Role::Input(0.0), text);
    let output = |name, unit, text: &str| variable(name, Kind::Real(unit), Role::Output, text);
    let count = |name, text: &str| variable(name, Kind::Integer, Role::Input(0.0), text);
    let code = |name, text: &str| variable(name, Kind::Integer, Role::Output, text);
    let flag = |name, start, text: &str| variable(name, Kind::Boolean, Role::Input(start), text);
    let ahead = |what: &str| format!("{what} {:.6} s ahead; used in position control if ahead_valid", lead);
    let mut all = vec![
        time(),
        count("motor_counts", "Reading of the motor encoder at the begin of the communication step"),
        count("motor_age", "Age of the reading motor_counts, in ticks of the encoders' clock"),
        flag("output_valid", 1.0, "True if the output encoder has a reading"),
        count("output_counts", "Reading of the output encoder at the begin of the communication step"),
        count("output_age", "Age of the reading output_counts, in ticks of the encoders' clock"),
        input(
            "target_angle",
            RAD,
            "Angle that the link is to have, all turns; in impedance control the spring's angle at rest",
        ),
        input("target_speed", RAD_PER_S, "Speed of target_angle"),
        input("target_acceleration", RAD_PER_S2, "Acceleration of target_angle; not used in impedance control"),
        input("ahead_angle", RAD, &ahead("target_angle")),
        input("ahead_speed", RAD_PER_S, &ahead("target_speed")),
        input("ahead_acceleration", RAD_PER_S2, &ahead("target_acceleration")),
        flag("ahead_valid", 0.0, "True if the motion ahead is known"),
        flag(
            "impedance",
            0.0,
            "True for impedance control: a spring and a damper at the link; false for position control",
        ),
        input("stiffness", NM_PER_RAD, "Stiffness of impedance control, at the link"),
        input("damping", NMS_PER_RAD, "Damping of impedance control, at the link"),
        input("link_torque", NM, "Torque at the link on top of spring and damper"),
        output("motor_torque", NM, "Torque to command to the motor, at its shaft"),
        output("trust", ONE, "Share of the compensation in motor_torque, from 0 to 1"),
        code("stage", "Stage: 0 touching, 1 crossing, 2 landing, 3 plain control, 4 off, 5 reversed sign found"),
        output("demand", NM, "Torque that the teeth must transmit after a crossing that began now"),
    ];
    for (name, unit, square, text) in [
        ("estimated_gap", M, M2, "Gap coordinate along the line of action"),
        ("estimated_half_backlash", M, M2, "Half-backlash of each mesh"),
        ("estimated_load_torque", NM, N2M2, "Torque that brakes the link"),
        ("estimated_mesh_torque", NM, N2M2, "Torque that the meshes transmit, at the carrier"),
    ] {
        all.push(variable(name, Kind::Real(unit), Role::Output, format!("{text}, estimated")));
        all.push(variable(format!("{name}_variance"), Kind::Real(square), Role::Output, format!("Variance of {name}")));
        let valid = format!("True if {name} may be used");
        all.push(variable(format!("{name}_valid"), Kind::Boolean, Role::Output, valid));
    }
    all.extend([
        output("estimated_gap_rate", M_PER_S, "Rate of the gap coordinate, estimated"),
        code("estimated_contact", &format!("Flank that carries, estimated: {SIDES} or unknown")),
        variable("estimated_contact_valid", Kind::Boolean, Role::Output, "True if estimated_contact may be used"),
        output("estimated_motor_angle", RAD, "Angle of the motor's shaft, all turns since the start, estimated"),
        output("estimated_motor_speed", RAD_PER_S, "Speed of the motor's shaft, estimated"),
        output("estimated_link_angle", RAD, "Angle of the link, all turns since the start, estimated"),
        output("estimated_link_speed", RAD_PER_S, "Speed of the link, estimated"),
        code("source", "Encoders in use: 0 none, 1 motor, 2 both"),
        code("motor_fault", "Reason for which the motor encoder is not used: JointFault of joint.h; 0 none"),
        code("output_fault", "Reason for which the output encoder is not used: JointFault of joint.h; 0 none"),
        code("notices", "Defects of the readings: sum of the JOINT_NOTICE_ bits of joint.h"),
    ]);
    all
}
