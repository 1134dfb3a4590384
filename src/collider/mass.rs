//! The mass that a body has from its colliders.

use super::ColliderDef;
use crate::scalar::{Factor, Scalar};
use crate::shape::Aabb;

/// The mass of a body's colliders together, and their moment of inertia about the body's centre of mass; zero without colliders.
///
/// A collider that comes or goes changes it alike whatever the others are, and in the same time however many there are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ColliderMass<S: Scalar> {
    count: u32,
    /// The number of colliders that are chains.
    chains: u32,
    masses: ExactSum,
    inertias: ExactSum,
    /// Σ density times area, kg.
    pub(crate) mass: S::Factor,
    /// The moment of inertia per mass, m²; zero without mass.
    pub(crate) gyration: S::Factor,
    /// The distance from the centre of mass of the body, m, that no point of a collider exceeds which it has, or had since it last had none.
    pub(crate) reach: S,
}

impl<S: Scalar> ColliderMass<S> {
    /// Returns true for a body without colliders.
    pub(crate) fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Returns true if a collider is a chain.
    pub(crate) fn any_chain(&self) -> bool {
        self.chains > 0
    }

    /// Σ w and Σ w·(k² + d²) / Σ w with w the mass of a collider, k its radius of gyration and d the distance of its centre of mass
    /// from that of the body.
    ///
    /// The result does not depend on the order in which colliders were added. *Error* 2^-60 relative.
    pub(crate) fn of<'a>(colliders: impl Iterator<Item = &'a ColliderDef<S>>) -> Self
    where
        S: 'a,
    {
        let mut all = Self::default();
        colliders.for_each(|def| all.add(def));
        all.totalled()
    }

    /// With one collider more.
    pub(crate) fn with(mut self, def: &ColliderDef<S>) -> Self {
        self.add(def);
        self.totalled()
    }

    /// Without a collider. *Domain* it is among them.
    pub(crate) fn without(mut self, def: &ColliderDef<S>) -> Self {
        self.remove(def);
        self.totalled()
    }

    /// With a collider defined anew. *Domain* it is among them.
    pub(crate) fn replaced(mut self, def: &ColliderDef<S>, next: &ColliderDef<S>) -> Self {
        self.remove(def);
        self.add(next);
        self.totalled()
    }

    fn remove(&mut self, def: &ColliderDef<S>) {
        let [mass, inertia] = terms(def);
        self.count -= 1;
        self.chains -= u32::from(def.shape.is_chain());
        self.masses.subtract(mass.to_binary());
        self.inertias.subtract(inertia.to_binary());
    }

    fn add(&mut self, def: &ColliderDef<S>) {
        let [mass, inertia] = terms(def);
        self.count += 1;
        self.chains += u32::from(def.shape.is_chain());
        self.masses.add(mass.to_binary());
        self.inertias.add(inertia.to_binary());
        let reach = reach(def);
        if reach > self.reach {
            self.reach = reach;
        }
    }

    /// With the mass and the gyration that follow from the sums.
    fn totalled(mut self) -> Self {
        let [mass, inertia] = [self.masses, self.inertias].map(|sum| {
            let (value, shift) = sum.total();
            S::Factor::from_binary(value, shift)
        });
        self.mass = mass;
        self.gyration = if mass.is_zero() { S::Factor::ZERO } else { inertia.over(mass) };
        self
    }
}

/// The mass of a collider, and its moment of inertia about the centre of mass of its body.
fn terms<S: Scalar>(def: &ColliderDef<S>) -> [S::Factor; 2] {
    let away = def.position.wide_length();
    let mass = S::Factor::from_scalar(def.density).times(def.shape.measure());
    [mass, mass.times(def.shape.gyration().plus(away.times(away)))]
}

/// A distance from the centre of mass of the body that no point of a collider exceeds, m.
fn reach<S: Scalar>(def: &ColliderDef<S>) -> S {
    let Aabb { min, max } = def.shape.bounds();
    let larger = |a: S, b: S| if a > b { a } else { b };
    let size = |x: S| larger(x, -x);
    // A distance is at most the sum of its parts along both axes: below 2^16 m. A metre is more than all that is rounded.
    larger(max.x, -min.x) + larger(max.y, -min.y) + size(def.position.x) + size(def.position.y) + S::ONE
}

/// A sum in units of 2^-192, low words first: exact, so that its terms may come and go in any order.
///
/// In fixed point a density is at least 2^-32, an area 2^-65, and a gyration 2^-20, as a shape is 2^-7 m long: with 64 bits
/// the last one of a term is above 2^-181. Above, densities are below 2^31, areas below 2^36 (256 parts of at most 2^13 m), k² + d² is
/// below 2^29, and there are at most 2^24 colliders: a sum is below 2^120. Floats of other sizes lose bits, or count as
/// [`HIGHEST`](Self::HIGHEST).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct ExactSum([u64; 5]);

impl ExactSum {
    /// The binary digits of the fraction.
    const FRACTION: i32 = 192;
    /// The highest place of the lowest digit of a term: it is below 2^104, so that 2^24 of them are below 2^128.
    const HIGHEST: i32 = Self::FRACTION + 104 - 64;

    /// The words of number · 2^-shift.
    fn words(number: u64, shift: i32) -> [u64; 5] {
        let mut words = [0; 5];
        match u32::try_from((Self::FRACTION - shift).min(Self::HIGHEST)) {
            Ok(place) => {
                let wide = u128::from(number) << (place % 64);
                let word = place as usize / 64;
                (words[word], words[word + 1]) = (wide as u64, (wide >> 64) as u64);
            }
            Err(_) => words[0] = number.checked_shr((shift - Self::FRACTION).unsigned_abs()).unwrap_or(0),
        }
        words
    }

    fn add(&mut self, term: (u64, i32)) {
        let mut carries = false;
        for (word, more) in self.0.iter_mut().zip(Self::words(term.0, term.1)) {
            let (sum, first) = word.overflowing_add(more);
            let (sum, second) = sum.overflowing_add(u64::from(carries));
            (*word, carries) = (sum, first | second);
        }
    }

    /// Takes a term out again. *Domain* it was added.
    fn subtract(&mut self, term: (u64, i32)) {
        let mut borrows = false;
        for (word, less) in self.0.iter_mut().zip(Self::words(term.0, term.1)) {
            let (rest, first) = word.overflowing_sub(less);
            let (rest, second) = rest.overflowing_sub(u64::from(borrows));
            (*word, borrows) = (rest, first | second);
        }
    }

    /// The 128 highest digits and their shift, with all that is below gathered in the last one.
    fn total(self) -> (u128, i32) {
        let Some(top) = self.0.iter().rposition(|word| *word != 0) else { return (0, 0) };
        let word = |below: usize| top.checked_sub(below).map_or(0, |i| self.0[i]);
        let zeros = word(0).leading_zeros();
        let highest = u128::from(word(0)) << 64 | u128::from(word(1));
        let value = highest << zeros | u128::from(word(2)) << zeros >> 64;
        let is_cut = word(2) << zeros != 0 || (3..=top).any(|below| word(below) != 0);
        (value | u128::from(is_cut), Self::FRACTION + zeros as i32 - 64 * (top as i32 - 1))
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::math::Random;
    use crate::scalar::FxFactor;

    fn sum(terms: &[FxFactor]) -> FxFactor {
        let mut sum = ExactSum::default();
        terms.iter().for_each(|term| sum.add(term.parts()));
        let (value, shift) = sum.total();
        FxFactor::new(value, shift)
    }

    /// Factors of all sizes that masses and inertias have.
    fn factor(random: &mut Random) -> FxFactor {
        FxFactor::new(u128::from(random.bits() | 1 << 63), 63 - 90 + random.below(207) as i32)
    }

    #[test]
    fn a_sum_of_two_is_the_nearest_factor() {
        let mut random = Random::seeded(1);
        for _ in 0..20_000 {
            let [a, b] = [(); 2].map(|()| factor(&mut random));
            assert_eq!(sum(&[a, b]), a.plus(b), "{a:?} {b:?}");
        }
    }

    #[test]
    fn terms_come_and_go_in_any_order() {
        let mut random = Random::seeded(2);
        let mut kept: Vec<FxFactor> = Vec::new();
        let mut running = ExactSum::default();
        for _ in 0..5_000 {
            if kept.is_empty() || random.below(5) < 3 {
                kept.push(factor(&mut random));
                running.add(kept[kept.len() - 1].parts());
            } else {
                let term = kept.swap_remove(random.below(kept.len() as u64) as usize);
                running.subtract(term.parts());
            }
            let (value, shift) = running.total();
            assert_eq!(FxFactor::new(value, shift), sum(&kept));
        }
        kept.iter().for_each(|term| running.subtract(term.parts()));
        assert_eq!(running, ExactSum::default());
    }

    #[test]
    fn what_rounding_twice_would_lose_counts() {
        let tiny = FxFactor::new(1, 150);
        // Half an ulp of 1 rounds to even, and with anything more it rounds up.
        let half = FxFactor::new(1, 64);
        assert_eq!(sum(&[FxFactor::ONE, half]), FxFactor::ONE);
        assert!(sum(&[FxFactor::ONE, half, tiny]) > FxFactor::ONE);
        assert_eq!(sum(&[]), FxFactor::ZERO);
    }
}
