//! State of an object as words without addresses: a head that identifies it, then the words of the core.

use model_core::numbers::digest::{START, chain};
use model_core::numbers::state_words::{Layout, Reader, Writer};

use crate::object::usable;
use crate::status::JointStatus;

/// Words of the head: kind; number of words and digest of the layout; digest of the tables; digest of all other words. Wide
/// numbers have the low word first.
pub const HEAD: usize = 8;
/// Words of the head before the digest of the words.
const IDENTITY: usize = HEAD - 2;

/// What a state must agree with to be loaded.
#[derive(Debug, Clone, Copy)]
pub struct Identity {
    /// Kind of object.
    pub kind: u32,
    /// Layout of the words after the head.
    pub layout: Layout,
    /// Digest of the object's tables.
    pub tables: u64,
}

impl Identity {
    /// Head without the digest of the words.
    fn words(&self) -> [u32; IDENTITY] {
        let [layout, tables] = [self.layout.digest, self.tables];
        let halves = |wide: u64| [wide as u32, (wide >> 32) as u32];
        let ([a, b], [c, d]) = (halves(layout), halves(tables));
        [self.kind, self.layout.words as u32, a, b, c, d]
    }
}

/// Number of two words.
fn wide(low: u32, high: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

/// Digest of all words but those of the digest.
fn digest_of(identity: &[u32], content: &[u32]) -> u64 {
    identity.iter().chain(content).fold(START, |running, word| chain(running, u64::from(*word)))
}

/// Writes a state of `N` words; words beyond its layout are zero.
///
/// # Safety
/// A pointer that is not NULL is valid for writes of `words` words that nobody else uses meanwhile.
pub unsafe fn save<const N: usize>(
    state: *mut u32,
    words: usize,
    identity: &Identity,
    write: impl FnOnce(&mut Writer),
) -> Result<(), JointStatus> {
    usable(state)?;
    if words != N {
        return Err(JointStatus::WrongSize);
    }
    // SAFETY: aligned, not NULL, and valid for writes of this many words.
    unsafe { state.write_bytes(0, N) };
    // SAFETY: as above, and initialised by now.
    let state = unsafe { &mut *state.cast::<[u32; N]>() };
    let (head, content) = state.split_first_chunk_mut::<HEAD>().ok_or(JointStatus::WrongSize)?;
    write(&mut Writer::new(content));
    let own = identity.words();
    let digest = digest_of(&own, content);
    let mut to = Writer::new(head);
    own.iter().chain(&[digest as u32, (digest >> 32) as u32]).for_each(|word| to.word(*word));
    Ok(())
}

/// Reads a state of `N` words, unless it is damaged or of another kind, layout or joint. `read` cannot fail.
///
/// # Safety
/// A pointer that is not NULL points to `words` words that nobody writes to meanwhile.
pub unsafe fn load<const N: usize>(
    state: *const u32,
    words: usize,
    identity: &Identity,
    read: impl FnOnce(&mut Reader),
) -> Result<(), JointStatus> {
    usable(state)?;
    if words != N {
        return Err(JointStatus::WrongSize);
    }
    // SAFETY: aligned, not NULL, and this many words by the caller's promise.
    let state = unsafe { &*state.cast::<[u32; N]>() };
    let (head, content) = state.split_first_chunk::<HEAD>().ok_or(JointStatus::WrongSize)?;
    let [kind, size, layout_low, layout_high, tables_low, tables_high, digest_low, digest_high] = *head;
    if kind != identity.kind {
        return Err(JointStatus::NotAState);
    }
    // Numbers and no arrays: arrays are compared by memcmp, which a program without a C library does not have.
    if size != identity.layout.words as u32 || wide(layout_low, layout_high) != identity.layout.digest {
        return Err(JointStatus::WrongStateVersion);
    }
    if wide(tables_low, tables_high) != identity.tables {
        return Err(JointStatus::OtherTables);
    }
    if wide(digest_low, digest_high) != digest_of(&identity.words(), content) {
        return Err(JointStatus::DamagedState);
    }
    read(&mut Reader::new(content));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: Layout = Layout { words: 2, digest: 5 };
    const IDENTITY: Identity = Identity { kind: 3, layout: LAYOUT, tables: 7 << 33 };

    fn saved() -> [u32; 11] {
        let mut words = [9; 11];
        // SAFETY: a place of this many words.
        let result = unsafe {
            save::<11>(words.as_mut_ptr(), 11, &IDENTITY, |to| [4, 6].into_iter().for_each(|word| to.word(word)))
        };
        assert_eq!(result, Ok(()));
        words
    }

    fn loaded(words: &[u32; 11], identity: &Identity) -> Result<[u32; 2], JointStatus> {
        let mut found = [0; 2];
        // SAFETY: this many words.
        unsafe { load::<11>(words.as_ptr(), 11, identity, |from| found = [from.word(), from.word()]) }.map(|()| found)
    }

    #[test]
    fn state_is_loaded_as_it_was_saved() {
        assert_eq!(loaded(&saved(), &IDENTITY), Ok([4, 6]));
        assert_eq!(saved()[10], 0);
    }

    #[test]
    fn state_of_another_object_is_refused() {
        let refused = |identity: Identity| loaded(&saved(), &identity).unwrap_err();
        assert_eq!(refused(Identity { kind: 4, ..IDENTITY }), JointStatus::NotAState);
        assert_eq!(refused(Identity { tables: 8, ..IDENTITY }), JointStatus::OtherTables);
        assert_eq!(
            refused(Identity { layout: Layout { digest: 6, ..LAYOUT }, ..IDENTITY }),
            JointStatus::WrongStateVersion
        );
        assert_eq!(
            refused(Identity { layout: Layout { words: 1, ..LAYOUT }, ..IDENTITY }),
            JointStatus::WrongStateVersion
        );
    }

    #[test]
    fn any_damaged_word_is_refused() {
        for word in 0..11 {
            let mut words = saved();
            words[word] ^= 1 << word;
            assert!(loaded(&words, &IDENTITY).is_err(), "{word}");
        }
    }
}
