//! The core's own steps on objects of the header, without what a call adds: for counting that. Pointers come from a program
//! that measures, and are good.

use model_core::compensation::{Command, Compensation, ControlOutput};
use model_core::observer::{Estimates, MAPPED, Observer, Samples};

use crate::compensation::{JointCompensation, JointMotion};
use crate::estimates::JointSamples;
use crate::object::{look, open};
use crate::observer::{AnyObserver, JointObserver};

/// Room for what a step takes or gives.
pub type Room = [u64; 32];

/// Samples as the core has them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_samples(samples: *const JointSamples, to: *mut Room) {
    const { assert!(size_of::<Samples<f32>>() <= size_of::<Room>()) };
    // SAFETY: a good pointer.
    if let Ok(samples) = unsafe { (*samples).samples() } {
        // SAFETY: likewise, and room enough.
        unsafe { to.cast::<Samples<f32>>().write(samples) };
    }
}

/// A command to follow a motion, as the core has it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_command(now: *const JointMotion, ahead: *const JointMotion, to: *mut Room) {
    const { assert!(size_of::<Command<f32>>() <= size_of::<Room>()) };
    // SAFETY: good pointers, and room enough.
    unsafe {
        let (now, ahead) = (*(*now).motion(), Some(*(*ahead).motion()));
        to.cast::<Command<f32>>().write(Command::Position { now, ahead });
    }
}

/// The core's own observer, with maps, in an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_observer(observer: *mut JointObserver) -> *mut Observer<'static, f32, MAPPED> {
    // SAFETY: a good pointer.
    unsafe { open::<AnyObserver>(observer) }.map_or(core::ptr::null_mut(), |object| object.value.observer.as_mut_ptr())
}

/// Its estimates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_estimates(observer: *const JointObserver) -> *const Estimates<f32> {
    // SAFETY: a good pointer.
    unsafe { look::<AnyObserver>(observer) }.map_or(core::ptr::null(), |object| object.value.estimates())
}

/// The core's own compensation in an object.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_compensation(of: *mut JointCompensation) -> *mut Compensation<'static, f32> {
    // SAFETY: a good pointer.
    unsafe { open::<Compensation<'static, f32>>(of) }.map_or(core::ptr::null_mut(), |object| &raw mut object.value)
}

/// A step of an observer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_observer_step(observer: *mut Observer<'static, f32, MAPPED>, from: *const Room) {
    // SAFETY: good pointers.
    unsafe { (*observer).step(&*from.cast::<Samples<f32>>()) };
}

/// A step of a compensation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn joint_bare_compensation_step(
    compensation: *mut Compensation<'static, f32>,
    estimates: *const Estimates<f32>,
    command: *const Room,
    to: *mut Room,
) {
    const { assert!(size_of::<ControlOutput<f32>>() <= size_of::<Room>()) };
    // SAFETY: good pointers, and room enough.
    unsafe {
        to.cast::<ControlOutput<f32>>().write((*compensation).step(&*estimates, &*command.cast::<Command<f32>>()))
    };
}
