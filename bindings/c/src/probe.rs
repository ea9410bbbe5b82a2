//! The width probe: a motor that wiggles against a held load and reads the half-backlash off where it comes to rest.

use core::mem::MaybeUninit;

use model_core::width_probe::{Probe, ProbeProgress, ProbeRefusal};

use table_blob::Blob;

use crate::estimates::JointEstimate;
use crate::fp_mode;
use crate::object::{Kind, Storage, look, open, start, usable};
use crate::observer::{AnyObserver, JointObserver};
use crate::status::JointStatus;

/// 64-bit words of a width probe.
pub const JOINT_PROBE_WORDS: usize = 16;

/// Storage of a width probe. Its content is the library's own.
#[repr(C)]
pub struct JointProbe {
    storage: [u64; JOINT_PROBE_WORDS],
}

/// A probe, and for how many periods it waits until the observer has settled.
struct Waiting {
    probe: Probe<'static, f32>,
    wait: u32,
}

impl Kind for Waiting {
    type Storage = JointProbe;
    const MARK: u32 = 0x9e9e_9e9e;
}

/// Where a probe stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointProgress {
    /// Go on: command the torque, and call again in the next period.
    Running = 0,
    /// The half-backlash is there.
    Done = 1,
    /// The motor was turning when the probe began: let it come to rest.
    NotAtRest = 2,
    /// The load pushes the teeth with more than the probe may use: take the load off.
    Loaded = 3,
    /// The motor did not come to rest, or went further than the teeth allow: hold the load.
    NotHeld = 4,
    /// The motor hardly moved: friction is more than the probe may use, or the joint is blocked.
    Stuck = 5,
    /// The first and the last pass do not agree: something moved.
    Unsteady = 6,
    /// Samples were missing or wrong, or torque or motor encoder has the wrong sign.
    BadSamples = 7,
}

/// What a probe answers.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointProbed {
    /// Torque to command next at the motor's shaft; zero once the probe has ended.
    pub motor_torque_Nm: f32,
    /// Where it stands.
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
        // The core's controller begins in a period of its own.
        place.write(Waiting { probe: Probe::new(table), wait: table.settle.saturating_add(1) });
        Ok(())
    };
    // SAFETY: the caller's word, as the header asks for it.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, make) }).into()
}

/// One control period of a probe, after the observer's step and in place of the compensation's.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_probe_step(
    probe: *mut JointProbe,
    observer: *const JointObserver,
    probed: *mut JointProbed,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's word, as the header asks for it.
        let object = unsafe { open::<Waiting>(probe) }?;
        // SAFETY: likewise; the marks of both say that they are two.
        let seen = unsafe { look::<AnyObserver>(observer) }?;
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
                let why = match refusal {
                    ProbeRefusal::NotAtRest => JointProgress::NotAtRest,
                    ProbeRefusal::Loaded => JointProgress::Loaded,
                    ProbeRefusal::NotHeld => JointProgress::NotHeld,
                    ProbeRefusal::Stuck => JointProgress::Stuck,
                    ProbeRefusal::Unsteady => JointProgress::Unsteady,
                    ProbeRefusal::BadSamples => JointProgress::BadSamples,
                };
                (why, none)
            }
        };
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { probed.write(JointProbed { motor_torque_Nm, progress, half_backlash_m }) };
        Ok(())
    })
    .into()
}
