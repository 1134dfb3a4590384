//! Colliders that do not move.

use alloc::vec::Vec;

use super::Proxy;
use super::tree::{Extent, Tree};

/// The static colliders of a world in a tree. It never changes: copies of a world share it, and a world in which a static collider is
/// added, changed or removed builds another one.
#[derive(Clone, Debug, Default)]
pub struct Statics {
    proxies: Vec<Proxy>,
    tree: Tree,
    end: usize,
}

impl Statics {
    /// Builds the tree of these colliders, in any order, each once.
    #[must_use]
    pub fn new(proxies: Vec<Proxy>) -> Self {
        let mut tree = Tree::default();
        for (i, proxy) in proxies.iter().enumerate() {
            tree.push(i as u32, Extent::new(proxy.bounds.into(), proxy.filter));
        }
        tree.build();
        tree.drop_workspace();
        let end = proxies.iter().map(|proxy| proxy.collider as usize + 1).max().unwrap_or(0);
        Self { proxies, tree, end }
    }

    /// Number of static colliders.
    #[must_use]
    pub fn len(&self) -> usize {
        self.proxies.len()
    }

    /// Returns true if there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.proxies.is_empty()
    }

    /// The number above those of all colliders.
    pub(super) fn end(&self) -> usize {
        self.end
    }

    /// Calls `found` with each collider that may meet a box, until it returns false.
    #[inline(always)]
    pub(super) fn search(&self, extent: &Extent, mut found: impl FnMut(&Proxy) -> bool) {
        self.tree.search(0, extent, |item| found(&self.proxies[item as usize]));
    }
}
