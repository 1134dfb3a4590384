//! The coefficients of pairs of materials.

use alloc::vec::Vec;

use super::{ColliderSet, MaterialPair};
use crate::codec::{self, Encoder, Malformed, Part, Read, Reader, StateHasher, Write};
use crate::error::{Error, Quantity};
use crate::limits;
use crate::scalar::Scalar;

/// Two materials by number, the lower one first, and their coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PairEntry<S: Scalar> {
    pub(crate) ids: [u32; 2],
    pub(crate) pair: MaterialPair<S>,
}

impl<S: Scalar> Write for PairEntry<S> {
    fn write(&self, out: &mut impl Encoder) {
        codec::field(out, "first", &self.ids[0]);
        codec::field(out, "second", &self.ids[1]);
        out.enter(Part::Name("coefficients"));
        self.pair.write(out);
        out.leave();
    }
}

impl Read for PairEntry<crate::fx::Fx> {
    fn read(reader: &mut Reader<'_>) -> Result<Self, Malformed> {
        Ok(Self { ids: [u32::read(reader)?, u32::read(reader)?], pair: MaterialPair::read(reader)? })
    }
}

/// The pairs of a world, sorted by both numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct MaterialPairs<S: Scalar>(Vec<PairEntry<S>>);

impl<S: Scalar> MaterialPairs<S> {
    fn find(&self, ids: [u32; 2]) -> Result<usize, usize> {
        self.0.binary_search_by_key(&ids, |entry| entry.ids)
    }
}

/// Two numbers in the order of the table.
fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

impl<S: Scalar> ColliderSet<S> {
    /// The pairs of materials with coefficients of their own, sorted.
    pub(crate) fn material_pairs(&self) -> &[PairEntry<S>] {
        &self.pairs.0
    }

    /// The coefficients of two materials together, in either order.
    pub(crate) fn material_pair(&self, ids: [u32; 2]) -> Option<&MaterialPair<S>> {
        let at = self.pairs.find(sorted(ids)).ok()?;
        Some(&self.pairs.0[at].pair)
    }

    /// Refuses an entry of the table.
    pub(crate) fn check_material_pair(&self, ids: [u32; 2], pair: Option<&MaterialPair<S>>) -> Result<(), Error> {
        if ids.contains(&0) {
            return Err(Error::OutOfRange { quantity: Quantity::MaterialId });
        }
        let Some(pair) = pair else { return Ok(()) };
        pair.check()?;
        let is_new = self.material_pair(ids).is_none();
        if is_new && self.pairs.0.len() >= limits::MATERIAL_PAIRS { Err(Error::Full) } else { Ok(()) }
    }

    /// Sets or removes an entry of the table. *Domain* it was checked.
    pub(crate) fn set_material_pair(&mut self, ids: [u32; 2], pair: Option<MaterialPair<S>>) {
        let ids = sorted(ids);
        if let Some(image) = &mut self.image {
            image.set_material_pair(ids, pair.map(MaterialPair::to_fx));
        }
        match (self.pairs.find(ids), pair) {
            (Ok(at), Some(pair)) => self.pairs.0[at].pair = pair,
            (Ok(at), None) => drop(self.pairs.0.remove(at)),
            (Err(at), Some(pair)) => self.pairs.0.insert(at, PairEntry { ids, pair }),
            (Err(_), None) => {}
        }
    }

    /// Adds the table to a hash.
    pub(crate) fn write_material_pairs(&self, sink: &mut StateHasher) {
        codec::list(sink, self.pairs.0.iter());
    }
}
