//! Masses: how they are given, the inverse masses that follow, and the table in which bodies that are alike share them.

use alloc::vec::Vec;

use super::{BodyInfo, BodyKind, Locks};
use crate::codec::codec_enum;
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::math::Vec2;
use crate::scalar::{Factor, Number, Scalar};
use crate::shape::Shape;
use crate::slots::{NONE, push};

/// How the mass and the moment of inertia of a dynamic body are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Mass<S = Fx> {
    /// A density in kg/m², times the area of the shape; in kg/m for a segment. The inertia follows from the shape.
    Density(S),
    /// A mass in kg. The inertia follows from the shape; without a shape it is infinite, and no torque turns the body.
    Kilograms(S),
    /// A mass and a moment of inertia.
    Explicit {
        /// The mass, kg.
        mass: S,
        /// The moment of inertia about the centre of mass, kg·m².
        inertia: S,
    },
}

codec_enum!(Mass<S>, "the number of a way to give a mass", {
    0 => Density(density),
    1 => Kilograms(mass),
    2 => Explicit { mass, inertia },
});

/// The locks of a body, and its inverse masses with the locks taken into account: a product with them is the effect of a
/// force, an impulse or a torque, and zero where the body is locked. All are zero for a body that is not dynamic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MassProperties<S: Scalar> {
    /// 1/m, 1/kg, whatever the locks are: drag slows a body by it.
    pub(crate) inverse_mass: S::Factor,
    /// 1/m along x and along y, 1/kg; zero along a locked axis. A dynamic body has it zero along locked axes only.
    pub(crate) axis_inverse_mass: Vec2<S::Factor>,
    /// 1/I, 1/(kg·m²); zero where the rotation is locked, or the inertia infinite.
    pub(crate) inverse_inertia: S::Factor,
    pub(crate) locks: Locks,
}

impl<S: Scalar> MassProperties<S> {
    /// *Domain* `inverse_inertia` is that of the body without its locks.
    pub(super) fn new(inverse_mass: S::Factor, inverse_inertia: S::Factor, locks: Locks) -> Self {
        let unless = |locked, factor| if locked { S::Factor::ZERO } else { factor };
        Self {
            inverse_mass,
            axis_inverse_mass: Vec2::new(unless(locks.x, inverse_mass), unless(locks.y, inverse_mass)),
            inverse_inertia: unless(locks.rotation, inverse_inertia),
            locks,
        }
    }

    /// A hash of what the properties are made from; its upper bits are the best ones.
    fn hash(&self) -> u64 {
        let Locks { x, y, rotation } = self.locks;
        let locks = u64::from(x) | u64::from(y) << 1 | u64::from(rotation) << 2;
        let (mass, inertia) = (self.inverse_mass.to_words(), self.inverse_inertia.to_words());
        // The golden ratio, 2^64/φ, as in Knuth's multiplicative hashing.
        let mix = |hash: u64, word: u64| (hash.rotate_left(29) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mass.into_iter().chain(inertia).fold(mix(0, locks), mix)
    }
}

/// The mass in kg of a dynamic body.
pub(super) fn mass_of<S: Scalar>(mass: Mass<S>, shape: Option<&Shape<S>>) -> Result<S, Error> {
    let out_of = |quantity| Error::OutOfRange { quantity };
    match mass {
        Mass::Density(density) => {
            if !(density > S::ZERO && density.is_finite()) {
                return Err(out_of(Quantity::Density));
            }
            let area = shape.ok_or(Error::NoShape)?.measure();
            S::Factor::from_scalar(density).times(area).to_scalar().ok_or(out_of(Quantity::Mass))
        }
        Mass::Kilograms(mass) | Mass::Explicit { mass, inertia: _ } => Ok(mass),
    }
}

/// The moment of inertia, kg·m², of a body of this mass in kg; zero stands for infinite.
pub(super) fn inertia_of<S: Scalar>(kilograms: S, mass: Mass<S>, shape: Option<&Shape<S>>) -> S::Factor {
    match (mass, shape) {
        (Mass::Explicit { mass: _, inertia }, _) => S::Factor::from_scalar(inertia),
        (_, Some(shape)) => S::Factor::from_scalar(kilograms).times(shape.gyration()),
        (_, None) => S::Factor::ZERO,
    }
}

/// The properties of a body that is defined like this.
///
/// # Errors
/// [`Error::OutOfRange`] naming the quantity; [`Error::NoShape`] for a density without a shape. A body that is not dynamic
/// may have any mass.
pub(crate) fn mass_properties<S: Scalar>(
    kind: BodyKind,
    mass: Mass<S>,
    shape: Option<&Shape<S>>,
    locks: Locks,
) -> Result<MassProperties<S>, Error> {
    let zero = S::Factor::ZERO;
    if kind != BodyKind::Dynamic {
        return Ok(MassProperties::new(zero, zero, locks));
    }
    if matches!(mass, Mass::Explicit { mass: _, inertia } if !(inertia > S::ZERO && inertia.is_finite())) {
        return Err(Error::OutOfRange { quantity: Quantity::Inertia });
    }
    let kilograms = mass_of(mass, shape)?;
    if !(kilograms >= S::from_fx(limits::MASS_MIN) && kilograms <= S::from_fx(limits::MASS_MAX)) {
        return Err(Error::OutOfRange { quantity: Quantity::Mass });
    }
    let inverse_mass = inverse::<S>(S::Factor::from_scalar(kilograms));
    Ok(MassProperties::new(inverse_mass, inverse::<S>(inertia_of(kilograms, mass, shape)), locks))
}

/// 1/I of a body without its locks; zero unless it is dynamic.
pub(super) fn inverse_inertia_of<S: Scalar>(info: &BodyInfo<S>) -> S::Factor {
    if info.kind == BodyKind::Dynamic { inverse::<S>(info.inertia()) } else { S::Factor::ZERO }
}

/// 1/f, and zero for the zero that stands for infinite.
fn inverse<S: Scalar>(f: S::Factor) -> S::Factor {
    if f.is_zero() { f } else { S::Factor::ONE.over(f) }
}

/// The mass properties in use. Bodies that are alike share a row, so that a body takes four bytes for its masses, and a copy
/// of a world those alone: copies share the table until a mass is changed in one.
///
/// The row number of a body is no state: it changes no bit of a result.
#[derive(Debug)]
pub(super) struct MassTable<S: Scalar> {
    rows: Vec<MassProperties<S>>,
    /// Number of bodies that have each row.
    users: Vec<u32>,
    /// Rows without a body, to be used again.
    free: Vec<u32>,
    /// A hash table of the rows with linear probing: a row, or [`NONE`]. A row that was given back and used again is in it
    /// once for each time, and found at one of its places.
    places: Vec<u32>,
    /// Number of places that are not [`NONE`]: at most half.
    taken: usize,
}

clone_by_field!(MassTable { rows, users, free, places, taken });

impl<S: Scalar> Default for MassTable<S> {
    fn default() -> Self {
        Self { rows: Vec::new(), users: Vec::new(), free: Vec::new(), places: Vec::new(), taken: 0 }
    }
}

impl<S: Scalar> MassTable<S> {
    /// The properties in a row.
    #[inline]
    pub(super) fn row(&self, row: u32) -> &MassProperties<S> {
        &self.rows[row as usize]
    }

    /// The row for a body with these properties. [`release`](Self::release) gives it back.
    pub(super) fn acquire(&mut self, properties: MassProperties<S>) -> u32 {
        if 2 * self.taken >= self.places.len() {
            self.rehash();
        }
        let place = self.find(&properties);
        let row = self.places[place];
        if row != NONE {
            self.users[row as usize] += 1;
            return row;
        }
        let row = if let Some(row) = self.free.pop() {
            (self.rows[row as usize], self.users[row as usize]) = (properties, 1);
            row
        } else {
            push(&mut self.rows, properties);
            push(&mut self.users, 1);
            (self.rows.len() - 1) as u32
        };
        self.places[place] = row;
        self.taken += 1;
        row
    }

    /// Gives a row back that a body no longer has.
    pub(super) fn release(&mut self, row: u32) {
        let users = &mut self.users[row as usize];
        *users -= 1;
        if *users == 0 {
            self.free.push(row);
        }
    }

    /// The place of the row with these properties, or the free place where it would be. *Domain* a place is free.
    fn find(&self, properties: &MassProperties<S>) -> usize {
        let last = self.places.len() - 1;
        let mut place = (properties.hash() >> 32) as usize & last;
        loop {
            let row = self.places[place];
            if row == NONE || (self.users[row as usize] > 0 && self.rows[row as usize] == *properties) {
                return place;
            }
            place = (place + 1) & last;
        }
    }

    /// Makes the hash table anew, of the rows that a body has, with at least three quarters of its places free.
    fn rehash(&mut self) {
        let used = self.rows.len() - self.free.len();
        let count = (4 * used).max(4).next_power_of_two().max(self.places.len());
        self.places.clear();
        self.places.resize(count, NONE);
        self.taken = used;
        for row in (0..self.rows.len()).filter(|&row| self.users[row] > 0) {
            let mut place = (self.rows[row].hash() >> 32) as usize & (count - 1);
            while self.places[place] != NONE {
                place = (place + 1) & (count - 1);
            }
            self.places[place] = row as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::collections::BTreeMap;

    use super::*;
    use crate::scalar::FxFactor;

    fn properties(mass: u64, locks: Locks) -> MassProperties<Fx> {
        let inverse = <FxFactor as Factor<Fx>>::from_ratio(1, mass);
        MassProperties::new(inverse, inverse, locks)
    }

    #[test]
    fn equal_properties_share_a_row_until_nobody_has_it() {
        let mut table = MassTable::default();
        let locked = Locks { x: true, ..Locks::NONE };
        let all = [properties(2, Locks::NONE), properties(2, locked), properties(3, Locks::NONE)];
        let rows = all.map(|own| [table.acquire(own), table.acquire(own)]);
        assert_eq!(rows, [[0, 0], [1, 1], [2, 2]]);
        table.release(1);
        assert_eq!(table.acquire(all[1]), 1);
        (0..2).for_each(|_| table.release(1));
        // The row is used again, and shared by what is in it now.
        let new = properties(5, Locks::NONE);
        assert_eq!([table.acquire(new), table.acquire(new), table.acquire(all[1])], [1, 1, 3]);
        assert_eq!((*table.row(1), *table.row(3)), (new, all[1]));
        (0..2).for_each(|_| table.release(1));
        assert_eq!([table.acquire(new), table.acquire(new)], [1, 1]);
    }

    /// Beside a count by kind, while bodies of many kinds come and go.
    #[test]
    fn there_is_one_row_for_each_kind_in_use() {
        let (mut table, mut rows) = (MassTable::default(), BTreeMap::<u64, (u32, u32)>::new());
        let mut random = 1u32;
        for step in 0..20_000u32 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Few kinds and many, in turns.
            let mass = u64::from(random >> 16) % if step & 4_096 == 0 { 500 } else { 5 } + 1;
            if random >> 8 & 1 == 0 {
                let row = table.acquire(properties(mass, Locks::NONE));
                let (own, users) = rows.entry(mass).or_insert((row, 0));
                assert_eq!(*own, row);
                *users += 1;
            } else if let Some((row, users)) = rows.get_mut(&mass) {
                table.release(*row);
                *users -= 1;
                if *users == 0 {
                    rows.remove(&mass);
                }
            }
            assert_eq!(table.rows.len() - table.free.len(), rows.len());
        }
        for (mass, (row, users)) in rows {
            let expected = (properties(mass, Locks::NONE), users);
            assert_eq!((*table.row(row), table.users[row as usize]), expected);
        }
        assert!(table.rows.len() <= 500 && table.places.len() <= 2_048);
    }
}
