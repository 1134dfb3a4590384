//! Hints in errors: the name that was probably meant.

use alloc::vec::Vec;

/// The longest name for which there is a hint, and the most names that it is compared with: hints are for people, and bound the
/// time that any text can take.
const LONGEST: usize = 40;
const MOST: usize = 4_096;

/// Names that other engines and formats have for a field or a value of ours.
const SYNONYMS: [(&str, &str); 54] = [
    ("type", "kind"),
    ("fixed", "static"),
    ("id", "name"),
    ("pos", "position"),
    ("rotation", "angle"),
    ("vel", "velocity"),
    ("linear_velocity", "velocity"),
    ("omega", "angular_velocity"),
    ("linear_damping", "damping"),
    ("angular_damping", "damping"),
    ("fixed_rotation", "locks"),
    ("box", "rectangle"),
    ("rect", "rectangle"),
    ("square", "rectangle"),
    ("ball", "circle"),
    ("disc", "circle"),
    ("disk", "circle"),
    ("sphere", "circle"),
    ("line", "segment"),
    ("edge", "segment"),
    ("dt", "time_step"),
    ("steps", "ticks"),
    ("objects", "bodies"),
    ("forces", "fields"),
    ("commands", "inputs"),
    ("gravity", "acceleration"),
    ("rest_length", "rest"),
    ("tick", "at"),
    ("x", "position"),
    ("y", "position"),
    ("fixtures", "colliders"),
    ("collider", "colliders"),
    ("bounciness", "restitution"),
    ("elasticity", "restitution"),
    ("tangent_speed", "surface_speed"),
    ("rolling_friction", "rolling_resistance"),
    ("user_material_id", "material_id"),
    ("is_sensor", "sensor"),
    ("enable_contact_events", "contact_events"),
    ("enable_hit_events", "hit_events"),
    ("hit_event_threshold", "hit_speed"),
    ("friction_combine_rule", "friction_rule"),
    ("restitution_combine_rule", "restitution_rule"),
    ("category_bits", "category"),
    ("categories", "category"),
    ("mask_bits", "mask"),
    ("collision_groups", "mask"),
    ("group_index", "group"),
    ("sub_step_count", "substeps"),
    ("constraints", "joints"),
    ("hinge", "revolute"),
    ("rod", "distance"),
    ("anchor", "point"),
    ("frequency", "hertz"),
];

/// Fields of colliders, here or in other engines.
const COLLIDER: [&str; 22] = [
    "shape",
    "density",
    "one_way",
    "sensor",
    "is_sensor",
    "contact_events",
    "hit_events",
    "friction",
    "restitution",
    "bounciness",
    "elasticity",
    "rolling_resistance",
    "surface_speed",
    "material_id",
    "friction_rule",
    "restitution_rule",
    "collision_groups",
    "collision_filter",
    "category",
    "category_bits",
    "mask",
    "mask_bits",
];

/// Returns whether a field belongs to a collider.
pub(super) fn is_of_collider(field: &str) -> bool {
    COLLIDER.iter().any(|name| plain(name) == plain(field))
}

/// The one of our own words that was probably meant: one that means the same elsewhere, or the nearest.
pub(super) fn word<'n>(input: &str, words: &[&'n str]) -> Option<&'n str> {
    let short = plain(input);
    let same = SYNONYMS.iter().find(|(synonym, ours)| plain(synonym) == short && words.contains(ours));
    let same = same.and_then(|(_, ours)| words.iter().find(|word| *word == ours).copied());
    same.or_else(|| nearest(input, words.iter().copied()))
}

/// The name that differs least from a text: by a letter if the text has three or four, by two from five on. The first
/// of several.
pub(super) fn nearest<'n>(input: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let input = plain(input);
    if input.is_empty() || input.len() > LONGEST {
        return None;
    }
    let allowed = (2 * input.len() / 5).min(2);
    let candidates = names.take(MOST).filter_map(|name| {
        // No text within two letters is longer by more, and a letter has at most four bytes.
        if name.len() > 5 * (LONGEST + 2) {
            return None;
        }
        let letters = plain(name);
        (letters.len().abs_diff(input.len()) <= allowed).then(|| (distance(&input, &letters), name))
    });
    candidates.filter(|(distance, _)| *distance <= allowed).min_by_key(|(distance, _)| *distance).map(|(_, name)| name)
}

/// The letters of a name, without what separates its words: `gravityScale` is `gravity_scale`.
fn plain(name: &str) -> Vec<char> {
    name.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).map(|c| c.to_ascii_lowercase()).take(LONGEST + 3).collect()
}

/// The number of letters to insert, remove, replace or swap with the next one, each letter once (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    // Rows of the table: the one before the last, the last, and the new one.
    let mut last: Vec<usize> = (0..=b.len()).collect();
    let mut before = last.clone();
    for i in 1..=a.len() {
        let mut row = Vec::with_capacity(b.len() + 1);
        row.push(i);
        for j in 1..=b.len() {
            let replaced = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = core::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_letters() {
        let letters = |text: &str| text.chars().collect::<Vec<_>>();
        for (a, b, expected) in [
            ("", "", 0),
            ("", "ab", 2),
            ("raduis", "radius", 1),
            ("masss", "mass", 1),
            ("ca", "abc", 3),
            ("abc", "xyz", 3),
        ] {
            assert_eq!(distance(&letters(a), &letters(b)), expected, "{a} {b}");
            assert_eq!(distance(&letters(b), &letters(a)), expected, "{b} {a}");
        }
    }

    #[test]
    fn words_that_are_near_or_mean_the_same_are_found() {
        let body = ["name", "kind", "position", "mass", "gravity_scale", "at", "to"];
        for (input, meant) in [
            ("nmae", Some("name")),
            ("type", Some("kind")),
            ("gravityScale", Some("gravity_scale")),
            ("Mass", Some("mass")),
            ("postion", Some("position")),
            ("it", None),
            ("colour", None),
            ("", None),
        ] {
            assert_eq!(word(input, &body), meant, "{input}");
        }
        assert_eq!(word("box", &["circle", "rectangle"]), Some("rectangle"));
        assert_eq!(word("bax", &["disc", "box"]), Some("box"));
        assert_eq!(nearest("ball 1", ["ball 3", "ball 2", "bell 1"].into_iter()), Some("ball 3"));
        assert_eq!(nearest(&"x".repeat(1_000_000), ["xxx"].into_iter()), None);
        assert!(is_of_collider("maskBits") && is_of_collider("friction") && !is_of_collider("mass"));
    }
}
