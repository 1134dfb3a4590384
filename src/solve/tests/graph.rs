//! The graph against a graph by brute force.

use alloc::vec;
use alloc::vec::Vec;

use super::made::Ranges;
use super::scene::{body, fixed, fx};
use crate::cases::{run_seed, times};
use crate::math::{Random, Vec2};
use crate::solve::graph::{Graph, graph_start};
use crate::solve::{Flight, Solver};

/// Labels of islands by relabelling until nothing changes; the body itself where it is fixed or touches nothing.
fn labels(fixed: &[bool], links: &[[u32; 2]]) -> Vec<usize> {
    let mut label: Vec<usize> = (0..fixed.len()).collect();
    for _ in 0..fixed.len() {
        for [a, b] in links.iter().map(|link| link.map(|body| body as usize)) {
            if !fixed[a] && !fixed[b] {
                let min_label = label[a].min(label[b]);
                (label[a], label[b]) = (min_label, min_label);
            }
        }
    }
    label
}

/// Distances from the sources by Bellman and Ford.
fn distances(is_source: &[bool], links: &[[u32; 2]]) -> Vec<Option<u32>> {
    let mut distance: Vec<Option<u32>> = is_source.iter().map(|&source| source.then_some(0)).collect();
    for _ in 0..is_source.len() {
        for [a, b] in links.iter().map(|link| link.map(|body| body as usize)) {
            for (from, to) in [(a, b), (b, a)] {
                if let Some(next) = distance[from].map(|d| d + 1) {
                    distance[to] = Some(distance[to].map_or(next, |d| d.min(next)));
                }
            }
        }
    }
    distance
}

/// Chooses every third body of an island, and the first.
fn choose_starts(members: &[u32], queue: &mut Vec<u32>) {
    let first = members.iter().min().copied().into_iter();
    let mut chosen: Vec<u32> = members.iter().copied().filter(|body| body % 3 == 0).chain(first).collect();
    chosen.sort_unstable();
    chosen.dedup();
    queue.extend(chosen);
}

fn check(graph: &Graph, fixed: &[bool], links: &[[u32; 2]]) {
    let label = labels(fixed, links);
    let links_of = |body: u32| links.iter().filter(move |link| link.contains(&body));
    let has_island = |body: u32| !fixed[body as usize] && links_of(body).next().is_some();
    let mut sources = fixed.to_vec();
    let grounded = distances(fixed, links);
    for island in 0..fixed.len() {
        let members: Vec<u32> =
            (0..fixed.len() as u32).filter(|&body| label[body as usize] == island && has_island(body)).collect();
        if members.iter().all(|&body| grounded[body as usize].is_none()) {
            let mut chosen = Vec::new();
            choose_starts(&members, &mut chosen);
            chosen.iter().for_each(|&body| sources[body as usize] = true);
        }
    }
    let level = distances(&sources, links);
    let bodies = 0..fixed.len() as u32;
    for a in bodies.clone() {
        assert_eq!(graph.island_of(a).is_some(), has_island(a));
        for b in bodies.clone().filter(|&b| has_island(a) && has_island(b)) {
            assert_eq!(graph.island_of(a) == graph.island_of(b), label[a as usize] == label[b as usize]);
        }
        let mut neighbours: Vec<u32> = graph.touched_by(a).collect();
        let mut expected: Vec<u32> = links_of(a).map(|&[x, y]| if x == a { y } else { x }).collect();
        neighbours.sort_unstable();
        expected.sort_unstable();
        assert_eq!(neighbours, expected);
    }
    for &link in links {
        let [a, b] = link.map(|body| level[body as usize].expect("it touches something"));
        assert_eq!(graph.phase(link), if a == b { 2 } else { (a.min(b) % 2) as usize });
        assert_eq!(graph.mover(link), link.into_iter().find(|&body| has_island(body)));
    }
    let mut islands: Vec<usize> = bodies.filter(|&body| has_island(body)).map(|body| label[body as usize]).collect();
    islands.sort_unstable();
    islands.dedup();
    assert_eq!(graph.islands(), islands.len());
}

/// Bodies and links, of which many stay from graph to graph.
#[derive(Default)]
struct Drawn {
    fixed: Vec<bool>,
    links: Vec<[u32; 2]>,
}

impl Drawn {
    /// Draws all anew, one more body, whether one body is fixed, or one link; or leaves all as it is.
    fn draw(&mut self, random: &mut Random) {
        let bodies = self.fixed.len();
        match random.below(6) {
            0 | 1 => {
                let bodies = 2 + random.below(24) as usize;
                let share = random.below(4);
                self.fixed = (0..bodies).map(|_| random.below(8) < share).collect();
                self.links = (0..random.below(2 * bodies as u64)).map(|_| draw_link(random, bodies)).collect();
            }
            2 => self.fixed.push(false),
            3 if bodies > 0 => self.fixed[random.below(bodies as u64) as usize] ^= true,
            4 if !self.links.is_empty() => {
                let index = random.below(self.links.len() as u64) as usize;
                self.links[index] = draw_link(random, bodies);
            }
            _ => {}
        }
        let Self { fixed, links } = self;
        links.retain(|link| link[0] != link[1] && !link.iter().all(|&body| fixed[body as usize]));
    }
}

fn draw_link(random: &mut Random, bodies: usize) -> [u32; 2] {
    [0; 2].map(|_| random.below(bodies as u64) as u32)
}

/// A graph with any past is the one that brute force finds.
#[test]
fn islands_levels_and_phases_match_brute_force() {
    let mut random = Random::seeded(run_seed(1));
    let mut graph = Graph::default();
    let (mut drawn, mut kept) = (Drawn::default(), 0);
    for _ in 0..6000 {
        drawn.draw(&mut random);
        let Drawn { fixed, links } = &drawn;
        let is_new = graph.build(|body| fixed[body as usize], fixed.len(), links.iter().copied(), choose_starts);
        check(&graph, fixed, links);
        kept += u32::from(!is_new);
    }
    assert!(kept > 500, "{kept} graphs were kept");
}

/// A solver solves a scene as a new one does, whatever it solved before: the same links with other contacts, or other links.
#[test]
fn a_solver_with_a_past_solves_as_a_new_one_does() {
    let (mut random, ranges) = (Random::seeded(run_seed(4)), Ranges::default());
    let mut solver = Solver::default();
    for _ in 0..times(400) {
        let mut scene = ranges.scene(&mut random, 6, 10);
        scene.flights[5] = fixed(4.0);
        for _ in 0..3 {
            assert_eq!(scene.solve_with(&mut solver), scene.solve());
            for contact in &mut scene.contacts {
                *contact = ranges.contact(&mut random, contact.bodies, &scene.flights);
            }
        }
    }
}

/// Islands start from the heaviest bodies nearest to the centre of mass, from all of them if several tie, by exact fractions.
#[test]
fn islands_start_from_the_heaviest_and_nearest() {
    let mut random = Random::seeded(run_seed(2));
    let mut ties = 0;
    for _ in 0..3000 {
        let count = 1 + random.below(8) as usize;
        let offset = i128::from(random.integer(-(1 << 30)..=1 << 30));
        let mut draw = |limit: u64| i128::from(random.below(limit));
        let bodies: Vec<[i128; 3]> = (0..count).map(|_| [1 + draw(3), offset + draw(5), draw(5)]).collect();
        let flights: Vec<Flight> = bodies
            .iter()
            .map(|&[mass, x, y]| Flight {
                position: Vec2::new(fx(x as f64), fx(y as f64)),
                ..body(mass as f64, 2.0, 1.0)
            })
            .collect();
        let mass: i128 = bodies.iter().map(|body| body[0]).sum();
        let [sx, sy] = [1, 2].map(|i| bodies.iter().map(|body| body[0] * body[i]).sum::<i128>());
        let distance = |body: &[i128; 3]| (mass * body[1] - sx).pow(2) + (mass * body[2] - sy).pow(2);
        let max_mass = bodies.iter().map(|body| body[0]).max();
        let is_heaviest = |body: &&[i128; 3]| Some(body[0]) == max_mass;
        let min_distance = bodies.iter().filter(is_heaviest).map(distance).min();
        let expected: Vec<u32> = (0..count as u32)
            .filter(|&i| is_heaviest(&&bodies[i as usize]) && Some(distance(&bodies[i as usize])) == min_distance)
            .collect();
        ties += usize::from(expected.len() > 1);
        let members: Vec<u32> = (0..count as u32).collect();
        let mut queue = vec![];
        graph_start(&flights, &members, &mut queue);
        assert_eq!(queue, expected, "{bodies:?}");
    }
    assert!(ties > 200, "{ties}");
}
