//! Properties of tables.

use core::ffi::c_char;

use crate::object::{blob, usable};
use crate::status::JointStatus;
use crate::version::has_abi;

/// Bytes of a joint's name, including the terminating zero.
pub const JOINT_NAME_BYTES: usize = 32;
/// Version of the tables that this library reads.
pub const JOINT_TABLES_VERSION: u32 = 5;
const _: () = assert!(JOINT_NAME_BYTES == table_blob::NAME_BYTES && JOINT_TABLES_VERSION == table_blob::VERSION);

/// Properties that tables were made for.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct JointTablesFacts {
    /// Digest of the tables: objects started from tables with one digest belong together.
    pub digest: u64,
    /// Version of the layout.
    pub version: u32,
    /// Control rate: the step functions are called at this rate.
    pub control_rate_Hz: u32,
    /// Tick rate of the samples' clock.
    pub clock_rate_Hz: u32,
    /// Control period.
    pub period_s: f32,
    /// Bandwidth that the compensation was designed for.
    pub bandwidth_rad_per_s: f32,
    /// Time from `now` to `ahead` in joint_compensation_follow.
    pub lead_s: f32,
    /// Motor turns per turn of the link.
    pub ratio: f32,
    /// Limit of the compensation's torque command.
    pub torque_limit_Nm: f32,
    /// Planets of the plant; 1 for an equivalent gear, 0 if the tables hold no plant.
    pub planets: u32,
    /// 1 if the observer uses an output encoder, else 0.
    pub has_output_encoder: u32,
    /// 1 if the tables hold a width probe, else 0.
    pub has_probe: u32,
    /// Name of the joint, terminated by zero.
    pub name: [c_char; JOINT_NAME_BYTES],
}

/// Reads the properties of tables, as joint_tables_facts; `abi` is JOINT_ABI.
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
        // SAFETY: the caller's promise, as required by the header.
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
        // SAFETY: aligned, not NULL, and valid for writes.
        unsafe { facts.write(found) };
        Ok(())
    })
    .into()
}
