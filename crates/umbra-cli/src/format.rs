//! Formats of outputs, which other programs tell by the ends of file names.

use std::path::Path;

use crate::text;

/// A format of an output.
#[derive(Clone, Copy, Debug)]
pub enum Format {
    /// A picture.
    Svg,
    /// A table.
    Csv,
    /// A page.
    Html,
    /// A scene, or figures.
    Json,
    /// A replay. Only this program reads it, and tells it by its first bytes: any name will do.
    Replay,
}

impl Format {
    /// The format in words, and the ends that a name may have, the usual one first; no name ends wrongly where there are none.
    const fn words(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Self::Svg => ("a picture in SVG", &["svg"]),
            Self::Csv => ("a table in CSV", &["csv", "txt"]),
            Self::Html => ("a page in HTML", &["html", "htm"]),
            Self::Json => ("JSON", &["json"]),
            Self::Replay => ("a replay", &[]),
        }
    }

    /// Says why a name would mislead other programs, and which one would not; `None` for a name that ends as it should, or has no end.
    pub(crate) fn objection(self, file: &Path) -> Option<String> {
        let (kind, ends) = self.words();
        let (end, usual) = (file.extension()?.to_str().unwrap_or_default(), ends.first()?);
        if ends.iter().any(|known| end.eq_ignore_ascii_case(known)) {
            return None;
        }
        let name = text::argument(&file.with_extension(usual));
        let hint = match self {
            Self::Svg => ", which browsers show and `rsvg-convert` makes a PNG of",
            _ => "",
        };
        Some(format!("this is {kind}: write {name}{hint}"))
    }
}
