//! Colliders at rest: colliders of static bodies and of sleeping bodies. They are kept in trees that copies of a world share. A
//! step changes the trees only where a call or the last step has changed a body, so that colliders at rest cost nothing.
//!
//! The numbers of pairs and of overlaps among colliders at rest are kept too. With too many pairs in all, a step takes sleeping
//! colliders for moving ones, and the same bodies are at fault whether some of them sleep or not.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::bodies;
use super::flights::pose;
use super::numbers::Numbers;
use super::one_way::has_changed;
use super::reach::{self, Reach};
use super::{Changed, Scene, pair_limits};
use crate::body::{Activity, BodyKind};
use crate::collide::broad::{Boxes, PairLimits, Proxy, RestingTrees, Statics};
use crate::collider::{Collider, ColliderSet};
use crate::query::place_digest;

/// The number of changes that are followed one by one in any world. More changes, if also more than an eighth of the colliders, take longer
/// than to list all colliders.
const FEW: usize = 512;

/// The trees of a world.
#[derive(Debug, Default)]
pub(super) struct Trees {
    pub(super) statics: Arc<Statics>,
    pub(super) sleepers: Statics,
    /// The number of changes of `sleepers`, by this world or by the one that it was copied from.
    version: u64,
    /// The pairs and overlaps of a sleeping collider and a collider at rest.
    pub(super) counts: Counts,
}

/// Numbers of pairs and of [overlaps](PairLimits::overlaps); `usize::MAX` if one of the numbers is above its limit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    pub(super) pairs: usize,
    pub(super) overlaps: usize,
}

impl Counts {
    const UNKNOWN: Self = Self { pairs: usize::MAX, overlaps: usize::MAX };

    fn add(&mut self, is_pair: bool) {
        self.pairs += usize::from(is_pair);
        self.overlaps += 1;
    }

    fn are_within(&self, limits: &PairLimits) -> bool {
        self.pairs <= limits.pairs && self.overlaps <= limits.overlaps
    }

    /// These counts, or unknown ones if one of them is above its limit.
    fn known(self, limits: &PairLimits) -> Self {
        if self.are_within(limits) { self } else { Self::UNKNOWN }
    }
}

/// The colliders at rest that may have other contacts than before: changed colliders, and static colliders beside a changed one,
/// whose surface may be another one. It stays the same however often contacts are detected in a step.
#[derive(Debug, Default)]
pub(crate) struct ChangedResting {
    /// True if all colliders at rest may have changed.
    are_all: bool,
    /// The numbers of the outlines, sorted.
    numbers: Vec<u32>,
    /// The slots of the bodies of all these outlines, sorted.
    bodies: Vec<u32>,
}

impl ChangedResting {
    pub(crate) fn clear(&mut self) {
        self.are_all = false;
        self.numbers.clear();
        self.bodies.clear();
    }

    /// Returns true if a collider of a body may have changed.
    pub(super) fn has(&self, body: u32) -> bool {
        self.are_all || self.bodies.binary_search(&body).is_ok()
    }
}

/// Reused memory for following changes.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    /// The boxes of all static or of all sleeping colliders.
    proxies: Vec<Proxy>,
    /// The static and the sleeping colliders that came, left or changed, by number.
    changes: [Vec<(u32, Option<Proxy>)>; 2],
    /// The boxes of static colliders that changed, before and after.
    changed_boxes: Boxes,
    /// The numbers of the changed colliders, sorted.
    numbers: Vec<u32>,
}

impl Trees {
    /// Becomes a copy.
    pub(super) fn copy_from(&mut self, source: &Self) {
        self.statics.clone_from(&source.statics);
        if !self.sleepers.are_those_of(&source.sleepers) {
            self.sleepers.clone_from(&source.sleepers);
            self.version += 1;
        }
        self.counts = source.counts;
    }

    pub(super) fn for_search(&self) -> RestingTrees<'_> {
        RestingTrees { statics: &self.statics, sleepers: Some(&self.sleepers), version: self.version }
    }

    /// Calls `visit` with each collider that overlaps `proxy`, true if that collider sleeps, and true if they make a pair, until `visit`
    /// returns false.
    fn partners(&self, proxy: &Proxy, sleeps: bool, mut visit: impl FnMut(&Proxy, bool, bool) -> bool) {
        let mut goes_on = true;
        self.sleepers.touching(proxy, |partner, is_pair| {
            goes_on = visit(partner, true, is_pair);
            goes_on
        });
        if goes_on && sleeps {
            self.statics.touching(proxy, |partner, is_pair| visit(partner, false, is_pair));
        }
    }

    /// Counts all pairs and overlaps, up to one more than the limits.
    fn count_all(&self, limits: &PairLimits) -> Counts {
        let mut counts = Counts::default();
        for sleeper in self.sleepers.iter() {
            self.partners(sleeper, true, |partner, sleeps, is_pair| {
                // Two sleeping colliders visit each other: count the pair once.
                if !sleeps || sleeper.collider < partner.collider {
                    counts.add(is_pair);
                }
                counts.are_within(limits)
            });
            if !counts.are_within(limits) {
                break;
            }
        }
        counts
    }

    /// Counts the pairs and overlaps of the colliders with these numbers, which are sorted, up to one more than the limits.
    fn count_of(&self, numbers: &[u32], limits: &PairLimits) -> Counts {
        let mut counts = Counts::default();
        for &number in numbers {
            let sleeper = self.sleepers.find(number);
            let Some(proxy) = sleeper.or_else(|| self.statics.find(number)) else { continue };
            self.partners(proxy, sleeper.is_some(), |partner, _, is_pair| {
                if partner.collider >= number || numbers.binary_search(&partner.collider).is_err() {
                    counts.add(is_pair);
                }
                counts.are_within(limits)
            });
            if !counts.are_within(limits) {
                break;
            }
        }
        counts
    }
}

/// Whether a body at rest is static or asleep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Static,
    Asleep,
}

/// The colliders at rest of a world, by the numbers of their outlines.
#[derive(Debug, Default)]
pub(super) struct Resting {
    /// The outlines of all colliders as the broad phase knows them.
    pub(super) numbers: Numbers,
    /// `None` before the first step.
    pub(super) trees: Option<Trees>,
    /// The revision of the colliders that the trees were built from.
    revision: u64,
    workspace: Workspace,
}

impl Resting {
    /// The trees, if they were built from these colliders.
    pub(super) fn current(&self, colliders: &ColliderSet) -> Option<&Trees> {
        let is_current = self.revision == colliders.revision() && self.numbers.is_of(colliders);
        self.trees.as_ref().filter(|_| is_current)
    }

    /// Takes over the trees of another world, of which this world is a copy. Returns true if it has other static colliders than before.
    pub(super) fn copy_from(&mut self, source: &Self) -> bool {
        let shares_statics = match (&self.trees, &source.trees) {
            (Some(trees), Some(source)) => Arc::ptr_eq(&trees.statics, &source.statics),
            _ => false,
        };
        match &source.trees {
            None => self.trees = None,
            Some(source) => self.trees.get_or_insert_default().copy_from(source),
        }
        self.revision = source.revision;
        // The trees know colliders by these numbers.
        self.numbers.copy_from(&source.numbers);
        !shares_statics
    }

    /// Follows the changes of colliders at rest. Returns true if static colliders may have changed.
    pub(super) fn update(&mut self, scene: &Scene<'_>, changed_resting: &mut ChangedResting) -> bool {
        let are_renumbered = self.numbers.update(scene.colliders);
        // Room for all colliders: a step that is taken again may have to list them where it followed changes before.
        self.workspace.proxies.clear();
        self.workspace.proxies.reserve(scene.colliders.len() + scene.colliders.more_outlines());
        let is_current = self.revision == scene.colliders.revision() && !are_renumbered;
        if is_current && self.trees.is_some() && scene.changed.is_some_and(Changed::is_empty) {
            return false;
        }
        self.revision = scene.colliders.revision();
        let limits = pair_limits(scene.settings, scene.colliders);
        let mut workspace = core::mem::take(&mut self.workspace);
        let before = self.trees.take();
        let is_known = before.is_some();
        let mut trees = before.unwrap_or_default();
        let few = FEW.max(scene.colliders.len() / 8);
        let have_statics_changed =
            match scene.changed.filter(|changed| changed.all(scene.colliders).take(few + 1).count() <= few) {
                Some(changed) if is_known && !are_renumbered => {
                    self.follow(scene, changed, &mut trees, &mut workspace, changed_resting, &limits)
                }
                _ => {
                    changed_resting.are_all = true;
                    self.list_resting(scene, State::Static, &mut workspace.proxies);
                    if !trees.statics.are(&workspace.proxies) {
                        trees.statics = Arc::new(Statics::new(workspace.proxies.clone()));
                    }
                    self.list_resting(scene, State::Asleep, &mut workspace.proxies);
                    if !trees.sleepers.are(&workspace.proxies) {
                        trees.sleepers.refill(&workspace.proxies);
                        trees.version += 1;
                    }
                    trees.counts = trees.count_all(&limits).known(&limits);
                    true
                }
            };
        self.workspace = workspace;
        self.trees = Some(trees);
        have_statics_changed
    }

    /// Lists all colliders of bodies in this state.
    fn list_resting(&self, scene: &Scene<'_>, state: State, proxies: &mut Vec<Proxy>) {
        proxies.clear();
        if state == State::Static || scene.bodies.any_asleep() {
            proxies.extend(scene.colliders.list().flat_map(|collider| self.proxies(scene, collider, state)));
        }
    }

    /// Applies the changes of bodies and colliders to the trees, the counts and the changed colliders. Returns true if static colliders
    /// may have changed.
    fn follow(
        &self,
        scene: &Scene<'_>,
        changed: &Changed,
        trees: &mut Trees,
        workspace: &mut Workspace,
        changed_resting: &mut ChangedResting,
        limits: &PairLimits,
    ) -> bool {
        let Workspace { changes: [statics, sleepers], changed_boxes, numbers, .. } = workspace;
        for (state, tree, changes) in
            [(State::Static, &*trees.statics, &mut *statics), (State::Asleep, &trees.sleepers, &mut *sleepers)]
        {
            changes.clear();
            changed.all(scene.colliders).for_each(|slot| self.list_changes(scene, tree, slot, state, changes));
        }
        let have_statics_changed = !statics.is_empty();
        let ChangedResting { numbers: all, bodies, .. } = changed_resting;
        all.extend(changed.all(scene.colliders).flat_map(|slot| self.numbers.of(slot)));
        let changed_proxies =
            statics.iter().flat_map(|(number, now)| [trees.statics.find(*number).copied(), *now].into_iter().flatten());
        changed_boxes.refill(changed_proxies.map(|proxy| proxy.bounds));
        trees.statics.near_any(changed_boxes, |neighbour| all.push(neighbour.collider));
        let collider = |number: u32| scene.colliders.at(self.numbers.outline(number).slot);
        let body = |&number: &u32| collider(number).map(|collider| collider.body.slot);
        bodies.extend(changed.bodies.iter().chain(&changed.owners).copied().chain(all.iter().filter_map(body)));
        for list in [all, bodies] {
            list.sort_unstable();
            list.dedup();
        }
        trees.statics.sift(statics);
        trees.sleepers.sift(sleepers);
        numbers.clear();
        numbers.extend(statics.iter().chain(&*sleepers).map(|(number, _)| *number));
        numbers.sort_unstable();
        numbers.dedup();
        let removed = trees.count_of(numbers, limits);
        let next = trees.statics.changed(statics);
        if !sleepers.is_empty() {
            trees.sleepers.change(sleepers);
            trees.version += 1;
        }
        if let Some(next) = next {
            trees.statics = Arc::new(next);
        }
        let counts = if trees.counts.are_within(limits) {
            let before = trees.counts;
            let added = trees.count_of(numbers, limits);
            Counts {
                pairs: before.pairs.saturating_sub(removed.pairs).saturating_add(added.pairs),
                overlaps: before.overlaps.saturating_sub(removed.overlaps).saturating_add(added.overlaps),
            }
        } else {
            trees.count_all(limits)
        };
        trees.counts = counts.known(limits);
        have_statics_changed
    }

    /// The boxes of a collider, if its body is in this state.
    fn proxies<'a>(
        &self,
        scene: &Scene<'a>,
        collider: &'a Collider,
        state: State,
    ) -> impl Iterator<Item = Proxy> + use<'a> {
        let bodies = scene.bodies;
        let first = self.numbers.first(collider.slot);
        let is_still = |dense: &usize| match (bodies.activity(*dense), state) {
            (Activity::Awake, State::Static) => bodies.contact_info(*dense).kind == BodyKind::Static,
            (Activity::Asleep, State::Asleep) => true,
            _ => false,
        };
        let dense = bodies.index_of(collider.body).filter(|_| collider.def.is_solid()).filter(is_still);
        dense.into_iter().flat_map(move |dense| {
            let position = bodies.position(dense);
            let angle = bodies.angle(dense);
            let pose = pose(position, angle);
            let digest = place_digest(collider.digest, pose.position(), angle);
            (0..collider.outline_count()).map(move |part| Proxy {
                collider: first + part,
                body: collider.body.slot,
                bounds: match state {
                    State::Static => reach::resting(&collider.outline(part), &pose),
                    // The box that it would have if it were awake and did not move.
                    State::Asleep => {
                        let outline = collider.outline(part);
                        let reach = Reach::new(&bodies::resting(pose.position()), outline.radius);
                        reach.swept(pose.outline_bounds(&outline))
                    }
                },
                filter: collider.def.filter,
                digest,
            })
        })
    }

    /// Adds the changes of a tree by the collider in a slot: it was added, removed or replaced.
    fn list_changes(
        &self,
        scene: &Scene<'_>,
        tree: &Statics,
        slot: u32,
        state: State,
        changes: &mut Vec<(u32, Option<Proxy>)>,
    ) {
        let before = changes.len();
        let proxies = scene.colliders.at(slot).into_iter().flat_map(|collider| self.proxies(scene, collider, state));
        changes.extend(proxies.map(|proxy| (proxy.collider, Some(proxy))));
        if changes.len() == before {
            let removed = self.numbers.of(slot).filter(|&number| tree.has(number));
            changes.extend(removed.map(|number| (number, None)));
        }
    }

    /// Adds the changed pairs of a sleeping and a static collider. Where the answer of a one-way collider for a body may have changed, it adds
    /// the pairs with all colliders of the body, since the answer follows from all of them.
    pub(super) fn pair_changed(&self, scene: &Scene<'_>, changed_resting: &ChangedResting, pairs: &mut Vec<[u32; 2]>) {
        let Some(Trees { statics, sleepers, .. }) = &self.trees else { return };
        if !scene.may_have_moved_statics || sleepers.is_empty() || statics.is_empty() {
            return;
        }
        let before = pairs.len();
        let mut add = |a: &Proxy, b: &Proxy| {
            pairs.push([a.collider.min(b.collider), a.collider.max(b.collider)]);
            true
        };
        // The collider, and the tree to search for its partners.
        let sides = |number: u32| match sleepers.find(number) {
            Some(sleeper) => Some((sleeper, &**statics)),
            None => statics.find(number).map(|proxy| (proxy, sleepers)),
        };
        if changed_resting.are_all {
            sleepers.iter().for_each(|sleeper| statics.meeting(sleeper, |partner| add(sleeper, partner)));
        } else {
            for (proxy, tree) in changed_resting.numbers.iter().copied().filter_map(sides) {
                tree.meeting(proxy, |partner| add(proxy, partner));
            }
            for record in scene.contacts.passes.iter().filter(|record| has_changed(scene, record, changed_resting)) {
                let (outline, body) = record.place();
                if let Some((proxy, tree)) = sides(self.numbers.number(outline)) {
                    tree.meeting(proxy, |partner| partner.body != body || add(proxy, partner));
                }
            }
        }
        if pairs.len() > before {
            pairs.sort_unstable();
            pairs.dedup();
        }
    }
}
