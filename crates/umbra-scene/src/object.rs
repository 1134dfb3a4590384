//! Objects as a scene reads them: their fields, the unknown ones and the missing ones.

use alloc::string::String;
use alloc::vec::Vec;
use core::cell::{Cell, RefCell};
use core::fmt;
use core::ops::ControlFlow;

use serde::de::{Deserializer as _, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::error::{Flaw, Refused};
use super::hint;
use super::node::{Kind, Node, Result, in_a_line};

struct Entry<'a> {
    name: String,
    node: Node<'a>,
    used: Cell<bool>,
}

/// The fields of an object. A field that nobody asks for is unknown.
pub(super) struct Object<'a> {
    pub(super) node: Node<'a>,
    entries: Vec<Entry<'a>>,
    asked: RefCell<Vec<&'static str>>,
    /// The needed fields that are missing and were not reported yet: they may be there under a name with a typing error.
    missing: RefCell<Vec<&'static str>>,
    /// The number of errors found in the text before the object was read.
    errors_before: u64,
}

/// The most fields of an object: more than any has that is read, and few enough to be looked through for doubles.
const FIELDS: usize = 64;

impl<'a> Node<'a> {
    pub(super) fn object(&self) -> Result<Object<'a>> {
        if self.kind() != Kind::Object {
            return Err(self.wrong_kind("an object"));
        }
        let errors_before = self.source.found.count();
        let mut entries: Vec<Entry<'a>> = Vec::new();
        let add = |name: String, raw: &'a RawValue| {
            let dot = if self.field.is_empty() { "" } else { "." };
            let node = self.child(raw, format_args!("{dot}{}", in_a_line(&name)));
            if entries.iter().any(|entry| entry.name == name) {
                node.fault(Flaw::Doubled.of("this field is given twice: give it once"));
                return ControlFlow::Continue(());
            }
            if entries.len() == FIELDS {
                node.fault(Flaw::TooMany.of(format_args!("out of range: at most {FIELDS} fields")));
                return ControlFlow::Break(());
            }
            entries.push(Entry { name, node, used: Cell::new(false) });
            ControlFlow::Continue(())
        };
        let mut text = serde_json::Deserializer::from_str(self.raw());
        let visited = text.deserialize_map(&mut Visit(add));
        if self.source.found.count() == errors_before {
            visited.map_err(|e| self.fault(Flaw::NotJson.of(e)))?;
        }
        let (asked, missing) = Default::default();
        Ok(Object { node: self.clone(), entries, asked, missing, errors_before })
    }
}

impl<'a> Object<'a> {
    pub(super) fn get(&self, name: &'static str) -> Option<&Node<'a>> {
        self.asked.borrow_mut().push(name);
        let entry = self.entry(name)?;
        entry.used.set(true);
        Some(&entry.node)
    }

    fn entry(&self, name: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// Says whether the object has a field, without asking for it.
    pub(super) fn has(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    /// Reads a field with `read`. One that is missing is reported when all of the object was read.
    pub(super) fn need<T>(&self, name: &'static str, read: impl FnOnce(&Node<'a>) -> Result<T>) -> Result<T> {
        let node = self.get(name).ok_or_else(|| {
            self.missing.borrow_mut().push(name);
            Refused::default()
        })?;
        read(node)
    }

    /// Reads a field with `read`, or returns `otherwise` if it is missing. A value that is refused is replaced by `otherwise` too, so
    /// that the rest can be read; [`finish`](Self::finish) refuses the object.
    pub(super) fn or<T>(&self, name: &'static str, otherwise: T, read: impl FnOnce(&Node<'a>) -> Result<T>) -> T {
        self.get(name).and_then(|node| read(node).ok()).unwrap_or(otherwise)
    }

    /// The one field of these that is there. It is asked for last: if there is none, all unknown fields are reported.
    pub(super) fn one_of(&self, names: &[&'static str]) -> Result<(&'static str, &Node<'a>)> {
        let mut present = None;
        for name in names {
            if let Some(node) = self.get(name) {
                if let Some((first, _)) = present {
                    return Err(node.fault(format_args!("`{first}` is given already: give only one of the two")));
                }
                present = Some((*name, node));
            }
        }
        present.ok_or_else(|| {
            if self.entries.iter().all(|entry| entry.used.get()) {
                let names = names.join(", ");
                self.node.fault(Flaw::Missing.of(format_args!("one of the fields {names} is missing")));
            }
            self.report();
            Refused::default()
        })
    }

    /// Returns the value of the first of these fields that is there, or the object itself if none is: the place for an error.
    pub(super) fn at(&self, names: &[&str]) -> &Node<'a> {
        let named = names.iter().find_map(|name| self.entry(name));
        named.map_or(&self.node, |entry| &entry.node)
    }

    /// Reports the fields that nobody asked for, then the missing ones that none of these is meant to be.
    fn report(&self) {
        let asked = self.asked.borrow();
        for entry in self.entries.iter().filter(|entry| !entry.used.replace(true)) {
            let meant = hint::word(&entry.name, &asked);
            self.missing.borrow_mut().retain(|missing| Some(*missing) != meant);
            let unknown = |words: fmt::Arguments<'_>| entry.node.fault(Flaw::Unknown.of(words));
            match meant {
                _ if entry.name == "shape" && asked.contains(&"colliders") => unknown(format_args!(
                    "unknown field: give it to a collider, `\"colliders\": [{{\"shape\": …}}]`; one with `\"mask\": []` touches nothing"
                )),
                _ if hint::is_of_collider(&entry.name) && !asked.contains(&"friction") => {
                    unknown(format_args!("unknown field: give it to a collider, in the list `colliders` of a body"))
                }
                Some(meant) => unknown(format_args!("unknown field: did you mean `{meant}`?")),
                None => unknown(format_args!("unknown field; there are {}", asked.join(", "))),
            };
        }
        self.report_missing();
    }

    fn report_missing(&self) {
        for name in self.missing.take() {
            self.node.fault(Flaw::Missing.of(format_args!("the field `{name}` is missing")));
        }
    }

    /// Refuses the object if it has unknown fields, lacks one that it needs, or if anything in it was refused. All its fields have been
    /// asked for.
    pub(super) fn finish(&self) -> Result<()> {
        self.report();
        if self.node.source.found.count() == self.errors_before { Ok(()) } else { Err(Refused::default()) }
    }
}

impl Drop for Object<'_> {
    /// However the reading ended, a field that was needed and missing has been reported.
    fn drop(&mut self) {
        self.report_missing();
    }
}

/// Hands on the fields of an object as long as they are wanted.
struct Visit<F>(F);

impl<'de, F: FnMut(String, &'de RawValue) -> ControlFlow<()>> Visitor<'de> for &mut Visit<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> core::result::Result<(), A::Error> {
        while let Some((name, raw)) = map.next_entry()? {
            if (self.0)(name, raw).is_break() {
                break;
            }
        }
        Ok(())
    }
}
