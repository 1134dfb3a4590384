//! Benchmark of the peer physics engines, so that a new engine can be measured
//! beside them in one run. See README.md.

mod bench;
mod builds;
mod engine;
mod engines;
mod plot;
mod report;
mod scene;

use bench::Opt;
use builds::BUILDS;
use engine::Engine;
use report::Report;
use std::time::Instant;

type Bench = fn(&mut Report, bench::Engines, &Opt);

const SCENES: &[(&str, Bench)] = &[
    ("free", bench::free),
    ("free_static", bench::free_static),
    ("sleeping", bench::sleeping),
    ("pyramid", bench::pyramid),
    ("rain", bench::rain),
    ("joints", bench::joints),
    ("ragdolls", bench::ragdolls),
    ("joint_grid", bench::joint_grid),
    ("tumbler", bench::tumbler),
    ("motor_spinner", bench::motor_spinner),
    ("joint_errors", bench::joint_errors),
    ("snapshot", bench::snapshot),
    ("accuracy", bench::accuracy),
    ("memory", bench::memory),
    ("passes", bench::passes),
    ("stages", bench::stages),
    ("rays", bench::rays),
    ("impacts", bench::impacts),
    ("many_pyramids", bench::many_pyramids),
    ("spinner", bench::spinner),
    ("hourglass", bench::hourglass),
    ("hopper", bench::hopper),
    ("polygons", bench::polygons),
    ("tiles", bench::tiles),
    ("rooms", bench::rooms),
    ("settling", bench::settling),
    ("threads", bench::threads),
    (QUALITY, bench::quality),
];

/// The scene that has parts, and that only runs when asked for.
const QUALITY: &str = "quality";

fn usage() -> ! {
    eprintln!(
        "peers [--scene A,B,quality:C] [--engine A,B] [--quick] [--wall] [--table min] [--csv FILE] [--plot FILE] [--list]"
    );
    std::process::exit(2)
}

fn main() {
    let mut all = engines::all();
    let mut scenes: Option<Vec<String>> = None;
    let mut only: Option<Vec<String>> = None;
    let mut quick = false;
    let mut table_min = false;
    let mut csv: Option<String> = None;
    let mut plot: Option<String> = None;
    let mut head_only = false;
    let mut args = std::env::args().skip(1);
    let list = |s: Option<String>| s.unwrap_or_else(|| usage()).split(',').map(str::to_string).collect::<Vec<_>>();
    while let Some(a) = args.next() {
        match a.as_str() {
            "--scene" => scenes = Some(list(args.next())),
            "--engine" => {
                let ids = list(args.next());
                all.extend(ids.iter().filter_map(|id| engines::with_options(id)));
                only = Some(ids);
            }
            "--csv" => csv = Some(args.next().unwrap_or_else(|| usage())),
            "--plot" => plot = Some(args.next().unwrap_or_else(|| usage())),
            "--quick" => quick = true,
            "--head" => head_only = true,
            "--wall" => bench::WALL.store(true, std::sync::atomic::Ordering::Relaxed),
            "--table" => match args.next().as_deref() {
                Some("min") => table_min = true,
                Some("median") => table_min = false,
                _ => usage(),
            },
            "--list" => {
                println!("scenes:  {}", SCENES.iter().map(|s| s.0).collect::<Vec<_>>().join(" "));
                println!("quality: {}", bench::quality_names().collect::<Vec<_>>().join(" "));
                println!("engines: {}", all.iter().map(|e| e.id()).collect::<Vec<_>>().join(" "));
                for build in &BUILDS {
                    println!("         {} (in a build of their own)", build.engines.join(" "));
                }
                return;
            }
            "--mem-child" => {
                let (e, s, n) = (args.next(), args.next(), args.next());
                all.extend(e.as_deref().and_then(engines::with_options));
                let e = all.iter().find(|x| Some(x.id()) == e.as_deref()).unwrap_or_else(|| usage());
                bench::mem_child(e.as_ref(), &s.unwrap_or_default(), n.and_then(|n| n.parse().ok()).unwrap_or(1000));
                return;
            }
            _ => usage(),
        }
    }
    let mut parts = Vec::new();
    for s in scenes.iter_mut().flatten() {
        if let Some((QUALITY, part)) = s.split_once(':') {
            parts.push(part.to_string());
            *s = QUALITY.into();
        }
    }
    if let Some(p) = parts.iter().find(|&p| !bench::quality_names().any(|n| n == p)) {
        eprintln!("quality has no scene {p}; --list names them");
        usage();
    }
    let known_scene = |s: &String| SCENES.iter().any(|k| k.0 == s);
    let known_engine =
        |s: &String| all.iter().any(|k| k.id() == s) || BUILDS.iter().any(|b| b.engines.contains(&s.as_str()));
    if !scenes.iter().flatten().all(known_scene) || !only.iter().flatten().all(known_engine) {
        eprintln!("unknown scene or engine; --list names them");
        usage();
    }
    let is_wanted = |id: &str| only.as_ref().is_none_or(|ids| ids.iter().any(|x| x == id));
    let chosen: Vec<&dyn Engine> = all.iter().map(|e| e.as_ref()).filter(|e| is_wanted(e.id())).collect();

    for e in &chosen {
        let i = e.info();
        println!("# {}: {}; {}; {}", e.id(), i.version, i.number, i.build);
        println!("#   {}; damping: {}", i.solver, i.damping_law);
    }
    if head_only {
        return;
    }
    let mut rep = Report::default();
    let is_wanted_child = |id: &str| is_wanted(id) && !all.iter().any(|e| e.id() == id);
    let children = builds::children(is_wanted_child, &mut rep);
    println!(
        "# one thread, dt 1/60 unless the scene says otherwise; timed scenes: friction 0.5, restitution 0, density 1"
    );
    let wall = bench::WALL.load(std::sync::atomic::Ordering::Relaxed);
    let clock = if wall { "wall clock" } else { "CPU time of the measuring thread (--wall for the wall clock)" };
    println!("# clock: {clock}");
    println!("{}", report::CSV_HEAD);
    let t0 = Instant::now();
    let opt = Opt { quick, parts };
    for (name, f) in SCENES {
        if scenes.as_ref().map_or(*name != QUALITY, |o| o.iter().any(|x| x == name)) {
            let t = Instant::now();
            f(&mut rep, &chosen, &opt);
            let parts = if *name == QUALITY { opt.parts.as_slice() } else { &[] };
            let scenes: Vec<String> = parts.iter().map(|part| format!("{QUALITY}:{part}")).collect();
            let scenes = if scenes.is_empty() { name.to_string() } else { scenes.join(",") };
            let mut options = vec!["--scene", &scenes];
            options.extend(quick.then_some("--quick"));
            options.extend(wall.then_some("--wall"));
            children.iter().for_each(|child| child.run(&options, &mut rep));
            eprintln!("[{name}: {:.1} s]", t.elapsed().as_secs_f64());
        }
    }
    let mut ids: Vec<&str> = chosen.iter().map(|e| e.id()).collect();
    ids.extend(children.iter().flat_map(|child| &child.engines));
    println!("{}", rep.tables(&ids, table_min));
    println!("total {:.0} s", t0.elapsed().as_secs_f64());
    if let Some(path) = plot
        && let Err(e) = plot::joint_errors(&rep, &ids, path.as_ref())
    {
        eprintln!("{path}: {e}");
        std::process::exit(1);
    }
    if let Some(path) = csv {
        let mut text = String::from(report::CSV_HEAD);
        text.push('\n');
        for r in &rep.rows {
            text.push_str(&format!(
                "{},{},{},{},{:e},{},{:e},{:e},{},{}\n",
                r.engine, r.scene, r.n, r.metric, r.value, r.unit, r.min, r.max, r.samples, r.note
            ));
        }
        if let Err(e) = std::fs::write(&path, text) {
            eprintln!("{path}: {e}");
            std::process::exit(1);
        }
    }
}
