//! Quantities that a step changes, one array per quantity and component.

use alloc::vec::Vec;

use super::Locks;
use super::columns::push;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Scalar};

/// Linear and angular acceleration, m/s² and rad/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Acceleration<S: Scalar> {
    pub(crate) linear: Vec2<S::Wide>,
    pub(crate) angular: S::Wide,
}

/// Vectors, one array a component.
#[derive(Debug, Default)]
pub(crate) struct Plane<T> {
    pub(crate) x: Vec<T>,
    pub(crate) y: Vec<T>,
}

clone_by_field!([T: Clone] Plane<T> { x, y });

impl<T: Copy> Plane<T> {
    pub(crate) fn get(&self, i: usize) -> Vec2<T> {
        Vec2::new(self.x[i], self.y[i])
    }

    pub(crate) fn set(&mut self, i: usize, value: Vec2<T>) {
        (self.x[i], self.y[i]) = (value.x, value.y);
    }

    fn push(&mut self, value: Vec2<T>) {
        push(&mut self.x, value.x);
        push(&mut self.y, value.y);
    }

    fn pop(&mut self) {
        self.x.pop();
        self.y.pop();
    }

    fn swap(&mut self, a: usize, b: usize) {
        self.x.swap(a, b);
        self.y.swap(a, b);
    }
}

/// Quantities of the bodies that a step changes.
#[derive(Debug, Default)]
pub(crate) struct Motion<S: Scalar> {
    pub(crate) position: Plane<S::Accumulator>,
    pub(crate) velocity: Plane<S::Accumulator>,
    pub(crate) angle: Vec<S::Angle>,
    pub(crate) angular_velocity: Vec<S::Accumulator>,
    /// The number of steps in a row that left the body as it was.
    pub(crate) ticks_at_rest: Vec<u32>,
    /// The acceleration of the step before: state of `PublishedVerlet`, empty otherwise.
    pub(crate) last_acceleration: Vec<Acceleration<S>>,
}

clone_by_field!(Motion { position, velocity, angle, angular_velocity, ticks_at_rest, last_acceleration });

impl<S: Scalar> Motion<S> {
    /// Adds a body; its last acceleration is left to the caller.
    pub(super) fn push(&mut self, position: Vec2<S>, velocity: Vec2<S>, angle: S::Angle, angular_velocity: S) {
        self.position.push(position.map(S::Accumulator::from_scalar));
        self.velocity.push(velocity.map(S::Accumulator::from_scalar));
        push(&mut self.angle, angle);
        push(&mut self.angular_velocity, S::Accumulator::from_scalar(angular_velocity));
        push(&mut self.ticks_at_rest, 0);
    }

    /// Takes over a body of `source`, to the bit.
    pub(super) fn copy(&mut self, i: usize, source: &Self, j: usize) {
        self.position.set(i, source.position.get(j));
        self.velocity.set(i, source.velocity.get(j));
        self.angle[i] = source.angle[j];
        self.angular_velocity[i] = source.angular_velocity[j];
        self.ticks_at_rest[i] = source.ticks_at_rest[j];
        if let (Some(last), Some(source_last)) = (self.last_acceleration.get_mut(i), source.last_acceleration.get(j)) {
            *last = *source_last;
        }
    }

    /// Stops body `i` along the locked axes.
    pub(super) fn lock(&mut self, i: usize, locks: Locks) {
        let Locks { x, y, rotation } = locks;
        let still = S::Accumulator::default();
        let mut none = Acceleration::default();
        let last = self.last_acceleration.get_mut(i).unwrap_or(&mut none);
        if x {
            (self.velocity.x[i], last.linear.x) = (still, S::Wide::default());
        }
        if y {
            (self.velocity.y[i], last.linear.y) = (still, S::Wide::default());
        }
        if rotation {
            (self.angular_velocity[i], last.angular) = (still, S::Wide::default());
        }
    }

    /// Stops a body, unless it is [still](Accumulator::is_still): it may be slow when it falls asleep.
    pub(crate) fn stop(&mut self, i: usize) {
        if !self.is_still(i) {
            self.velocity.set(i, Vec2::new(S::Accumulator::default(), S::Accumulator::default()));
            self.angular_velocity[i] = S::Accumulator::default();
        }
    }

    /// Returns true if the public velocities of a body are zero.
    pub(crate) fn is_still(&self, i: usize) -> bool {
        let [x, y] = [self.velocity.x[i], self.velocity.y[i]];
        [x, y, self.angular_velocity[i]].iter().all(|velocity| velocity.is_still())
    }

    /// Makes room to [`keep`](Self::keep) so many bodies.
    pub(crate) fn make_room(&mut self, count: usize) {
        fn reserve<T>(column: &mut Vec<T>, count: usize) {
            column.reserve(count.saturating_sub(column.len()));
        }
        let Plane { x, y } = &mut self.position;
        let Plane { x: vx, y: vy } = &mut self.velocity;
        [x, y, vx, vy, &mut self.angular_velocity].into_iter().for_each(|column| reserve(column, count));
        reserve(&mut self.angle, count);
    }

    /// Takes over the bodies of a block, in the memory that is there.
    pub(crate) fn keep(&mut self, block: &Block<'_, S>) {
        fn copy<T: Copy>(to: &mut Vec<T>, from: &[T]) {
            to.clear();
            to.reserve(from.len());
            // In pieces that stay in the nearest cache: a copy of all at once takes twice the instructions.
            from.chunks(BLOCK).for_each(|part| to.extend_from_slice(part));
        }
        let [x, y] = &block.position;
        let [vx, vy] = &block.velocity;
        copy(&mut self.position.x, x);
        copy(&mut self.position.y, y);
        copy(&mut self.velocity.x, vx);
        copy(&mut self.velocity.y, vy);
        copy(&mut self.angle, block.angle);
        copy(&mut self.angular_velocity, block.angular_velocity);
        copy(&mut self.last_acceleration, block.last_acceleration);
    }

    /// Takes body `i` of the block that was kept back to what it was. Its ticks at rest are not kept.
    pub(crate) fn restore(&self, block: &mut Block<'_, S>, i: usize) {
        let (position, velocity) = (self.position.get(i), self.velocity.get(i));
        (block.position[0][i], block.position[1][i]) = (position.x, position.y);
        (block.velocity[0][i], block.velocity[1][i]) = (velocity.x, velocity.y);
        block.angle[i] = self.angle[i];
        block.angular_velocity[i] = self.angular_velocity[i];
        if let Some(last) = self.last_acceleration.get(i) {
            block.last_acceleration[i] = *last;
        }
    }

    /// Returns true if body `i` of the kept block is unchanged, to the bit.
    pub(crate) fn is_same(&self, block: &Block<'_, S>, i: usize) -> bool {
        self.position.get(i) == Vec2::new(block.position[0][i], block.position[1][i])
            && self.velocity.get(i) == Vec2::new(block.velocity[0][i], block.velocity[1][i])
            && self.angle[i] == block.angle[i]
            && self.angular_velocity[i] == block.angular_velocity[i]
            && self.last_acceleration.get(i) == block.last_acceleration.get(i)
    }

    /// Removes the last body.
    pub(super) fn pop(&mut self) {
        self.position.pop();
        self.velocity.pop();
        self.angle.pop();
        self.angular_velocity.pop();
        self.ticks_at_rest.pop();
        self.last_acceleration.pop();
    }

    pub(super) fn swap(&mut self, a: usize, b: usize) {
        self.position.swap(a, b);
        self.velocity.swap(a, b);
        self.angle.swap(a, b);
        self.angular_velocity.swap(a, b);
        self.ticks_at_rest.swap(a, b);
        if !self.last_acceleration.is_empty() {
            self.last_acceleration.swap(a, b);
        }
    }
}

/// Bodies that move together through the stages of a step: few enough that they stay in the nearest cache.
pub(crate) const BLOCK: usize = 128;

/// Some of the bodies that move, one after the other in the columns.
pub(crate) struct Block<'a, S: Scalar> {
    /// The index of the first in the columns.
    pub(crate) first: usize,
    pub(crate) position: [&'a mut [S::Accumulator]; 2],
    pub(crate) velocity: [&'a mut [S::Accumulator]; 2],
    pub(crate) angle: &'a mut [S::Angle],
    pub(crate) angular_velocity: &'a mut [S::Accumulator],
    pub(crate) ticks_at_rest: &'a mut [u32],
    /// Empty unless the integrator is `PublishedVerlet`.
    pub(crate) last_acceleration: &'a mut [Acceleration<S>],
    /// The rows of the [`FactorTable`](super::FactorTable) that the bodies have.
    pub(crate) factors: &'a [u32],
}

impl<'a, S: Scalar> Block<'a, S> {
    pub(super) fn new(motion: &'a mut Motion<S>, factors: &'a [u32], first: usize, end: usize) -> Self {
        let range = first..end;
        let Motion { position, velocity, angle, angular_velocity, ticks_at_rest, last_acceleration } = motion;
        Self {
            first,
            position: [&mut position.x[range.clone()], &mut position.y[range.clone()]],
            velocity: [&mut velocity.x[range.clone()], &mut velocity.y[range.clone()]],
            angle: &mut angle[range.clone()],
            angular_velocity: &mut angular_velocity[range.clone()],
            ticks_at_rest: &mut ticks_at_rest[range.clone()],
            last_acceleration: if last_acceleration.is_empty() {
                last_acceleration
            } else {
                &mut last_acceleration[range.clone()]
            },
            factors: &factors[range],
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.factors.len()
    }

    /// The first `count` of them, and the others.
    pub(crate) fn split(self, count: usize) -> (Self, Self) {
        fn pair<T>([x, y]: [&mut [T]; 2], count: usize) -> ([&mut [T]; 2], [&mut [T]; 2]) {
            let ((x, x2), (y, y2)) = (x.split_at_mut(count), y.split_at_mut(count));
            ([x, y], [x2, y2])
        }
        let (position, position2) = pair(self.position, count);
        let (velocity, velocity2) = pair(self.velocity, count);
        let (angle, angle2) = self.angle.split_at_mut(count);
        let (angular_velocity, angular_velocity2) = self.angular_velocity.split_at_mut(count);
        let (ticks_at_rest, ticks_at_rest2) = self.ticks_at_rest.split_at_mut(count);
        let (last_acceleration, last_acceleration2) =
            self.last_acceleration.split_at_mut(count.min(self.last_acceleration.len()));
        let (factors, factors2) = self.factors.split_at(count);
        let first = self.first;
        (
            Self { first, position, velocity, angle, angular_velocity, ticks_at_rest, last_acceleration, factors },
            Self {
                first: first + count,
                position: position2,
                velocity: velocity2,
                angle: angle2,
                angular_velocity: angular_velocity2,
                ticks_at_rest: ticks_at_rest2,
                last_acceleration: last_acceleration2,
                factors: factors2,
            },
        )
    }

    /// Returns true if any body of the block turns.
    pub(crate) fn any_turns(&self) -> bool {
        self.angular_velocity.iter().any(|angular_velocity| *angular_velocity != S::Accumulator::default())
    }

    /// Returns true if the public velocities of body `i` of the block are zero.
    pub(crate) fn is_still(&self, i: usize) -> bool {
        self.velocity[0][i].is_still() && self.velocity[1][i].is_still() && self.angular_velocity[i].is_still()
    }
}
