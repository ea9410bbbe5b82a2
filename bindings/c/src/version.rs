//! Version of the library, and the check that a header belongs to it.

use crate::status::JointStatus;

/// Version of this header: major.
pub const JOINT_VERSION_MAJOR: u32 = 0;
/// Version of this header: minor.
pub const JOINT_VERSION_MINOR: u32 = 1;
/// Version of this header: patch.
pub const JOINT_VERSION_PATCH: u32 = 0;
/// Version of the interface between caller and library. It grows when a struct, an enumeration or the meaning of a
/// field changes; sizes are checked in addition.
pub const JOINT_ABI_VERSION: u32 = 1;

/// Folds the size of a type into `JOINT_ABI`.
const fn fold(abi: u32, bytes: usize) -> u32 {
    abi.wrapping_mul(31).wrapping_add(bytes as u32)
}

macro_rules! abi {
    ($($crossing:ident),* $(,)?) => {{
        let mut abi = JOINT_ABI_VERSION;
        $(abi = fold(abi, size_of::<crate::$crossing>());)*
        abi
    }};
}

/// `JOINT_ABI` of this library: version and sizes of all structs of the header, in the order of the header's sum.
const ABI: u32 = abi!(
    JointTablesFacts,
    JointReading,
    JointSamples,
    JointEstimate,
    JointShaft,
    JointEstimates,
    JointMotion,
    JointImpedance,
    JointTorque,
    JointProbed,
    JointPlantOutputs,
    JointWiringStep,
    JointWiringVerdicts,
    JointObserver,
    JointCompensation,
    JointProbe,
    JointPlant,
    JointWiring,
);

/// Rejects a caller whose header has another version.
pub(crate) fn has_abi(abi: u32) -> Result<(), JointStatus> {
    if abi == ABI { Ok(()) } else { Err(JointStatus::OtherHeader) }
}

/// Version of the library: major in bits 16 to 23, minor in bits 8 to 15, patch in bits 0 to 7.
#[unsafe(no_mangle)]
pub extern "C" fn joint_version() -> u32 {
    JOINT_VERSION_MAJOR << 16 | JOINT_VERSION_MINOR << 8 | JOINT_VERSION_PATCH
}
