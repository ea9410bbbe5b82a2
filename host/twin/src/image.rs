//! Joint of a firmware image in role `drive`: the fixed step and the drive in f32 with the tables of a board's chip, so
//! that image and twin give the same frames.

use std::f64::consts::TAU;

use board::device::board::Board;
use drives::Drive;
use drives::drive::VirtualPower;
use live::Sample;
use model_core::virtual_joint::{VirtualJoint, VirtualJointDesign};
use report::failure::{Failure, Outcome};
use scenario::case::Case;

/// Tables of a joint, as its image has them.
pub struct ImageTables(Box<dyn Designed>);

/// Joint in motion.
pub type ImageJoint<'t> = Box<dyn Moving + 't>;

/// Tables for any number of planets.
trait Designed {
    fn start(&self) -> ImageJoint<'_>;
}

/// Joint in motion with any number of planets.
pub trait Moving {
    /// Runs one control period.
    fn step(&mut self, drive: &mut Drive, power: &mut VirtualPower);
    /// Time since the start [s].
    fn time(&self) -> f64;
    /// Control period [s].
    fn period(&self) -> f64;
    /// True state. The step has no force of a single mesh.
    fn truth(&self) -> Sample;
}

struct TablesOf<const N: usize> {
    design: VirtualJointDesign<N>,
    half_backlash: f64,
    /// Lever of the mesh forces on the sun [m].
    sun_radius: f64,
}

struct MovingJoint<'t, const N: usize> {
    tables: &'t TablesOf<N>,
    joint: VirtualJoint<'t, f32, N>,
    periods: u64,
}

impl ImageTables {
    /// Designs the tables of a true joint for the chip of a board, at the control rate of its surroundings.
    pub fn new(case: &Case, board: &Board) -> Outcome<Self> {
        let designed = match case.truth.parameters.geometry.planets {
            1 => design::<1>(case, board),
            3 => design::<3>(case, board),
            4 => design::<4>(case, board),
            _ => design::<5>(case, board),
        };
        designed.map(Self)
    }

    /// Joint at rest.
    pub fn start(&self) -> ImageJoint<'_> {
        self.0.start()
    }
}

fn design<const N: usize>(case: &Case, board: &Board) -> Outcome<Box<dyn Designed>> {
    let joint = &case.truth.parameters;
    let refused = |error: &dyn std::fmt::Display| {
        Failure::new(format!("joint `{}` cannot be simulated on {}: {error}", joint.name, board.name()))
            .with_help("`joint twin` without --image has other models of the joint")
    };
    let design = virtual_drive::joint_tables(joint, &case.truth.surroundings, &board.processor())
        .map_err(|error| refused(&error))?;
    let (half_backlash, sun_radius) = (case.half_backlash(), joint.geometry.sun_base_radius);
    Ok(Box::new(TablesOf::<N> { design, half_backlash, sun_radius }))
}

impl<const N: usize> Designed for TablesOf<N> {
    fn start(&self) -> ImageJoint<'_> {
        let joint = self.design.joint();
        Box::new(MovingJoint { tables: self, joint, periods: 0 })
    }
}

impl<const N: usize> Moving for MovingJoint<'_, N> {
    fn step(&mut self, drive: &mut Drive, power: &mut VirtualPower) {
        virtual_drive::step(&mut self.joint, drive, power);
        self.periods += 1;
    }

    fn time(&self) -> f64 {
        self.periods as f64 * self.period()
    }

    fn period(&self) -> f64 {
        1.0 / f64::from(self.tables.design.gears.tick_rate)
    }

    fn truth(&self) -> Sample {
        let (outputs, acting) = (self.joint.outputs(), self.joint.acting());
        let carrier = f64::from(outputs.carrier_turns) + f64::from(outputs.carrier_fraction) / f64::powi(2.0, 32);
        let mut sample = Sample {
            link: TAU * carrier + f64::from(outputs.link_offset),
            link_speed: f64::from(self.joint.link_speed()),
            motor: f64::from(self.tables.design.surroundings.gear) * TAU * carrier + f64::from(outputs.motor_offset),
            gap: f64::from(outputs.gap),
            half_backlash: self.tables.half_backlash,
            mesh_force: f64::from(self.joint.mesh_torque()) / self.tables.sun_radius,
            load_torque: f64::from(acting.load),
            motor_torque: f64::from(acting.air_gap),
            ..Sample::at(self.time())
        };
        for contact in outputs.contacts.as_flattened() {
            sample.meshes.add(*contact, f64::NAN);
        }
        sample
    }
}
