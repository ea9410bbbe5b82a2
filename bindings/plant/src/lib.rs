#![no_std]
//! A plant of any number of planets behind one type. It is a crate of its own because it is compiled for speed, as it is in
//! the firmware's images, while `bindings/c` around it is compiled for size: nothing in here is generic for a caller.

use core::mem::MaybeUninit;

use model_core::gears::Tables;
use model_core::observer::Samples;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use parameters::ContactState;
use table_blob::{Blob, BlobError, Gears};

/// Most planets.
pub const MOST_PLANETS: usize = 5;

/// A joint by its number of planets.
#[derive(Debug)]
pub struct Plant<'t>(Joint<'t>);

#[derive(Debug)]
enum Joint<'t> {
    One(VirtualJoint<'t, f32, 1>),
    Three(VirtualJoint<'t, f32, 3>),
    Four(VirtualJoint<'t, f32, 4>),
    Five(VirtualJoint<'t, f32, 5>),
}

/// The motion now, in SI; entries beyond the planets are zero.
#[derive(Debug, Clone, Copy, Default)]
pub struct Motion {
    /// Whole turns of the rigid-body carrier angle, and the rest in 2^-32 turns.
    pub carrier: (i32, u32),
    /// Its rate [rad/s].
    pub carrier_speed: f32,
    /// Of motor and link beyond it [rad].
    pub offsets: [f32; 2],
    /// Gap coordinate and wind-up [m].
    pub gap_and_wind_up: [f32; 2],
    /// In the air gap, on the sun, on the link [N m].
    pub torques: [f32; 3],
    /// Planets.
    pub planets: u32,
    /// Deflections, sun's meshes and ring's [m].
    pub deflections: [[f32; MOST_PLANETS]; 2],
    /// Contacts likewise.
    pub contacts: [[ContactState; MOST_PLANETS]; 2],
}

/// Does the same with a joint of any number of planets.
macro_rules! each {
    ($plant:expr, $joint:ident => $work:expr) => {
        match $plant {
            Joint::One($joint) => $work,
            Joint::Three($joint) => $work,
            Joint::Four($joint) => $work,
            Joint::Five($joint) => $work,
        }
    };
}

impl<'t> Plant<'t> {
    /// Builds a plant at rest in its place, which is not written to if the tables have no plant.
    #[inline(never)]
    pub fn new_in(place: &mut MaybeUninit<Self>, blob: &Blob<'t>) -> Result<(), BlobError> {
        let (gears, around) = blob.plant()?;
        match gears {
            Gears::One(gears) => Self::put(place, gears, around, Joint::One),
            Gears::Three(gears) => Self::put(place, gears, around, Joint::Three),
            Gears::Four(gears) => Self::put(place, gears, around, Joint::Four),
            Gears::Five(gears) => Self::put(place, gears, around, Joint::Five),
        }
        Ok(())
    }

    /// A function of its own for each number of planets: together, their joints would lie side by side on the stack.
    #[inline(never)]
    fn put<const N: usize>(
        place: &mut MaybeUninit<Self>,
        gears: &'t Tables<f32, N>,
        around: &'t SurroundingsTable<f32>,
        kind: impl FnOnce(VirtualJoint<'t, f32, N>) -> Joint<'t>,
    ) {
        place.write(Self(kind(VirtualJoint::new(gears, around))));
    }

    /// Moves on by one control period under a torque command and a torque that brakes the link [N m].
    #[inline(never)]
    pub fn advance(&mut self, command: f32, disturbance: f32) {
        each!(&mut self.0, joint => joint.advance(command, disturbance));
    }

    /// Measurements now.
    #[inline(never)]
    pub fn samples(&self) -> Samples<f32> {
        each!(&self.0, joint => joint.samples())
    }

    /// Digest of every bit of the gears' state.
    #[inline(never)]
    pub fn digest(&self) -> u64 {
        each!(&self.0, joint => joint.model().state_digest())
    }

    /// The motion now.
    #[inline(never)]
    pub fn motion(&self) -> Motion {
        each!(&self.0, joint => motion(joint))
    }
}

fn motion<const N: usize>(joint: &VirtualJoint<'_, f32, N>) -> Motion {
    let (of, acting) = (joint.outputs(), joint.acting());
    let mut motion = Motion {
        carrier: (of.carrier_turns, of.carrier_fraction),
        carrier_speed: of.carrier_speed,
        offsets: [of.motor_offset, of.link_offset],
        gap_and_wind_up: [of.gap, of.wind_up],
        torques: [acting.air_gap, acting.drive, acting.load],
        planets: N as u32,
        ..Motion::default()
    };
    let kinds = motion.deflections.iter_mut().zip(&mut motion.contacts);
    for ((deflections, contacts), kind) in kinds.zip(of.deflections.iter().zip(&of.contacts)) {
        deflections.iter_mut().zip(kind.0).for_each(|(place, value)| *place = *value);
        contacts.iter_mut().zip(kind.1).for_each(|(place, value)| *place = *value);
    }
    motion
}
