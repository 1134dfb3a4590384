//! JSON as a scene reads it: every value with its text and its place. The grammar is `serde_json`'s.
//!
//! A value is looked into only as deep as the format goes, so that depth costs no stack, and a number is the text that
//! stands in the file.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::ops::ControlFlow;

use serde::de::{Deserializer as _, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::error::{Flaw, Found, Place, Reason, Refused};
use super::hint;
use super::repeat::Round;

/// A value that was read, or the mark that it was refused: the error itself is with the [`Source`].
pub(super) type Result<T> = core::result::Result<T, Refused>;

/// A scene's text, how many lines end before each page of it, and the errors found in it.
pub(super) struct Source<'a> {
    text: &'a str,
    pages: Vec<usize>,
    pub(super) found: Found,
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
        Self { text, pages: pages.collect(), found: Found::default() }
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
    pub(super) source: &'a Source<'a>,
    text: &'a str,
    pub(super) field: String,
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
            let what = format!("not JSON: {what} at column {}", error.column());
            source.found.add(|| place.fault(Flaw::NotJson.of(what)))
        })?;
        Ok(Self { source, text: raw.get(), field: String::new(), round: None })
    }

    /// The place in the text.
    pub(super) fn place(&self) -> Place {
        // A part of the document's own text, so the difference is an index in it.
        let offset = (self.text.as_ptr() as usize).saturating_sub(self.source.text.as_ptr() as usize);
        Place { line: self.source.line(offset), field: self.field.clone() }
    }

    /// Refuses the value.
    pub(super) fn fault(&self, reason: impl Reason) -> Refused {
        self.source.found.add(|| self.place().fault(reason))
    }

    pub(super) fn wrong_kind(&self, expected: &str) -> Refused {
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

    pub(super) fn child(&self, raw: &'a RawValue, step: fmt::Arguments<'_>) -> Self {
        Self { source: self.source, text: raw.get(), field: format!("{}{step}", self.field), round: self.round }
    }

    /// Hands on the values of a list one by one: all of them at once would take many times their text. One that is refused does not
    /// keep the next ones from being read.
    pub(super) fn each(&self, mut read: impl FnMut(Self) -> Result<()>) -> Result<()> {
        if self.kind() != Kind::List {
            return Err(self.wrong_kind("a list"));
        }
        let (mut index, mut result) = (0, Ok(()));
        let visit = |raw: &'a RawValue| {
            let node = self.child(raw, format_args!("[{index}]"));
            index += 1;
            let Err(refused) = read(node) else { return ControlFlow::Continue(()) };
            result = Err(Refused::default());
            if refused.ends_list { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut text = serde_json::Deserializer::from_str(self.text);
        let visited = text.deserialize_seq(&mut Visit(visit));
        // A list that was left before its end is no error of its text.
        result?;
        visited.map_err(|e| self.fault(Flaw::NotJson.of(e)))
    }

    /// The values of a list of at most so many; one more is refused as `too_many` says.
    pub(super) fn list(&self, limit: usize, too_many: impl Reason) -> Result<Vec<Self>> {
        let mut nodes = Vec::new();
        self.each(|node| {
            if nodes.len() == limit {
                return Err(self.fault(&too_many).ending_list());
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
        let wrong_count =
            |_| self.fault(Flaw::WrongKind.of(format_args!("expected a list of {N} values, found {count}")));
        if count > N { Err(wrong_count(nodes)) } else { nodes.try_into().map_err(wrong_count) }
    }

    /// A text; in a repetition with its indices put in for `{i}`, `{j}`, `{i+1}` and the like.
    pub(super) fn string(&self) -> Result<String> {
        if self.kind() != Kind::Text {
            return Err(self.wrong_kind("a text"));
        }
        self.filled().map_err(|message| self.fault(Flaw::Text.of(message)))
    }

    /// The text that the value is, or the reason why it is none that a scene may have.
    pub(super) fn filled(&self) -> core::result::Result<String, String> {
        let text: String = serde_json::from_str(self.text).map_err(|error| format!("not a text: {error}"))?;
        // Names and titles go to terminals, tables and pictures, where these would do something.
        if let Some(control) = text.chars().find(|c| c.is_control()) {
            return Err(format!("a text must have no control characters: found {}", control.escape_debug()));
        }
        self.round.map_or(Ok(text.clone()), |round| round.fill(&text))
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
        let choice = choices.iter().find(|(name, _)| *name == text);
        choice.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let meant = hint::word(&text, &names).map_or_else(String::new, |name| format!(": did you mean `{name}`?"));
            let (names, input) = (names.join(", "), quoted(&text));
            self.fault(Flaw::WrongKind.of(format_args!("expected one of {names}, found {input}{meant}")))
        })
    }
}

/// Hands on the values of a list as long as they are wanted.
struct Visit<F>(F);

impl<'de, F: FnMut(&'de RawValue) -> ControlFlow<()>> Visitor<'de> for &mut Visit<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> core::result::Result<(), A::Error> {
        while let Some(raw) = list.next_element()? {
            if (self.0)(raw).is_break() {
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
