//! Matrices of sets of joined bodies: 3×3 blocks, symmetric, eliminated by Cholesky (LLᵀ) in an order that keeps most blocks zero.
//!
//! The order takes a body with the fewest neighbours next (minimum degree). In a tree that is a leaf, so no block is added; in a loop the
//! neighbours of a body become neighbours of each other.

use alloc::collections::BTreeSet;
use alloc::vec::Vec;
use core::ops::Range;

use crate::slots::NONE;
use crate::solve::float::{Vector, dot};

/// A 3×3 matrix by rows.
pub(super) type Block = [Vector; 3];

/// The matrices of all sets. Bodies have ranks: the order in which they are eliminated, set after set.
#[derive(Debug, Default)]
pub(super) struct Matrix {
    /// The rank by body, [`NONE`] for bodies without.
    rank_of: Vec<u32>,
    /// The end of the blocks of each column.
    ends: Vec<u32>,
    /// The ranks of the rows of blocks below the diagonal, rising in each column.
    rows: Vec<u32>,
    diagonal: Vec<Block>,
    below: Vec<Block>,
}

/// The product of a matrix and a vector.
fn product(block: &Block, vector: &Vector) -> Vector {
    block.map(|row| dot(&row, vector))
}

/// The product of the transpose of a matrix and a vector.
fn transposed_product(block: &Block, vector: &Vector) -> Vector {
    [0, 1, 2].map(|i| (0..3).map(|k| block[k][i] * vector[k]).sum())
}

/// The lower factor of a symmetric positive definite matrix, with the inverse of its diagonal on the diagonal.
fn factor(block: &Block) -> Block {
    let mut lower = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let sum = block[i][j] - dot(&lower[i][..j], &lower[j][..j]);
            // The unit matrix is part of it: pivots are at least 1 but for rounding.
            lower[i][j] = if i == j { 1.0 / libm::sqrt(sum.max(0.5)) } else { sum * lower[j][j] };
        }
    }
    lower
}

/// The solution of the lower factor.
fn forward(lower: &Block, vector: &Vector) -> Vector {
    let mut solution = [0.0; 3];
    for i in 0..3 {
        solution[i] = (vector[i] - dot(&lower[i][..i], &solution[..i])) * lower[i][i];
    }
    solution
}

/// The solution of the transpose of the lower factor.
fn backward(lower: &Block, vector: &Vector) -> Vector {
    let mut solution = [0.0; 3];
    for i in (0..3).rev() {
        let sum: f64 = (i + 1..3).map(|k| lower[k][i] * solution[k]).sum();
        solution[i] = (vector[i] - sum) * lower[i][i];
    }
    solution
}

impl Matrix {
    /// Forgets all sets, for a number of bodies.
    pub(super) fn clear(&mut self, bodies: usize) {
        let Self { rank_of, ends, rows, diagonal, below } = self;
        rank_of.clear();
        rank_of.resize(bodies, NONE);
        ends.clear();
        rows.clear();
        diagonal.clear();
        below.clear();
    }

    /// Adds a set: the pairs of its bodies that joints connect, [`NONE`] for a body that cannot be moved. Returns its ranks.
    pub(super) fn add_set(&mut self, links: impl Iterator<Item = [u32; 2]> + Clone) -> Range<usize> {
        let begin = self.diagonal.len();
        let mut bodies = Vec::new();
        for body in links.clone().flatten().filter(|&body| body != NONE) {
            if self.rank_of[body as usize] == NONE {
                self.rank_of[body as usize] = bodies.len() as u32;
                bodies.push(body);
            }
        }
        let mut neighbours = alloc::vec![BTreeSet::new(); bodies.len()];
        for [a, b] in links.filter(|link| !link.contains(&NONE)) {
            let [a, b] = [a, b].map(|body| self.rank_of[body as usize]);
            neighbours[a as usize].insert(b);
            neighbours[b as usize].insert(a);
        }
        let degree = |neighbours: &[BTreeSet<u32>], body: u32| (neighbours[body as usize].len(), body);
        let mut queue: BTreeSet<_> = (0..bodies.len() as u32).map(|body| degree(&neighbours, body)).collect();
        let mut columns = Vec::new();
        let mut ranks = alloc::vec![0; bodies.len()];
        while let Some((_, body)) = queue.pop_first() {
            let column = core::mem::take(&mut neighbours[body as usize]);
            for &neighbour in &column {
                queue.remove(&degree(&neighbours, neighbour));
                let links = &mut neighbours[neighbour as usize];
                links.extend(column.iter().filter(|&&body| body != neighbour));
                links.remove(&body);
                queue.insert(degree(&neighbours, neighbour));
            }
            ranks[body as usize] = (begin + columns.len()) as u32;
            columns.push(column);
        }
        for column in columns {
            let first = self.rows.len();
            self.rows.extend(column.into_iter().map(|body| ranks[body as usize]));
            self.rows[first..].sort_unstable();
            self.ends.push(self.rows.len() as u32);
        }
        for (body, rank) in bodies.into_iter().zip(ranks) {
            self.rank_of[body as usize] = rank;
        }
        self.diagonal.resize(self.ends.len(), Block::default());
        self.below.resize(self.rows.len(), Block::default());
        begin..self.diagonal.len()
    }

    /// The number of ranks.
    pub(super) fn len(&self) -> usize {
        self.diagonal.len()
    }

    /// Returns true if it was made for this number of bodies.
    pub(super) fn is_for(&self, bodies: usize) -> bool {
        self.rank_of.len() == bodies
    }

    /// The rank of a body.
    pub(super) fn rank(&self, body: u32) -> Option<usize> {
        self.rank_of.get(body as usize).filter(|&&rank| rank != NONE).map(|&rank| rank as usize)
    }

    /// The blocks of a column below the diagonal.
    fn column(&self, rank: usize) -> Range<usize> {
        let begin = if rank == 0 { 0 } else { self.ends[rank - 1] };
        begin as usize..self.ends[rank] as usize
    }

    /// The block of two ranks, the higher one first.
    fn block_mut(&mut self, row: usize, column: usize) -> &mut Block {
        let range = self.column(column);
        // It is there: both are neighbours.
        let place = self.rows[range.clone()].partition_point(|&rank| (rank as usize) < row);
        &mut self.below[range.start + place]
    }

    /// Begins the matrix of a set with the unit matrix.
    pub(super) fn begin(&mut self, ranks: Range<usize>) {
        for rank in ranks {
            self.diagonal[rank] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let range = self.column(rank);
            self.below[range].fill(Block::default());
        }
    }

    /// Adds sᵀ·t to the block of two ranks, row and column, for the vectors of a row of a joint.
    pub(super) fn add(&mut self, ranks: [usize; 2], row: &Vector, column: &Vector) {
        let [first, second] = ranks;
        let (block, row, column) = match first.cmp(&second) {
            core::cmp::Ordering::Equal => (&mut self.diagonal[first], row, column),
            core::cmp::Ordering::Greater => (self.block_mut(first, second), row, column),
            // The block is the transpose of the one below the diagonal.
            core::cmp::Ordering::Less => return,
        };
        for (elements, part) in block.iter_mut().zip(row) {
            elements.iter_mut().zip(column).for_each(|(element, factor)| *element += part * factor);
        }
    }

    /// Eliminates the bodies of a set.
    pub(super) fn factor(&mut self, ranks: Range<usize>) {
        for rank in ranks {
            let lower = factor(&self.diagonal[rank]);
            self.diagonal[rank] = lower;
            let range = self.column(rank);
            for k in range.clone() {
                self.below[k] = self.below[k].map(|row| forward(&lower, &row));
            }
            for k in range.clone() {
                let (row, rows) = (self.rows[k] as usize, self.below[k]);
                for l in range.start..=k {
                    let columns = self.below[l];
                    let column = self.rows[l] as usize;
                    let block = if l == k { &mut self.diagonal[row] } else { self.block_mut(row, column) };
                    for (elements, row) in block.iter_mut().zip(&rows) {
                        elements.iter_mut().zip(&columns).for_each(|(element, column)| *element -= dot(row, column));
                    }
                }
            }
        }
    }

    /// Solves the eliminated matrix of a set, in place. `vectors` are by rank.
    pub(super) fn solve(&self, ranks: Range<usize>, vectors: &mut [Vector]) {
        for rank in ranks.clone() {
            let solution = forward(&self.diagonal[rank], &vectors[rank]);
            vectors[rank] = solution;
            for k in self.column(rank) {
                let gain = product(&self.below[k], &solution);
                let vector = &mut vectors[self.rows[k] as usize];
                (0..3).for_each(|i| vector[i] -= gain[i]);
            }
        }
        for rank in ranks.rev() {
            let mut vector = vectors[rank];
            for k in self.column(rank) {
                let gain = transposed_product(&self.below[k], &vectors[self.rows[k] as usize]);
                (0..3).for_each(|i| vector[i] -= gain[i]);
            }
            vectors[rank] = backward(&self.diagonal[rank], &vector);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::run_seed;
    use crate::math::Random;

    /// A random graph of joints, and rows at random: the solution, put in, gives the right side.
    #[test]
    fn solutions_solve_matrices_of_any_graph() {
        let mut random = Random::seeded(run_seed(3));
        for _ in 0..200 {
            let bodies = 2 + random.below(12) as u32;
            let mut links: Vec<[u32; 2]> =
                (1..bodies).map(|body| [random.below(u64::from(body)) as u32, body]).collect();
            for _ in 0..random.below(4) {
                let body = 1 + random.below(u64::from(bodies) - 1) as u32;
                links.push([random.below(u64::from(body)) as u32, body]);
            }
            links.push([NONE, 0]);
            let mut matrix = Matrix::default();
            matrix.clear(bodies as usize);
            let ranks = matrix.add_set(links.iter().copied());
            assert_eq!(ranks, 0..bodies as usize);
            let mut number = || random.below(1 << 20) as f64 / f64::from(1 << 19) - 1.0;
            let rows: Vec<[Vector; 2]> =
                links.iter().map(|_| [0, 1].map(|_| [0, 1, 2].map(|_| 8.0 * number()))).collect();
            matrix.begin(ranks.clone());
            for (link, row) in links.iter().zip(&rows) {
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if let (Some(row_rank), Some(column_rank)) = (matrix.rank(link[i]), matrix.rank(link[j])) {
                        matrix.add([row_rank, column_rank], &row[i], &row[j]);
                    }
                }
            }
            let right: Vec<Vector> = (0..bodies).map(|_| [0, 1, 2].map(|_| number())).collect();
            matrix.factor(ranks.clone());
            let mut solution = right.clone();
            matrix.solve(ranks, &mut solution);
            let mut left = solution.clone();
            for (link, row) in links.iter().zip(&rows) {
                let ends = [0, 1].map(|side| matrix.rank(link[side]));
                let along: f64 =
                    (0..2).map(|side| ends[side].map_or(0.0, |rank| dot(&row[side], &solution[rank]))).sum();
                for (side, rank) in ends.into_iter().enumerate() {
                    if let Some(rank) = rank {
                        (0..3).for_each(|i| left[rank][i] += row[side][i] * along);
                    }
                }
            }
            for (left, right) in left.as_flattened().iter().zip(right.as_flattened()) {
                assert!((left - right).abs() < 1e-10, "{left} {right}");
            }
        }
    }
}
