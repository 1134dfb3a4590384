//! Memory a body, each engine in a process of its own.

use super::{Engines, Opt, heap_bytes};
use crate::engine::Engine;
use crate::report::Report;
use crate::scene::{self, Scene};

fn rss() -> (usize, usize) {
    let st = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let get = |k: &str| {
        st.lines()
            .find_map(|l| l.strip_prefix(k))
            .and_then(|l| l.split_whitespace().next()?.parse::<usize>().ok())
            .unwrap_or(0)
            * 1024
    };
    (get("VmRSS:"), get("VmHWM:"))
}

fn mem_scene(name: &str, n: usize) -> Scene {
    match name {
        "free" => scene::free(n),
        "free_far" => scene::free_far(n),
        _ => scene::rain(n),
    }
}

/// Run in a child process of its own, so that the peak is this engine's.
pub fn mem_child(e: &dyn Engine, name: &str, n: usize) {
    let s = mem_scene(name, n);
    let (r0, _) = rss();
    let h0 = heap_bytes();
    let mut w = e.build(&s);
    let steps = if n > 50_000 { 2 } else { 10 };
    let h_build = heap_bytes() - h0;
    for _ in 0..steps {
        w.step();
    }
    let h1 = heap_bytes() - h0;
    let (r1, peak) = rss();
    println!("{} {} {} {} {}", h_build, h1, r1 - r0, peak - r0, steps);
}

pub fn memory(rep: &mut Report, engines: Engines, _opt: &Opt) {
    let exe = std::env::current_exe().expect("own path");
    for (name, n) in [("free", 100_000usize), ("free_far", 10_000), ("rain", 1_000)] {
        let scene = mem_scene(name, n);
        for e in engines {
            if let Some(why) = e.refuse(&scene) {
                rep.skip(e.id(), &format!("mem_{name}"), n, &why);
                continue;
            }
            let out = std::process::Command::new(&exe).args(["--mem-child", e.id(), name, &n.to_string()]).output();
            let Ok(out) = out else { continue };
            let text = String::from_utf8_lossy(&out.stdout);
            let v: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
            if v.len() != 5 {
                rep.skip(
                    e.id(),
                    "memory",
                    n,
                    &format!("child failed: {}", String::from_utf8_lossy(&out.stderr).trim()),
                );
                continue;
            }
            let note = format!("after {} steps", v[4]);
            let sc = format!("mem_{name}");
            rep.one(e.id(), &sc, n, "heap_built", "B/body", v[0] / n as f64, "after build");
            rep.one(e.id(), &sc, n, "heap_stepped", "B/body", v[1] / n as f64, note.clone());
            rep.one(e.id(), &sc, n, "peak_rss", "B/body", v[3] / n as f64, note);
        }
    }
    for e in engines {
        if let Some(b) = e.info().body_struct_bytes {
            rep.one(e.id(), "mem_struct", 1, "size_of_body", "B", b as f64, "the public body struct alone");
        }
    }
}
