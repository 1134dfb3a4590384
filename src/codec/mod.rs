//! Values as bytes: little-endian on every machine, without padding, each list after its length.
//!
//! One walk over the fields of a value, [`Write`], serves hashes, files, and the index that says which field a byte of a file
//! belongs to and what its value is. [`Read`] decodes values from files.

mod decode;
mod encode;
mod hash;
mod index;
mod macros;
mod values;

pub use decode::Malformed;
pub(crate) use decode::{Read, Reader};
pub(crate) use encode::{Encoder, Part, Write, count, field, list};
pub(crate) use hash::StateHasher;
pub(crate) use index::{FieldIndex, FieldValue, Wanted, first_difference};
pub(crate) use macros::{codec_enum, codec_plain, codec_struct};
