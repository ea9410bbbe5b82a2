#![no_std]
//! Plant of any number of planets behind one type. It is a separate crate because it is compiled for speed, as in the
//! firmware's images, while `bindings/c` is compiled for size: nothing in here is generic for a caller.

use core::mem::MaybeUninit;

use model_core::gears::Tables;
use model_core::numbers::state_words::{Layout, Reader, StateWords, Writer};
use model_core::observer::Samples;
use model_core::virtual_joint::{DrivenLink, SurroundingsTable, VirtualJoint, VirtualJointState};
use parameters::ContactState;
use table_blob::{Blob, BlobError, Gears};

/// Maximum number of planets.
pub const MOST_PLANETS: usize = 5;
/// Layout of the state of a plant with the most planets; others use its first words.
pub const STATE_LAYOUT: Layout = VirtualJointState::<f32, MOST_PLANETS>::LAYOUT;

/// Plant of a joint with any supported number of planets.
#[derive(Debug)]
pub struct Plant<'t>(Joint<'t>);

#[derive(Debug)]
enum Joint<'t> {
    One(VirtualJoint<'t, f32, 1>),
    Three(VirtualJoint<'t, f32, 3>),
    Four(VirtualJoint<'t, f32, 4>),
    Five(VirtualJoint<'t, f32, 5>),
}

/// Present motion, in SI; entries beyond the number of planets are zero.
#[derive(Debug, Clone, Copy, Default)]
pub struct Motion {
    /// Rigid-body carrier angle: whole turns, and the rest in 2^-32 turns.
    pub carrier: (i32, u32),
    /// Rate of the rigid-body carrier angle [rad/s].
    pub carrier_speed: f32,
    /// Offsets of motor and link from the rigid-body motion [rad].
    pub offsets: [f32; 2],
    /// Gap coordinate and wind-up [m].
    pub gap_and_wind_up: [f32; 2],
    /// Torques in the air gap, on the sun and on the link [N m].
    pub torques: [f32; 3],
    /// Number of planets.
    pub planets: u32,
    /// Deflections of the sun's and the ring's meshes [m].
    pub deflections: [[f32; MOST_PLANETS]; 2],
    /// Contacts of the sun's and the ring's meshes.
    pub contacts: [[ContactState; MOST_PLANETS]; 2],
}

/// Evaluates an expression for a joint of any number of planets.
macro_rules! for_each_joint {
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
    /// Plant at rest; fails if the tables have no plant. `#[inline]` compiles it only for callers, of which the C library
    /// has none: with two users of the joints' constructor, `new_in` would hold each joint on the stack twice.
    #[inline]
    pub fn new(blob: &Blob<'t>) -> Result<Self, BlobError> {
        let (gears, around) = blob.plant()?;
        Ok(Self(match gears {
            Gears::One(gears) => Joint::One(VirtualJoint::new(gears, around)),
            Gears::Three(gears) => Joint::Three(VirtualJoint::new(gears, around)),
            Gears::Four(gears) => Joint::Four(VirtualJoint::new(gears, around)),
            Gears::Five(gears) => Joint::Five(VirtualJoint::new(gears, around)),
        }))
    }

    /// Builds a plant at rest in its final place; nothing is written if the tables have no plant.
    #[inline(never)]
    pub fn new_in(place: &mut MaybeUninit<Self>, blob: &Blob<'t>) -> Result<(), BlobError> {
        let (gears, around) = blob.plant()?;
        match gears {
            Gears::One(gears) => Self::write_joint(place, gears, around, Joint::One),
            Gears::Three(gears) => Self::write_joint(place, gears, around, Joint::Three),
            Gears::Four(gears) => Self::write_joint(place, gears, around, Joint::Four),
            Gears::Five(gears) => Self::write_joint(place, gears, around, Joint::Five),
        }
        Ok(())
    }

    /// Separate function for each number of planets: inlined, their joints would lie side by side on the stack.
    #[inline(never)]
    fn write_joint<const N: usize>(
        place: &mut MaybeUninit<Self>,
        gears: &'t Tables<f32, N>,
        around: &'t SurroundingsTable<f32>,
        kind: impl FnOnce(VirtualJoint<'t, f32, N>) -> Joint<'t>,
    ) {
        place.write(Self(kind(VirtualJoint::new(gears, around))));
    }

    /// Advances by one control period under a torque command and a torque that brakes the link [N m].
    #[inline(never)]
    pub fn advance(&mut self, command: f32, disturbance: f32) {
        for_each_joint!(&mut self.0, joint => joint.advance(command, disturbance));
    }

    /// Advances by one control period with a link that another simulator moves, and returns the mean torque of the gears on
    /// the link [N m].
    #[inline(never)]
    pub fn advance_with_link(&mut self, command: f32, link: DrivenLink<f32>) -> f32 {
        for_each_joint!(&mut self.0, joint => joint.advance_with_link(command, link))
    }

    /// Turns the whole joint by an angle at the link [turns] and changes its speed [rad/s]; deformations stay.
    #[inline(never)]
    pub fn shift(&mut self, turns: i32, fraction: f32, speed: f32) {
        for_each_joint!(&mut self.0, joint => joint.shift(turns, fraction, speed));
    }

    /// Writes the state. A plant of the same tables that reads the words continues with equal bits, and so does this plant
    /// once it has read them.
    #[inline(never)]
    pub fn write_state(&self, to: &mut Writer) {
        for_each_joint!(&self.0, joint => joint.state().write(to));
    }

    /// Replaces the state by one of a plant of the same tables.
    #[inline(never)]
    pub fn read_state(&mut self, from: &mut Reader) {
        for_each_joint!(&mut self.0, joint => joint.set_state(&VirtualJointState::read(from)));
    }

    /// Speeds of motor and link [rad/s].
    pub fn speeds(&self) -> [f32; 2] {
        for_each_joint!(&self.0, joint => [joint.motor_speed(), joint.link_speed()])
    }

    /// Present measurements.
    #[inline(never)]
    pub fn samples(&self) -> Samples<f32> {
        for_each_joint!(&self.0, joint => joint.samples())
    }

    /// Digest of every bit of the gears' state.
    #[inline(never)]
    pub fn digest(&self) -> u64 {
        for_each_joint!(&self.0, joint => joint.model().state_digest())
    }

    /// Present motion.
    #[inline(never)]
    pub fn motion(&self) -> Motion {
        for_each_joint!(&self.0, joint => motion(joint))
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

#[cfg(test)]
mod tests {
    use super::*;
    use model_core::VirtualJointDesign;

    #[test]
    fn read_state_continues_with_equal_bits() {
        let q1 = joint_file::read(joint_file::preset("q1").unwrap()).unwrap();
        let design = VirtualJointDesign::<3>::new(&q1, 10_000).unwrap();
        let [mut one, mut other] = [(); 2].map(|()| Plant(Joint::Three(design.joint())));
        for period in 0..2_000 {
            let link = DrivenLink { inverse_inertia: 2.0, acceleration: 0.3 };
            one.advance_with_link((0.01 * period as f32).cos(), link);
        }
        let words_of = |plant: &Plant<'_>| {
            let mut words = [0; STATE_LAYOUT.words];
            plant.write_state(&mut Writer::new(&mut words));
            words
        };
        let words = words_of(&one);
        for plant in [&mut one, &mut other] {
            plant.read_state(&mut Reader::new(&words));
            assert_eq!(words_of(plant), words);
            (0..500).for_each(|_| plant.advance(0.4, 0.1));
        }
        assert_eq!(words_of(&one), words_of(&other));
        assert_eq!(one.samples(), other.samples());
    }
}
