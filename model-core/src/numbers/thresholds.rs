//! Declaration of thresholds: the constants of one subject that decide something, each with unit and origin.

/// Declares the thresholds of a subject: a struct with a documented field for each threshold, and its one instance. A
/// type with a parameter `T` keeps its instance in the associated constant `TUNED`. Every threshold of the core passes
/// through this macro, so that a study can override values here.
macro_rules! thresholds {
    ($(#[$doc:meta])* $name:ident: $type:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ty = $value:expr,)* }) => {
        $(#[$doc])*
        pub(crate) struct $type {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        $(#[$doc])*
        pub(crate) const $name: $type = $type { $($field: $value,)* };
    };
    ($(#[$doc:meta])* $type:ident<T> { $($(#[$field_doc:meta])* $field:ident: $kind:ty = $value:expr,)* }) => {
        $(#[$doc])*
        pub(crate) struct $type<T: Real> {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        impl<T: Real> $type<T> {
            /// Values in use.
            pub const TUNED: Self = Self { $($field: $value,)* };
        }
    };
}

pub(crate) use thresholds;
