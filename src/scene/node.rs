//! JSON as a scene reads it: every value with its text and its place. The grammar is `serde_json`'s.
//!
//! A value is looked into only as deep as the format goes, so that depth costs no stack, and a number is the text that
//! stands in the file.

use alloc::collections::BTreeSet;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::cell::{Cell, RefCell};
use core::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;

use super::error::{Place, SceneError};
use super::repeat::Round;

pub(super) type Result<T> = core::result::Result<T, SceneError>;

/// A scene's text, and where its lines begin.
pub(super) struct Source<'a> {
    text: &'a str,
    lines: Vec<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        Self { text, lines: ends.map(|(at, _)| at + 1).collect() }
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

/// What a value is.
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
            place.fault(format_args!("not JSON: {what} at column {}", error.column()))
        })?;
        Ok(Self { source, text: raw.get(), field: String::new(), round: None })
    }

    /// Where it stands.
    pub(super) fn place(&self) -> Place {
        // A part of the document's own text, so the difference is an index in it.
        let offset = (self.text.as_ptr() as usize).saturating_sub(self.source.text.as_ptr() as usize);
        let line = 1 + self.source.lines.partition_point(|&start| start <= offset);
        Place { line, field: self.field.clone() }
    }

    pub(super) fn fault(&self, message: impl fmt::Display) -> SceneError {
        self.place().fault(message)
    }

    pub(super) fn wrong_kind(&self, expected: &str) -> SceneError {
        self.fault(format_args!("expected {expected}, found {}", self.kind().name()))
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

    /// The same value, read in a repetition.
    pub(super) fn in_round(&self, round: Round) -> Self {
        Self { field: format!("{}{round}", self.field), round: Some(round), ..self.clone() }
    }

    fn child(&self, raw: &'a RawValue, step: fmt::Arguments<'_>) -> Self {
        Self { source: self.source, text: raw.get(), field: format!("{}{step}", self.field), round: self.round }
    }

    pub(super) fn list(&self) -> Result<Vec<Self>> {
        if self.kind() != Kind::List {
            return Err(self.wrong_kind("a list"));
        }
        let raw: Vec<&'a RawValue> = serde_json::from_str(self.text).map_err(|e| self.fault(e))?;
        Ok(raw.into_iter().enumerate().map(|(i, raw)| self.child(raw, format_args!("[{i}]"))).collect())
    }

    /// A list of this many values.
    pub(super) fn tuple<const N: usize>(&self) -> Result<[Self; N]> {
        let list = self.list()?;
        let count = list.len();
        list.try_into().map_err(|_| self.fault(format_args!("expected a list of {N}, found {count} in it")))
    }

    pub(super) fn object(&self) -> Result<Object<'a>> {
        if self.kind() != Kind::Object {
            return Err(self.wrong_kind("an object"));
        }
        let Entries(raw) = serde_json::from_str(self.text).map_err(|e| self.fault(e))?;
        let dot = if self.field.is_empty() { "" } else { "." };
        let field = |name: &str, raw: &'a RawValue| self.child(raw, format_args!("{dot}{}", in_a_line(name)));
        // In order, so that a thousand fields take no million comparisons.
        let mut names: BTreeSet<&str> = BTreeSet::new();
        if let Some((name, raw)) = raw.iter().find(|(name, _)| !names.insert(name)) {
            return Err(field(name, raw).fault("this field is there twice"));
        }
        let entry = |(name, raw): (String, &'a RawValue)| {
            let node = field(&name, raw);
            Entry { name, node, used: Cell::new(false) }
        };
        let entries = raw.into_iter().map(entry).collect();
        Ok(Object { node: self.clone(), entries, asked: RefCell::default() })
    }

    /// A text; in a repetition with its indices put in for `{i}`, `{j}`, `{i+1}` and the like.
    pub(super) fn string(&self) -> Result<String> {
        if self.kind() != Kind::Text {
            return Err(self.wrong_kind("a text"));
        }
        let text: String = serde_json::from_str(self.text).map_err(|e| self.fault(e))?;
        // Names and titles go to terminals, tables and pictures, where these would do something.
        if let Some(control) = text.chars().find(|c| c.is_control()) {
            return Err(self.fault(format_args!("a text has no control characters: found {}", control.escape_debug())));
        }
        match self.round {
            Some(round) => round.fill(&text).map_err(|message| self.fault(message)),
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

    /// One of some names.
    pub(super) fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T> {
        let text = self.string()?;
        let found = choices.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            self.fault(format_args!("expected one of {}, found {}", names.join(", "), quoted(&text)))
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
        self.get(name).ok_or_else(|| self.node.fault(format_args!("the field `{name}` is missing")))
    }

    /// What `read` makes of a field, or `otherwise` without it.
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
                    return Err(node.fault(format_args!("there is `{other}` already: one of them only")));
                }
                found = Some((*name, node));
            }
        }
        found.ok_or_else(|| {
            let missing = || self.node.fault(format_args!("one of the fields {} is missing", names.join(", ")));
            self.unknown().unwrap_or_else(missing)
        })
    }

    /// Where the value of one of these fields is that is there; the object itself without any.
    pub(super) fn at(&self, names: &[&str]) -> &Node<'a> {
        let named = names.iter().find_map(|name| self.entries.iter().find(|entry| entry.name == *name));
        named.map_or(&self.node, |entry| &entry.node)
    }

    fn unknown(&self) -> Option<SceneError> {
        let entry = self.entries.iter().find(|entry| !entry.used.get())?;
        let asked = self.asked.borrow();
        Some(entry.node.fault(format_args!("unknown field; there are {}", asked.join(", "))))
    }

    /// Refuses fields that nobody asked for.
    pub(super) fn finish(&self) -> Result<()> {
        self.unknown().map_or(Ok(()), Err)
    }
}

/// The fields of an object in their order, doubles included.
struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Entries<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> core::result::Result<Self, D::Error> {
        struct Fields;

        impl<'de> Visitor<'de> for Fields {
            type Value = Vec<(String, &'de RawValue)>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> core::result::Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(entries)
            }
        }

        deserializer.deserialize_map(Fields).map(Self)
    }
}

/// A text of the file in a message: short, and without what would begin a new line.
pub(super) fn in_a_line(text: &str) -> String {
    const LONGEST: usize = 60;
    let short = text.char_indices().nth(LONGEST).map_or(text, |(end, _)| &text[..end]);
    let dots = if short.len() < text.len() { "…" } else { "" };
    format!("{}{dots}", short.escape_debug())
}

/// The same, in quotes.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", in_a_line(text))
}
