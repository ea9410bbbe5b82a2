//! Observer, with or without error maps. The start function selects the kind; a program that starts only one kind links
//! only the step of that kind.

use core::mem::MaybeUninit;
use core::ptr;

use model_core::numbers::state_words::{Layout, Reader, StateWords, Writer};
use model_core::observer::{Estimates, MAPPED, MEMORY_BYTES, Memory, Observer, PLAIN, Samples};
use table_blob::Blob;

use crate::estimates::{JointEstimates, JointSamples};
use crate::object::{Kind, Storage, open, open_shared, read, start, usable};
use crate::state::{HEAD, Identity, load, save};
use crate::status::JointStatus;

/// 64-bit words of an observer.
pub const JOINT_OBSERVER_WORDS: usize = 275;
/// Bytes of an observer's saved memory.
pub const JOINT_MEMORY_BYTES: usize = 544;
const _: () = assert!(JOINT_MEMORY_BYTES == MEMORY_BYTES);

/// 32-bit words of an observer's saved state.
pub const JOINT_OBSERVER_STATE_WORDS: usize = 621;
const _: () = assert!(JOINT_OBSERVER_STATE_WORDS == HEAD + STEPPED.words + Mapped::STATE_LAYOUT.words);
const _: () = assert!(Mapped::STATE_LAYOUT.words >= Plain::STATE_LAYOUT.words);
/// Layout of the word that tells whether the observer was stepped.
const STEPPED: Layout = bool::LAYOUT;

/// Storage of an observer. Its content is the library's own.
#[repr(C)]
pub struct JointObserver {
    storage: [u64; JOINT_OBSERVER_WORDS],
}

/// Content of the storage: an observer of either kind, its step function, and the offset of its estimates. Functions
/// outside of the control period test the kind, so that a program that never saves does not link the saving code.
pub(crate) struct AnyObserver {
    step: unsafe fn(*mut (), &Samples<f32>),
    /// Offset of the estimates from the beginning of the observer [B].
    estimates: usize,
    has_maps: bool,
    /// True after the first step; a memory can be loaded before it only.
    stepped: bool,
    pub(crate) observer: MaybeUninit<Observer<'static, f32, MAPPED>>,
}

impl Kind for AnyObserver {
    type Storage = JointObserver;
    const MARK: u32 = 0x5e5e_5e5e;
}

impl AnyObserver {
    /// Builds an observer of a kind in its final place.
    fn new_in<const P: usize>(blob: &Blob<'static>, place: &mut MaybeUninit<Self>) -> Result<(), JointStatus> {
        const { assert!(size_of::<Observer<'static, f32, P>>() <= size_of::<Observer<'static, f32, MAPPED>>()) };
        const { assert!(align_of::<Observer<'static, f32, P>>() <= align_of::<Observer<'static, f32, MAPPED>>()) };
        let step = |observer: *mut (), samples: &Samples<f32>| {
            // SAFETY: this function is stored beside an observer of this kind only.
            unsafe { &mut *observer.cast::<Observer<'static, f32, P>>() }.step(samples);
        };
        let tables = blob.observer()?;
        let any = place.as_mut_ptr();
        // SAFETY: inside of the place.
        let room = unsafe { &raw mut (*any).observer }.cast::<MaybeUninit<Observer<'static, f32, P>>>();
        // SAFETY: large enough and aligned, as asserted; uninitialised storage may hold any bits.
        let observer = Observer::new_in(unsafe { &mut *room }, tables);
        let estimates = ptr::from_ref(observer.estimates()).addr() - room.addr();
        // SAFETY: inside of the place; the observer is already written.
        unsafe {
            (&raw mut (*any).step).write(step);
            (&raw mut (*any).estimates).write(estimates);
            (&raw mut (*any).has_maps).write(P == MAPPED);
            (&raw mut (*any).stepped).write(false);
        }
        Ok(())
    }

    /// Estimates of the last step.
    #[inline(always)]
    pub(crate) fn estimates(&self) -> &Estimates<f32> {
        // SAFETY: the estimates are at this offset in this observer.
        unsafe { &*self.observer.as_ptr().byte_add(self.estimates).cast() }
    }

    fn save(&self) -> Memory {
        let observer = self.observer.as_ptr();
        // SAFETY: `has_maps` tells the kind of the observer.
        unsafe { if self.has_maps { (*observer).save() } else { (*observer.cast::<Plain>()).save() } }
    }

    fn load(&mut self, memory: &[u8]) -> Result<(), JointStatus> {
        let observer = self.observer.as_mut_ptr();
        // SAFETY: `has_maps` tells the kind of the observer.
        let loaded =
            unsafe { if self.has_maps { (*observer).load(memory) } else { (*observer.cast::<Plain>()).load(memory) } };
        Ok(loaded?)
    }

    /// Identity of the state of an observer of this kind.
    fn identity(&self, tables: u64) -> Identity {
        let (maps, layout) = if self.has_maps { (MAPPED, Mapped::STATE_LAYOUT) } else { (PLAIN, Plain::STATE_LAYOUT) };
        Identity { kind: Self::MARK ^ maps as u32, layout: STEPPED.with("observer", layout), tables }
    }
}

/// Observer with maps.
type Mapped = Observer<'static, f32, MAPPED>;
/// Observer without maps.
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
    // SAFETY: the caller's promise, as required by the header.
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
    // SAFETY: the caller's promise, as required by the header.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, AnyObserver::new_in::<PLAIN>) }).into()
}

/// One control period: processes the samples.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_step(
    observer: *mut JointObserver,
    samples: *const JointSamples,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<AnyObserver>(observer) }?;
        // SAFETY: as above.
        let samples = unsafe { read(samples) }?.samples()?;
        let any = &mut object.value;
        any.stepped = true;
        // SAFETY: the observer beside this function is of its kind.
        unsafe { (any.step)(any.observer.as_mut_ptr().cast(), &samples) };
        Ok(())
    })
    .into()
}

/// Copies the estimates of the last period.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_estimates(
    observer: *const JointObserver,
    estimates: *mut JointEstimates,
) -> JointStatus {
    let copy_estimates = || {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<AnyObserver>(observer) }?;
        usable(estimates)?;
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { estimates.write(JointEstimates::new(object.value.estimates())) };
        Ok(())
    };
    JointStatus::from(copy_estimates())
}

/// Saves the estimated parameters, outside of the control period. `bytes` is JOINT_MEMORY_BYTES.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_save(
    observer: *const JointObserver,
    memory: *mut u8,
    bytes: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<AnyObserver>(observer) }?;
        usable(memory)?;
        if bytes != JOINT_MEMORY_BYTES {
            return Err(JointStatus::WrongSize);
        }
        // SAFETY: not NULL, of this size, and valid for writes.
        unsafe { memory.cast::<Memory>().write(object.value.save()) };
        Ok(())
    })
    .into()
}

/// Loads saved parameters, outside of the control period and before the first step. `bytes` is JOINT_MEMORY_BYTES.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_load(
    observer: *mut JointObserver,
    memory: *const u8,
    bytes: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<AnyObserver>(observer) }?;
        usable(memory)?;
        if bytes != JOINT_MEMORY_BYTES {
            return Err(JointStatus::WrongSize);
        }
        if object.value.stepped {
            return Err(JointStatus::AlreadyStepped);
        }
        // SAFETY: not NULL, of this size, and disjoint from the object.
        let memory = unsafe { core::slice::from_raw_parts(memory, bytes) };
        object.value.load(memory)
    })
    .into()
}

/// Copies the whole state of an observer, without addresses. `words` is JOINT_OBSERVER_STATE_WORDS.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_save_state(
    observer: *const JointObserver,
    state: *mut u32,
    words: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<AnyObserver>(observer) }?;
        let any = &object.value;
        let identity = any.identity(object.tables_digest());
        let observer = any.observer.as_ptr();
        let write = |to: &mut Writer| {
            any.stepped.write(to);
            // SAFETY: `has_maps` tells the kind of the observer.
            unsafe {
                if any.has_maps { (*observer).write_state(to) } else { (*observer.cast::<Plain>()).write_state(to) }
            }
        };
        // SAFETY: the caller's promise, as required by the header.
        unsafe { save::<JOINT_OBSERVER_STATE_WORDS>(state, words, &identity, write) }
    })
    .into()
}

/// Continues from a saved state of an observer of the same tables, in this process or another, before or after steps.
/// `words` is JOINT_OBSERVER_STATE_WORDS. Equal states continue with equal bits.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_observer_load_state(
    observer: *mut JointObserver,
    state: *const u32,
    words: usize,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<AnyObserver>(observer) }?;
        let identity = object.value.identity(object.tables_digest());
        let any = &mut object.value;
        let observer = any.observer.as_mut_ptr();
        let read = |from: &mut Reader| {
            any.stepped = bool::read(from);
            // SAFETY: `has_maps` tells the kind of the observer.
            unsafe {
                if any.has_maps { (*observer).read_state(from) } else { (*observer.cast::<Plain>()).read_state(from) }
            }
        };
        // SAFETY: the caller's promise, as required by the header.
        unsafe { load::<JOINT_OBSERVER_STATE_WORDS>(state, words, &identity, read) }
    })
    .into()
}
