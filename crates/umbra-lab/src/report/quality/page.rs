//! The page: a table of all measures, and a section with a picture for each scene.

use umbra_cli::text::markup;

use super::peers::{PEERS, Peer, figure, origin};
use super::rows::{PARTS, Part};
use super::{Judged, Report, Results, Verdict, number};
use crate::chart;
use crate::report::page::{STYLE, table};

const OWN_STYLE: &str = include_str!("page.css");

pub(super) fn page(report: &Report) -> String {
    let parts: String = PARTS.iter().map(|part| section(part, report)).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>umbra-physics: quality of contacts</title>\n<style>{}{STYLE}{OWN_STYLE}</style></head>\n<body><main>\n{}{}\
         {parts}<section id=\"figures\"><h2>The figures of other engines</h2>\n<pre>{}</pre></section>\n\
         </main></body></html>\n",
        chart::STYLE,
        head(report),
        overview(report),
        markup(&origin()),
    )
}

fn head(report: &Report) -> String {
    let count = |verdict| {
        let all = report.scenes.iter().flat_map(|scene| &scene.measures);
        all.filter(|measure| measure.verdict == verdict).count()
    };
    let [passed, failed, open] = [Verdict::Passed, Verdict::Failed, Verdict::Open].map(count);
    format!(
        "<h1>Quality of contacts</h1>\n<p class=\"lead\">Stacks, slopes, bounces, shots and impacts: each scene runs in fixed point, and \
         its measures stand beside what is promised of them. <strong class=\"passed\">{passed} passed</strong>, <strong class=\"failed\">{failed} failed</strong>, \
         <strong class=\"open\">{open} open</strong>.</p>\n\
         <dl><dt>Program</dt><dd>umbra-physics {}, {} sub-steps, 60 steps a second where nothing else is said, no body sleeps</dd>\
         <dt>Made by</dt><dd><code>{}</code>; each run makes the same page, but for the times in the charts of time against error</dd>\
         <dt>Passed, failed</dt><dd>a promise that is kept or broken: a run with a broken one ends with an error</dd>\
         <dt>Open</dt><dd>a goal that is not reached yet</dd>\
         <dt>Other engines</dt><dd>figures of one run of the same scenes, see <a href=\"#figures\">the end of the page</a>; – where there is none; \
         in brackets how long they ran, where that was another time</dd></dl>\n",
        report.version,
        report.substeps,
        markup(&report.command),
    )
}

/// All measures, with the scene beside its first one.
fn overview(report: &Report) -> String {
    let peers = PEERS.into_iter().map(|peer| format!("{} {}", peer.title, peer.version));
    let head: Vec<String> =
        ["scene", "measure", "this run", "promised", ""].into_iter().map(str::to_owned).chain(peers).collect();
    let rows = report.scenes.iter().flat_map(|scene| {
        scene.measures.iter().enumerate().map(move |(i, measure)| {
            let link = format!("<a href=\"#{}\">{}</a>", scene.name, scene.row.title);
            let promise = measure.promise.clone().unwrap_or_else(|| "–".to_owned());
            let verdict = measure.verdict.name();
            let verdict = format!("<span class=\"{verdict}\">{verdict}</span>");
            let cells = [
                if i == 0 { link } else { String::new() },
                measure.about.to_owned(),
                measure.shown(),
                promise,
                verdict,
            ];
            cells.into_iter().chain(PEERS.into_iter().map(|peer| figure_of(peer, scene, measure))).collect()
        })
    });
    format!("<div class=\"quality\">{}</div>\n", table(&head, rows))
}

/// The figure of another engine, with the length of its run where that is another one.
fn figure_of(peer: Peer, scene: &Results, measure: &Judged) -> String {
    figure(peer, scene.name, measure.name).map_or("–".to_owned(), |(value, length)| {
        let value = if value.is_finite() { number(value) } else { "never".to_owned() };
        if length == scene.length { value } else { format!("{value} ({length})") }
    })
}

/// The chosen scenes of a part; nothing if there are none.
fn section(part: &Part, report: &Report) -> String {
    let is_in_part = |scene: &&Results| part.rows.iter().any(|row| row.name == scene.name);
    let scenes: String = report.scenes.iter().filter(is_in_part).map(article).collect();
    if scenes.is_empty() {
        return String::new();
    }
    format!("<section id=\"{}\"><h2>{}</h2>\n<div class=\"scenes\">\n{scenes}</div></section>\n", part.name, part.title)
}

fn article(scene: &Results) -> String {
    format!(
        "<section id=\"{}\"><h3>{}</h3>\n<p>{} Run: {}.</p>\n{}</section>\n",
        scene.name, scene.row.title, scene.row.about, scene.length, scene.picture,
    )
}
