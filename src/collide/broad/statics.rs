//! Colliders that do not move.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::Proxy;
use super::core_tree::{Cached, CoreAt, CoreTree};
use super::tree::{Extent, Tree};
use crate::collider::Filter;
use crate::fx::Fx;
use crate::shape::Aabb;

/// The number of changes that stand beside a tree before it is built anew.
const CHANGES: usize = 512;

/// The static colliders of a world: a tree, and the few changes since it was built. It never changes: copies of a world share it, and a
/// world in which a static collider is added, changed or removed makes another one, which shares the tree.
///
/// What a search finds depends on the colliders alone, and not on when the tree was built.
#[derive(Clone, Debug, Default)]
pub struct Statics {
    base: Arc<Part>,
    /// The numbers of colliders in the tree that are there no more, or changed, sorted.
    gone: Vec<u32>,
    /// Those that are new or changed.
    added: Part,
}

/// Colliders in a tree.
#[derive(Clone, Debug, Default)]
struct Part {
    /// Sorted by number.
    proxies: Vec<Proxy>,
    tree: Tree,
    /// The cores of the colliders, for queries.
    cores: Cached,
}

impl Part {
    fn new(mut proxies: Vec<Proxy>) -> Self {
        proxies.sort_unstable_by_key(|proxy| proxy.collider);
        let mut tree = Tree::default();
        for (i, proxy) in proxies.iter().enumerate() {
            tree.push(i as u32, Extent::new(proxy.bounds.into(), proxy.filter));
        }
        tree.build();
        tree.drop_workspace();
        Self { proxies, tree, cores: Cached::default() }
    }

    fn find(&self, collider: u32) -> Result<usize, usize> {
        self.proxies.binary_search_by_key(&collider, |proxy| proxy.collider)
    }

    /// The number above those of all colliders.
    fn end(&self) -> usize {
        self.proxies.last().map_or(0, |proxy| proxy.collider as usize + 1)
    }
}

impl Statics {
    /// Builds the tree of these colliders, in any order, each once.
    #[must_use]
    pub fn new(proxies: Vec<Proxy>) -> Self {
        Self { base: Arc::new(Part::new(proxies)), gone: Vec::new(), added: Part::default() }
    }

    /// The colliders after changes: of each number what stands there now. `None` if nothing changes.
    #[must_use]
    pub(crate) fn changed(&self, changes: &[(u32, Option<Proxy>)]) -> Option<Self> {
        if changes.is_empty() {
            return None;
        }
        let (mut gone, mut added) = (self.gone.clone(), self.added.proxies.clone());
        let mut differs = false;
        for &(collider, ref now) in changes {
            // A number that is there twice has the same change twice.
            if self.find(collider) == now.as_ref() {
                continue;
            }
            differs = true;
            if let Ok(i) = added.binary_search_by_key(&collider, |proxy| proxy.collider) {
                added.remove(i);
            }
            if let (Ok(_), Err(i)) = (self.base.find(collider), gone.binary_search(&collider)) {
                gone.insert(i, collider);
            }
            if let (Some(now), Err(i)) = (now, added.binary_search_by_key(&collider, |proxy| proxy.collider)) {
                added.insert(i, *now);
            }
        }
        if !differs {
            return None;
        }
        if gone.len() + added.len() <= CHANGES {
            return Some(Self { base: Arc::clone(&self.base), gone, added: Part::new(added) });
        }
        let stays = |proxy: &&Proxy| gone.binary_search(&proxy.collider).is_err();
        Some(Self::new(self.base.proxies.iter().filter(stays).chain(&added).copied().collect()))
    }

    /// Returns true if these are the colliders, in any order.
    pub(crate) fn are(&self, proxies: &[Proxy]) -> bool {
        proxies.len() == self.len() && proxies.iter().all(|proxy| self.find(proxy.collider) == Some(proxy))
    }

    /// Returns true if there is a collider with a number.
    pub(crate) fn has(&self, collider: u32) -> bool {
        self.find(collider).is_some()
    }

    /// The collider with a number.
    fn find(&self, collider: u32) -> Option<&Proxy> {
        let from = |part: &'_ Part| part.find(collider).ok();
        if let Some(i) = from(&self.added) {
            return self.added.proxies.get(i);
        }
        let is_gone = self.gone.binary_search(&collider).is_ok();
        from(&self.base).filter(|_| !is_gone).and_then(|i| self.base.proxies.get(i))
    }

    /// Number of static colliders.
    #[must_use]
    pub fn len(&self) -> usize {
        self.base.proxies.len() - self.gone.len() + self.added.proxies.len()
    }

    /// Returns true if there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number above those of all colliders.
    pub(super) fn end(&self) -> usize {
        self.base.end().max(self.added.end())
    }

    /// Calls `found` with each collider whose box overlaps a box, whatever its filter.
    pub(crate) fn near(&self, bounds: Aabb<Fx>, mut found: impl FnMut(&Proxy)) {
        let all = Filter { category: !0, mask: !0, group: 0 };
        self.search(&Extent::new(bounds.into(), all), |proxy| {
            found(proxy);
            true
        });
    }

    /// Calls `found` with the number of each collider whose box meets a box and whose filter agrees with a filter, and perhaps with others,
    /// until it returns false.
    pub fn search_box(&self, bounds: Aabb<Fx>, filter: Filter, mut found: impl FnMut(u32) -> bool) {
        self.search(&Extent::new(bounds.into(), filter), |proxy| found(proxy.collider));
    }

    /// The cores of all outlines, in two trees, which are kept for later queries; `place` gives the core of a number. Copies of a world share
    /// the first one, also after changes, so that it may have [numbers that are gone](Self::is_gone).
    pub(crate) fn cores(&self, mut place: impl FnMut(u32) -> Option<CoreAt>) -> [Arc<CoreTree>; 2] {
        [&*self.base, &self.added].map(|part| {
            part.cores.get(|| {
                CoreTree::new(&part.tree, |item| {
                    let proxy = &part.proxies[item as usize];
                    // One that is gone here may stand elsewhere: it is found without a place.
                    let is_here = core::ptr::eq(part, &self.added) || !self.is_gone(proxy.collider);
                    (proxy.collider, proxy.filter, if is_here { place(proxy.collider) } else { None })
                })
            })
        })
    }

    /// Returns true for a number in the first tree of [`cores`](Self::cores) that stands there no more.
    #[inline]
    pub(crate) fn is_gone(&self, number: u32) -> bool {
        !self.gone.is_empty() && self.gone.binary_search(&number).is_ok()
    }

    /// Calls `found` with each collider that may meet a box, until it returns false.
    #[inline(always)]
    pub(super) fn search(&self, extent: &Extent, mut found: impl FnMut(&Proxy) -> bool) {
        let mut goes_on = true;
        self.base.tree.search(0, extent, |item| {
            let proxy = &self.base.proxies[item as usize];
            goes_on = self.is_gone(proxy.collider) || found(proxy);
            goes_on
        });
        if goes_on && !self.added.proxies.is_empty() {
            self.added.tree.search(0, extent, |item| found(&self.added.proxies[item as usize]));
        }
    }
}

#[cfg(test)]
impl Statics {
    /// Returns true if both have the same tree, with other changes beside it.
    pub(super) fn shares_tree(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base, &other.base)
    }
}
