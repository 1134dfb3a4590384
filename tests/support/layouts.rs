//! A reader of bytes that knows the tables of `docs/formats.md` and nothing else.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Index;

pub(crate) const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/formats.md");

/// Content of a value, as a table gives it.
#[derive(Debug)]
pub(crate) enum Content {
    /// Fields, one after the other: (name, form).
    Fields(Vec<(String, String)>),
    /// A tag, and the fields of its case.
    Choice(Vec<Case>),
}

#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) tag: u8,
    pub(crate) name: String,
    fields: Vec<(String, String)>,
    /// Length that the table gives, if it does.
    pub(crate) bytes: String,
}

/// A value that was read.
#[derive(Debug)]
pub(crate) struct Value {
    bytes: Vec<u8>,
    case: Option<String>,
    fields: Vec<(String, Value)>,
    entries: Vec<Value>,
}

impl Index<&str> for Value {
    type Output = Value;

    fn index(&self, name: &str) -> &Value {
        let entry = self.fields.iter().find(|(field, _)| field == name);
        &entry.unwrap_or_else(|| panic!("no field {name} in {:?}", self.fields)).1
    }
}

impl Value {
    /// All bytes of it.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The name of the case, of a choice.
    pub(crate) fn case(&self) -> &str {
        self.case.as_deref().expect("a choice")
    }

    /// Content of an option.
    pub(crate) fn option(&self) -> Option<&Value> {
        self.entries.first()
    }

    /// The entries of a list.
    pub(crate) fn list(&self) -> &[Value] {
        &self.entries
    }

    /// Bytes without their number.
    pub(crate) fn raw(&self) -> &[u8] {
        &self.bytes[4..]
    }

    /// An integer from 0.
    pub(crate) fn natural(&self) -> u64 {
        self.long().try_into().expect("it fits in 64 bits")
    }

    pub(crate) fn long(&self) -> u128 {
        assert!(self.bytes.len() <= 16, "no integer");
        self.bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u128::from(*byte))
    }

    pub(crate) fn words<const N: usize>(&self) -> [u64; N] {
        assert_eq!(self.bytes.len(), 8 * N);
        std::array::from_fn(|i| u64::from_le_bytes(self.bytes[8 * i..8 * i + 8].try_into().expect("eight")))
    }

    /// A two's complement integer, in words of 64 bits with the highest first; of three words one that fits in two.
    pub(crate) fn integer(&self) -> i128 {
        match self.bytes.len() {
            8 => (self.words::<1>()[0] as i64).into(),
            16 => {
                let [high, low] = self.words();
                i128::from(high as i64) << 64 | i128::from(low)
            }
            24 => {
                let [wraps, high, low] = self.words();
                assert_eq!(wraps, 0);
                i128::from(high as i64) << 64 | i128::from(low)
            }
            length => panic!("{length} bytes are no number"),
        }
    }
}

/// All tables.
pub(crate) struct Layouts {
    /// Forms of so many bytes.
    plain: BTreeMap<String, usize>,
    forms: BTreeMap<String, Content>,
    /// The number of the format that a section is about, by its heading.
    numbers: BTreeMap<String, u32>,
}

fn code(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// `name`: `form`, and so on.
fn pairs(cell: &str) -> Vec<(String, String)> {
    let words = code(cell);
    assert!(words.len() % 2 == 0, "{cell}");
    words.chunks(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect()
}

impl Layouts {
    pub(crate) fn documented() -> Self {
        Self::parse(&fs::read_to_string(PATH).expect("the document"))
    }

    fn parse(text: &str) -> Self {
        let mut layouts = Self { plain: BTreeMap::new(), forms: BTreeMap::new(), numbers: BTreeMap::new() };
        let (mut section, mut name) = (String::new(), None);
        for line in text.lines() {
            if let Some(heading) = line.strip_prefix("## ") {
                (section, name) = (heading.to_owned(), None);
            } else if let Some(heading) = line.strip_prefix("### ") {
                name = code(heading).pop();
            } else if let Some(number) = line.strip_prefix("Format ") {
                let number = number.split('.').next().and_then(|number| number.parse().ok());
                layouts.numbers.insert(section.clone(), number.expect("a number"));
            }
            let Some(row) = line.strip_prefix('|') else { continue };
            let cells: Vec<&str> = row.trim_end_matches('|').split('|').map(str::trim).collect();
            if cells[0].starts_with("---") || matches!(cells[0], "form" | "field" | "tag" | "bytes" | "letters") {
                continue;
            }
            match &name {
                Some(name) => layouts.add(name, &cells),
                None if section == "Forms" => layouts.add_plain(&cells),
                None => {}
            }
        }
        layouts
    }

    /// A row of the first table. What has no fixed length is none of them.
    fn add_plain(&mut self, cells: &[&str]) {
        let sizes: Vec<Option<usize>> = cells[1].split(", ").map(|size| size.parse().ok()).collect();
        for (name, size) in code(cells[0]).into_iter().zip(sizes) {
            if let Some(size) = size {
                self.plain.insert(name, size);
            }
        }
    }

    fn add(&mut self, name: &str, cells: &[&str]) {
        let Ok(tag) = cells[0].parse() else {
            let field = (code(cells[0]).remove(0), code(cells[1]).remove(0));
            match self.forms.entry(name.to_owned()).or_insert_with(|| Content::Fields(Vec::new())) {
                Content::Fields(fields) => fields.push(field),
                Content::Choice(_) => panic!("{name} is a choice"),
            }
            return;
        };
        let bytes = cells.get(3).unwrap_or(&"").to_string();
        let case = Case { tag, name: cells[1].to_owned(), fields: pairs(cells[2]), bytes };
        match self.forms.entry(name.to_owned()).or_insert_with(|| Content::Choice(Vec::new())) {
            Content::Choice(cases) => cases.push(case),
            Content::Fields(_) => panic!("{name} has fields"),
        }
    }

    pub(crate) fn form(&self, name: &str) -> &Content {
        self.forms.get(name).unwrap_or_else(|| panic!("no form {name}"))
    }

    /// The number of the format that a section is about.
    pub(crate) fn number_of(&self, section: &str) -> u32 {
        self.numbers[section]
    }

    /// The value that is these bytes, all of them.
    pub(crate) fn whole(&self, form: &str, bytes: &[u8]) -> Value {
        let mut rest = bytes;
        let value = self.read(form, &mut rest);
        assert!(rest.is_empty(), "{} bytes are left over after {form}", rest.len());
        value
    }

    fn read(&self, form: &str, rest: &mut &[u8]) -> Value {
        let start = *rest;
        let mut value = Value { bytes: Vec::new(), case: None, fields: Vec::new(), entries: Vec::new() };
        if let Some(inner) = form.strip_prefix("option of ") {
            match take(rest, 1) {
                [0] => {}
                [1] => value.entries.push(self.read(inner, rest)),
                byte => panic!("{byte:?} before an option"),
            }
        } else if let Some(inner) = form.strip_prefix("list of ") {
            let count = self.read("u32", rest).natural();
            value.entries = (0..count).map(|_| self.read(inner, rest)).collect();
        } else if form == "bytes" {
            let count = self.read("u32", rest).natural();
            take(rest, count as usize);
        } else if let Some(&size) = self.plain.get(form) {
            let mut parts = take(rest, size);
            // Two of the same.
            let (names, half) = match form {
                "vector" => (["x", "y"], "fx"),
                "accumulators" => (["x", "y"], "accumulator"),
                "wides" => (["x", "y"], "wide"),
                "sums" => (["x", "y"], "sum"),
                "handle" => (["slot", "generation"], "u32"),
                "time_step" => (["num", "den"], "u32"),
                "elapsed" => (["num", "den"], "u128"),
                _ => ([""; 2], ""),
            };
            if !half.is_empty() {
                value.fields = names.map(|name| (name.to_owned(), self.read(half, &mut parts))).into();
                assert!(parts.is_empty(), "{form} is not two of {half}");
            }
        } else {
            let fields = match self.form(form) {
                Content::Fields(fields) => fields,
                Content::Choice(cases) => {
                    let tag = take(rest, 1)[0];
                    let case = cases.iter().find(|case| case.tag == tag);
                    let case = case.unwrap_or_else(|| panic!("no {form} has the tag {tag}"));
                    value.case = Some(case.name.clone());
                    &case.fields
                }
            };
            value.fields = fields.iter().map(|(name, form)| (name.clone(), self.read(form, rest))).collect();
        }
        value.bytes = start[..start.len() - rest.len()].to_vec();
        value
    }
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> &'a [u8] {
    assert!(count <= rest.len(), "{count} bytes of {}", rest.len());
    let (taken, left) = rest.split_at(count);
    *rest = left;
    taken
}
