//! The plant: the gears with motor, current loop, frictions, weight and encoders around them, for a controller to be tried
//! on.

use model_core::gears::Tables;
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use table_blob::Gears;

use crate::compensation::finite;
use crate::estimates::{JointContact, JointSamples};
use crate::fp_mode;
use crate::object::{Kind, look, open, place, start};
use crate::status::JointStatus;

/// 64-bit words of a plant.
pub const JOINT_PLANT_WORDS: usize = 80;
/// Most planets of a plant.
pub const JOINT_MOST_PLANETS: usize = 5;

/// Storage of a plant. Its content is the library's own.
#[repr(C)]
pub struct JointPlant {
    storage: [u64; JOINT_PLANT_WORDS],
}

/// A joint by its number of planets.
enum Plant {
    One(VirtualJoint<'static, f32, 1>),
    Three(VirtualJoint<'static, f32, 3>),
    Four(VirtualJoint<'static, f32, 4>),
    Five(VirtualJoint<'static, f32, 5>),
}

impl Kind for Plant {
    type Storage = JointPlant;
    const MARK: u32 = 0x91a2_7000;
}

/// Does the same with a joint of any number of planets.
macro_rules! each {
    ($plant:expr, $joint:ident => $work:expr) => {
        match $plant {
            Plant::One($joint) => $work,
            Plant::Three($joint) => $work,
            Plant::Four($joint) => $work,
            Plant::Five($joint) => $work,
        }
    };
}

/// The motion of a plant, which no sensor sees: for judging what a controller makes of it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointPlantOutputs {
    /// Whole turns of the rigid-body carrier angle.
    pub carrier_turns: i32,
    /// The rest of it, in 2^-32 turns.
    pub carrier_fraction: u32,
    /// Rate of that angle.
    pub carrier_speed_rad_per_s: f32,
    /// Motor angle less ratio times that angle.
    pub motor_offset_rad: f32,
    /// Link angle less that angle.
    pub link_offset_rad: f32,
    /// Gap coordinate along the line of action.
    pub gap_m: f32,
    /// Wind-up between carrier and link along the line of action.
    pub wind_up_m: f32,
    /// Torque in the motor's air gap.
    pub air_gap_torque_Nm: f32,
    /// Torque on the sun, friction and cogging included.
    pub drive_torque_Nm: f32,
    /// What brakes the link: friction, weight, disturbance.
    pub load_torque_Nm: f32,
    /// Planets; what follows has so many entries in use.
    pub planets: u32,
    /// Deflections of the sun's meshes, planet by planet.
    pub sun_deflections_m: [f32; JOINT_MOST_PLANETS],
    /// Deflections of the ring's.
    pub ring_deflections_m: [f32; JOINT_MOST_PLANETS],
    /// Contacts of the sun's meshes.
    pub sun_contacts: [JointContact; JOINT_MOST_PLANETS],
    /// Contacts of the ring's.
    pub ring_contacts: [JointContact; JOINT_MOST_PLANETS],
}

fn outputs<const N: usize>(joint: &VirtualJoint<'static, f32, N>) -> JointPlantOutputs {
    let (of, acting) = (joint.outputs(), joint.acting());
    let [sun, ring] = of.deflections.map(|values| {
        let mut all = [0.0; JOINT_MOST_PLANETS];
        all.iter_mut().zip(values).for_each(|(place, value)| *place = value);
        all
    });
    let [sun_contacts, ring_contacts] = of.contacts.map(|values| {
        let mut all = [JointContact::Separated; JOINT_MOST_PLANETS];
        all.iter_mut().zip(values).for_each(|(place, value)| *place = value.into());
        all
    });
    JointPlantOutputs {
        carrier_turns: of.carrier_turns,
        carrier_fraction: of.carrier_fraction,
        carrier_speed_rad_per_s: of.carrier_speed,
        motor_offset_rad: of.motor_offset,
        link_offset_rad: of.link_offset,
        gap_m: of.gap,
        wind_up_m: of.wind_up,
        air_gap_torque_Nm: acting.air_gap,
        drive_torque_Nm: acting.drive,
        load_torque_Nm: acting.load,
        planets: N as u32,
        sun_deflections_m: sun,
        ring_deflections_m: ring,
        sun_contacts,
        ring_contacts,
    }
}

/// Starts a plant, at rest. `bytes` is sizeof(JointPlant). The tables must stay as they are for as long as it is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_plant_start(
    plant: *mut JointPlant,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
) -> JointStatus {
    fn new<const N: usize>(
        (gears, around): (&'static Tables<f32, N>, &'static SurroundingsTable<f32>),
    ) -> VirtualJoint<'static, f32, N> {
        VirtualJoint::new(gears, around)
    }
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        unsafe {
            start(plant, bytes, tables, tables_bytes, |blob| {
                let (gears, around) = blob.plant()?;
                Ok(match gears {
                    Gears::One(gears) => Plant::One(new((gears, around))),
                    Gears::Three(gears) => Plant::Three(new((gears, around))),
                    Gears::Four(gears) => Plant::Four(new((gears, around))),
                    Gears::Five(gears) => Plant::Five(new((gears, around))),
                })
            })
        }
    })
    .into()
}

/// Moves on by one control period under a torque command for the motor and a torque that brakes the link.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_plant_step(
    plant: *mut JointPlant,
    motor_torque_Nm: f32,
    load_torque_Nm: f32,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { open::<Plant>(plant) }?;
        finite([motor_torque_Nm, load_torque_Nm])?;
        each!(&mut object.value, joint => joint.advance(motor_torque_Nm, load_torque_Nm));
        Ok(())
    })
    .into()
}

/// What the encoders read now, and the torque that was commanded last.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_plant_samples(plant: *const JointPlant, samples: *mut JointSamples) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { look::<Plant>(plant) }?;
        place(samples, plant)?;
        let found = each!(&object.value, joint => joint.samples());
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { samples.write(JointSamples::new(&found)) };
        Ok(())
    })
    .into()
}

/// The motion now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_plant_outputs(plant: *const JointPlant, motion: *mut JointPlantOutputs) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { look::<Plant>(plant) }?;
        place(motion, plant)?;
        let found = each!(&object.value, joint => outputs(joint));
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { motion.write(found) };
        Ok(())
    })
    .into()
}

/// Digest of every bit of the gears' state: two runs of which it is the same have gone the same way so far.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_plant_digest(plant: *const JointPlant, digest: *mut u64) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { look::<Plant>(plant) }?;
        place(digest, plant)?;
        let found = each!(&object.value, joint => joint.model().state_digest());
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { digest.write(found) };
        Ok(())
    })
    .into()
}
