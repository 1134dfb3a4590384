//! A tree of cores that is kept for later queries. Without the feature `std` there is nothing that several threads may fill once.

use alloc::sync::Arc;

use super::core_tree::CoreTree;

/// A tree of cores that is made when the first query asks for it. It is no part of any state.
#[derive(Debug, Default)]
pub(super) struct Cached {
    #[cfg(feature = "std")]
    tree: std::sync::OnceLock<Arc<CoreTree>>,
}

impl Cached {
    /// The tree, made if there is none. Without the feature `std` nothing is kept.
    #[cfg(feature = "std")]
    pub(super) fn get(&self, make: impl FnOnce() -> CoreTree) -> Arc<CoreTree> {
        Arc::clone(self.tree.get_or_init(|| Arc::new(make())))
    }

    #[cfg(not(feature = "std"))]
    pub(super) fn get(&self, make: impl FnOnce() -> CoreTree) -> Arc<CoreTree> {
        Arc::new(make())
    }
}

impl Clone for Cached {
    /// An empty one: the copy may come to hold other colliders.
    fn clone(&self) -> Self {
        Self::default()
    }
}
