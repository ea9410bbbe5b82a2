//! Compensation: motor torque from the observer's estimates and a set-point.

use core::mem::MaybeUninit;

use core::mem::offset_of;
use core::ptr;

use model_core::compensation::{CommandRef, Compensation, ControlOutput, ImpedancePoint, Motion, Stage};

use model_core::gears::Flank;

use table_blob::Blob;

use crate::estimates::JointContact;
use crate::object::{Kind, Storage, open, open_shared, start, started_object};
use crate::observer::{AnyObserver, JointObserver};
use crate::state::{HEAD, Identity, load, save};
use crate::status::JointStatus;

/// 64-bit words of a compensation.
pub const JOINT_COMPENSATION_WORDS: usize = 65;

/// 32-bit words of a compensation's saved state.
pub const JOINT_COMPENSATION_STATE_WORDS: usize = 143;
const _: () = assert!(JOINT_COMPENSATION_STATE_WORDS == HEAD + Compensation::<'static, f32>::STATE_LAYOUT.words);

/// Storage of a compensation. Its content is the library's own.
#[repr(C)]
pub struct JointCompensation {
    storage: [u64; JOINT_COMPENSATION_WORDS],
}

impl Kind for Compensation<'static, f32> {
    type Storage = JointCompensation;
    const MARK: u32 = 0xc5c5_c5c5;
}

/// Asserts that a struct of the header begins with the memory layout of the core's struct.
macro_rules! assert_same_layout {
    ($own:ty, $core:ty, $($field:ident: $($path:ident).+),+) => {
        const {
            assert!(size_of::<$own>() >= size_of::<$core>() && align_of::<$own>() == 4 && align_of::<$core>() == 4);
            $(assert!(offset_of!($own, $field) == offset_of!($core, $($path).+));)+
        }
    };
}

/// Limit of a fraction of a turn [turns]: counts, degrees and most radians exceed it, while a set-point may cross a
/// turn before it carries the whole one over.
const MAX_FRACTION: f32 = 1.0;

/// Motion of the link at one time, on the scale of the observer's link shaft.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointMotion {
    /// Whole turns.
    pub turns: i32,
    /// Remaining fraction of a turn, from -1 to 1.
    pub fraction_turns: f32,
    /// Speed.
    pub speed_rad_per_s: f32,
    /// Acceleration.
    pub acceleration_rad_per_s2: f32,
}

impl JointMotion {
    /// The core's motion, which has the same memory layout.
    #[inline(always)]
    pub(crate) fn motion(&self) -> &Motion<f32> {
        assert_same_layout!(JointMotion, Motion<f32>, turns: position.turns, fraction_turns: position.fraction,
            speed_rad_per_s: speed, acceleration_rad_per_s2: acceleration);
        // SAFETY: equal types at equal offsets, as asserted; every bit pattern is valid.
        unsafe { &*ptr::from_ref(self).cast() }
    }

    /// Adds zero times each number to a sum; the result is zero only if all numbers are finite.
    #[inline(always)]
    fn finite_probe(&self, before: f32) -> f32 {
        before + 0.0 * self.fraction_turns + 0.0 * self.speed_rad_per_s + 0.0 * self.acceleration_rad_per_s2
    }
}

/// Spring and damper about a moving point, on the scale of the observer's link shaft.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointImpedance {
    /// Whole turns of the point.
    pub turns: i32,
    /// Remaining fraction of a turn, from -1 to 1.
    pub fraction_turns: f32,
    /// Speed of the point.
    pub speed_rad_per_s: f32,
    /// Torque at the link, on top of spring and damper.
    pub torque_Nm: f32,
    /// Stiffness at the link.
    pub stiffness_Nm_per_rad: f32,
    /// Damping at the link.
    pub damping_Nm_s_per_rad: f32,
}

impl JointImpedance {
    /// The core's impedance point, which has the same memory layout.
    #[inline(always)]
    fn point(&self) -> &ImpedancePoint<f32> {
        assert_same_layout!(JointImpedance, ImpedancePoint<f32>, turns: position.turns, fraction_turns: position.fraction,
            speed_rad_per_s: speed, torque_Nm: torque, stiffness_Nm_per_rad: stiffness, damping_Nm_s_per_rad: damping);
        // SAFETY: equal types at equal offsets, as asserted; every bit pattern is valid.
        unsafe { &*ptr::from_ref(self).cast() }
    }

    /// Zero times each number; zero only if all numbers are finite.
    #[inline(always)]
    fn finite_probe(&self) -> f32 {
        let spring = 0.0 * self.stiffness_Nm_per_rad + 0.0 * self.damping_Nm_s_per_rad + 0.0 * self.torque_Nm;
        0.0 * self.fraction_turns + 0.0 * self.speed_rad_per_s + spring
    }
}

/// Returns whether a sum of products with zero is zero. Zero times infinity or NaN is a quiet NaN, which has this bit
/// set; zero does not. The test takes fewer instructions than the flags of a comparison.
#[inline(always)]
fn all_finite(finite_probe: f32) -> bool {
    const QUIET: u32 = 1 << 22;
    finite_probe.to_bits() & QUIET == 0
}

/// Stage of the compensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointStage {
    /// A flank carries the demand; or friction holds the link at its set-point, and the motor waits in the middle of
    /// the gap.
    Touching = 0,
    /// The motor moves through the gap towards a flank.
    Crossing = 1,
    /// The motor approaches a flank at a small speed.
    Landing = 2,
    /// Control without compensation: the gap is not observable.
    Plain = 3,
    /// No torque: the position of the motor is unknown.
    Off = 4,
    /// No torque until observer and compensation are restarted: the motor moved against its torque, so torque or motor
    /// encoder has the wrong sign.
    Reversed = 5,
}

/// Output of the compensation.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointTorque {
    /// Torque for the motor's shaft, finite and within the limit; divided by the torque constant it is the current to
    /// command.
    pub motor_torque_Nm: f32,
    /// Torque that the teeth must transmit after a crossing that began now.
    pub demand_Nm: f32,
    /// Estimated load on the link without dry friction.
    pub load_Nm: f32,
    /// Estimated dry friction of the link.
    pub friction_Nm: f32,
    /// Share of the compensation in the torque, 0 to 1; the rest is control without compensation.
    pub trust: f32,
    /// Stage of the compensation.
    pub stage: JointStage,
    /// Flank that carries, or towards which the motor moves.
    pub flank: JointContact,
    /// 1 if the law requires more torque than the motor has, or brakes early for lack of torque; else 0.
    pub short_of_torque: u32,
    /// 1 while control without compensation is active because the loop hunted; else 0.
    pub stepped_back: u32,
}

impl JointTorque {
    /// Writes an output to the caller's struct.
    ///
    /// # Safety
    /// The pointer is aligned, not NULL, and valid for writes.
    #[inline(always)]
    unsafe fn write_to(of: &ControlOutput<f32>, to: *mut Self) {
        const NUMBERS: usize = 5;
        assert_same_layout!(JointTorque, ControlOutput<f32>, motor_torque_Nm: torque, demand_Nm: demand, load_Nm: load, trust: trust);
        let stage = match of.stage {
            Stage::Touching => JointStage::Touching,
            Stage::Crossing => JointStage::Crossing,
            Stage::Landing => JointStage::Landing,
            Stage::Plain => JointStage::Plain,
            Stage::Off => JointStage::Off,
            Stage::Reversed => JointStage::Reversed,
        };
        let flank = match of.flank {
            Some(Flank::Drive) => JointContact::DriveSide,
            Some(Flank::Back) => JointContact::BackSide,
            None => JointContact::Separated,
        };
        // SAFETY: the numbers are the first fields of both structs, as asserted; the rest is the caller's promise.
        unsafe {
            to.cast::<[f32; NUMBERS]>().write(*ptr::from_ref(of).cast());
            (*to).stage = stage;
            (*to).flank = flank;
            (*to).short_of_torque = of.short_of_torque.into();
            (*to).stepped_back = of.stepped_back.into();
        }
    }
}

/// Starts a compensation, as joint_compensation_start; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_compensation_start_checked(
    compensation: *mut JointCompensation,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: compensation, bytes, abi };
    let make = |blob: &Blob<'static>, place: &mut MaybeUninit<_>| {
        place.write(Compensation::new(blob.compensation()?));
        Ok(())
    };
    // SAFETY: the caller's promise, as required by the header.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, make) }).into()
}

/// One control period of position control, after the observer's step: follows a motion. `ahead` is the motion `lead_s`
/// (joint_tables_facts) after `now`, or NULL if it is unknown.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_compensation_follow(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    now: *const JointMotion,
    ahead: *const JointMotion,
    torque: *mut JointTorque,
) -> JointStatus {
    let objects = [compensation.addr(), observer.addr()];
    if !all_usable(objects, [now.addr(), torque.addr()], ahead.addr()) {
        return unusable_status(objects, [now.addr(), torque.addr()]);
    }
    fp_mode::standard(|| {
        // SAFETY: aligned, and not NULL except where NULL is allowed; the rest is the caller's promise, as required by
        // the header.
        let (now, ahead) = unsafe { (&*now, ahead.as_ref()) };
        let finite_probe = now.finite_probe(0.0);
        if !all_finite(ahead.map_or(finite_probe, |ahead| ahead.finite_probe(finite_probe))) {
            return JointStatus::NotFinite;
        }
        let fraction = ahead.map_or(0.0, |ahead| ahead.fraction_turns);
        if now.fraction_turns.abs() > MAX_FRACTION || fraction.abs() > MAX_FRACTION {
            return JointStatus::FractionOutOfRange;
        }
        let command = CommandRef::Position { now: now.motion(), ahead: ahead.map(JointMotion::motion) };
        // SAFETY: as above.
        unsafe { step(compensation, observer, command, torque) }
    })
}

/// One control period of impedance control, after the observer's step: acts as a spring and damper at the link.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_compensation_yield(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    impedance: *const JointImpedance,
    torque: *mut JointTorque,
) -> JointStatus {
    let objects = [compensation.addr(), observer.addr()];
    if !all_usable(objects, [impedance.addr(), torque.addr()], 0) {
        return unusable_status(objects, [impedance.addr(), torque.addr()]);
    }
    fp_mode::standard(|| {
        // SAFETY: aligned and not NULL; the rest is the caller's promise, as required by the header.
        let impedance = unsafe { &*impedance };
        if !all_finite(impedance.finite_probe()) {
            return JointStatus::NotFinite;
        }
        if impedance.fraction_turns.abs() > MAX_FRACTION {
            return JointStatus::FractionOutOfRange;
        }
        // SAFETY: as above.
        unsafe { step(compensation, observer, CommandRef::Impedance(impedance.point()), torque) }
    })
}

/// Returns whether all pointers are usable, in one test: only the last may be NULL, pointers to objects are multiples
/// of eight, the others of four.
#[inline(always)]
fn all_usable([one, two]: [usize; 2], [three, four]: [usize; 2], or_null: usize) -> bool {
    const { assert!(align_of::<JointCompensation>() == 8 && align_of::<JointObserver>() == 8) };
    const { assert!(align_of::<JointTorque>() == 4) };
    let low = (one | two) | (three | four | or_null) << 1;
    low.trailing_zeros() >= 3 && one != 0 && two != 0 && three != 0 && four != 0
}

/// Status for unusable pointers.
#[cold]
fn unusable_status([one, two]: [usize; 2], [three, four]: [usize; 2]) -> JointStatus {
    let is_null = one == 0 || two == 0 || three == 0 || four == 0;
    if is_null { JointStatus::NullPointer } else { JointStatus::Misaligned }
}

/// Steps the compensation; all pointers are aligned and not NULL.
#[inline(always)]
unsafe fn step(
    compensation: *mut JointCompensation,
    observer: *const JointObserver,
    command: CommandRef<f32>,
    torque: *mut JointTorque,
) -> JointStatus {
    // SAFETY: the caller's promise; different marks show that the objects are distinct.
    let (Some(object), Some(seen)) = (unsafe {
        (started_object::<Compensation<'static, f32>>(compensation), started_object::<AnyObserver>(observer.cast_mut()))
    }) else {
        return JointStatus::NotStarted;
    };
    if !object.has_tables_of(seen) {
        return JointStatus::OtherTables;
    }
    let shaped = object.value.step_by_reference(seen.value.estimates(), command);
    // SAFETY: aligned, not NULL, and valid for writes.
    unsafe { JointTorque::write_to(&shaped, torque) };
    JointStatus::Ok
}

/// Identity of the state of a compensation.
fn identity(tables: u64) -> Identity {
    let layout = Compensation::<'static, f32>::STATE_LAYOUT;
    Identity { kind: Compensation::<'static, f32>::MARK, layout, tables }
}

/// Copies the whole state of a compensation, without addresses. `words` is JOINT_COMPENSATION_STATE_WORDS.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_compensation_save_state(
    compensation: *const JointCompensation,
    state: *mut u32,
    words: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Compensation<'static, f32>>(compensation) }?;
        let identity = identity(object.tables_digest());
        // SAFETY: as above.
        unsafe { save::<JOINT_COMPENSATION_STATE_WORDS>(state, words, &identity, |to| object.value.write_state(to)) }
    })
    .into()
}

/// Continues from a saved state of a compensation of the same tables, in this process or another. `words` is
/// JOINT_COMPENSATION_STATE_WORDS. Equal states continue with equal bits.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_compensation_load_state(
    compensation: *mut JointCompensation,
    state: *const u32,
    words: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Compensation<'static, f32>>(compensation) }?;
        let identity = identity(object.tables_digest());
        // SAFETY: as above.
        unsafe { load::<JOINT_COMPENSATION_STATE_WORDS>(state, words, &identity, |from| object.value.read_state(from)) }
    })
    .into()
}
