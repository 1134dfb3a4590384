//! JSON as a scene reads it: every value with its text and its place. The grammar is `serde_json`'s.
//!
//! A value is looked into only as deep as the format goes, so that depth costs no stack, and a number is the text that
//! stands in the file.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::cell::{Cell, RefCell};
use core::fmt;

use serde::de::{Deserializer as _, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::error::{Flaw, Place, Reason, SceneError};
use super::repeat::Round;

pub(super) type Result<T> = core::result::Result<T, SceneError>;

/// A scene's text, and how many lines end before each page of it.
pub(super) struct Source<'a> {
    text: &'a str,
    pages: Vec<usize>,
}

/// Bytes of text between two counts of lines: few to count again, and few counts.
const PAGE: usize = 1_024;

fn ends(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte == b'\n').count()
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let pages = text.as_bytes().chunks(PAGE).scan(0, |before, page| {
            let start = *before;
            *before += ends(page);
            Some(start)
        });
        Self { text, pages: pages.collect() }
    }

    /// The line, from 1, of a byte.
    fn line(&self, at: usize) -> usize {
        let (page, at) = (at / PAGE, at.min(self.text.len()));
        let before = self.pages.get(page).copied().unwrap_or_default();
        1 + before + ends(self.text.as_bytes().get(page * PAGE..at).unwrap_or_default())
    }
}

/// A value in the text of a scene.
#[derive(Clone)]
pub(super) struct Node<'a> {
    source: &'a Source<'a>,
    text: &'a str,
    field: String,
    /// The repetition it is read in.
    pub(super) round: Option<Round>,
}

/// The kind of a JSON value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Object,
    List,
    Text,
    Number,
    Boolean,
    Null,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Object => "an object",
            Self::List => "a list",
            Self::Text => "a text",
            Self::Number => "a number",
            Self::Boolean => "true or false",
            Self::Null => "null",
        }
    }
}

impl<'a> Node<'a> {
    /// The value a text consists of.
    pub(super) fn document(source: &'a Source<'a>) -> Result<Self> {
        let raw: &RawValue = serde_json::from_str(source.text).map_err(|error| {
            let message = format!("{error}");
            // serde_json ends with the place; the line stands in front of ours.
            let what = message.split(" at line ").next().unwrap_or(&message);
            let place = Place { line: error.line().max(1), field: String::new() };
            place.fault(Flaw::NotJson.of(format_args!("not JSON: {what} at column {}", error.column())))
        })?;
        Ok(Self { source, text: raw.get(), field: String::new(), round: None })
    }

    /// The place in the text.
    pub(super) fn place(&self) -> Place {
        // A part of the document's own text, so the difference is an index in it.
        let offset = (self.text.as_ptr() as usize).saturating_sub(self.source.text.as_ptr() as usize);
        Place { line: self.source.line(offset), field: self.field.clone() }
    }

    pub(super) fn fault(&self, reason: impl Reason) -> SceneError {
        self.place().fault(reason)
    }

    pub(super) fn wrong_kind(&self, expected: &str) -> SceneError {
        self.fault(Flaw::WrongKind.of(format_args!("expected {expected}, found {}", self.kind().name())))
    }

    pub(super) fn kind(&self) -> Kind {
        match self.text.as_bytes().first() {
            Some(b'{') => Kind::Object,
            Some(b'[') => Kind::List,
            Some(b'"') => Kind::Text,
            Some(b't' | b'f') => Kind::Boolean,
            Some(b'n') => Kind::Null,
            _ => Kind::Number,
        }
    }

    /// The value as it is written.
    pub(super) fn raw(&self) -> &'a str {
        self.text
    }

    /// Returns the same value, to be read in a repetition.
    pub(super) fn in_round(&self, round: Round) -> Self {
        Self { field: format!("{}{round}", self.field), round: Some(round), ..self.clone() }
    }

    fn child(&self, raw: &'a RawValue, step: fmt::Arguments<'_>) -> Self {
        Self { source: self.source, text: raw.get(), field: format!("{}{step}", self.field), round: self.round }
    }

    /// Hands on the values of a list one by one: all of them at once would take many times their text.
    pub(super) fn each(&self, mut read: impl FnMut(Self) -> Result<()>) -> Result<()> {
        if self.kind() != Kind::List {
            return Err(self.wrong_kind("a list"));
        }
        let mut index = 0;
        let one = |raw: &'a RawValue| {
            let node = self.child(raw, format_args!("[{index}]"));
            index += 1;
            read(node)
        };
        let mut visit = Visit { one, refused: None };
        let mut text = serde_json::Deserializer::from_str(self.text);
        let visited = text.deserialize_seq(&mut visit);
        // What was refused is why the rest was not looked at.
        visit.refused.map_or(Ok(()), Err)?;
        visited.map_err(|e| self.fault(Flaw::NotJson.of(e)))
    }

    /// The values of a list of at most so many; one more is refused as `too_many` says.
    pub(super) fn list(&self, most: usize, too_many: impl Reason) -> Result<Vec<Self>> {
        let mut nodes = Vec::new();
        self.each(|node| {
            if nodes.len() == most {
                return Err(self.fault(&too_many));
            }
            nodes.push(node);
            Ok(())
        })?;
        Ok(nodes)
    }

    /// A list of this many values.
    pub(super) fn tuple<const N: usize>(&self) -> Result<[Self; N]> {
        let (mut nodes, mut count) = (Vec::with_capacity(N), 0);
        self.each(|node| {
            count += 1;
            if nodes.len() < N {
                nodes.push(node);
            }
            Ok(())
        })?;
        let other = |_| self.fault(Flaw::WrongKind.of(format_args!("expected a list of {N} values, found {count}")));
        if count > N { Err(other(nodes)) } else { nodes.try_into().map_err(other) }
    }

    pub(super) fn object(&self) -> Result<Object<'a>> {
        if self.kind() != Kind::Object {
            return Err(self.wrong_kind("an object"));
        }
        let mut entries: Vec<Entry<'a>> = Vec::new();
        let one = |name: String, raw: &'a RawValue| {
            let dot = if self.field.is_empty() { "" } else { "." };
            let node = self.child(raw, format_args!("{dot}{}", in_a_line(&name)));
            if entries.iter().any(|entry| entry.name == name) {
                return Err(node.fault(Flaw::Doubled.of("this field is given twice: give it once")));
            }
            if entries.len() == FIELDS {
                return Err(node.fault(Flaw::TooMany.of(format_args!("out of range: at most {FIELDS} fields"))));
            }
            entries.push(Entry { name, node, used: Cell::new(false) });
            Ok(())
        };
        let mut visit = VisitFields { one, refused: None };
        let mut text = serde_json::Deserializer::from_str(self.text);
        let visited = text.deserialize_map(&mut visit);
        visit.refused.map_or(Ok(()), Err)?;
        visited.map_err(|e| self.fault(Flaw::NotJson.of(e)))?;
        Ok(Object { node: self.clone(), entries, asked: RefCell::default() })
    }

    /// A text; in a repetition with its indices put in for `{i}`, `{j}`, `{i+1}` and the like.
    pub(super) fn string(&self) -> Result<String> {
        if self.kind() != Kind::Text {
            return Err(self.wrong_kind("a text"));
        }
        let text: String = serde_json::from_str(self.text).map_err(|e| self.fault(Flaw::NotJson.of(e)))?;
        // Names and titles go to terminals, tables and pictures, where these would do something.
        if let Some(control) = text.chars().find(|c| c.is_control()) {
            let found = control.escape_debug();
            return Err(
                self.fault(Flaw::Text.of(format_args!("a text must have no control characters: found {found}")))
            );
        }
        match self.round {
            Some(round) => round.fill(&text).map_err(|message| self.fault(Flaw::Text.of(message))),
            None => Ok(text),
        }
    }

    pub(super) fn boolean(&self) -> Result<bool> {
        match self.text {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(self.wrong_kind("true or false")),
        }
    }

    /// Reads one of the given names.
    pub(super) fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T> {
        let text = self.string()?;
        let found = choices.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let (names, found) = (names.join(", "), quoted(&text));
            self.fault(Flaw::WrongKind.of(format_args!("expected one of {names}, found {found}")))
        })
    }
}

struct Entry<'a> {
    name: String,
    node: Node<'a>,
    used: Cell<bool>,
}

/// The fields of an object. Those that nobody asks for are unknown.
pub(super) struct Object<'a> {
    pub(super) node: Node<'a>,
    entries: Vec<Entry<'a>>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Object<'a> {
    pub(super) fn get(&self, name: &'static str) -> Option<&Node<'a>> {
        self.asked.borrow_mut().push(name);
        let entry = self.entries.iter().find(|entry| entry.name == name)?;
        entry.used.set(true);
        Some(&entry.node)
    }

    pub(super) fn need(&self, name: &'static str) -> Result<&Node<'a>> {
        self.get(name).ok_or_else(|| self.node.fault(Flaw::Missing.of(format_args!("the field `{name}` is missing"))))
    }

    /// Reads a field with `read`, or returns `otherwise` if it is missing.
    pub(super) fn or<T>(
        &self,
        name: &'static str,
        otherwise: T,
        read: impl FnOnce(&Node<'a>) -> Result<T>,
    ) -> Result<T> {
        self.get(name).map_or(Ok(otherwise), read)
    }

    /// The one field of these that is there.
    pub(super) fn one_of(&self, names: &[&'static str]) -> Result<(&'static str, &Node<'a>)> {
        let mut found = None;
        for name in names {
            if let Some(node) = self.get(name) {
                if let Some((other, _)) = found {
                    return Err(node.fault(format_args!("`{other}` is given already: give only one of the two")));
                }
                found = Some((*name, node));
            }
        }
        found.ok_or_else(|| {
            let missing = || {
                let names = names.join(", ");
                self.node.fault(Flaw::Missing.of(format_args!("one of the fields {names} is missing")))
            };
            self.unknown().unwrap_or_else(missing)
        })
    }

    /// Returns the value of the first of these fields that is there, or the object itself if none is: the place for an error.
    pub(super) fn at(&self, names: &[&str]) -> &Node<'a> {
        let named = names.iter().find_map(|name| self.entries.iter().find(|entry| entry.name == *name));
        named.map_or(&self.node, |entry| &entry.node)
    }

    fn unknown(&self) -> Option<SceneError> {
        let entry = self.entries.iter().find(|entry| !entry.used.get())?;
        let asked = self.asked.borrow();
        Some(entry.node.fault(Flaw::Unknown.of(format_args!("unknown field; there are {}", asked.join(", ")))))
    }

    /// Refuses fields that nobody asked for.
    pub(super) fn finish(&self) -> Result<()> {
        self.unknown().map_or(Ok(()), Err)
    }
}

/// The most fields of an object: more than any has that is read, and few enough to be looked through for doubles.
const FIELDS: usize = 64;

/// Hands on the parts of a value, until one is refused.
struct Visit<F> {
    one: F,
    refused: Option<SceneError>,
}

impl<'de, F: FnMut(&'de RawValue) -> Result<()>> Visitor<'de> for &mut Visit<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> core::result::Result<(), A::Error> {
        while let Some(raw) = list.next_element()? {
            if let Err(refused) = (self.one)(raw) {
                self.refused = Some(refused);
                break;
            }
        }
        Ok(())
    }
}

/// Hands on the fields of an object, until one is refused.
struct VisitFields<F> {
    one: F,
    refused: Option<SceneError>,
}

impl<'de, F: FnMut(String, &'de RawValue) -> Result<()>> Visitor<'de> for &mut VisitFields<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> core::result::Result<(), A::Error> {
        while let Some((name, raw)) = map.next_entry()? {
            if let Err(refused) = (self.one)(name, raw) {
                self.refused = Some(refused);
                break;
            }
        }
        Ok(())
    }
}

/// A text of the file in a message: short, and without what would begin a new line.
pub(super) fn in_a_line(text: &str) -> String {
    const LONGEST: usize = 60;
    let short = text.char_indices().nth(LONGEST).map_or(text, |(end, _)| &text[..end]);
    let dots = if short.len() < text.len() { "…" } else { "" };
    format!("{}{dots}", short.escape_debug())
}

/// Puts a text of the file in quotes, for a message.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", in_a_line(text))
}
