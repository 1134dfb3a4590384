//! What reading takes, of files that are made to take as much as they can.

use allocation_counter::measure;
use umbra_physics::{
    BodyDef, Command, Dump, Field, Fx, Input, Inputs, Integrator, Law, Mass, Part, RecordOptions, Recorder, Region,
    Replay, Shape, Snapshot, Vec2, World, WorldDef, fx, vec2,
};

use crate::everything::laws;

fn worst(name: &str, file: &[u8], read: impl FnOnce()) {
    let taken = measure(read).bytes_max;
    println!("{name:<28} {:>9} bytes, {taken:>10} taken, {:>6.2} times", file.len(), taken as f64 / file.len() as f64);
}

fn world() -> World {
    World::new(WorldDef::default()).expect("a world")
}

fn snapshot(name: &str, world: &World) {
    let bytes = world.snapshot().to_bytes();
    worst(name, &bytes, || {
        Snapshot::from_bytes(&bytes, &laws()).expect("a snapshot");
    });
}

fn parts(count: i32) -> Vec<Part> {
    let disc = Shape::circle(fx!(0.5)).expect("a shape");
    (0..count).map(|x| Part { shape: disc.clone(), position: vec2(x, 0), angle: fx!(0), density: fx!(1) }).collect()
}

fn replay(name: &str, file: Vec<u8>) {
    worst(name, &file, || {
        Replay::from_bytes(&file, &laws()).expect("a replay");
    });
    worst(&format!("{name}, verified"), &file, || {
        Replay::from_bytes(&file, &laws()).expect("a replay").verify().expect("it goes as recorded");
    });
}

#[test]
fn look() {
    snapshot("nothing", &world());
    let mut emptied = world();
    let ids: Vec<_> = (0..100_000).map(|_| emptied.add_body(BodyDef::dynamic()).unwrap()).collect();
    let mut fields = world();
    let zone = Field { law: Law::Drag { linear: fx!(1), quadratic: fx!(0), wind: vec2(0, 0) }, groups: 1 };
    let fids: Vec<_> = (0..100_000).map(|_| fields.add_field(zone).unwrap()).collect();
    snapshot("bodies alike", &emptied);
    snapshot("fields", &fields);
    for id in ids {
        emptied.remove_body(id).unwrap();
    }
    for id in fids {
        fields.remove_field(id).unwrap();
    }
    snapshot("empty slots", &emptied);
    snapshot("empty field slots", &fields);
    let mut custom = world();
    custom.register_law(laws().remove(0)).unwrap();
    for _ in 0..100_000 {
        custom.add_field(Law::Custom { id: 9 }).unwrap();
    }
    snapshot("custom fields", &custom);
    for integrator in [Integrator::VelocityVerlet, Integrator::PublishedVerlet] {
        let mut tuned = World::new(WorldDef { integrator, ..WorldDef::default() }).unwrap();
        for i in 0..20_000 {
            tuned.add_body(BodyDef { gravity_scale: Fx::from_bits(i), ..BodyDef::dynamic() }).unwrap();
        }
        snapshot("tunings", &tuned);
        for i in 0..20_000 {
            tuned
                .add_body(BodyDef {
                    gravity_scale: Fx::from_bits(i),
                    shape: Some(Shape::circle(fx!(0.5) + Fx::from_bits(i)).unwrap()),
                    ..BodyDef::dynamic()
                })
                .unwrap();
        }
        snapshot("tunings and shapes", &tuned);
    }
    let mut compounds = world();
    for i in 0..1_000 {
        let mut parts = parts(100);
        parts[0].angle = Fx::from_bits(i);
        compounds.add_body(BodyDef { shape: Some(Shape::compound(&parts).unwrap()), ..BodyDef::dynamic() }).unwrap();
    }
    snapshot("compounds", &compounds);
    let mut blob = world();
    blob.set_blob(&vec![1; 1 << 24]).unwrap();
    snapshot("blob", &blob);
    let compound =
        Command::AddBody(BodyDef { shape: Some(Shape::compound(&parts(256)).unwrap()), ..BodyDef::dynamic() })
            .to_bytes();
    worst("command, compound", &compound, || {
        Command::<Fx>::from_bytes(&compound).unwrap();
    });

    let options = RecordOptions { hash_every: 1_000_000, snapshot_every: 0 };
    let mut w = world();
    let mut r = Recorder::new(&w, options);
    for _ in 0..500_000 {
        r.execute(&mut w, &Command::ClearForces).unwrap();
    }
    r.step(&mut w, &Inputs::new());
    replay("shortest calls", r.finish(&w));
    let mut w = world();
    let mut r = Recorder::new(&w, options);
    let mut inputs = Inputs::new();
    for player in 0..100_000 {
        inputs.insert(Input { player, sequence: 0, command: Command::ClearForces }).unwrap();
    }
    r.step(&mut w, &inputs);
    replay("shortest inputs", r.finish(&w));
    let mut w = world();
    let mut r = Recorder::new(&w, options);
    for _ in 0..100_000 {
        r.step(&mut w, &Inputs::new());
    }
    replay("shortest ticks", r.finish(&w));
    let mut w = world();
    let mut r = Recorder::new(&w, RecordOptions { hash_every: 1_000_000, snapshot_every: 1 });
    for _ in 0..5_000 {
        r.step(&mut w, &Inputs::new());
    }
    replay("snapshots of nothing", r.finish(&w));
    let mut w = world();
    for i in 0..1_000 {
        w.add_body(BodyDef { position: vec2(i, 0), ..BodyDef::dynamic() }).unwrap();
    }
    let after = {
        let mut a = w.clone();
        a.step();
        a
    };
    let dump = Dump::of_tick(&w, &[], &Inputs::new(), &after).to_bytes();
    worst("dump", &dump, || {
        Dump::from_bytes(&dump, &[]).unwrap();
    });
    let _ = (Region::Disc { centre: Vec2::ZERO, radius: Fx::ONE }, Mass::Of(Fx::ONE));
}
