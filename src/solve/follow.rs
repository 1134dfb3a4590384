//! Followers: copies of bodies without masses, for contacts that are not to move the body.
//!
//! Where two bodies of unlike dominance touch, the contact is one of the lower body with a follower of the higher one: a fixed body that
//! moves as its leader does. To the graph it is a fixed body like any other, so that the leader's island knows nothing of the contact, and
//! units, shares and phases of the leader do not depend on it. The rows of a follower, one for each unit of its contacts, are set to the
//! row of its leader after every change of it.
//!
//! A leader without contacts of its own has no row: its follower goes along its free flight, as a kinematic body does.
//!
//! Reads: the rows of leaders. Writes: the rows of followers.

use super::Flight;
use super::bodies::{BodyRows, STILL};
use super::graph::Graph;
use super::number::shifted_word;

/// A row of a follower, which is set to the row of its leader.
#[derive(Clone, Copy, Debug)]
pub(super) struct Follower {
    pub(super) row: u32,
    pub(super) leader: u32,
    /// log2 of its unit over the unit of its leader: not negative.
    pub(super) down: i32,
}

/// An island is as fast as the leaders whose followers it touches, so that its unit is not finer than theirs. Islands of leaders may
/// touch followers themselves: this goes on until no speed changes.
pub(super) fn add_leader_speeds(fastest: &mut [u64], graph: &Graph, flights: &[Flight]) {
    let pairs = || (0..).zip(flights).filter_map(|(body, flight)| Some((body, flight.leader?)));
    let mut has_changed = pairs().next().is_some();
    while has_changed {
        has_changed = false;
        for (follower, leader) in pairs() {
            let Some(leader_island) = graph.island_of(leader) else { continue };
            let speed = fastest[leader_island as usize];
            for neighbour in graph.touched_by(follower) {
                if let Some(island) = graph.island_of(neighbour) {
                    let fastest = &mut fastest[island as usize];
                    has_changed |= *fastest < speed;
                    *fastest = (*fastest).max(speed);
                }
            }
        }
    }
}

/// Lists the rows of followers whose leaders have rows.
pub(super) fn set_followers(bodies: &mut BodyRows, flights: &[Flight]) {
    let BodyRows { row_of, bodies, carriers, carrier_of, followers, .. } = bodies;
    followers.clear();
    let pairs = (0..).zip(flights).filter_map(|(body, flight): (usize, _)| Some((body, flight.leader? as usize)));
    for (body, leader) in pairs.filter(|&(_, leader)| row_of[leader] != STILL) {
        let mut next = carrier_of[body];
        while let Some(index) = next {
            let carrier = &carriers[index as usize];
            let down = carrier.unit - bodies[leader].unit;
            followers.push(Follower { row: carrier.row, leader: row_of[leader], down });
            next = carrier.next;
        }
    }
}

/// Sets the rows of followers to the rows of their leaders.
pub(super) fn follow(bodies: &mut BodyRows) {
    let BodyRows { rows, followers, .. } = bodies;
    for &Follower { row, leader, down } in followers.iter() {
        let motion = [rows.velocity(leader), rows.displacement(leader)];
        let [velocity, moved] = motion.map(|vector| vector.map(|value| shifted_word(value.into(), down) as i32));
        let row = &mut rows.rows[row as usize];
        // The fourth component of a velocity is the angle.
        (row.velocity, row.displacement) = ([velocity[0], velocity[1], velocity[2], moved[2]], moved);
    }
}
