//! Colliders that stand still: those of static bodies, and those of sleeping ones. They stand in trees that a step only changes where a
//! call, or the last step, has changed a body, and which copies of a world share.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::engine::Engine;
use super::numerics::Numerics;
use super::{Detected, Scene};
use crate::body::{Activity, BodyKind};
use crate::collide::broad::{Proxy, Statics};
use crate::collider::Collider;
use crate::scalar::Scalar;

/// The trees of a world.
#[derive(Clone, Debug, Default)]
pub(super) struct Still {
    pub(super) statics: Arc<Statics>,
    pub(super) sleepers: Arc<Statics>,
}

/// The state of bodies that stand still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Static,
    Asleep,
}

impl<S: Scalar, N: Numerics<S>> Engine<S, N> {
    /// Follows the changes of colliders that stand still. `are_renumbered` says that outlines may have other numbers than before.
    pub(super) fn update_still(&mut self, scene: &Scene<'_, S>, are_renumbered: bool) -> Still {
        let is_current = self.statics_revision == scene.colliders.revision() && !are_renumbered;
        match (&self.still, scene.changed) {
            (Some(still), Some(changed)) if is_current && changed.is_empty() => return still.clone(),
            _ => {}
        }
        let next = match (&self.still, scene.changed) {
            (Some(still), Some(changed)) if !are_renumbered => {
                let changes = |tree: &Statics, state| -> Vec<_> {
                    let slots = changed.all(scene.colliders);
                    slots.flat_map(|slot| self.changes(scene, tree, slot, state)).collect()
                };
                let [statics, sleepers] =
                    [changes(&still.statics, State::Static), changes(&still.sleepers, State::Asleep)];
                if !statics.is_empty() {
                    self.tiles.clear();
                }
                [still.statics.changed(&statics), still.sleepers.changed(&sleepers)]
            }
            (still, _) => {
                self.tiles.clear();
                let mut proxies = core::mem::take(&mut self.standing);
                let next = [State::Static, State::Asleep].map(|state| {
                    proxies.clear();
                    if state == State::Static || scene.bodies.any_asleep() {
                        proxies.extend(scene.colliders.list().flat_map(|it| self.proxies(scene, it, state)));
                    }
                    let before = still.as_ref().map(|still| match state {
                        State::Static => &still.statics,
                        State::Asleep => &still.sleepers,
                    });
                    let is_same = before.is_some_and(|before| before.are(&proxies));
                    (!is_same).then(|| Statics::new(proxies.clone()))
                });
                self.standing = proxies;
                next
            }
        };
        self.statics_revision = scene.colliders.revision();
        let [statics, sleepers] = next;
        let mut still = self.still.take().unwrap_or_default();
        if let Some(statics) = statics {
            still.statics = Arc::new(statics);
        }
        if let Some(sleepers) = sleepers {
            still.sleepers = Arc::new(sleepers);
        }
        self.still = Some(still.clone());
        still
    }

    /// The boxes of a collider, if its body stands still in this way.
    fn proxies<'a>(
        &self,
        scene: &Scene<'a, S>,
        collider: &'a Collider<S>,
        state: State,
    ) -> impl Iterator<Item = Proxy> + use<'a, S, N> {
        let bodies = scene.bodies;
        let first = self.numbers.first(collider.slot);
        let is_still = |dense: &usize| match (bodies.activity(*dense), state) {
            (Activity::Awake, State::Static) => bodies.info(*dense).kind == BodyKind::Static,
            (Activity::Asleep, State::Asleep) => true,
            _ => false,
        };
        let dense = bodies.find(collider.body).ok().filter(is_still);
        let motion = &bodies.columns.motion;
        let pose = dense.map(|dense| N::pose(motion.position.get(dense), motion.angle[dense]));
        pose.into_iter().flat_map(move |pose| {
            (0..collider.outline_count()).map(move |part| Proxy {
                collider: first + part,
                body: collider.body.slot,
                bounds: N::resting(&collider.outline(part), &pose),
                filter: collider.def.filter,
            })
        })
    }

    /// The changes of a tree by the collider in a slot: it came, it left, or it is another one.
    fn changes(&self, scene: &Scene<'_, S>, tree: &Statics, slot: u32, state: State) -> Vec<(u32, Option<Proxy>)> {
        let numbers = self.numbers.of(slot);
        let proxies = scene.colliders.at(slot).into_iter().flat_map(|it| self.proxies(scene, it, state));
        let changes: Vec<_> = proxies.map(|proxy| (proxy.collider, Some(proxy))).collect();
        match changes.is_empty() {
            true => numbers.filter(|&number| tree.has(number)).map(|number| (number, None)).collect(),
            false => changes,
        }
    }

    /// Adds the pairs of a sleeping and a static collider of which a call may have moved one. One that sleeps and has more than
    /// `most` such pairs is touched.
    pub(super) fn pair_still(
        &self,
        scene: &Scene<'_, S>,
        still: &Still,
        (most, pairs): (usize, &mut Vec<[u32; 2]>),
        out: &mut Detected,
    ) {
        let Still { statics, sleepers } = still;
        if !scene.may_have_moved_statics || sleepers.is_empty() || statics.is_empty() {
            return;
        }
        let before = pairs.len();
        let mut pair_sleeper = |sleeper: &Proxy| {
            let first = pairs.len();
            statics.near(sleeper.bounds, |other| {
                if sleeper.filter.agrees(other.filter) && pairs.len() - first <= most {
                    pairs.push([sleeper.collider.min(other.collider), sleeper.collider.max(other.collider)]);
                }
            });
            if pairs.len() - first > most {
                pairs.truncate(first);
                let outline = self.numbers.outline(sleeper.collider);
                out.touched.extend(scene.colliders.at(outline.slot).map(|collider| collider.body));
            }
        };
        match scene.changed {
            None => sleepers.iter().for_each(pair_sleeper),
            Some(changed) => {
                for number in changed.all(scene.colliders).flat_map(|slot| self.numbers.of(slot)) {
                    if let Some(sleeper) = sleepers.find(number) {
                        pair_sleeper(sleeper);
                    } else if let Some(own) = statics.find(number) {
                        sleepers.near(own.bounds, &mut pair_sleeper);
                    }
                }
            }
        }
        if pairs.len() > before {
            pairs.sort_unstable();
            pairs.dedup();
        }
    }
}
