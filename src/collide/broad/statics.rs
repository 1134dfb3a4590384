//! Colliders at rest.
//!
//! The set of colliders remembers its last changes, and the step the bodies that calls changed. The changed colliders stand in a second small
//! tree, beside a list of the colliders that are gone, until [`CHANGES`] are together and one tree is built of all.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::Proxy;
use super::cached::Cached;
use super::core_tree::{CoreAt, CoreTree};
use super::tree::{Extent, Tree};
use crate::collider::Filter;
use crate::fx::Fx;
use crate::shape::Aabb;

/// The number of changes that stand beside a tree before it is built anew.
const CHANGES: usize = 512;

/// The filter that meets all others.
const EVERYTHING: Filter = Filter { category: !0, mask: !0, group: 0 };

/// Colliders at rest, of static bodies or of sleeping ones: a tree, which copies of a world share, and the few changes
/// since it was built.
///
/// A search finds the same colliders whenever the tree was built.
#[derive(Debug, Default)]
pub struct Statics {
    base: Arc<Part>,
    /// The numbers of colliders in the tree that are there no more, or changed, sorted.
    gone: Vec<u32>,
    /// The colliders that are new or have changed.
    added: Part,
}

clone_by_field!([] Statics { base, gone, added });

/// Colliders in a tree.
#[derive(Debug, Default)]
struct Part {
    /// Sorted by number.
    proxies: Vec<Proxy>,
    tree: Tree,
    /// The cores of the colliders, for queries.
    cores: Cached,
}

impl Clone for Part {
    fn clone(&self) -> Self {
        Self { proxies: self.proxies.clone(), tree: self.tree.clone(), cores: Cached::default() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.proxies.clone_from(&source.proxies);
        self.tree.clone_from(&source.tree);
        self.cores = Cached::default();
    }
}

impl Part {
    fn new(proxies: Vec<Proxy>) -> Self {
        let mut part = Self { proxies, ..Self::default() };
        part.build();
        part.tree.drop_workspace();
        part
    }

    fn build(&mut self) {
        self.proxies.sort_unstable_by_key(|proxy| proxy.collider);
        self.tree.clear();
        for (i, proxy) in self.proxies.iter().enumerate() {
            self.tree.push(i as u32, Extent::new(proxy.bounds.into(), proxy.filter));
        }
        self.tree.build();
        self.cores = Cached::default();
    }

    fn find(&self, collider: u32) -> Result<usize, usize> {
        self.proxies.binary_search_by_key(&collider, |proxy| proxy.collider)
    }

    /// The number above the numbers of all colliders.
    fn end(&self) -> usize {
        self.proxies.last().map_or(0, |proxy| proxy.collider as usize + 1)
    }
}

/// Boxes in a tree, whatever their filters.
#[derive(Debug, Default)]
pub(crate) struct Boxes(Tree);

impl Boxes {
    /// Replaces all boxes.
    pub(crate) fn refill(&mut self, boxes: impl Iterator<Item = Aabb<Fx>>) {
        self.0.clear();
        for (bounds, item) in boxes.zip(0..) {
            self.0.push(item, Extent::new(bounds.into(), EVERYTHING));
        }
        self.0.build();
    }

    /// Returns true if one of the boxes overlaps another one.
    fn meets(&self, extent: &Extent) -> bool {
        let mut is_met = false;
        self.0.search(
            0,
            |node| node.meets(extent),
            |_| {
                is_met = true;
                false
            },
        );
        is_met
    }
}

impl Statics {
    /// Builds the tree of these colliders, in any order, each once.
    #[must_use]
    pub fn new(proxies: Vec<Proxy>) -> Self {
        Self { base: Arc::new(Part::new(proxies)), gone: Vec::new(), added: Part::default() }
    }

    /// Replaces all colliders. Takes nothing from the heap where there were as many before and no copy shares the tree.
    pub(crate) fn refill(&mut self, proxies: &[Proxy]) {
        self.gone.clear();
        self.added.proxies.clear();
        let many = if proxies.len() > CHANGES { proxies } else { &[] };
        if !many.is_empty() || !self.base.proxies.is_empty() {
            if Arc::get_mut(&mut self.base).is_none() {
                self.base = Arc::default();
            }
            let base = Arc::make_mut(&mut self.base);
            base.proxies.clear();
            base.proxies.extend_from_slice(many);
            base.build();
        }
        if many.is_empty() {
            self.added.proxies.extend_from_slice(proxies);
        }
        self.added.build();
    }

    /// Builds the tree anew, of all colliders. Takes nothing from the heap where there were as many before and no copy shares the tree.
    fn rebuild(&mut self) {
        if let Some(base) = Arc::get_mut(&mut self.base) {
            base.proxies.retain(|proxy| self.gone.binary_search(&proxy.collider).is_err());
            base.proxies.extend_from_slice(&self.added.proxies);
            base.build();
        } else {
            self.base = Arc::new(Part::new(self.iter().copied().collect()));
        }
        self.gone.clear();
        self.added.proxies.clear();
        self.added.build();
    }

    /// Sorts changes, each a number with the collider that stands there now, and keeps the changes that change something. *Domain* a number
    /// that is there twice has the same change twice.
    pub(crate) fn sift(&self, changes: &mut Vec<(u32, Option<Proxy>)>) {
        changes.retain(|(collider, now)| self.find(*collider) != now.as_ref());
        changes.sort_unstable_by_key(|(collider, _)| *collider);
        changes.dedup_by_key(|(collider, _)| *collider);
    }

    /// Makes changes as [`sift`](Self::sift) left them. Takes nothing from the heap where there were as many before, and as
    /// [`rebuild`](Self::rebuild) says where there are too many of them.
    pub(crate) fn change(&mut self, changes: &[(u32, Option<Proxy>)]) {
        if changes.is_empty() {
            return;
        }
        let Self { base, gone, added } = &mut *self;
        let stays = |proxy: &Proxy| changes.binary_search_by_key(&proxy.collider, |(collider, _)| *collider).is_err();
        added.proxies.retain(stays);
        added.proxies.extend(changes.iter().filter_map(|(_, now)| *now));
        let before = gone.len();
        for (collider, _) in changes {
            if base.find(*collider).is_ok() && gone[..before].binary_search(collider).is_err() {
                gone.push(*collider);
            }
        }
        gone.sort_unstable();
        if gone.len() + added.proxies.len() > CHANGES {
            self.rebuild();
        } else {
            added.build();
        }
    }

    /// The colliders after changes as [`sift`](Self::sift) left them. `None` if nothing changes.
    #[must_use]
    pub(crate) fn changed(&self, changes: &[(u32, Option<Proxy>)]) -> Option<Self> {
        if changes.is_empty() {
            return None;
        }
        let mut next = self.clone();
        next.change(changes);
        Some(next)
    }

    /// Returns true if these are the colliders of a copy, with the same changes since.
    pub(crate) fn are_those_of(&self, copy: &Self) -> bool {
        Arc::ptr_eq(&self.base, &copy.base) && self.gone == copy.gone && self.added.proxies == copy.added.proxies
    }

    /// Returns true if these are the colliders, in any order.
    pub(crate) fn are(&self, proxies: &[Proxy]) -> bool {
        proxies.len() == self.len() && proxies.iter().all(|proxy| self.find(proxy.collider) == Some(proxy))
    }

    /// Returns true if there is a collider with a number.
    pub(crate) fn has(&self, collider: u32) -> bool {
        self.find(collider).is_some()
    }

    /// All colliders, in no order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Proxy> {
        let stays = |proxy: &&Proxy| self.gone.binary_search(&proxy.collider).is_err();
        self.base.proxies.iter().filter(stays).chain(&self.added.proxies)
    }

    /// The collider with a number.
    pub(crate) fn find(&self, collider: u32) -> Option<&Proxy> {
        let index_in = |part: &'_ Part| part.find(collider).ok();
        if let Some(i) = index_in(&self.added) {
            return self.added.proxies.get(i);
        }
        let is_gone = self.gone.binary_search(&collider).is_ok();
        index_in(&self.base).filter(|_| !is_gone).and_then(|i| self.base.proxies.get(i))
    }

    /// Number of colliders.
    #[must_use]
    pub fn len(&self) -> usize {
        self.base.proxies.len() - self.gone.len() + self.added.proxies.len()
    }

    /// Returns true if there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number above the numbers of all colliders.
    pub(super) fn end(&self) -> usize {
        self.base.end().max(self.added.end())
    }

    /// Calls `visit` with each collider whose box overlaps a box, whatever its filter, until it returns false.
    pub(crate) fn near(&self, bounds: Aabb<Fx>, visit: impl FnMut(&Proxy) -> bool) {
        let extent = Extent::new(bounds.into(), EVERYTHING);
        self.search(|node| node.meets(&extent), visit);
    }

    /// Calls `visit` with each collider whose box overlaps one of some boxes, whatever its filter, once.
    pub(crate) fn near_any(&self, boxes: &Boxes, mut visit: impl FnMut(&Proxy)) {
        self.search(
            |node| boxes.meets(node),
            |proxy| {
                visit(proxy);
                true
            },
        );
    }

    /// Calls `visit` with each collider that makes a pair with another one, until it returns false.
    pub(crate) fn meeting(&self, proxy: &Proxy, mut visit: impl FnMut(&Proxy) -> bool) {
        let extent = Extent::new(proxy.bounds.into(), proxy.filter);
        self.search(
            |node| node.meets(&extent),
            |other_proxy| {
                let is_pair = proxy.body != other_proxy.body && proxy.filter.agrees(other_proxy.filter);
                !is_pair || visit(other_proxy)
            },
        );
    }

    /// Calls `visit` with each other collider that a search for the pairs of one comes to, and with whether it makes a pair, until it
    /// returns false.
    pub(crate) fn touching(&self, proxy: &Proxy, mut visit: impl FnMut(&Proxy, bool) -> bool) {
        let extent = Extent::new(proxy.bounds.into(), proxy.filter);
        self.search(
            |node| node.touches(&extent),
            |other_proxy| {
                let is_pair = proxy.body != other_proxy.body && proxy.filter.agrees(other_proxy.filter);
                other_proxy.collider == proxy.collider || visit(other_proxy, is_pair)
            },
        );
    }

    /// Calls `visit` with the number of each collider whose box meets a box and whose filter agrees with a filter, and perhaps with others,
    /// until it returns false.
    pub fn search_box(&self, bounds: Aabb<Fx>, filter: Filter, mut visit: impl FnMut(u32) -> bool) {
        let extent = Extent::new(bounds.into(), filter);
        self.search(|node| node.meets(&extent), |proxy| visit(proxy.collider));
    }

    /// The cores of all outlines, in two trees, which are kept for later queries; `place` gives the core of a number. Copies of a world
    /// share the first one, also after changes, so that it may have [numbers that are gone](Self::is_gone).
    pub(crate) fn cores(&self, mut place: impl FnMut(u32) -> Option<CoreAt>) -> [Arc<CoreTree>; 2] {
        [&*self.base, &self.added].map(|part| {
            part.cores.get(|| {
                CoreTree::new(&part.tree, |item| {
                    let proxy = &part.proxies[item as usize];
                    // A collider that is gone here may stand elsewhere now: it is listed without a place.
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

    /// Calls `visit` with each collider for which `is_met` is true, until it returns false.
    #[inline(always)]
    pub(super) fn search(&self, is_met: impl Fn(&Extent) -> bool, mut visit: impl FnMut(&Proxy) -> bool) {
        let mut goes_on = true;
        self.base.tree.search(0, &is_met, |item| {
            let proxy = &self.base.proxies[item as usize];
            goes_on = self.is_gone(proxy.collider) || visit(proxy);
            goes_on
        });
        if goes_on && !self.added.proxies.is_empty() {
            self.added.tree.search(0, &is_met, |item| visit(&self.added.proxies[item as usize]));
        }
    }
}

#[cfg(test)]
impl Statics {
    /// Returns true if both have the same tree, with other changes beside it.
    pub(super) fn shares_tree(&self, statics: &Self) -> bool {
        Arc::ptr_eq(&self.base, &statics.base)
    }
}
