//! Rows of results: printed as CSV as they come, and as tables at the end.

use std::fmt::Write as _;

pub struct Row {
    pub engine: String,
    pub scene: String,
    pub n: usize,
    pub metric: String,
    pub value: f64,
    pub unit: String,
    pub min: f64,
    pub max: f64,
    pub samples: usize,
    pub note: String,
}

/// Scene, n, metric, unit.
type Key = (String, usize, String, String);

#[derive(Default)]
pub struct Report {
    pub rows: Vec<Row>,
    pub notes: Vec<String>,
}

pub const CSV_HEAD: &str = "engine,scene,n,metric,value,unit,min,max,samples,note";

pub fn num(v: f64) -> String {
    if !v.is_finite() {
        return format!("{v}");
    }
    let a = v.abs();
    if a == 0.0 {
        "0".into()
    } else if v.fract() == 0.0 && a < 1e9 {
        format!("{v:.0}")
    } else if !(1e-3..1e9).contains(&a) {
        format!("{v:.3e}")
    } else if a < 10.0 {
        format!("{v:.4}")
    } else if a < 1000.0 {
        format!("{v:.2}")
    } else {
        format!("{v:.0}")
    }
}

impl Report {
    /// Median with min and max.
    pub fn add(
        &mut self,
        engine: &str,
        scene: &str,
        n: usize,
        metric: &str,
        unit: &'static str,
        samples: &[f64],
        note: impl Into<String>,
    ) {
        let mut s: Vec<f64> = samples.to_vec();
        s.sort_by(f64::total_cmp);
        let (value, min, max) = match s.len() {
            0 => (f64::NAN, f64::NAN, f64::NAN),
            k => (if k % 2 == 1 { s[k / 2] } else { 0.5 * (s[k / 2 - 1] + s[k / 2]) }, s[0], s[k - 1]),
        };
        let r = Row {
            engine: engine.into(),
            scene: scene.into(),
            n,
            metric: metric.into(),
            value,
            unit: unit.into(),
            min,
            max,
            samples: s.len(),
            note: note.into().replace(',', ";"),
        };
        self.push(r);
    }
    /// Adds a row, and prints it.
    fn push(&mut self, r: Row) {
        println!(
            "{},{},{},{},{},{},{},{},{},{}",
            r.engine,
            r.scene,
            r.n,
            r.metric,
            num(r.value),
            r.unit,
            num(r.min),
            num(r.max),
            r.samples,
            r.note
        );
        self.rows.push(r);
    }

    /// Adds a row of the CSV file of another run.
    pub fn add_line(&mut self, line: &str) {
        let cells: Vec<&str> = line.splitn(10, ',').collect();
        let [engine, scene, n, metric, value, unit, min, max, samples, note] = cells[..] else { return };
        let number = |text: &str| text.parse().unwrap_or(f64::NAN);
        self.push(Row {
            engine: engine.into(),
            scene: scene.into(),
            n: n.parse().unwrap_or(0),
            metric: metric.into(),
            value: number(value),
            unit: unit.into(),
            min: number(min),
            max: number(max),
            samples: samples.parse().unwrap_or(0),
            note: note.into(),
        });
    }

    pub fn one(
        &mut self,
        engine: &str,
        scene: &str,
        n: usize,
        metric: &str,
        unit: &'static str,
        value: f64,
        note: impl Into<String>,
    ) {
        self.add(engine, scene, n, metric, unit, &[value], note);
    }
    pub fn skip(&mut self, engine: &str, scene: &str, n: usize, why: &str) {
        self.note_skipped(&format!("{engine} {scene} {n}: {why}"));
    }
    pub fn note_skipped(&mut self, note: &str) {
        println!("# skipped: {note}");
        self.notes.push(note.into());
    }

    /// The table's entry of an engine in the row of (scene, n, metric, unit).
    fn cell(&self, engine: &str, k: &Key, min: bool) -> String {
        let mut rows = self.rows.iter();
        let Some(r) = rows.find(|r| r.engine == engine && (&r.scene, r.n, &r.metric) == (&k.0, k.1, &k.2)) else {
            return "-".into();
        };
        let value = num(if min { r.min } else { r.value });
        let cut = if r.note.contains("first ") { "*" } else { "" };
        let bad = if r.note.contains("INVALID") { "!" } else { "" };
        format!("{value}{cut}{bad}")
    }

    /// A table in Markdown: a row for each metric of a scene, a column for each engine.
    pub fn tables(&self, engines: &[&str], min: bool) -> String {
        let mut out = String::from("\n");
        let mut keys: Vec<Key> = Vec::new();
        for r in &self.rows {
            let k = (r.scene.clone(), r.n, r.metric.clone(), r.unit.clone());
            if !keys.contains(&k) {
                keys.push(k);
            }
        }
        // Metrics of one scene stay together, whatever order they were measured in.
        let mut scenes: Vec<(String, usize)> = Vec::new();
        for k in &keys {
            let s = (k.0.clone(), k.1);
            if !scenes.contains(&s) {
                scenes.push(s);
            }
        }
        let mut line = |cells: [&str; 4], values: &[String]| {
            let [scene, n, metric, unit] = cells;
            let _ = write!(out, "| {scene:<16} | {n:>6} | {metric:<24} | {unit:<8} |");
            for v in values {
                let _ = write!(out, " {v:>13} |");
            }
            out.push('\n');
        };
        line(["scene", "n", "metric", "unit"], &engines.iter().map(|e| e.to_string()).collect::<Vec<_>>());
        line(["---"; 4], &vec!["---:".to_string(); engines.len()]);
        for (s, n) in scenes {
            for k in keys.iter().filter(|k| k.0 == s && k.1 == n) {
                let cells: Vec<_> = engines.iter().map(|e| self.cell(e, k, min)).collect();
                line([&k.0, &k.1.to_string(), &k.2, &k.3], &cells);
            }
        }
        out.push_str(if min { "\nSmallest of the samples." } else { "\nMedians." });
        out.push_str(" * = the run was cut by the time cap: see the note of its CSV line.\n! = the end state is wrong (note of the CSV line): its times are not comparable.\n");
        if !self.notes.is_empty() {
            out.push_str("\nSkipped:\n");
            for n in &self.notes {
                let _ = writeln!(out, "  {n}");
            }
        }
        out
    }
}
