//! The contacts of each row of a body, for impacts.
//!
//! Reads: the groups of contacts. Writes: lists of places by row, and on demand the normal rows of their contacts.

use alloc::vec::Vec;
use core::ops::Range;

use super::super::bodies::STILL;
use super::super::groups::{ContactGroups, Place};
use super::super::motion::Rows;
use super::NONE;
use super::jacobian::NormalRows;

/// The contacts of each row. A body that cannot be moved has rows, and contacts here, only if it moves.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactIndex {
    /// The index in `places` of the first contact of each row, and the end; empty until a sub-step of the step needs it.
    first: Vec<u32>,
    pub(super) places: Vec<u32>,
    /// The normal rows of the contacts of rows that have been looked at in the step.
    pub(super) normal_rows: Vec<NormalRows>,
    /// By row: the first ones of its contacts, or [`NONE`].
    normal_rows_of: Vec<u32>,
}

impl ContactIndex {
    /// Forgets the contacts of the step before.
    pub(super) fn clear(&mut self) {
        self.first.clear();
    }

    /// Lists the contacts of each row, once a step. Returns true if they were not listed.
    pub(super) fn build(&mut self, rows: &Rows, groups: &ContactGroups) -> bool {
        if !self.first.is_empty() {
            return false;
        }
        let rows_of = |place: &Place| {
            let (group, lane) = (&groups.groups[place.group as usize], place.lane as usize);
            [group.a[lane], group.b[lane]].into_iter().filter(|&row| row != STILL)
        };
        let Self { first, places, normal_rows, normal_rows_of } = self;
        first.resize(rows.len() as usize + 1, 0);
        for row in groups.places.iter().flat_map(rows_of) {
            first[row as usize] += 1;
        }
        let mut sum = 0;
        for end in first.iter_mut() {
            sum += *end;
            *end = sum;
        }
        places.clear();
        places.resize(sum as usize, 0);
        for (index, place) in groups.places.iter().enumerate() {
            for row in rows_of(place) {
                first[row as usize] -= 1;
                places[first[row as usize] as usize] = index as u32;
            }
        }
        normal_rows.clear();
        normal_rows_of.clear();
        normal_rows_of.resize(rows.len() as usize, NONE);
        true
    }

    /// The indices in `places` of the contacts of a row.
    pub(super) fn places_of(&self, row: u32) -> Range<usize> {
        self.first[row as usize] as usize..self.first[row as usize + 1] as usize
    }

    /// The index of the first one of the normal rows of the contacts of a row.
    pub(super) fn first_normal_rows(&mut self, row: u32, groups: &ContactGroups) -> usize {
        let range = self.places_of(row);
        let Self { places, normal_rows, normal_rows_of, .. } = self;
        let first = &mut normal_rows_of[row as usize];
        if *first == NONE {
            *first = normal_rows.len() as u32;
            for &place in &places[range] {
                let (_, group, lane) = groups.lane_of(place);
                normal_rows.push(NormalRows::of(place, group, lane));
            }
        }
        *first as usize
    }
}
