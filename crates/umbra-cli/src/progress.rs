//! The progress of a long task.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on a terminal; nothing elsewhere.
pub fn progress(count: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(count);
    let template = format!("{{bar:40}} {what} {{pos}} of {{len}}, {{eta}} to go");
    ProgressStyle::with_template(&template).map_or(bar.clone(), |style| bar.with_style(style))
}
