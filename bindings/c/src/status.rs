//! Status of a call: a number with a name and a text.

use core::ffi::c_char;

use model_core::observer::MemoryError;
use table_blob::BlobError;

/// Result of every function. Unless it is `JOINT_STATUS_OK`, nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum JointStatus {
    /// Done.
    Ok = 0,
    /// A pointer is NULL.
    NullPointer = 1,
    /// A pointer is not aligned for its type.
    Misaligned = 2,
    /// A size differs from the one that the header states.
    WrongSize = 3,
    /// The object was not started, was moved, or is of another kind.
    NotStarted = 4,
    /// A number is infinite or not a number.
    NotFinite = 5,
    /// The data are no tables.
    NotTables = 6,
    /// The tables have another version than this library.
    WrongTablesVersion = 7,
    /// The digest of the tables does not match: they are damaged.
    DamagedTables = 8,
    /// The tables were made without this part.
    MissingTables = 9,
    /// Two objects, or an object and a state, are of different tables.
    OtherTables = 10,
    /// The data are no memory of an observer.
    NotAMemory = 11,
    /// The memory has another version of the observer.
    WrongMemoryVersion = 12,
    /// The digest of the memory does not match: it is damaged.
    DamagedMemory = 13,
    /// The memory belongs to another joint or to other encoders.
    OtherJoint = 14,
    /// The memory holds a number that no joint of this design can have.
    MemoryOutOfRange = 15,
    /// A fraction of a turn is more than a turn.
    FractionOutOfRange = 16,
    /// The caller was compiled with a header of another version.
    OtherHeader = 17,
    /// The observer has been stepped; a memory is loaded before the first step.
    AlreadyStepped = 18,
    /// The data are no state of an object of this kind.
    NotAState = 19,
    /// The state has the layout of another version of the library.
    WrongStateVersion = 20,
    /// The digest of the state does not match: it is damaged.
    DamagedState = 21,
}

impl From<BlobError> for JointStatus {
    fn from(error: BlobError) -> Self {
        match error {
            BlobError::NotTables => Self::NotTables,
            BlobError::WrongVersion => Self::WrongTablesVersion,
            BlobError::WrongSize => Self::WrongSize,
            BlobError::Damaged => Self::DamagedTables,
            BlobError::Missing => Self::MissingTables,
        }
    }
}

impl From<MemoryError> for JointStatus {
    fn from(error: MemoryError) -> Self {
        match error {
            MemoryError::NotAMemory => Self::NotAMemory,
            MemoryError::WrongVersion => Self::WrongMemoryVersion,
            MemoryError::Damaged => Self::DamagedMemory,
            MemoryError::OtherJoint => Self::OtherJoint,
            MemoryError::OutOfRange => Self::MemoryOutOfRange,
        }
    }
}

impl From<Result<(), JointStatus>> for JointStatus {
    fn from(result: Result<(), Self>) -> Self {
        result.err().unwrap_or(Self::Ok)
    }
}

/// Names and texts by number.
const TEXTS: [[&core::ffi::CStr; 2]; 22] = [
    [c"JOINT_STATUS_OK", c"done"],
    [c"JOINT_STATUS_NULL_POINTER", c"a pointer is NULL: give the object that the header asks for"],
    [c"JOINT_STATUS_MISALIGNED", c"a pointer is not aligned for its type: use the header's types, not bytes"],
    [c"JOINT_STATUS_WRONG_SIZE", c"a size differs from the one in the header: pass sizeof the header's type, and build header and library from one archive"],
    [c"JOINT_STATUS_NOT_STARTED", c"the object was not started, was moved, or is of another kind: start it where it stays"],
    [c"JOINT_STATUS_NOT_FINITE", c"a number is infinite or not a number: check its source"],
    [c"JOINT_STATUS_NOT_TABLES", c"the data are no tables: link the file that `joint tables` wrote"],
    [c"JOINT_STATUS_WRONG_TABLES_VERSION", c"the tables have another version than the library: write them again with its `joint tables`"],
    [c"JOINT_STATUS_DAMAGED_TABLES", c"the tables are damaged: flash them again"],
    [c"JOINT_STATUS_MISSING_TABLES", c"the tables were made without this part: write them again with it"],
    [c"JOINT_STATUS_OTHER_TABLES", c"two objects, or an object and a state, are of different tables: start both from the same"],
    [c"JOINT_STATUS_NOT_A_MEMORY", c"this is no memory of an observer: save one first"],
    [c"JOINT_STATUS_WRONG_MEMORY_VERSION", c"the memory is of another version of the observer: let it learn again and save anew"],
    [c"JOINT_STATUS_DAMAGED_MEMORY", c"the memory is damaged: load a copy, or let the observer learn again"],
    [c"JOINT_STATUS_OTHER_JOINT", c"the memory belongs to another joint, to other encoders, or to an observer with or without maps"],
    [c"JOINT_STATUS_MEMORY_OUT_OF_RANGE", c"the memory holds a number that no joint of this design can have: let the observer learn again"],
    [c"JOINT_STATUS_FRACTION_OUT_OF_RANGE", c"a fraction of a turn exceeds one turn: give turns, not counts, degrees or radians, and whole turns in `turns`"],
    [c"JOINT_STATUS_OTHER_HEADER", c"the caller was compiled with a header of another version: take header and library from one archive"],
    [c"JOINT_STATUS_ALREADY_STEPPED", c"the observer was already stepped: start it again, and load before the first step"],
    [c"JOINT_STATUS_NOT_A_STATE", c"this is no state of an object of this kind, or it is of an observer with or without maps: save one first"],
    [c"JOINT_STATUS_WRONG_STATE_VERSION", c"the state is of another version of the library: start the object again"],
    [c"JOINT_STATUS_DAMAGED_STATE", c"the state is damaged: load a copy, or start the object again"],
];

fn status_text(status: u32, which: usize) -> *const c_char {
    let unknown = [c"JOINT_STATUS_UNKNOWN", c"this is no status of this library"];
    let [name, text] = TEXTS.get(status as usize).copied().unwrap_or(unknown);
    if which == 0 { name.as_ptr() } else { text.as_ptr() }
}

/// The name of a status, such as "JOINT_STATUS_OK"; never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn joint_status_name(status: u32) -> *const c_char {
    status_text(status, 0)
}

/// Meaning of a status and its remedy, in one sentence; never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn joint_status_text(status: u32) -> *const c_char {
    status_text(status, 1)
}
