//! The figures of other engines, from one run of `benches/peers`.

use serde::Serialize;

/// An engine of the figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Peer {
    /// The name in the figures.
    #[serde(rename = "engine")]
    pub(super) id: &'static str,
    #[serde(skip)]
    pub(super) title: &'static str,
    pub(super) version: &'static str,
}

pub(super) const BOX2D: Peer = Peer { id: "box2d", title: "Box2D", version: "3.2.0" };
pub(super) const PEERS: [Peer; 2] = [BOX2D, Peer { id: "rapier", title: "Rapier", version: "0.36.1" }];

const FIGURES: &str = include_str!("peers.csv");

/// A figure of an engine, and the length of its run.
pub(super) fn figure(peer: Peer, scene: &str, measure: &str) -> Option<(f64, &'static str)> {
    let is_it = |line: &&str| line.split(',').take(3).eq([peer.id, scene, measure]);
    let mut rest = FIGURES.lines().find(is_it)?.split(',').skip(3);
    let value = rest.next()?.parse().ok()?;
    Some((value, rest.nth(1)?))
}

/// The lines above the figures: the versions, and the command that made them.
pub(super) fn origin() -> String {
    FIGURES.lines().map_while(|line| line.strip_prefix("# ")).collect::<Vec<_>>().join("\n")
}
