//! Filters: which colliders may meet.

/// The filter of a collider: which others it may meet. Two colliders meet if each has a category in the other's mask. If both are in the
/// same group, the sign of the group decides instead.
///
/// ```
/// use umbra_physics::Filter;
///
/// const WALL: u32 = 1;
/// const PLAYER: u32 = 2;
/// const GHOST: u32 = 4;
/// let player = Filter { category: PLAYER, ..Filter::default() };
/// let ghost = Filter { category: GHOST, mask: WALL, ..Filter::default() }; // walks through players
/// assert!(ghost.agrees(Filter::default()) && player.agrees(player) && !ghost.agrees(player));
/// ```
#[doc(alias("InteractionGroups", "collision_groups"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Filter {
    /// The categories that the collider is in, one bit each.
    pub category: u32,
    /// The categories that the collider meets, one bit each.
    pub mask: u32,
    /// The group. Two colliders of one positive group always meet, two of one negative group never. Group 0 is no group.
    pub group: i32,
}

impl Default for Filter {
    /// Category 1, a mask of all categories, and no group: the collider meets all others with this filter.
    fn default() -> Self {
        Self { category: 1, mask: !0, group: 0 }
    }
}

impl Filter {
    /// The filter that meets nothing, as every filter does without a category or without a mask, and without a positive group. A collider
    /// with it gives its body mass and an outline to draw; contacts, sensors, queries, characters, fluids and explosions pass it over, and
    /// it costs a step nothing.
    pub const NONE: Self = Self { category: 0, mask: 0, group: 0 };

    /// Returns true if two colliders with these filters may meet.
    #[must_use]
    pub fn agrees(self, rhs: Self) -> bool {
        if self.group == rhs.group && self.group != 0 {
            return self.group > 0;
        }
        self.category & rhs.mask != 0 && rhs.category & self.mask != 0
    }

    /// Returns true if the filter agrees with no other: it has no category or no mask, and no positive group.
    pub(super) fn meets_nothing(self) -> bool {
        (self.category == 0 || self.mask == 0) && self.group <= 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn categories_count_both_ways_and_groups_come_first() {
        let filter = |category, mask, group| Filter { category, mask, group };
        assert!(Filter::default().agrees(Filter::default()));
        let one_way = [filter(1, 2, 0), filter(2, 4, 0)];
        assert!(!one_way[0].agrees(one_way[1]) && !one_way[1].agrees(one_way[0]));
        assert!(filter(1, 2, 0).agrees(filter(2, 1, 0)));
        assert!(filter(1, 2, 5).agrees(filter(2, 4, 5)));
        assert!(!filter(1, 2, 5).agrees(filter(2, 4, 6)));
        assert!(!filter(1, !0, -5).agrees(filter(1, !0, -5)));
        assert!(filter(1, !0, -5).agrees(filter(1, !0, -6)));
    }
}
