//! The numbers of errors.

/// Gives an error its numbers, one per variant. A number is never changed and never reused. A variant that is not in the list
/// does not compile. `docs/errors.md` lists all numbers.
macro_rules! codes {
    ($type:ident { $($variant:ident = $code:literal),* $(,)? }) => {
        impl $type {
            /// The number of the error in `docs/errors.md`: unique, and the same in every version. Its cause
            /// ([`source`](core::error::Error::source)) has a number of its own.
            #[must_use]
            pub const fn code(&self) -> u16 {
                match self {
                    $(Self::$variant { .. } => $code),*
                }
            }
        }
    };
    ($type:ident = $code:literal) => {
        impl $type {
            /// The number of the error in `docs/errors.md`: unique, and the same in every version.
            #[must_use]
            pub const fn code(&self) -> u16 {
                $code
            }
        }
    };
}

pub(crate) use codes;
