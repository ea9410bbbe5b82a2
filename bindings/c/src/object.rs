//! Objects in the caller's storage: how they are told from storage that holds none, and how pointers are checked.

use core::mem::MaybeUninit;

use table_blob::{Blob, Header};

use crate::status::JointStatus;
use crate::version::has_abi;

/// A kind of object: the type of its storage in the header, and what lies in it.
pub trait Kind: Sized {
    /// What the header declares.
    type Storage;
    /// Tells kinds apart: four bytes alike, which a processor of these boards compares with in one instruction.
    const MARK: u32;
}

/// What lies at the beginning of the storage. The mark has the address in it, so that storage which was copied is not taken
/// for an object.
#[repr(C)]
pub struct Object<K> {
    mark: usize,
    /// Where those tables are.
    tables: *const Header,
    /// Of the tables that it was started from.
    tables_digest: u64,
    /// The object itself.
    pub value: K,
}

impl<K> Object<K> {
    /// Whether another object was started from the same tables, or from others of the same digest.
    #[inline(always)]
    pub fn has_tables_of<L>(&self, other: &Object<L>) -> bool {
        // One look says it where there are no two copies of the tables.
        self.tables == other.tables || same(self.tables_digest, other.tables_digest)
    }
}

#[cold]
fn same(one: u64, other: u64) -> bool {
    one == other
}

fn mark<K: Kind>(at: *const K::Storage) -> usize {
    K::MARK as usize ^ at.addr()
}

/// A pointer that something can be read from or written to.
#[inline(always)]
pub fn usable<T>(pointer: *const T) -> Result<(), JointStatus> {
    if !pointer.is_null() && pointer.is_aligned() { Ok(()) } else { Err(unusable(pointer.is_null())) }
}

/// Why a pointer is of no use; out of the way of those that are.
#[cold]
fn unusable(is_null: bool) -> JointStatus {
    if is_null { JointStatus::NullPointer } else { JointStatus::Misaligned }
}

/// A copy of what the caller points to.
///
/// # Safety
/// What is not NULL points to a value that nobody writes to meanwhile.
#[inline(always)]
pub unsafe fn read<T: Copy>(from: *const T) -> Result<T, JointStatus> {
    usable(from)?;
    // SAFETY: aligned and not NULL; the rest is the caller's word.
    Ok(unsafe { from.read() })
}

/// The object in a storage, if it was started there.
///
/// # Safety
/// What is not NULL points to a storage of this type that nobody else uses meanwhile.
#[inline(always)]
pub unsafe fn open<'a, K: Kind>(storage: *mut K::Storage) -> Result<&'a mut Object<K>, JointStatus> {
    usable(storage)?;
    // SAFETY: aligned and not NULL; the rest is the caller's word.
    unsafe { marked::<K>(storage) }.ok_or(JointStatus::NotStarted)
}

/// The same behind a pointer that is known to be aligned and not NULL.
///
/// # Safety
/// It is, and it points to a storage of this type that nobody else uses meanwhile.
#[inline(always)]
pub unsafe fn marked<'a, K: Kind>(storage: *mut K::Storage) -> Option<&'a mut Object<K>> {
    let object = storage.cast::<Object<K>>();
    // SAFETY: aligned, not NULL, and large enough by its type; any bits are a mark.
    if unsafe { (*object).mark } ^ storage.addr() != K::MARK as usize {
        return None;
    }
    // SAFETY: the mark is put there by `start` alone, after everything else.
    Some(unsafe { &mut *object })
}

/// The same for reading.
///
/// # Safety
/// As for [`open`], but others may read.
#[inline(always)]
pub unsafe fn look<'a, K: Kind>(storage: *const K::Storage) -> Result<&'a Object<K>, JointStatus> {
    // SAFETY: the same promise; it is only read from.
    unsafe { open::<K>(storage.cast_mut()) }.map(|object| &*object)
}

/// Storage of an object, as a caller hands it over to have an object started in it.
#[derive(Debug, Clone, Copy)]
pub struct Storage<S> {
    /// Pointer to the storage.
    pub at: *mut S,
    /// Its size, by the caller's word [B].
    pub bytes: usize,
    /// `JOINT_ABI` of the caller's header.
    pub abi: u32,
}

/// Makes an object from tables where it stays: the stack of a caller may have no room for a second one. `make` writes to its
/// place if it succeeds, and only then.
///
/// # Safety
/// Storage that is not NULL is of `bytes` and in nobody else's use; tables that are not NULL are of `tables_bytes`, and stay
/// as they are for as long as the object is used.
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
    // SAFETY: the caller's word on the tables.
    let blob = unsafe { blob(tables, tables_bytes) }?;
    let object = storage.at.cast::<Object<MaybeUninit<K>>>();
    // SAFETY: aligned, large enough, and the caller's to give; a place without a value may hold any bits.
    make(&blob, unsafe { &mut (*object).value })?;
    let tables = blob.header();
    // SAFETY: likewise; the mark comes last, when everything else is in place.
    unsafe {
        (&raw mut (*object).tables).write(tables);
        (&raw mut (*object).tables_digest).write(tables.digest);
        (&raw mut (*object).mark).write(mark::<K>(storage.at));
    }
    Ok(())
}

/// The tables that the caller points to.
///
/// # Safety
/// What is not NULL is of so many bytes and stays as it is.
pub unsafe fn blob(tables: *const u64, bytes: usize) -> Result<Blob<'static>, JointStatus> {
    usable(tables)?;
    if bytes == 0 || !bytes.is_multiple_of(size_of::<u64>()) || bytes > isize::MAX as usize {
        return Err(JointStatus::WrongSize);
    }
    // SAFETY: aligned, not NULL, initialised as all constants are, and of this size by the caller's word.
    let words = unsafe { core::slice::from_raw_parts(tables, bytes / size_of::<u64>()) };
    Ok(Blob::open(words)?)
}
