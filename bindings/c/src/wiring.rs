//! Wiring check: compares signs, counts, ratio, torque, rate and clock with the tables, on a gently moved motor or on
//! any given motion.

use core::mem::MaybeUninit;

use core::ffi::{CStr, c_char};

use model_core::wiring::{Wiring, WiringCheck, WiringProgress, WiringRefusal, WiringVerdict};

use table_blob::Blob;

use crate::estimates::JointSamples;
use crate::object::{Kind, Storage, open, open_shared, read, start, usable};
use crate::status::JointStatus;

/// 64-bit words of a wiring check.
pub const JOINT_WIRING_WORDS: usize = 72;

/// Number of items of the wiring.
pub const JOINT_WIRING_ITEMS: usize = 13;
const _: () = assert!(JOINT_WIRING_ITEMS == model_core::wiring::WIRING_ITEMS);

/// Storage of a wiring check. Its content is the library's own.
#[repr(C)]
pub struct JointWiring {
    storage: [u64; JOINT_WIRING_WORDS],
}

/// Wiring check of the core.
struct Check(WiringCheck<'static, f32>);

impl Kind for Check {
    type Storage = JointWiring;
    const MARK: u32 = 0x3b3b_3b3b;
}

/// Item of the wiring: its index in `verdicts`, and the meaning of `found`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointWiringItem {
    /// Samples are given once per control period. Found: calls per sample.
    Calls = 0,
    /// Control rate of the tables. Found: control period over the tables'.
    Period = 1,
    /// Tick rate of the clock. Found: tick rate over the tables'.
    Clock = 2,
    /// Times of the motor's readings are of the samples' clock. Found: 0.
    MotorTime = 3,
    /// The motor moved. Found: torque that is expected to move it, in N m.
    Motion = 4,
    /// Counts per turn of the motor encoder. Found: their number; 0 for counts that stand still.
    MotorCounts = 5,
    /// Counts per turn of the output encoder. Found: their number; 0 for counts that stand still.
    OutputCounts = 6,
    /// The encoders are not exchanged. Found: 0.
    Places = 7,
    /// Gear ratio. Found: motor turns per output turn.
    Ratio = 8,
    /// The motor encoder counts up in the direction of a positive torque. Found: -1.
    MotorDirection = 9,
    /// The output encoder counts up when the motor encoder does. Found: -1.
    OutputDirection = 10,
    /// A positive torque drives in the direction in which both encoders count up. Found: -1.
    TorqueDirection = 11,
    /// Acting torque over commanded torque. Found: that factor.
    TorqueScale = 12,
}

/// Verdict on an item of the wiring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointVerdict {
    /// The samples do not show it.
    NotSeen = 0,
    /// Equal to the tables.
    Right = 1,
    /// Different from the tables; `found` is the measured value.
    Wrong = 2,
    /// This item or another suspect is wrong, and the samples do not tell which; `found` is the value if it is this
    /// one.
    Suspect = 3,
}

/// Progress of a wiring check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointWiringProgress {
    /// Go on: command the torque, and call again in the next period.
    Running = 0,
    /// The check is over: read the verdicts.
    Done = 1,
    /// The joint moved before any torque was given: let it come to rest.
    NotAtRest = 2,
    /// The joint moved further than allowed: look for another drive. The verdicts hold as far as they go.
    TooFar = 3,
    /// The check took too long: check the times of the samples. The verdicts hold as far as they go.
    TooLong = 4,
}

/// Outputs of one control period of a wiring check.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointWiringStep {
    /// Torque to command next at the motor's shaft, never larger than allowed; zero once the check has ended.
    pub motor_torque_Nm: f32,
    /// Progress.
    pub progress: JointWiringProgress,
}

/// Verdicts on all items, indexed by JointWiringItem.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointWiringVerdicts {
    /// 1 if every item that these tables allow to be judged was seen and is right, else 0.
    pub all_right: u32,
    /// Number of items that are wrong or suspect.
    pub bad: u32,
    /// Verdicts.
    pub verdicts: [JointVerdict; JOINT_WIRING_ITEMS],
    /// Measured values for wrong and suspect items; else 0.
    pub found: [f32; JOINT_WIRING_ITEMS],
}

impl From<&Wiring<f32>> for JointWiringVerdicts {
    fn from(of: &Wiring<f32>) -> Self {
        let mut all = Self {
            all_right: of.is_all_right().into(),
            bad: 0,
            verdicts: [JointVerdict::NotSeen; JOINT_WIRING_ITEMS],
            found: [0.0; JOINT_WIRING_ITEMS],
        };
        for (((_, verdict), place), found) in of.iter().zip(&mut all.verdicts).zip(&mut all.found) {
            (*place, *found) = match verdict {
                WiringVerdict::NotSeen => (JointVerdict::NotSeen, 0.0),
                WiringVerdict::Right => (JointVerdict::Right, 0.0),
                WiringVerdict::Wrong(value) => (JointVerdict::Wrong, value),
                WiringVerdict::Suspect(value) => (JointVerdict::Suspect, value),
            };
            all.bad += u32::from(verdict.is_bad());
        }
        all
    }
}

/// Starts a wiring check, as joint_wiring_start; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_wiring_start_checked(
    wiring: *mut JointWiring,
    bytes: usize,
    tables: *const u64,
    tables_bytes: usize,
    abi: u32,
) -> JointStatus {
    let storage = Storage { at: wiring, bytes, abi };
    let make = |blob: &Blob<'static>, place: &mut MaybeUninit<_>| {
        place.write(Check(WiringCheck::new(blob.wiring()?)));
        Ok(())
    };
    // SAFETY: the caller's promise, as required by the header.
    fp_mode::standard(|| unsafe { start(storage, tables, tables_bytes, make) }).into()
}

/// One control period of a wiring check, instead of the observer's and the compensation's steps. With an allowed torque
/// of zero, or with another torque in force than the commanded one, any motion in the samples is judged.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_wiring_step(
    wiring: *mut JointWiring,
    samples: *const JointSamples,
    allowed_torque_Nm: f32,
    step: *mut JointWiringStep,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open::<Check>(wiring) }?;
        // SAFETY: as above.
        let samples = unsafe { read(samples) }?.samples()?;
        usable(step)?;
        if !allowed_torque_Nm.is_finite() {
            return Err(JointStatus::NotFinite);
        }
        let (motor_torque_Nm, progress) = object.value.0.step(&samples, allowed_torque_Nm);
        let progress = match progress {
            WiringProgress::Running => JointWiringProgress::Running,
            WiringProgress::Done(_) => JointWiringProgress::Done,
            WiringProgress::Refused(WiringRefusal::NotAtRest) => JointWiringProgress::NotAtRest,
            WiringProgress::Refused(WiringRefusal::TooFar) => JointWiringProgress::TooFar,
            WiringProgress::Refused(WiringRefusal::TooLong) => JointWiringProgress::TooLong,
        };
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { step.write(JointWiringStep { motor_torque_Nm, progress }) };
        Ok(())
    })
    .into()
}

/// Copies the verdicts on the motion so far, outside of the control period.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_wiring_verdicts(
    wiring: *const JointWiring,
    verdicts: *mut JointWiringVerdicts,
) -> JointStatus {
    fp_mode::standard(|| {
        // SAFETY: the caller's promise, as required by the header.
        let object = unsafe { open_shared::<Check>(wiring) }?;
        usable(verdicts)?;
        let found = JointWiringVerdicts::from(&object.value.0.wiring());
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { verdicts.write(found) };
        Ok(())
    })
    .into()
}

/// Names and helps by number, equal to the core's (compared by a test).
const TEXTS: [[&CStr; 2]; JOINT_WIRING_ITEMS] = [
    [c"calls", c"samples come more than once: call the step once a control period"],
    [c"period", c"the control rate is not that of the tables: call at control_rate_Hz, or make tables for this rate"],
    [c"clock", c"the clock of the samples has another tick rate than the tables: give ticks of clock_rate_Hz"],
    [
        c"motor_time",
        c"the times of the motor's readings stand still or are of another clock: give the time of the latch",
    ],
    [
        c"motion",
        c"nothing moved: enable the drive, release the brake, or allow the torque that is expected to move the joint",
    ],
    [c"motor_counts", c"the motor encoder has another number of counts in a turn than the tables, or stands still"],
    [c"output_counts", c"the output encoder has another number of counts in a turn than the tables, or stands still"],
    [c"places", c"motor and output encoder are exchanged"],
    [c"ratio", c"the gear ratio is not that of the tables: these are tables of another joint"],
    [c"motor_direction", c"the motor encoder counts down under a positive torque: give the range less the counts"],
    [c"output_direction", c"the output encoder counts against the motor encoder: give the range less the counts"],
    [
        c"torque_direction",
        c"a positive torque drives backwards: change the sign of the current, or exchange two phases",
    ],
    [
        c"torque_scale",
        c"the torque that acts is not the commanded one: check torque constant, unit, and the link's inertia",
    ],
];

fn item_text(item: u32, which: usize) -> *const c_char {
    let unknown = [c"unknown", c"this is no item of the wiring"];
    let [name, help] = TEXTS.get(item as usize).copied().unwrap_or(unknown);
    if which == 0 { name.as_ptr() } else { help.as_ptr() }
}

/// Name of an item of the wiring, such as "output_direction"; never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn joint_wiring_item_name(item: u32) -> *const c_char {
    item_text(item, 0)
}

/// Error and remedy for an item of the wiring, in one sentence; never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn joint_wiring_item_text(item: u32) -> *const c_char {
    item_text(item, 1)
}

#[cfg(test)]
mod tests {
    use model_core::wiring::WiringItem;

    use super::TEXTS;

    #[test]
    fn wiring_texts_match_core() {
        for (item, [name, help]) in WiringItem::ALL.into_iter().zip(TEXTS) {
            assert_eq!([name.to_str(), help.to_str()], [Ok(item.name()), Ok(item.help())]);
        }
    }
}
