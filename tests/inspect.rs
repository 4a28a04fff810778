//! Uncut recordings: the rhythmic part is found, and where there is none it is said.

mod common;

use std::path::Path;

use undulate::{CsvOptions, Recording};

/// A row of the index: a window of a source.
struct Indexed {
    file: String,
    source: String,
    arm: String,
    start: f64,
    end: f64,
    cycles: f64,
}

fn index(shared: &Path) -> Vec<Indexed> {
    let text = std::fs::read_to_string(shared.join("waves/motions_index.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let [file, source, arm, start, duration, cycles] =
        ["file", "source", "arm", "t_start_s", "duration_s", "cycles"].map(column);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            Indexed {
                file: cells[file].into(),
                source: cells[source].into(),
                arm: cells[arm].into(),
                start: number(start),
                end: number(start) + number(duration),
                cycles: number(cycles),
            }
        })
        .collect()
}

fn uncut(shared: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![shared.join("waves/motions")];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.to_str().unwrap().ends_with("_full.csv") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn probe() {
    let Some(shared) = common::shared("real uncut recordings") else {
        return;
    };
    let index = index(&shared);
    for file in uncut(&shared) {
        let name = file.file_name().unwrap().to_str().unwrap();
        let stem = name.trim_end_matches("_full.csv");
        let own: Vec<&Indexed> = index
            .iter()
            .filter(|row| row.file.rsplit('/').next().unwrap().starts_with(stem))
            .collect();
        let recording = Recording::open(&file, &CsvOptions::default()).unwrap();
        let parts = recording.rhythmic_parts();
        println!(
            "{name}  {:.2}..{:.2}",
            recording.times()[0],
            recording.times().last().unwrap()
        );
        for row in &own {
            let iou = parts
                .iter()
                .map(|p| {
                    let both = (p.end.min(row.end) - p.start.max(row.start)).max(0.0);
                    let any = p.end.max(row.end) - p.start.min(row.start);
                    both / any
                })
                .fold(0.0, f64::max);
            println!(
                "   index {:.2}..{:.2} {} cycles  IoU {iou:.2} {}",
                row.start,
                row.end,
                row.cycles,
                if iou < 0.8 { "LOW" } else { "" }
            );
        }
        for p in &parts {
            println!(
                "   found {:.2}..{:.2} {} cycles {:.2} Hz size {:.2}",
                p.start, p.end, p.cycles, p.frequency, p.size
            );
        }
    }
}

#[test]
fn windows() {
    let Some(shared) = common::shared("real uncut recordings") else {
        return;
    };
    let (mut whole, mut none, mut all) = (0, 0, 0);
    for row in index(&shared) {
        let recording = Recording::open(
            &shared.join("waves").join(&row.file),
            &CsvOptions::default(),
        )
        .unwrap();
        let parts = recording.rhythmic_parts();
        let best = parts.iter().map(|p| p.duration()).fold(0.0, f64::max) / recording.span();
        all += 1;
        if best >= 0.8 {
            whole += 1
        }
        if parts.is_empty() {
            none += 1;
        }
        if best < 0.8 {
            println!(
                "WIN {best:.2} {} {:.2} s, {} cycles: {:.2?}",
                row.file.rsplit('/').next().unwrap(),
                recording.span(),
                row.cycles,
                parts
                    .iter()
                    .map(|p| (p.start, p.end, p.cycles))
                    .collect::<Vec<_>>()
            );
        }
    }
    println!("WIN {whole} of {all} whole, {none} none");
}
