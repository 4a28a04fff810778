//! Models side by side.

mod common;

use undulate::{
    Comparison, ComparisonOptions, CsvOptions, ModelKind, Recording, Statistic, synthetic,
};

#[test]
fn shared_sets() {
    let mut sources = vec![(
        "demonstrator".to_owned(),
        synthetic(0).unwrap().recordings().to_vec(),
    )];
    if let Some(shared) = common::shared("real sets of waves") {
        let mut files: Vec<_> = std::fs::read_dir(shared.join("waves/sets"))
            .unwrap()
            .map(|e| e.unwrap().path())
            .collect();
        files.sort();
        let wanted = std::env::var("SETS").unwrap_or("ABDE".into());
        for file in files {
            let name = file.file_stem().unwrap().to_str().unwrap().to_owned();
            if !wanted.contains(&name[..1]) {
                continue;
            }
            let root = shared.join("waves");
            let files = Recording::files_listed(&file, Some(&root)).unwrap();
            let open = |f: &std::path::PathBuf| Recording::open(f, &CsvOptions::default()).unwrap();
            sources.push((name, files.iter().map(open).collect()));
        }
    }
    for (name, recordings) in sources {
        let t = std::time::Instant::now();
        let options = ComparisonOptions {
            threads: 2,
            draws: 60,
            ..Default::default()
        };
        let c = match Comparison::new(&recordings, &options, || ()) {
            Ok(c) => c,
            Err(e) => {
                println!("{name}: {e}");
                continue;
            }
        };
        println!(
            "== {name}: {} demos, {} unusable, dominant {}, {:.1} s",
            c.demonstrations.len(),
            c.unusable.len(),
            c.dominant,
            t.elapsed().as_secs_f64()
        );
        for (i, s) in Statistic::ALL.iter().enumerate() {
            let e = c.demonstrated[i];
            print!(
                "{:20} {:.3} [{:.3} {:.3}]",
                s.key(),
                e.value,
                e.lower,
                e.upper
            );
            for m in &c.models {
                let e = m.statistics[i];
                print!(" | {:.3} [{:.3} {:.3}]", e.value, e.lower, e.upper);
            }
            println!();
        }
        for i in 0..3 {
            print!("distance {i}            ");
            for m in &c.models {
                let e = m.distances[i];
                print!(" | {:.3} [{:.3} {:.3}]", e.value, e.lower, e.upper);
            }
            println!();
        }
        for m in &c.models {
            println!(
                "{} learn {:.4} condition {:?} draw {:.2e}",
                m.kind.name(),
                m.seconds.learn,
                m.seconds.condition,
                m.seconds.draw
            );
            for g in &m.given {
                match g {
                    Ok(g) => println!(
                        "   swing off {:.3} frequency off {:.3} distances {:.3} {:.3} {:.3}",
                        g.swing_off.value,
                        g.frequency_off.value,
                        g.distances[0].value,
                        g.distances[1].value,
                        g.distances[2].value
                    ),
                    Err(e) => println!("   {e}"),
                }
            }
        }
        for p in &c.paired {
            println!(
                "{:?} {} over {}: {:.3} [{:.3} {:.3}]",
                p.distance,
                p.ours.name(),
                p.baseline.name(),
                p.difference.value,
                p.difference.lower,
                p.difference.upper
            );
        }
    }
    let _ = ModelKind::ALL;
}
