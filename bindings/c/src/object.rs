//! Objects in the caller's storage: recognition of started objects, and checks of pointers.

use core::mem::MaybeUninit;

use table_blob::{Blob, Header};

use crate::status::JointStatus;
use crate::version::has_abi;

/// Kind of object: its storage in the header, and its content.
pub trait Kind: Sized {
    /// Storage type of the header.
    type Storage;
    /// Mark of the kind: four equal bytes, which a Cortex-M can compare with in one instruction.
    const MARK: u32;
}

/// Content of a storage. The mark includes the address, so that copied storage is not recognised as an object.
#[repr(C)]
pub struct Object<K> {
    mark: usize,
    /// Address of the tables.
    tables: *const Header,
    /// Digest of the tables that the object was started from.
    tables_digest: u64,
    /// Value of the object.
    pub value: K,
}

impl<K> Object<K> {
    /// Digest of the tables that the object was started from.
    pub fn tables_digest(&self) -> u64 {
        self.tables_digest
    }

    /// Returns whether another object was started from the same tables, or from tables with the same digest.
    #[inline(always)]
    pub fn has_tables_of<L>(&self, other: &Object<L>) -> bool {
        // Without copies of the tables the addresses are equal.
        self.tables == other.tables || digests_equal(self.tables_digest, other.tables_digest)
    }
}

#[cold]
fn digests_equal(one: u64, other: u64) -> bool {
    one == other
}

fn mark<K: Kind>(at: *const K::Storage) -> usize {
    K::MARK as usize ^ at.addr()
}

/// Checks that a pointer is not NULL and is aligned.
#[inline(always)]
pub fn usable<T>(pointer: *const T) -> Result<(), JointStatus> {
    if !pointer.is_null() && pointer.is_aligned() { Ok(()) } else { Err(unusable(pointer.is_null())) }
}

/// Status for an unusable pointer, kept out of the path of usable ones.
#[cold]
fn unusable(is_null: bool) -> JointStatus {
    if is_null { JointStatus::NullPointer } else { JointStatus::Misaligned }
}

/// Copies the value behind a pointer.
///
/// # Safety
/// A pointer that is not NULL points to a value that nobody writes to meanwhile.
#[inline(always)]
pub unsafe fn read<T: Copy>(from: *const T) -> Result<T, JointStatus> {
    usable(from)?;
    // SAFETY: aligned and not NULL; the rest is the caller's promise.
    Ok(unsafe { from.read() })
}

/// Object in a storage, if it was started there.
///
/// # Safety
/// A pointer that is not NULL points to a storage of this type that nobody else uses meanwhile.
#[inline(always)]
pub unsafe fn open<'a, K: Kind>(storage: *mut K::Storage) -> Result<&'a mut Object<K>, JointStatus> {
    usable(storage)?;
    // SAFETY: aligned and not NULL; the rest is the caller's promise.
    unsafe { started_object::<K>(storage) }.ok_or(JointStatus::NotStarted)
}

/// Object in a storage whose pointer is known to be aligned and not NULL.
///
/// # Safety
/// The pointer is aligned and not NULL, and points to a storage of this type that nobody else uses meanwhile.
#[inline(always)]
pub unsafe fn started_object<'a, K: Kind>(storage: *mut K::Storage) -> Option<&'a mut Object<K>> {
    let object = storage.cast::<Object<K>>();
    // SAFETY: aligned, not NULL, and large enough by its type; every bit pattern is a valid mark.
    if unsafe { (*object).mark } ^ storage.addr() != K::MARK as usize {
        return None;
    }
    // SAFETY: only `start` writes the mark, after everything else.
    Some(unsafe { &mut *object })
}

/// Object in a storage, for reading.
///
/// # Safety
/// As for [`open`], but others may read.
#[inline(always)]
pub unsafe fn open_shared<'a, K: Kind>(storage: *const K::Storage) -> Result<&'a Object<K>, JointStatus> {
    // SAFETY: the caller's promise of this function; the object is only read.
    unsafe { open::<K>(storage.cast_mut()) }.map(|object| &*object)
}

/// Storage in which a caller wants an object to be started.
#[derive(Debug, Clone, Copy)]
pub struct Storage<S> {
    /// Pointer to the storage.
    pub at: *mut S,
    /// Size of the storage, as stated by the caller [B].
    pub bytes: usize,
    /// `JOINT_ABI` of the caller's header.
    pub abi: u32,
}

/// Starts an object from tables in its final place, since the caller's stack may have no room for a second copy. `make`
/// writes to the place only if it succeeds.
///
/// # Safety
/// Storage that is not NULL has `bytes` bytes and no other user; tables that are not NULL have `tables_bytes` bytes and
/// stay unchanged for as long as the object is used.
pub unsafe fn start<K: Kind>(
    storage: Storage<K::Storage>,
    tables: *const u64,
    tables_bytes: usize,
    make: impl FnOnce(&Blob<'static>, &mut MaybeUninit<K>) -> Result<(), JointStatus>,
) -> Result<(), JointStatus> {
    const { assert!(size_of::<Object<K>>() <= size_of::<K::Storage>()) };
    const { assert!(align_of::<Object<K>>() <= align_of::<K::Storage>()) };
    usable(storage.at)?;
    has_abi(storage.abi)?;
    if storage.bytes != size_of::<K::Storage>() {
        return Err(JointStatus::WrongSize);
    }
    // SAFETY: the caller's promise about the tables.
    let blob = unsafe { blob(tables, tables_bytes) }?;
    let object = storage.at.cast::<Object<MaybeUninit<K>>>();
    // SAFETY: aligned, large enough, and valid for writes; uninitialised storage may hold any bits.
    make(&blob, unsafe { &mut (*object).value })?;
    let tables = blob.header();
    // SAFETY: as above; the mark is written last, when everything else is in place.
    unsafe {
        (&raw mut (*object).tables).write(tables);
        (&raw mut (*object).tables_digest).write(tables.digest);
        (&raw mut (*object).mark).write(mark::<K>(storage.at));
    }
    Ok(())
}

/// Opens the tables behind a pointer.
///
/// # Safety
/// A pointer that is not NULL points to `bytes` bytes that stay unchanged.
pub unsafe fn blob(tables: *const u64, bytes: usize) -> Result<Blob<'static>, JointStatus> {
    usable(tables)?;
    if bytes == 0 || !bytes.is_multiple_of(size_of::<u64>()) || bytes > isize::MAX as usize {
        return Err(JointStatus::WrongSize);
    }
    // SAFETY: aligned, not NULL, initialised as all constants are, and of this size by the caller's promise.
    let words = unsafe { core::slice::from_raw_parts(tables, bytes / size_of::<u64>()) };
    Ok(Blob::open(words)?)
}
