//! Indexes of values: the position, name and text of each field.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::{self, Display};

use super::encode::{Encoder, Part, Write};
use super::hash::StateHasher;

/// The fields of a value: the position of each among its bytes, its name and its text.
#[derive(Debug, Default)]
pub(crate) struct FieldIndex {
    path: Vec<Part>,
    end: usize,
    seen: usize,
    wanted: Wanted,
    pub(crate) leaves: Vec<FieldValue>,
}

/// The fields that an index keeps: each takes some hundred bytes of memory.
#[derive(Debug, Default)]
pub(crate) enum Wanted {
    #[default]
    All,
    /// The field that this byte belongs to.
    At(usize),
    /// The field at this path.
    On(Vec<Part>),
    /// The field after so many others.
    Nth(usize),
}

/// A field without parts, and its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FieldValue {
    pub(crate) path: Vec<Part>,
    pub(crate) at: usize,
    pub(crate) bytes: Vec<u8>,
    pub(crate) text: String,
}

impl FieldIndex {
    pub(crate) fn of(value: &impl Write) -> Self {
        let mut index = Self::default();
        value.write(&mut index);
        index
    }

    /// The first field that is wanted.
    pub(crate) fn find(value: &impl Write, wanted: Wanted) -> Option<FieldValue> {
        let mut index = Self { wanted, ..Self::default() };
        value.write(&mut index);
        index.leaves.into_iter().next()
    }
}

impl Encoder for FieldIndex {
    fn bytes(&mut self, bytes: &[u8]) {
        struct Hex<'a>(&'a [u8]);
        impl Display for Hex<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
            }
        }
        self.leaf(bytes, &Hex(bytes));
    }

    fn enter(&mut self, part: Part) {
        self.path.push(part);
    }

    fn leave(&mut self) {
        self.path.pop();
    }

    fn leaf(&mut self, bytes: &[u8], value: &dyn Display) {
        let (at, end) = (self.end, self.end + bytes.len());
        let is_wanted = match &self.wanted {
            Wanted::All => true,
            Wanted::At(byte) => at <= *byte && *byte < end,
            Wanted::On(path) => *path == self.path,
            Wanted::Nth(place) => *place == self.seen,
        };
        self.seen += 1;
        if is_wanted {
            self.leaves.push(FieldValue {
                path: self.path.clone(),
                at,
                bytes: bytes.to_vec(),
                text: value.to_string(),
            });
        }
        self.end = end;
    }
}

/// The first field in which two values of one type differ, as it is in each. Lengths and variants are fields too, which differ
/// before the fields that depend on them. Takes eight bytes of memory for each field.
pub(crate) fn first_difference(
    left: &impl Write,
    right: &impl Write,
) -> Option<(Option<FieldValue>, Option<FieldValue>)> {
    #[derive(Default)]
    struct Digests(Vec<u64>);

    impl Encoder for Digests {
        fn bytes(&mut self, bytes: &[u8]) {
            self.0.push(StateHasher::of_bytes(bytes));
        }
    }

    struct Beside<'a> {
        digests: &'a [u64],
        same: usize,
        parted: bool,
    }

    impl Encoder for Beside<'_> {
        fn bytes(&mut self, bytes: &[u8]) {
            self.parted = self.parted || self.digests.get(self.same) != Some(&StateHasher::of_bytes(bytes));
            self.same += usize::from(!self.parted);
        }
    }

    let mut digests = Digests::default();
    left.write(&mut digests);
    let mut beside = Beside { digests: &digests.0, same: 0, parted: false };
    right.write(&mut beside);
    let Beside { same, parted, .. } = beside;
    if !parted && same == digests.0.len() {
        return None;
    }
    drop(digests);
    Some((FieldIndex::find(left, Wanted::Nth(same)), FieldIndex::find(right, Wanted::Nth(same))))
}
