//! Values with the memory layout of C, written and checked field by field.

use model_core::gears::tables::{Block, DampingLaw, Scheme};

/// Value of a fixed layout. Implemented only here and by [`structs!`](crate::layout): [`cast`] relies on it.
pub trait Fixed {
    /// Writes the value's bytes; padding is left unchanged.
    #[cfg(feature = "design")]
    fn write_to(&self, place: &mut [u8]);

    /// Returns whether bytes are a valid value. All bytes are valid numbers, but not all are valid booleans or
    /// variants.
    fn is_valid(bytes: &[u8]) -> bool;

    /// Appends a description of the layout: names, offsets, types.
    #[cfg(test)]
    fn describe(name: &str, offset: usize, out: &mut Vec<String>);
}

/// Value in place, if the words are a valid one.
pub fn cast<T: Fixed>(words: &[u64]) -> Option<&T> {
    const { assert!(align_of::<T>() <= align_of::<u64>()) };
    // SAFETY: the same memory and lifetime, seen as bytes, all of which are initialised.
    let bytes = unsafe { core::slice::from_raw_parts(words.as_ptr().cast::<u8>(), size_of_val(words)) };
    if bytes.len() != size_of::<T>().next_multiple_of(size_of::<u64>()) || !T::is_valid(bytes) {
        return None;
    }
    // SAFETY: the size of the value, aligned for it, and every field was checked.
    Some(unsafe { &*words.as_ptr().cast::<T>() })
}

macro_rules! numbers {
    ($($number:ty),*) => {$(
        impl Fixed for $number {
            #[cfg(feature = "design")]
            fn write_to(&self, place: &mut [u8]) {
                place[..size_of::<Self>()].copy_from_slice(&self.to_le_bytes());
            }

            fn is_valid(_: &[u8]) -> bool {
                true
            }

            #[cfg(test)]
            fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
                out.push(format!("{offset} {name}: {}", stringify!($number)));
            }
        }
    )*};
}

numbers!(u8, u16, u32, u64, i32, i64, f32);

impl Fixed for bool {
    #[cfg(feature = "design")]
    fn write_to(&self, place: &mut [u8]) {
        place[0] = u8::from(*self);
    }

    fn is_valid(bytes: &[u8]) -> bool {
        matches!(bytes, [0 | 1, ..])
    }

    #[cfg(test)]
    fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
        out.push(format!("{offset} {name}: bool"));
    }
}

macro_rules! variants {
    ($kind:ty, $all:pat) => {
        impl Fixed for $kind {
            #[cfg(feature = "design")]
            fn write_to(&self, place: &mut [u8]) {
                (*self as u32).write_to(place);
            }

            fn is_valid(bytes: &[u8]) -> bool {
                matches!(bytes, [$all, 0, 0, 0, ..])
            }

            #[cfg(test)]
            fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
                out.push(format!("{offset} {name}: {}", stringify!($kind)));
            }
        }
    };
}

// A board has no other scheme.
variants!(Scheme, 0);
variants!(DampingLaw, 0 | 1);

impl<T: Fixed, const N: usize> Fixed for [T; N] {
    #[cfg(feature = "design")]
    fn write_to(&self, place: &mut [u8]) {
        for (index, value) in self.iter().enumerate() {
            value.write_to(&mut place[index * size_of::<T>()..]);
        }
    }

    fn is_valid(bytes: &[u8]) -> bool {
        (0..N).all(|index| bytes.get(index * size_of::<T>()..).is_some_and(T::is_valid))
    }

    #[cfg(test)]
    fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
        T::describe(&format!("{name}[{N}]"), offset, out);
    }
}

// Columns in order, as nalgebra stores them.
impl<const R: usize, const C: usize> Fixed for Block<f32, R, C> {
    #[cfg(feature = "design")]
    fn write_to(&self, place: &mut [u8]) {
        self.0.data.0.write_to(place);
    }

    fn is_valid(_: &[u8]) -> bool {
        true
    }

    #[cfg(test)]
    fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
        out.push(format!("{offset} {name}: {R} x {C}"));
    }
}
