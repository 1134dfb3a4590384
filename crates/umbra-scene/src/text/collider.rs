//! Writing colliders and the settings of contacts.

use alloc::format;
use alloc::string::String;

use super::json::{Fields, bits, point, text};
use super::{SceneCollider, ShapeDef};
use umbra_physics::{ColliderDef, ContactSettings, Filter, Fx, Material, MaterialPair, MixRule, OneWay, Vec2};

impl SceneCollider {
    pub(super) fn text(&self) -> String {
        collider_text(self.name.as_deref().map_or_else(Fields::default, Fields::of_name), &self.def)
    }
}

pub(super) fn collider_text(mut object: Fields, def: &ColliderDef) -> String {
    let (material, filter): (Material, Filter) = Default::default();
    object.put("shape", ShapeDef::from(&def.shape).text());
    object.unless(def.position == Vec2::ZERO, "position", point(def.position));
    object.unless(def.angle == Fx::ZERO, "angle", def.angle);
    object.unless(def.density == Fx::ONE, "density", def.density);
    object.unless(def.material.friction == material.friction, "friction", def.material.friction);
    object.unless(def.material.restitution == material.restitution, "restitution", def.material.restitution);
    let rolling = def.material.rolling_resistance;
    object.unless(rolling == material.rolling_resistance, "rolling_resistance", rolling);
    object.unless(def.material.surface_speed == material.surface_speed, "surface_speed", def.material.surface_speed);
    let rules = [("friction_rule", def.material.friction_rule), ("restitution_rule", def.material.restitution_rule)];
    for (name, rule) in rules {
        object.unless(rule == MixRule::Standard, name, text(rule.name()));
    }
    object.unless(def.material.id == 0, "material_id", def.material.id);
    object.unless(def.filter.category == filter.category, "category", bits(def.filter.category));
    object.unless(def.filter.mask == filter.mask, "mask", bits(def.filter.mask));
    object.unless(def.filter.group == filter.group, "group", def.filter.group);
    if let Some(one_way) = &def.one_way {
        object.put("one_way", one_way_text(one_way));
    }
    let flags = [("sensor", def.sensor), ("contact_events", def.contact_events), ("hit_events", def.hit_events)];
    for (name, is_set) in flags {
        object.unless(!is_set, name, true);
    }
    object.unless(def.key == 0, "key", def.key);
    object.unless(def.user_data == 0, "user_data", def.user_data);
    object.line()
}

fn one_way_text(one_way: &OneWay) -> String {
    let standard: OneWay = OneWay::default();
    let mut object = Fields::default();
    object.unless(one_way.direction == standard.direction, "direction", point(one_way.direction));
    object.unless(one_way.tolerance == standard.tolerance, "tolerance", one_way.tolerance);
    object.line()
}

/// The numbers of two materials, and their coefficients or that these are taken back.
pub(super) fn material_pair_text([a, b]: [u32; 2], pair: Option<&MaterialPair>) -> String {
    let standard: MaterialPair = MaterialPair::default();
    let mut object = Fields::default();
    object.put("materials", format!("[{a}, {b}]"));
    match pair {
        None => object.put("remove", true),
        Some(MaterialPair { friction, restitution, rolling_resistance: rolling }) => {
            object.unless(*friction == standard.friction, "friction", *friction);
            object.unless(*restitution == standard.restitution, "restitution", *restitution);
            object.unless(*rolling == standard.rolling_resistance, "rolling_resistance", *rolling);
        }
    }
    object.line()
}

pub(super) fn contacts_text(contacts: &ContactSettings) -> String {
    let standard: ContactSettings = ContactSettings::default();
    let ContactSettings {
        substeps,
        push_speed,
        restitution_speed,
        sleep_speed,
        hit_speed,
        max_pairs,
        max_pairs_per_collider: max_per_collider,
    } = *contacts;
    let mut object = Fields::default();
    object.unless(substeps == standard.substeps, "substeps", substeps);
    object.unless(push_speed == standard.push_speed, "push_speed", push_speed);
    object.unless(restitution_speed == standard.restitution_speed, "restitution_speed", restitution_speed);
    object.unless(sleep_speed == standard.sleep_speed, "sleep_speed", sleep_speed);
    object.unless(hit_speed == standard.hit_speed, "hit_speed", hit_speed);
    object.unless(max_pairs == standard.max_pairs, "max_pairs", max_pairs);
    object.unless(max_per_collider == standard.max_pairs_per_collider, "max_pairs_per_collider", max_per_collider);
    object.line()
}
