//! The observer, with error maps or without: which of them, the function that starts it says, and a program that starts only
//! one kind links only the step of that.

use core::mem::MaybeUninit;
use core::ptr;

use model_core::observer::{Estimates, MAPPED, MEMORY_BYTES, Memory, Observer, PLAIN, Samples};
use table_blob::Blob;

use crate::estimates::{JointEstimates, JointSamples};
use crate::fp_mode;
use crate::object::{Kind, Storage, look, open, read, start, usable};
use crate::status::JointStatus;

/// 64-bit words of an observer.
pub const JOINT_OBSERVER_WORDS: usize = 275;
/// Bytes of what an observer has learnt.
pub const JOINT_MEMORY_BYTES: usize = 544;
const _: () = assert!(JOINT_MEMORY_BYTES == MEMORY_BYTES);

/// Storage of an observer. Its content is the library's own.
#[repr(C)]
pub struct JointObserver {
    storage: [u64; JOINT_OBSERVER_WORDS],
}

/// What lies in the storage: an observer of either kind, how it is stepped and where in it the estimates are. What is not
/// of a control period asks for the kind: a program that never saves does not link what saves.
pub(crate) struct AnyObserver {
    step: unsafe fn(*mut (), &Samples<f32>),
    /// From the observer's beginning [B].
    estimates: usize,
    has_maps: bool,
    /// A memory is loaded before the first step alone.
    stepped: bool,
    pub(crate) observer: MaybeUninit<Observer<'static, f32, MAPPED>>,
}

impl Kind for AnyObserver {
    type Storage = JointObserver;
    const MARK: u32 = 0x5e5e_5e5e;
}

impl AnyObserver {
    /// Builds an observer of a kind in its place.
    fn new_in<const P: usize>(blob: &Blob<'static>, place: &mut MaybeUninit<Self>) -> Result<(), JointStatus> {
        const { assert!(size_of::<Observer<'static, f32, P>>() <= size_of::<Observer<'static, f32, MAPPED>>()) };
        const { assert!(align_of::<Observer<'static, f32, P>>() <= align_of::<Observer<'static, f32, MAPPED>>()) };
        let step = |observer: *mut (), samples: &Samples<f32>| {
            // SAFETY: an observer of this kind is put beside this function.
            unsafe { &mut *observer.cast::<Observer<'static, f32, P>>() }.step(samples);
        };
        let tables = blob.observer()?;
        let any = place.as_mut_ptr();
        // SAFETY: inside of the place.
        let room = unsafe { &raw mut (*any).observer }.cast::<MaybeUninit<Observer<'static, f32, P>>>();
        // SAFETY: large enough and aligned, as was asserted; it may hold any bits.
        let observer = Observer::new_in(unsafe { &mut *room }, tables);
        let estimates = ptr::from_ref(observer.estimates()).addr() - room.addr();
        // SAFETY: inside of the place; the observer is written already.
        unsafe {
            (&raw mut (*any).step).write(step);
            (&raw mut (*any).estimates).write(estimates);
            (&raw mut (*any).has_maps).write(P == MAPPED);
            (&raw mut (*any).stepped).write(false);
        }
        Ok(())
    }

    /// The estimates of the last step.
    #[inline(always)]
    pub(crate) fn estimates(&self) -> &Estimates<f32> {
        // SAFETY: so far from its beginning they are in this observer.
        unsafe { &*self.observer.as_ptr().byte_add(self.estimates).cast() }
    }

    fn save(&self) -> Memory {
        let observer = self.observer.as_ptr();
        // SAFETY: an observer of the kind that it says.
        unsafe { if self.has_maps { (*observer).save() } else { (*observer.cast::<Plain>()).save() } }
    }

    fn load(&mut self, memory: &[u8]) -> Result<(), JointStatus> {
        let observer = self.observer.as_mut_ptr();
        // SAFETY: as above.
        let loaded =
            unsafe { if self.has_maps { (*observer).load(memory) } else { (*observer.cast::<Plain>()).load(memory) } };
        Ok(loaded?)
    }
}

/// An observer without maps.
type Plain = Observer<'static, f32, PLAIN>;

/// Starts an observer, as joint_observer_start; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_start_checked(
    observer: *mut JointObserver,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: observer, bytes, abi };
    // SAFETY: the caller's word, as the header asks for it.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, AnyObserver::new_in::<MAPPED>) }).into()
}

/// Starts an observer, as joint_observer_start_without_maps; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_start_without_maps_checked(
    observer: *mut JointObserver,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: observer, bytes, abi };
    // SAFETY: the caller's word, as the header asks for it.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, AnyObserver::new_in::<PLAIN>) }).into()
}

/// One control period: takes what was measured.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_step(
    observer: *mut JointObserver,
    samples: *const JointSamples,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { open::<AnyObserver>(observer) }?;
        // SAFETY: likewise.
        let samples = unsafe { read(samples) }?.samples()?;
        let any = &mut object.value;
        any.stepped = true;
        // SAFETY: the observer beside this function is of its kind.
        unsafe { (any.step)(any.observer.as_mut_ptr().cast(), &samples) };
        Ok(())
    })
    .into()
}

/// The estimates of the last period.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_estimates(
    observer: *const JointObserver,
    estimates: *mut JointEstimates,
) -> JointStatus {
    let give = || {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { look::<AnyObserver>(observer) }?;
        usable(estimates)?;
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { estimates.write(JointEstimates::new(object.value.estimates())) };
        Ok(())
    };
    JointStatus::from(give())
}

/// Saves what was learnt, outside of the control period. `bytes` is JOINT_MEMORY_BYTES.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_save(
    observer: *const JointObserver,
    memory: *mut u8,
    bytes: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { look::<AnyObserver>(observer) }?;
        usable(memory)?;
        if bytes != JOINT_MEMORY_BYTES {
            return Err(JointStatus::WrongSize);
        }
        // SAFETY: not NULL, of this size, and the caller's to give.
        unsafe { memory.cast::<Memory>().write(object.value.save()) };
        Ok(())
    })
    .into()
}

/// Goes on from what was saved, outside of the control period, before the first step. `bytes` is JOINT_MEMORY_BYTES.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_load(
    observer: *mut JointObserver,
    memory: *const u8,
    bytes: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { open::<AnyObserver>(observer) }?;
        usable(memory)?;
        if bytes != JOINT_MEMORY_BYTES {
            return Err(JointStatus::WrongSize);
        }
        if object.value.stepped {
            return Err(JointStatus::AlreadyStepped);
        }
        // SAFETY: not NULL, of this size, and not the object's own.
        let memory = unsafe { core::slice::from_raw_parts(memory, bytes) };
        object.value.load(memory)
    })
    .into()
}
