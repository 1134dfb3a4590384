//! Arguments of the form `--name value`.

use std::str::FromStr;

/// The arguments of a program after its role, in pairs.
pub(crate) struct Options(Vec<(String, String)>);

impl Options {
    /// Takes the pairs apart; of the names, only those that are known.
    ///
    /// # Errors
    /// A message for the user.
    pub(crate) fn read(mut arguments: impl Iterator<Item = String>, known: &[&str]) -> Result<Self, String> {
        let mut pairs = Vec::new();
        while let Some(name) = arguments.next() {
            let short = name.strip_prefix("--").filter(|short| known.contains(short));
            let short = short.ok_or(format!("unknown option {name}; known are --{}", known.join(" --")))?.to_owned();
            let value = arguments.next().ok_or(format!("{name} needs a value"))?;
            pairs.push((short, value));
        }
        Ok(Self(pairs))
    }

    /// (name, value), as they were given.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// The last value given for a name.
    ///
    /// # Errors
    /// If it cannot be read as a `T`.
    pub(crate) fn get<T: FromStr>(&self, name: &str) -> Result<Option<T>, String> {
        let Some((_, value)) = self.0.iter().rev().find(|(known, _)| known == name) else { return Ok(None) };
        value.parse().map(Some).map_err(|_| format!("--{name} {value}: not what it takes"))
    }
}
