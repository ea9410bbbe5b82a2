//! Width probe: moves the motor gently to and fro under a held link, and measures the half-backlash from its rest
//! positions.

use core::mem::MaybeUninit;

use model_core::width_probe::{Probe, ProbeProgress, ProbeRefusal};

use table_blob::Blob;

use crate::estimates::JointEstimate;
use crate::object::{Kind, Storage, open, open_shared, start, usable};
use crate::observer::{AnyObserver, JointObserver};
use crate::status::JointStatus;

/// 64-bit words of a width probe.
pub const JOINT_PROBE_WORDS: usize = 16;

/// Storage of a width probe. Its content is the library's own.
#[repr(C)]
pub struct JointProbe {
    storage: [u64; JOINT_PROBE_WORDS],
}

/// Probe with the number of periods that it waits for the observer to settle.
struct Waiting {
    probe: Probe<'static, f32>,
    wait: u32,
}

impl Kind for Waiting {
    type Storage = JointProbe;
    const MARK: u32 = 0x9e9e_9e9e;
}

/// Progress of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointProgress {
    /// Go on: command the torque, and call again in the next period.
    Running = 0,
    /// The half-backlash is valid.
    Done = 1,
    /// The motor was turning when the probe began: let it come to rest.
    NotAtRest = 2,
    /// The load presses the teeth with more torque than the probe may use: remove the load.
    Loaded = 3,
    /// The motor did not come to rest, or moved further than the teeth allow: hold the load.
    NotHeld = 4,
    /// The motor hardly moved: friction exceeds the probe's torque, or the joint is blocked.
    Stuck = 5,
    /// The first and the last pass differ: something moved.
    Unsteady = 6,
    /// Samples were missing or wrong, or torque or motor encoder has the wrong sign.
    BadSamples = 7,
}

/// Output of a probe.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointProbed {
    /// Torque to command next at the motor's shaft; zero once the probe has ended.
    pub motor_torque_Nm: f32,
    /// Progress.
    pub progress: JointProgress,
    /// Half-backlash of each mesh; valid when done.
    pub half_backlash_m: JointEstimate,
}

/// Starts a width probe, as joint_probe_start; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_probe_start_checked(
    probe: *mut JointProbe,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: probe, bytes, abi };
    let make = |blob: &Blob<'static>, place: &mut MaybeUninit<_>| {
        let table = blob.probe()?;
        // The core's controller spends one period on its start.
        place.write(Waiting { probe: Probe::new(table), wait: table.settle.saturating_add(1) });
        Ok(())
    };
    // SAFETY: the caller's promise, as required by the header.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, make) }).into()
}

/// One control period of a probe, after the observer's step and instead of the compensation's.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_probe_step(
    probe: *mut JointProbe,
    observer: *const JointObserver,
    probed: *mut JointProbed,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Waiting>(probe) }?;
        // SAFETY: as above; different marks show that the objects are distinct.
        let seen = unsafe { open_shared::<AnyObserver>(observer) }?;
        if !object.has_tables_of(seen) {
            return Err(JointStatus::OtherTables);
        }
        usable(probed)?;
        let Waiting { probe, wait } = &mut object.value;
        let (motor_torque_Nm, progress) = if *wait > 0 {
            *wait -= 1;
            (0.0, ProbeProgress::Running)
        } else {
            probe.step(seen.value.estimates())
        };
        let none = JointEstimate { value: 0.0, variance: 0.0, valid: 0 };
        let (progress, half_backlash_m) = match progress {
            ProbeProgress::Running => (JointProgress::Running, none),
            ProbeProgress::Done(width) => (JointProgress::Done, width.into()),
            ProbeProgress::Refused(refusal) => {
                let reason = match refusal {
                    ProbeRefusal::NotAtRest => JointProgress::NotAtRest,
                    ProbeRefusal::Loaded => JointProgress::Loaded,
                    ProbeRefusal::NotHeld => JointProgress::NotHeld,
                    ProbeRefusal::Stuck => JointProgress::Stuck,
                    ProbeRefusal::Unsteady => JointProgress::Unsteady,
                    ProbeRefusal::BadSamples => JointProgress::BadSamples,
                };
                (reason, none)
            }
        };
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { probed.write(JointProbed { motor_torque_Nm, progress, half_backlash_m }) };
        Ok(())
    })
    .into()
}
