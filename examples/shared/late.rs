//! A match of two peers with a bad line: an input arrives after 1 to 12 ticks. Each peer predicts what is missing, and goes back where it
//! was wrong.

use umbra_physics::{Error, Random, Rollback, World};

const WINDOW: usize = 8;

/// A peer after the match.
pub(crate) struct Peer<I> {
    pub(crate) player: u32,
    world: World,
    rollback: Rollback<I>,
    /// The hash of each tick that is final.
    pub(crate) hashes: Vec<u64>,
    /// Ticks that were made again.
    pub(crate) redone: u64,
}

impl<I: Clone + Default + PartialEq> Peer<I> {
    fn advance(&mut self, tick: impl FnMut(&mut World, &[(u32, I)])) -> Result<(), Error> {
        let report = self.rollback.advance(&mut self.world, tick)?;
        self.redone += report.redone;
        self.hashes.extend(report.confirmed().map(|tick| tick.after.state_hash()));
        Ok(())
    }
}

/// Plays so many ticks from a start: `input` is what a player does in a tick, and `tick` makes the calls of a tick.
pub(crate) fn play<I: Clone + Default + PartialEq>(
    start: &World,
    ticks: u64,
    input: impl Fn(u32, u64) -> I,
    tick: impl Fn(&mut World, &[(u32, I)]),
) -> Result<[Peer<I>; 2], Error> {
    let mut peers = [0, 1].map(|player| {
        let (world, rollback) = (start.clone(), Rollback::new(start, [0, 1], WINDOW));
        Peer { player, world, rollback, hashes: Vec::new(), redone: 0 }
    });
    // When an input arrives, whose it is, and its tick.
    let (mut random, mut line) = (Random::seeded(1), Vec::new());
    let mut frame = 0;
    while peers.iter().any(|peer| (peer.hashes.len() as u64) < ticks) {
        frame += 1;
        for peer in &mut peers {
            let is_here = |&(arrives, player, _): &(u64, u32, u64)| arrives <= frame && player != peer.player;
            for &(_, player, tick) in line.iter().filter(|sent| is_here(sent)) {
                peer.rollback.add_input(tick, player, input(player, tick))?;
            }
            line.retain(|sent| !is_here(sent));
            let now = peer.world.tick();
            if peer.rollback.add_input(now, peer.player, input(peer.player, now))? {
                line.push((frame + 1 + random.below(12), peer.player, now));
            }
            peer.advance(&tick)?;
        }
    }
    for Peer { hashes, .. } in &mut peers {
        hashes.truncate(ticks as usize);
    }
    Ok(peers)
}
