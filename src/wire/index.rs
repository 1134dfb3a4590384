//! Values as their parts: where each stands, its name, how it reads.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt::{self, Display};

use super::{Out, Part, Write};

/// The values of which a value is made: where each stands among its bytes, its name and how it reads.
#[derive(Debug, Default)]
pub(crate) struct Index {
    path: Vec<Part>,
    end: usize,
    wanted: Wanted,
    pub(crate) leaves: Vec<Leaf>,
}

/// Which values an index keeps: one takes some hundred bytes, however few it stands for.
#[derive(Debug, Default)]
pub(crate) enum Wanted {
    #[default]
    All,
    /// The one that this byte belongs to.
    At(usize),
    /// Those at this path.
    On(Vec<Part>),
}

/// A value that has no parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Leaf {
    pub(crate) path: Vec<Part>,
    pub(crate) at: usize,
    pub(crate) bytes: Vec<u8>,
    pub(crate) text: String,
}

impl Index {
    pub(crate) fn of(value: &impl Write) -> Self {
        let mut index = Self::default();
        value.write(&mut index);
        index
    }

    /// The first value that is wanted.
    pub(crate) fn find(value: &impl Write, wanted: Wanted) -> Option<Leaf> {
        let mut index = Self { wanted, ..Self::default() };
        value.write(&mut index);
        index.leaves.into_iter().next()
    }
}

impl Out for Index {
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
        };
        if is_wanted {
            self.leaves.push(Leaf { path: self.path.clone(), at, bytes: bytes.to_vec(), text: value.to_string() });
        }
        self.end = end;
    }
}
