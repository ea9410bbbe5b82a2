//! What tables say of themselves.

use core::ffi::c_char;

use crate::fp_mode;
use crate::object::{blob, usable};
use crate::status::JointStatus;
use crate::version::has_abi;

/// Bytes of a joint's name, with the zero at its end.
pub const JOINT_NAME_BYTES: usize = 32;
/// Version of tables that this library reads.
pub const JOINT_TABLES_VERSION: u32 = 5;
const _: () = assert!(JOINT_NAME_BYTES == table_blob::NAME_BYTES && JOINT_TABLES_VERSION == table_blob::VERSION);

/// What tables were made for.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointTablesFacts {
    /// Digest over the tables: objects started from tables of one digest belong together.
    pub digest: u64,
    /// Version of the layout.
    pub version: u32,
    /// Control periods in a second: call the step functions so often.
    pub control_rate_Hz: u32,
    /// Ticks in a second of the clock that samples are timed by.
    pub clock_rate_Hz: u32,
    /// A control period.
    pub period_s: f32,
    /// Bandwidth that the compensation was designed for.
    pub bandwidth_rad_per_s: f32,
    /// How far ahead of now the second motion of joint_compensation_follow is.
    pub lead_s: f32,
    /// Motor turns for a turn of the link.
    pub ratio: f32,
    /// Largest torque that the compensation asks the motor for.
    pub torque_limit_Nm: f32,
    /// Planets of the plant; 1 for an equivalent gear, 0 if the tables hold no plant.
    pub planets: u32,
    /// 1 if the observer uses an output encoder, else 0.
    pub has_output_encoder: u32,
    /// 1 if the tables hold a width probe, else 0.
    pub has_probe: u32,
    /// Of the joint; ends with a zero.
    pub name: [c_char; JOINT_NAME_BYTES],
}

/// Looks at tables, as joint_tables_facts; `abi` is JOINT_ABI.
#[unsafe(no_mangle)]
#[must_use]
pub unsafe extern "C" fn joint_tables_facts_checked(
    tables: *const u64,
    tables_bytes: usize,
    facts: *mut JointTablesFacts,
    abi: u32,
) -> JointStatus {
    fp_mode::standard(|| {
        has_abi(abi)?;
        // SAFETY: the caller's word, as the header asks for it.
        let blob = unsafe { blob(tables, tables_bytes) }?;
        let (header, observer, compensation) = (blob.header(), blob.observer()?, blob.compensation()?);
        if facts.is_null() {
            return Ok(());
        }
        usable(facts)?;
        let found = JointTablesFacts {
            digest: header.digest,
            version: header.version,
            control_rate_Hz: header.control_rate,
            clock_rate_Hz: header.clock_rate,
            period_s: observer.period,
            bandwidth_rad_per_s: header.bandwidth,
            lead_s: compensation.crossing.lead,
            ratio: compensation.gear.motor_per_link,
            torque_limit_Nm: compensation.limits.motor * compensation.gear.link_per_motor,
            planets: header.planets,
            has_output_encoder: observer.counts.has_output.into(),
            has_probe: blob.probe().is_ok().into(),
            name: header.name.map(|byte| byte as c_char),
        };
        // SAFETY: aligned, not NULL, and the caller's to give.
        unsafe { facts.write(found) };
        Ok(())
    })
    .into()
}
