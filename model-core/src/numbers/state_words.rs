//! State as 32-bit words without addresses, padding or invalid values: a copy that another object of the same tables
//! continues from with equal bits, in another process too.
//!
//! A type occupies a fixed number of words; the words of an absent value are zero. Reading cannot fail: a word that stands
//! for no variant gives the first one. The caller detects damaged words and words of another layout.

use parameters::ContactState;

use super::digest;

/// Number of words of a type, and a digest of its fields' names in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Number of words.
    pub words: usize,
    /// Digest of names and layouts of the fields.
    pub digest: u64,
}

impl Layout {
    /// Layout without fields.
    pub const EMPTY: Self = Self { words: 0, digest: digest::START };

    /// Layout of a scalar.
    const fn scalar(words: usize) -> Self {
        Self { words, digest: words as u64 }
    }

    /// Adds a field or the name of a variant.
    #[must_use]
    pub const fn with(self, name: &str, field: Self) -> Self {
        let (bytes, mut at, mut running) = (name.as_bytes(), 0, self.digest);
        while at < bytes.len() {
            running = digest::chain(running, bytes[at] as u64);
            at += 1;
        }
        running = digest::chain(digest::chain(running, field.words as u64), field.digest);
        Self { words: self.words + field.words, digest: running }
    }

    /// Layout of equal elements.
    const fn repeated(self, count: usize) -> Self {
        Self { words: self.words * count, digest: digest::chain(self.digest, count as u64) }
    }
}

/// Layout of a field, which the type of its accessor tells.
pub const fn layout_of<S, F: StateWords>(_: fn(&S) -> &F) -> Layout {
    F::LAYOUT
}

/// Words being written, one after the other.
#[derive(Debug)]
pub struct Writer<'words>(core::slice::IterMut<'words, u32>);

impl<'words> Writer<'words> {
    /// Writes from the first word on. Words beyond the last one are discarded.
    pub fn new(words: &'words mut [u32]) -> Self {
        Self(words.iter_mut())
    }

    /// Writes one word.
    pub fn word(&mut self, word: u32) {
        if let Some(place) = self.0.next() {
            *place = word;
        }
    }
}

/// Words being read, one after the other.
#[derive(Debug)]
pub struct Reader<'words>(core::slice::Iter<'words, u32>);

impl<'words> Reader<'words> {
    /// Reads from the first word on. Words beyond the last one are zero.
    pub fn new(words: &'words [u32]) -> Self {
        Self(words.iter())
    }

    /// Reads one word.
    pub fn word(&mut self) -> u32 {
        self.0.next().copied().unwrap_or(0)
    }
}

/// Type that is written as words and read again.
pub trait StateWords: Sized {
    /// Number of words, and digest of the fields' names.
    const LAYOUT: Layout;

    /// Writes the value as `LAYOUT.words` words.
    fn write(&self, to: &mut Writer);

    /// Reads a value.
    fn read(from: &mut Reader) -> Self;

    /// Reads a value field by field in its place, with less stack than a second value would need.
    fn read_in_place(&mut self, from: &mut Reader) {
        *self = Self::read(from);
    }
}

macro_rules! scalars {
    ($($scalar:ty: $write:expr, $read:expr;)+) => {
        $(impl StateWords for $scalar {
            const LAYOUT: Layout = Layout::scalar(1);

            fn write(&self, to: &mut Writer) {
                to.word($write(*self));
            }

            fn read(from: &mut Reader) -> Self {
                $read(from.word())
            }
        })+
    };
}

scalars! {
    bool: u32::from, |word| word != 0;
    u8: u32::from, |word| word as u8;
    u16: u32::from, |word| word as u16;
    u32: |value| value, |word| word;
    i8: |value| value as u32, |word| word as i8;
    i16: |value| value as u32, |word| word as i16;
    i32: |value| value as u32, |word| word as i32;
    f32: f32::to_bits, f32::from_bits;
}

macro_rules! wide_scalars {
    ($($scalar:ty: $write:expr, $read:expr;)+) => {
        $(impl StateWords for $scalar {
            const LAYOUT: Layout = Layout::scalar(2);

            fn write(&self, to: &mut Writer) {
                let bits: u64 = $write(*self);
                to.word(bits as u32);
                to.word((bits >> 32) as u32);
            }

            fn read(from: &mut Reader) -> Self {
                let low = u64::from(from.word());
                $read(low | u64::from(from.word()) << 32)
            }
        })+
    };
}

wide_scalars! {
    u64: |value| value, |bits| bits;
    i64: |value| value as u64, |bits| bits as i64;
    f64: f64::to_bits, f64::from_bits;
}

impl<V: StateWords, const N: usize> StateWords for [V; N] {
    const LAYOUT: Layout = V::LAYOUT.repeated(N);

    fn write(&self, to: &mut Writer) {
        self.iter().for_each(|value| value.write(to));
    }

    fn read(from: &mut Reader) -> Self {
        core::array::from_fn(|_| V::read(from))
    }

    fn read_in_place(&mut self, from: &mut Reader) {
        self.iter_mut().for_each(|value| value.read_in_place(from));
    }
}

impl<V: StateWords> StateWords for Option<V> {
    const LAYOUT: Layout = Layout::EMPTY.with("is_some", bool::LAYOUT).with("value", V::LAYOUT);

    fn write(&self, to: &mut Writer) {
        self.is_some().write(to);
        match self {
            Some(value) => value.write(to),
            None => (0..V::LAYOUT.words).for_each(|_| to.word(0)),
        }
    }

    fn read(from: &mut Reader) -> Self {
        let is_some = bool::read(from);
        let value = V::read(from);
        is_some.then_some(value)
    }
}

impl<A: StateWords, B: StateWords> StateWords for (A, B) {
    const LAYOUT: Layout = Layout::EMPTY.with("0", A::LAYOUT).with("1", B::LAYOUT);

    fn write(&self, to: &mut Writer) {
        self.0.write(to);
        self.1.write(to);
    }

    fn read(from: &mut Reader) -> Self {
        (A::read(from), B::read(from))
    }
}

/// Implements `StateWords` for a struct by its fields, or for an enum without fields by its variants. A missing field or
/// variant does not compile.
macro_rules! state_words {
    (struct $name:ident { $($field:ident),+ $(,)? }) => {
        $crate::numbers::state_words::state_words!(@fields [] [$name] $($field)+);
    };
    (struct $name:ident<T> { $($field:ident),+ $(,)? }) => {
        $crate::numbers::state_words::state_words!(@fields [T: $crate::numbers::Real] [$name<T>] $($field)+);
    };
    (struct $name:ident<T, P> { $($field:ident),+ $(,)? }) => {
        $crate::numbers::state_words::state_words!(
            @fields [T: $crate::numbers::Real, const P: usize] [$name<T, P>] $($field)+
        );
    };
    (@fields [$($generics:tt)*] [$type:ty] $($field:ident)+) => {
        impl<$($generics)*> $crate::numbers::state_words::StateWords for $type {
            const LAYOUT: $crate::numbers::state_words::Layout = $crate::numbers::state_words::Layout::EMPTY
                $(.with(stringify!($field), $crate::numbers::state_words::layout_of(|state: &Self| &state.$field)))+;

            fn write(&self, to: &mut $crate::numbers::state_words::Writer) {
                let Self { $($field),+ } = self;
                $($crate::numbers::state_words::StateWords::write($field, to);)+
            }

            fn read(from: &mut $crate::numbers::state_words::Reader) -> Self {
                $(let $field = $crate::numbers::state_words::StateWords::read(from);)+
                Self { $($field),+ }
            }

            fn read_in_place(&mut self, from: &mut $crate::numbers::state_words::Reader) {
                let Self { $($field),+ } = self;
                $($crate::numbers::state_words::StateWords::read_in_place($field, from);)+
            }
        }
    };
    (enum $name:ident { $first:ident $(, $variant:ident)* $(,)? }) => {
        impl $crate::numbers::state_words::StateWords for $name {
            const LAYOUT: $crate::numbers::state_words::Layout = $crate::numbers::state_words::Layout::EMPTY
                .with(stringify!($first), $crate::numbers::state_words::Layout::EMPTY)
                $(.with(stringify!($variant), $crate::numbers::state_words::Layout::EMPTY))*
                .with("variant", <u32 as $crate::numbers::state_words::StateWords>::LAYOUT);

            fn write(&self, to: &mut $crate::numbers::state_words::Writer) {
                match self {
                    Self::$first => to.word(Self::$first as u32),
                    $(Self::$variant => to.word(Self::$variant as u32),)*
                }
            }

            fn read(from: &mut $crate::numbers::state_words::Reader) -> Self {
                let word = from.word();
                $(if word == Self::$variant as u32 {
                    return Self::$variant;
                })*
                Self::$first
            }
        }
    };
}

pub(crate) use state_words;

state_words! { enum ContactState { Separated, DriveSide, BackSide } }

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Side {
        Near = 1,
        Far = 2,
    }

    state_words! { enum Side { Near, Far } }

    #[derive(Debug, Clone, Copy, PartialEq)]
    struct All {
        wide: i64,
        small: [i8; 2],
        side: Option<Side>,
        pair: (bool, f64),
    }

    state_words! { struct All { wide, small, side, pair } }

    #[test]
    fn values_are_read_as_they_were_written() {
        let all = All { wide: -3 << 40, small: [-1, 127], side: Some(Side::Far), pair: (true, -0.0) };
        assert_eq!(All::LAYOUT.words, 9);
        let mut words = [7; 9];
        all.write(&mut Writer::new(&mut words));
        assert_eq!(All::read(&mut Reader::new(&words)), all);
        let mut other = All { wide: 1, small: [0; 2], side: None, pair: (false, 1.0) };
        other.read_in_place(&mut Reader::new(&words));
        assert_eq!(other, all);
    }

    #[test]
    fn absent_value_overwrites_its_words() {
        let mut words = [7; 2];
        None::<u32>.write(&mut Writer::new(&mut words));
        assert_eq!(words, [0, 0]);
    }

    #[test]
    fn unknown_variant_is_the_first() {
        assert_eq!(Side::read(&mut Reader::new(&[99])), Side::Near);
    }

    #[test]
    fn layout_tells_order_and_size() {
        let (one, two) = (u32::LAYOUT, i64::LAYOUT);
        let digests = [
            Layout::EMPTY.with("a", one).with("b", one),
            Layout::EMPTY.with("b", one).with("a", one),
            Layout::EMPTY.with("a", two).with("b", one),
        ]
        .map(|layout| layout.digest);
        assert!(digests[0] != digests[1] && digests[0] != digests[2] && digests[1] != digests[2]);
    }
}
