//! The core's own steps on objects of the header, without the overhead of a call: for counting that overhead. Pointers
//! come from a measuring program and are valid.

use model_core::compensation::{Command, Compensation, ControlOutput};
use model_core::observer::{Estimates, MAPPED, Observer, Samples};

use crate::compensation::{JointCompensation, JointMotion};
use crate::estimates::JointSamples;
use crate::object::{open, open_shared};
use crate::observer::{AnyObserver, JointObserver};

/// Storage for an input or output of a step.
pub type StepStorage = [u64; 32];

/// Converts samples to the core's form.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_samples(samples: *const JointSamples, to: *mut StepStorage) {
    const { assert!(size_of::<Samples<f32>>() <= size_of::<StepStorage>()) };
    // SAFETY: a valid pointer.
    if let Ok(samples) = unsafe { (*samples).samples() } {
        // SAFETY: a valid pointer to storage that is large enough.
        unsafe { to.cast::<Samples<f32>>().write(samples) };
    }
}

/// Converts a command to follow a motion to the core's form.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_command(now: *const JointMotion, ahead: *const JointMotion, to: *mut StepStorage) {
    const { assert!(size_of::<Command<f32>>() <= size_of::<StepStorage>()) };
    // SAFETY: valid pointers, and storage that is large enough.
    unsafe {
        let (now, ahead) = (*(*now).motion(), Some(*(*ahead).motion()));
        to.cast::<Command<f32>>().write(Command::Position { now, ahead });
    }
}

/// The core's observer with maps in an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_observer(observer: *mut JointObserver) -> *mut Observer<'static, f32, MAPPED> {
    // SAFETY: a valid pointer.
    unsafe { open::<AnyObserver>(observer) }.map_or(core::ptr::null_mut(), |object| object.value.observer.as_mut_ptr())
}

/// Estimates of an observer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_estimates(observer: *const JointObserver) -> *const Estimates<f32> {
    // SAFETY: a valid pointer.
    unsafe { open_shared::<AnyObserver>(observer) }.map_or(core::ptr::null(), |object| object.value.estimates())
}

/// The core's compensation in an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_compensation(of: *mut JointCompensation) -> *mut Compensation<'static, f32> {
    // SAFETY: a valid pointer.
    unsafe { open::<Compensation<'static, f32>>(of) }.map_or(core::ptr::null_mut(), |object| &raw mut object.value)
}

/// Steps an observer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_observer_step(
    observer: *mut Observer<'static, f32, MAPPED>,
    from: *const StepStorage,
) {
    // SAFETY: valid pointers.
    unsafe { (*observer).step(&*from.cast::<Samples<f32>>()) };
}

/// Steps a compensation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_compensation_step(
    compensation: *mut Compensation<'static, f32>,
    estimates: *const Estimates<f32>,
    command: *const StepStorage,
    to: *mut StepStorage,
) {
    const { assert!(size_of::<ControlOutput<f32>>() <= size_of::<StepStorage>()) };
    // SAFETY: valid pointers, and storage that is large enough.
    unsafe {
        to.cast::<ControlOutput<f32>>().write((*compensation).step(&*estimates, &*command.cast::<Command<f32>>()))
    };
}
