//! The observer, with error maps or without: which of them, the function that starts it says, and a program that starts only
//! one kind links only that.

use core::mem::MaybeUninit;

use model_core::observer::{Estimates, MAPPED, MEMORY_BYTES, Memory, Observer, PLAIN, Samples};
use table_blob::Blob;

use crate::estimates::{JointEstimates, JointSamples};
use crate::fp_mode;
use crate::object::{Kind, look, open, read, start, usable};
use crate::status::JointStatus;

/// 64-bit words of an observer.
pub const JOINT_OBSERVER_WORDS: usize = 240;
/// Bytes of what an observer has learnt.
pub const JOINT_MEMORY_BYTES: usize = 544;
const _: () = assert!(JOINT_MEMORY_BYTES == MEMORY_BYTES);

/// Storage of an observer. Its content is the library's own.
#[repr(C)]
pub struct JointObserver {
    storage: [u64; JOINT_OBSERVER_WORDS],
}

/// What lies in the storage: an observer of either kind, and what can be done with that kind.
pub(crate) struct AnyObserver {
    functions: &'static Functions,
    pub(crate) observer: MaybeUninit<Observer<'static, f32, MAPPED>>,
}

impl Kind for AnyObserver {
    type Storage = JointObserver;
    const MARK: u32 = 0x0b5e_17e5;
}

struct Functions {
    step: unsafe fn(*mut (), &Samples<f32>),
    estimates: unsafe fn(*const ()) -> *const Estimates<f32>,
    save: unsafe fn(*const ()) -> Memory,
    load: unsafe fn(*mut (), &[u8]) -> Result<(), JointStatus>,
}

/// The functions of a kind.
struct Of<const P: usize>;

impl<const P: usize> Of<P> {
    const FUNCTIONS: Functions = Functions {
        step: |observer, samples| {
            // SAFETY: `AnyObserver::new` has put an observer of this kind beside these functions.
            unsafe { &mut *observer.cast::<Observer<'static, f32, P>>() }.step(samples);
        },
        estimates: |observer| {
            // SAFETY: as above.
            unsafe { &*observer.cast::<Observer<'static, f32, P>>() }.estimates()
        },
        save: |observer| {
            // SAFETY: as above.
            unsafe { &*observer.cast::<Observer<'static, f32, P>>() }.save()
        },
        load: |observer, memory| {
            // SAFETY: as above.
            Ok(unsafe { &mut *observer.cast::<Observer<'static, f32, P>>() }.load(memory)?)
        },
    };
}

impl AnyObserver {
    fn new<const P: usize>(blob: &Blob<'static>, functions: &'static Functions) -> Result<Self, JointStatus> {
        const { assert!(size_of::<Observer<'static, f32, P>>() <= size_of::<Observer<'static, f32, MAPPED>>()) };
        const { assert!(align_of::<Observer<'static, f32, P>>() <= align_of::<Observer<'static, f32, MAPPED>>()) };
        let mut any = Self { functions, observer: MaybeUninit::uninit() };
        let place = any.observer.as_mut_ptr().cast::<Observer<'static, f32, P>>();
        // SAFETY: large enough and aligned, as was asserted.
        unsafe { place.write(Observer::new(blob.observer()?)) };
        Ok(any)
    }

    /// The estimates of the last step.
    pub(crate) fn estimates(&self) -> &Estimates<f32> {
        // SAFETY: the observer beside these functions is of their kind; what they point to is in it.
        unsafe { &*(self.functions.estimates)(self.observer.as_ptr().cast()) }
    }
}

/// Starts an observer with maps of the encoders' errors. `bytes` is sizeof(JointObserver). The tables must stay as they are
/// for as long as it is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_observer_start(
    observer: *mut JointObserver,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
) -> JointStatus {
    let make = |blob: &Blob<'static>| AnyObserver::new::<MAPPED>(blob, &const { Of::<MAPPED>::FUNCTIONS });
    // SAFETY: the caller's word, as the header asks for it.
    fp_mode::standard(|| unsafe { start(observer, bytes, tables, tables_bytes, make) }).into()
}

/// Starts an observer without maps of the encoders' errors: for ideal encoders, or where flash is short.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_observer_start_without_maps(
    observer: *mut JointObserver,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
) -> JointStatus {
    let make = |blob: &Blob<'static>| AnyObserver::new::<PLAIN>(blob, &const { Of::<PLAIN>::FUNCTIONS });
    // SAFETY: the caller's word, as the header asks for it.
    fp_mode::standard(|| unsafe { start(observer, bytes, tables, tables_bytes, make) }).into()
}

/// One control period: takes what was measured.
#[unsafe(no_mangle)]
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
        // SAFETY: the observer beside these functions is of their kind.
        unsafe { (any.functions.step)(any.observer.as_mut_ptr().cast(), &samples) };
        Ok(())
    })
    .into()
}

/// The estimates of the last period.
#[unsafe(no_mangle)]
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
        // SAFETY: the observer beside these functions is of their kind.
        let saved = unsafe { (object.value.functions.save)(object.value.observer.as_ptr().cast()) };
        // SAFETY: not NULL, of this size, and the caller's to give.
        unsafe { memory.cast::<Memory>().write(saved) };
        Ok(())
    })
    .into()
}

/// Goes on from what was saved, outside of the control period, before the first step. `bytes` is JOINT_MEMORY_BYTES.
#[unsafe(no_mangle)]
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
        // SAFETY: not NULL, of this size, and not the object's own.
        let memory = unsafe { core::slice::from_raw_parts(memory, bytes) };
        let any = &mut object.value;
        // SAFETY: the observer beside these functions is of their kind.
        unsafe { (any.functions.load)(any.observer.as_mut_ptr().cast(), memory) }
    })
    .into()
}
