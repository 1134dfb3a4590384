//! Handles: a slot and how often it was taken before.

use alloc::vec::Vec;
use core::fmt;

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident, $noun:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
        pub struct $name {
            pub(crate) slot: u32,
            pub(crate) generation: u32,
        }

        impl $name {
            /// (slot, generation): slots are used again, each time with the next generation.
            #[must_use]
            pub const fn parts(self) -> (u32, u32) {
                (self.slot, self.generation)
            }

            /// The handle of these parts, as it was sent or saved.
            #[must_use]
            pub const fn from_parts(slot: u32, generation: u32) -> Self {
                Self { slot, generation }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($noun, " {}"), self.slot)?;
                if self.generation > 0 { write!(f, " (generation {})", self.generation) } else { Ok(()) }
            }
        }
    };
}

handle!(
    /// A handle to a body. It stays good until the body is removed, and never names another one afterwards.
    BodyId,
    "body"
);
handle!(
    /// A handle to a force field. It stays good until the field is removed, and never names another one afterwards.
    FieldId,
    "force field"
);

/// Whether a list of free slots names those without an occupant alone, and each of them once at most.
pub(crate) fn are_free(slots: impl Iterator<Item = bool>, listed: &[u32]) -> bool {
    let mut is_free: Vec<bool> = slots.collect();
    listed.iter().all(|&slot| is_free.get_mut(slot as usize).is_some_and(core::mem::take))
}
