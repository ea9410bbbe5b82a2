//! Declaration of thresholds: the constants of one subject that decide something, each with unit and origin.

/// Declares the thresholds of a subject: a struct with a documented field for each threshold, and its one instance. A
/// type with a parameter `T` keeps its instance in the associated constant `TUNED`. Every threshold of the core passes
/// through this macro. With the feature `sensitivity` the instance is a handle that dereferences to values computed at
/// process start (`numbers::sensitivity`).
#[cfg(not(feature = "sensitivity"))]
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

#[cfg(feature = "sensitivity")]
macro_rules! thresholds {
    ($(#[$doc:meta])* $name:ident: $type:ident {
        $($(#[doc = $field_doc:literal])* $field:ident: $kind:ty = $value:expr,)*
    }) => {
        $(#[$doc])*
        pub(crate) struct $type(());

        $(#[$doc])*
        pub(crate) const $name: $type = $type(());

        const _: () = {
            pub struct Values {
                $($(#[doc = $field_doc])* pub $field: $kind,)*
            }

            static VALUES: std::sync::LazyLock<Values> = std::sync::LazyLock::new(|| Values {
                $($field: $crate::numbers::sensitivity::overridden::<$kind>(
                    $value,
                    concat!(stringify!($name), ".", stringify!($field)),
                ),)*
            });

            impl core::ops::Deref for $type {
                type Target = Values;

                fn deref(&self) -> &Values {
                    &VALUES
                }
            }

            impl $type {
                /// Description of every threshold.
                pub fn list(&self) -> std::vec::Vec<$crate::numbers::sensitivity::Threshold> {
                    std::vec![$($crate::numbers::sensitivity::Threshold::new::<$kind>(
                        module_path!(),
                        concat!(stringify!($name), ".", stringify!($field)),
                        $value,
                        concat!($($field_doc),*),
                    ),)*]
                }
            }
        };
    };
    ($(#[$doc:meta])* $type:ident<T> {
        $($(#[doc = $field_doc:literal])* $field:ident: $kind:ty = $value:expr,)*
    }) => {
        $(#[$doc])*
        pub(crate) struct $type<T: Real>(core::marker::PhantomData<T>);

        impl<T: Real> $type<T> {
            /// Values in use.
            pub const TUNED: Self = Self(core::marker::PhantomData);
        }

        const _: () = {
            pub struct Values<T: Real> {
                $($(#[doc = $field_doc])* pub $field: $kind,)*
            }

            impl<T: Real + $crate::numbers::sensitivity::Scale> Values<T> {
                fn new() -> Self {
                    Self {
                        $($field: $crate::numbers::sensitivity::overridden::<$kind>(
                            $value,
                            concat!(stringify!($type), ".", stringify!($field)),
                        ),)*
                    }
                }
            }

            static SINGLE: std::sync::LazyLock<Values<f32>> = std::sync::LazyLock::new(Values::new);
            static DOUBLE: std::sync::LazyLock<Values<f64>> = std::sync::LazyLock::new(Values::new);

            impl<T: Real> core::ops::Deref for $type<T> {
                type Target = Values<T>;

                fn deref(&self) -> &Values<T> {
                    let is_single = core::any::TypeId::of::<T>() == core::any::TypeId::of::<f32>();
                    let values: &'static dyn core::any::Any = if is_single { &*SINGLE } else { &*DOUBLE };
                    values.downcast_ref().expect("f32 and f64 are the only scalars of the core")
                }
            }

            impl<T: Real + $crate::numbers::sensitivity::Scale> $type<T> {
                /// Description of every threshold.
                pub fn list(&self) -> std::vec::Vec<$crate::numbers::sensitivity::Threshold> {
                    std::vec![$($crate::numbers::sensitivity::Threshold::new::<$kind>(
                        module_path!(),
                        concat!(stringify!($type), ".", stringify!($field)),
                        $value,
                        concat!($($field_doc),*),
                    ),)*]
                }
            }
        };
    };
}

pub(crate) use thresholds;
