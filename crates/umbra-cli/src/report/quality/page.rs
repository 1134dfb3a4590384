//! The page: a table of all measures, and a section with a picture for each scene.

use super::peers::{PEERS, figure, origin};
use super::{Judged, Report, Results, Verdict, number};
use crate::chart::{self, escaped};
use crate::report::page::{STYLE, table};

const OWN_STYLE: &str = include_str!("page.css");

pub(super) fn page(report: &Report) -> String {
    let scenes: String = report.scenes.iter().map(section).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>umbra-physics: quality of contacts</title>\n<style>{}{STYLE}{OWN_STYLE}</style></head>\n<body><main>\n{}{}\
         <div class=\"scenes\">\n{scenes}</div>\n<section id=\"figures\"><h2>The figures of other engines</h2>\n<pre>{}</pre></section>\n\
         </main></body></html>\n",
        chart::STYLE,
        head(report),
        overview(report),
        escaped(&origin()),
    )
}

fn head(report: &Report) -> String {
    let count = |verdict| {
        let all = report.scenes.iter().flat_map(|scene| &scene.measures);
        all.filter(|measure| measure.verdict == verdict).count()
    };
    let [passed, failed, open] = [Verdict::Passed, Verdict::Failed, Verdict::Open].map(count);
    format!(
        "<h1>Quality of contacts</h1>\n<p class=\"lead\">What stands, rests, slides and bounces: each scene runs in fixed point and is measured \
         beside what is promised of it. <strong class=\"passed\">{passed} passed</strong>, <strong class=\"failed\">{failed} failed</strong>, \
         <strong class=\"open\">{open} open</strong>.</p>\n\
         <dl><dt>Program</dt><dd>umbra-physics {}, {} sub-steps, 60 steps a second where nothing else is said, no body sleeps</dd>\
         <dt>Made by</dt><dd><code>{}</code>; every machine makes the same page</dd>\
         <dt>Passed, failed</dt><dd>a promise that is kept or broken: a run with a broken one ends with an error</dd>\
         <dt>Open</dt><dd>a goal that is not reached yet</dd>\
         <dt>Other engines</dt><dd>figures of one run of the same scenes, see <a href=\"#figures\">the end of the page</a>; – where there is none; \
         in brackets how long they ran, where that was another time</dd></dl>\n",
        report.version,
        report.substeps,
        escaped(&report.command),
    )
}

/// The head of a table of measures after its first column.
fn columns() -> impl Iterator<Item = String> {
    let peers = PEERS.into_iter().map(|peer| format!("{} {}", peer.title, peer.version));
    peers.chain(["promised", "this run", ""].map(str::to_owned))
}

/// The cells of a measure after the first one.
fn cells<'a>(scene: &'a Results, measure: &'a Judged) -> impl Iterator<Item = String> + 'a {
    let peers = PEERS.into_iter().map(|peer| {
        figure(peer, scene.name, measure.name).map_or("–".to_owned(), |(value, length)| {
            let value = if value.is_finite() { number(value) } else { "never".to_owned() };
            let length = if length == scene.length { String::new() } else { format!(" ({length})") };
            format!("{value}{length}")
        })
    });
    let promise = measure.promise.clone().unwrap_or_else(|| "–".to_owned());
    let verdict = measure.verdict.name();
    peers.chain([promise, measure.shown(), format!("<span class=\"{verdict}\">{verdict}</span>")])
}

fn overview(report: &Report) -> String {
    let head: Vec<String> = ["scene", "measure"].map(str::to_owned).into_iter().chain(columns()).collect();
    let rows = report.scenes.iter().flat_map(|scene| {
        scene.measures.iter().enumerate().map(move |(i, measure)| {
            let link = if i == 0 { format!("<a href=\"#{}\">{}</a>", scene.name, scene.row.title) } else { String::new() };
            [link, measure.about.to_owned()].into_iter().chain(cells(scene, measure)).collect()
        })
    });
    table(&head, rows)
}

fn section(scene: &Results) -> String {
    let head: Vec<String> = ["measure".to_owned()].into_iter().chain(columns()).collect();
    let rows = scene.measures.iter().map(|measure| {
        [measure.about.to_owned()].into_iter().chain(cells(scene, measure)).collect()
    });
    format!(
        "<section id=\"{}\"><h2>{}</h2>\n<p>{} Run: {}.</p>\n{}{}</section>\n",
        scene.name,
        scene.row.title,
        scene.row.about,
        scene.length,
        scene.picture.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1),
        table(&head, rows)
    )
}
