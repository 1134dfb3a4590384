//! Counts of the bodies that are asleep, so that a call that may wake bodies costs nothing where none sleeps.

use super::BodyKind;
use super::info::BodyInfo;
use crate::scalar::Scalar;

/// Number of bodies asleep, and number of the dynamic ones among them in each group.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sleepers {
    pub(super) count: usize,
    by_group: [u32; 32],
}

impl Sleepers {
    /// Adds a body to the counts (`change` = 1) or takes it out of them (−1).
    pub(super) fn count<S: Scalar>(&mut self, info: &BodyInfo<S>, change: i32) {
        self.count = self.count.wrapping_add_signed(change as isize);
        let mut force_groups = if info.kind == BodyKind::Dynamic { info.force_groups } else { 0 };
        while force_groups != 0 {
            let group = force_groups.trailing_zeros() as usize;
            self.by_group[group] = self.by_group[group].wrapping_add_signed(change);
            force_groups &= force_groups - 1;
        }
    }

    /// The groups with a dynamic body that is asleep.
    pub(super) fn force_groups(&self) -> u32 {
        (0..32).fold(0, |force_groups, group| force_groups | u32::from(self.by_group[group] > 0) << group)
    }
}
