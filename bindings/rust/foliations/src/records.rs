//! How structures and codes of the C interface become types of this crate.

use foliations_sys as sys;

/// A number of the C interface as a `T`.
pub(crate) trait Read<T> {
    fn read(&self) -> T;
}

impl<T: Copy> Read<T> for T {
    fn read(&self) -> T {
        *self
    }
}

impl Read<usize> for u64 {
    fn read(&self) -> usize {
        *self as usize
    }
}

impl Read<usize> for u32 {
    fn read(&self) -> usize {
        *self as usize
    }
}

impl Read<bool> for i32 {
    fn read(&self) -> bool {
        *self != 0
    }
}

/// An index that may be `HMF_NONE`.
impl Read<Option<u32>> for u32 {
    fn read(&self) -> Option<u32> {
        (*self != sys::HMF_NONE).then_some(*self)
    }
}

/// A number that is negative where it was not evaluated.
impl Read<Option<f64>> for f64 {
    fn read(&self) -> Option<f64> {
        (*self >= 0.0).then_some(*self)
    }
}

/// An enum whose values are codes of the C interface.
macro_rules! codes {
    ($(#[$meta:meta])* $name:ident: $int:ident { $($(#[$doc:meta])* $variant:ident = $code:expr,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        #[repr($int)]
        pub enum $name {
            $($(#[$doc])* $variant = $code,)*
        }

        impl $crate::records::Read<$name> for $int {
            fn read(&self) -> $name {
                match *self {
                    $(code if code == $name::$variant as $int => $name::$variant,)*
                    code => panic!(concat!("hmf gave the unknown ", stringify!($name), " {}"), code),
                }
            }
        }
    };
}

/// A structure with fields of one of the C interface, under the same names or as a
/// function of that structure says.
macro_rules! record {
    (@read $raw:ident $field:ident) => { $crate::records::Read::read(&$raw.$field) };
    (@read $raw:ident $field:ident $get:expr) => { ($get)($raw) };
    ($(#[$meta:meta])* $name:ident from $source:ident {
        $($(#[$doc:meta])* $field:ident: $type:ty $(= $get:expr)?,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
        }

        impl $crate::records::Read<$name> for foliations_sys::$source {
            fn read(&self) -> $name {
                let raw = self;
                $name { $($field: record!(@read raw $field $($get)?),)* }
            }
        }
    };
}

/// The default options: a structure of zeros with its size and the given fields.
macro_rules! options {
    ($name:ident $($field:ident: $value:expr),*) => {{
        // Where all fields are named there is nothing left to take from the defaults.
        #[allow(clippy::needless_update)]
        let options = foliations_sys::$name {
            struct_size: std::mem::size_of::<foliations_sys::$name>() as u32,
            $($field: $value,)*
            ..Default::default()
        };
        options
    }};
}

pub(crate) use {codes, options, record};
