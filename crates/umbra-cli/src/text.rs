//! Text for the standard output and the standard error. File names, scenes and replays are not trusted: the control
//! characters in them are escaped.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::failure::Failure;
use crate::load;

/// The standard output in messages.
pub(crate) const STDOUT: &str = "standard output";

/// Prints text to the standard output, with an end of line.
pub fn print(text: impl Display) -> Result<(), Failure> {
    let text = text.to_string();
    written(|out| writeln!(out, "{}", escaped(text.trim_end(), &['\n'])))
}

/// Prints what the program has made itself, as it is.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    written(|out| out.write_all(bytes))
}

/// Prints a result for a person, or as a JSON object.
pub fn print_result<T: Display + Serialize>(value: &T, json: bool) -> Result<(), Failure> {
    print(result(value, json))
}

/// A result for a person, or as a JSON object.
pub(crate) fn result<T: Display + Serialize>(value: &T, json: bool) -> String {
    if json { serde_json::to_string_pretty(value).unwrap_or_default() } else { value.to_string() }
}

/// Prints a line that somebody waits for: a reader that has closed its end is a failure.
pub(crate) fn answer(line: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let written = writeln!(out, "{}", escaped(line, &[])).and_then(|()| out.flush());
    written.map_err(Failure::file(Path::new(STDOUT), "write"))
}

/// Prints the help or the version, or says what is wrong with the arguments.
pub fn print_usage(mut message: clap::Error) -> Result<(), Failure> {
    use clap::error::{ContextKind, ContextValue};
    if !message.use_stderr() {
        return written(|_| message.print());
    }
    // The ends of lines in its layout stay, those in the arguments that it quotes do not.
    let context: Vec<(ContextKind, ContextValue)> = message
        .context()
        .filter_map(|(kind, value)| {
            let value = match value {
                ContextValue::String(text) => ContextValue::String(quoted(text)),
                ContextValue::Strings(texts) => ContextValue::Strings(texts.iter().map(|text| quoted(text)).collect()),
                ContextValue::StyledStrs(tips) => {
                    ContextValue::StyledStrs(tips.iter().map(|tip| quoted(&tip.to_string()).into()).collect())
                }
                _ => return None,
            };
            Some((kind, value))
        })
        .collect();
    for (kind, value) in context {
        message.insert(kind, value);
    }
    Err(Failure::Usage { what: message.render().to_string().trim_end().to_owned() })
}

/// Prints a line to the standard error. If that cannot be written, there is still the status.
pub(crate) fn warn(text: impl Display) {
    let _ = writeln!(io::stderr(), "{}", escaped(&text.to_string(), &['\n']));
}

/// The path of an input for a message, on one line.
pub fn path(path: &Path) -> String {
    if load::is_dash(path) { "standard input".to_owned() } else { argument(path) }
}

/// The name of an input without its folders, for a title.
pub(crate) fn name(file: &Path) -> String {
    if load::is_dash(file) {
        return "standard input".to_owned();
    }
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// A path as the arguments have it, on one line.
pub(crate) fn argument(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// A text as the content of an element or an attribute of HTML and SVG.
pub fn markup(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A text to quote in a message, on one line.
fn quoted(text: &str) -> String {
    escaped(text, &[]).into_owned()
}

/// A number and its noun, of which the singular and the plural are given.
pub(crate) fn counted(number: u64, nouns: [&str; 2]) -> String {
    format!("{} {}", grouped(number), nouns[usize::from(number != 1)])
}

/// A number with its digits in threes.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Writes to the standard output and flushes it. A reader that has closed its end is no failure.
fn written(write: impl FnOnce(&mut io::Stdout) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = io::stdout();
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::file(Path::new(STDOUT), "write")(error))
        }
        _ => Ok(()),
    }
}

/// The text with the characters that move a cursor, change colours or turn the direction of text written as `\u001b`. In
/// JSON, which has them within strings alone, that is the same text.
fn escaped<'a>(text: &'a str, keep: &[char]) -> Cow<'a, str> {
    let acts = |c: char| acts_on_terminals(c) && !keep.contains(&c);
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if acts(c) {
            plain += &format!("\\u{:04x}", u32::from(c));
        } else {
            plain.push(c);
        }
    }
    Cow::Owned(plain)
}

/// The control characters, those with the property `Bidi_Control`, and the two that end a line or a paragraph.
fn acts_on_terminals(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_characters_that_a_terminal_obeys_are_escaped() {
        let hostile = "\u{1b}[2J\r\u{7}\u{7f}\u{9b}31m\t\u{202e}\u{2066}\u{2028}";
        assert_eq!(quoted(hostile), r"\u001b[2J\u000d\u0007\u007f\u009b31m\u0009\u202e\u2066\u2028");
        assert_eq!(quoted("a\nb"), r"a\u000ab");
        assert_eq!(escaped("a\nb", &['\n']), "a\nb");
        let harmless = r"ω·dt = 2.1 → 5 kg·m², C:\new, 日本, مرحبا, 👩‍🚀";
        assert!(matches!(escaped(harmless, &[]), Cow::Borrowed(it) if it == harmless));
    }

    #[test]
    fn escaped_json_says_the_same() {
        let value = serde_json::json!({"file": "\u{1b}\u{9b}\u{7f}\u{202e}\u{2028}\n", "list": [1, "\\u009b"]});
        for text in [value.to_string(), serde_json::to_string_pretty(&value).expect("JSON")] {
            let plain = escaped(&text, &['\n']);
            assert_eq!(plain.matches("\\u009b").count(), 2);
            assert_eq!(serde_json::from_str::<serde_json::Value>(&plain).expect("JSON"), value);
        }
    }
}
