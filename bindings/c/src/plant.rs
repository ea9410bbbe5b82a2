//! Plant: the gears with motor, current loop, frictions, weight and encoders, for testing a controller.

use core::mem::MaybeUninit;

use c_plant::{MOST_PLANETS, Motion, Plant, STATE_LAYOUT};
use model_core::numbers::state_words::{Reader, Writer};
use model_core::virtual_joint::DrivenLink;
use table_blob::Blob;

use crate::estimates::{JointContact, JointSamples};
use crate::object::{Kind, Storage, open, open_shared, start, usable};
use crate::state::{HEAD, Identity, load, save};
use crate::status::JointStatus;

/// 64-bit words of a plant.
pub const JOINT_PLANT_WORDS: usize = 80;
/// Maximum number of planets of a plant.
pub const JOINT_MOST_PLANETS: usize = 5;
const _: () = assert!(JOINT_MOST_PLANETS == MOST_PLANETS);
/// 32-bit words of a plant's saved state.
pub const JOINT_PLANT_STATE_WORDS: usize = 39;
const _: () = assert!(JOINT_PLANT_STATE_WORDS == HEAD + STATE_LAYOUT.words);

/// Storage of a plant. Its content is the library's own.
#[repr(C)]
pub struct JointPlant {
    storage: [u64; JOINT_PLANT_WORDS],
}

impl Kind for Plant<'static> {
    type Storage = JointPlant;
    const MARK: u32 = 0x9191_9191;
}

/// What a plant's state must agree with; the tables have the number of planets.
fn identity(tables: u64) -> Identity {
    Identity { kind: Plant::MARK, layout: STATE_LAYOUT, tables }
}

/// True motion of a plant, which no sensor measures: for evaluating a controller.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointPlantOutputs {
    /// Whole turns of the rigid-body carrier angle.
    pub carrier_turns: i32,
    /// Fraction of the turn of that angle, in 2^-32 turns.
    pub carrier_fraction: u32,
    /// Rate of the rigid-body carrier angle.
    pub carrier_speed_rad_per_s: f32,
    /// Motor angle less ratio times the rigid-body carrier angle.
    pub motor_offset_rad: f32,
    /// Link angle less the rigid-body carrier angle.
    pub link_offset_rad: f32,
    /// Gap coordinate along the line of action.
    pub gap_m: f32,
    /// Wind-up between carrier and link along the line of action.
    pub wind_up_m: f32,
    /// Torque in the motor's air gap.
    pub air_gap_torque_Nm: f32,
    /// Torque on the sun, friction and cogging included.
    pub drive_torque_Nm: f32,
    /// Torque that brakes the link: friction, weight, disturbance.
    pub load_torque_Nm: f32,
    /// Number of planets; the arrays below have this many entries in use.
    pub planets: u32,
    /// Deflections of the sun's meshes, planet by planet.
    pub sun_deflections_m: [f32; JOINT_MOST_PLANETS],
    /// Deflections of the ring's meshes, planet by planet.
    pub ring_deflections_m: [f32; JOINT_MOST_PLANETS],
    /// Contacts of the sun's meshes.
    pub sun_contacts: [JointContact; JOINT_MOST_PLANETS],
    /// Contacts of the ring's meshes.
    pub ring_contacts: [JointContact; JOINT_MOST_PLANETS],
}

fn outputs(of: &Motion) -> JointPlantOutputs {
    let ([sun_deflections_m, ring_deflections_m], [sun, ring]) = (of.deflections, of.contacts);
    JointPlantOutputs {
        carrier_turns: of.carrier.0,
        carrier_fraction: of.carrier.1,
        carrier_speed_rad_per_s: of.carrier_speed,
        motor_offset_rad: of.offsets[0],
        link_offset_rad: of.offsets[1],
        gap_m: of.gap_and_wind_up[0],
        wind_up_m: of.gap_and_wind_up[1],
        air_gap_torque_Nm: of.torques[0],
        drive_torque_Nm: of.torques[1],
        load_torque_Nm: of.torques[2],
        planets: of.planets,
        sun_deflections_m,
        ring_deflections_m,
        sun_contacts: sun.map(JointContact::from),
        ring_contacts: ring.map(JointContact::from),
    }
}

/// Starts a plant, as joint_plant_start; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_start_checked(
    plant: *mut JointPlant,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: plant, bytes, abi };
    let make = |blob: &Blob<'static>, place: &mut MaybeUninit<Plant<'static>>| Ok(Plant::new_in(place, blob)?);
    // SAFETY: the caller's promise, as required by the header.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, make) }).into()
}

/// Advances by one control period under a torque command for the motor and a torque that brakes the link.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_step(
    plant: *mut JointPlant,
    motor_torque_Nm: f32,
    load_torque_Nm: f32,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Plant<'static>>(plant) }?;
        if !(motor_torque_Nm.is_finite() && load_torque_Nm.is_finite()) {
            return Err(JointStatus::NotFinite);
        }
        object.value.advance(motor_torque_Nm, load_torque_Nm);
        Ok(())
    })
    .into()
}

/// Advances by one control period with a link that another simulator moves. Its acceleration is the torque of the gears
/// times `link_inverse_inertia_per_kg_m2`, plus `link_acceleration_rad_per_s2`. `link_torque_Nm` receives the mean torque of
/// the gears on the link. Inertia, weight and friction of the link are the other simulator's; the tables' have no effect.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_step_with_link(
    plant: *mut JointPlant,
    motor_torque_Nm: f32,
    link_inverse_inertia_per_kg_m2: f32,
    link_acceleration_rad_per_s2: f32,
    link_torque_Nm: *mut f32,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Plant<'static>>(plant) }?;
        usable(link_torque_Nm)?;
        let link =
            DrivenLink { inverse_inertia: link_inverse_inertia_per_kg_m2, acceleration: link_acceleration_rad_per_s2 };
        if ![motor_torque_Nm, link.inverse_inertia, link.acceleration].iter().all(|value| value.is_finite()) {
            return Err(JointStatus::NotFinite);
        }
        let torque = object.value.advance_with_link(motor_torque_Nm, link);
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { link_torque_Nm.write(torque) };
        Ok(())
    })
    .into()
}

/// Turns the whole plant by an angle at the link, whole turns and a fraction, and changes the link's speed; the teeth keep
/// their deformations.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_shift(
    plant: *mut JointPlant,
    turns: i32,
    fraction_turns: f32,
    speed_rad_per_s: f32,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Plant<'static>>(plant) }?;
        if !(fraction_turns.is_finite() && speed_rad_per_s.is_finite()) {
            return Err(JointStatus::NotFinite);
        }
        if fraction_turns.abs() > 1.0 {
            return Err(JointStatus::FractionOutOfRange);
        }
        object.value.shift(turns, fraction_turns, speed_rad_per_s);
        Ok(())
    })
    .into()
}

/// Copies the state of a plant, without addresses. `words` is JOINT_PLANT_STATE_WORDS.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_save(plant: *const JointPlant, state: *mut u32, words: usize) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Plant<'static>>(plant) }?;
        let write = |to: &mut Writer| object.value.write_state(to);
        // SAFETY: the caller's promise, as required by the header.
        unsafe { save::<JOINT_PLANT_STATE_WORDS>(state, words, &identity(object.tables_digest()), write) }
    })
    .into()
}

/// Continues from a saved state of a plant of the same tables, in this process or another. `words` is
/// JOINT_PLANT_STATE_WORDS. Equal states continue with equal bits.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_load(plant: *mut JointPlant, state: *const u32, words: usize) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Plant<'static>>(plant) }?;
        let identity = identity(object.tables_digest());
        let read = |from: &mut Reader| object.value.read_state(from);
        // SAFETY: the caller's promise, as required by the header.
        unsafe { load::<JOINT_PLANT_STATE_WORDS>(state, words, &identity, read) }
    })
    .into()
}

/// Present encoder readings, and the torque that was commanded last.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_samples(plant: *const JointPlant, samples: *mut JointSamples) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Plant<'static>>(plant) }?;
        usable(samples)?;
        let found = object.value.samples();
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { samples.write(JointSamples::new(&found)) };
        Ok(())
    })
    .into()
}

/// Present motion.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_outputs(plant: *const JointPlant, motion: *mut JointPlantOutputs) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Plant<'static>>(plant) }?;
        usable(motion)?;
        let found = outputs(&object.value.motion());
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { motion.write(found) };
        Ok(())
    })
    .into()
}

/// Present speeds of motor and link.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_speeds(
    plant: *const JointPlant,
    motor_rad_per_s: *mut f32,
    link_rad_per_s: *mut f32,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Plant<'static>>(plant) }?;
        usable(motor_rad_per_s)?;
        usable(link_rad_per_s)?;
        let [motor, link] = object.value.speeds();
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe {
            motor_rad_per_s.write(motor);
            link_rad_per_s.write(link);
        }
        Ok(())
    })
    .into()
}

/// Digest of every bit of the gears' state; equal digests mean equal runs so far.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_plant_digest(plant: *const JointPlant, digest: *mut u64) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Plant<'static>>(plant) }?;
        usable(digest)?;
        let found = object.value.digest();
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { digest.write(found) };
        Ok(())
    })
    .into()
}
