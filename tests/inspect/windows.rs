//! Whole motions and windows of real recordings, and where the index says that the waves are.

use std::path::{Path, PathBuf};

use undulate::{CsvOptions, Recording, RhythmicPart};

use crate::{common, overlap};

/// A row of the index: a window of a source.
struct Indexed {
    file: String,
    start: f64,
    end: f64,
    frequency: f64,
}

/// A wave as slow as this has half cycles near 0.6 s \[Hz\]; the index has no longer ones, and ends its windows there though the wave goes on.
const SLOW: f64 = 1.1;

fn index(shared: &Path) -> Vec<Indexed> {
    let text = std::fs::read_to_string(shared.join("waves/motions_index.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let [file, start, duration, frequency] =
        ["file", "t_start_s", "duration_s", "f0_hz"].map(column);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            Indexed {
                file: cells[file].into(),
                start: number(start),
                end: number(start) + number(duration),
                frequency: number(frequency),
            }
        })
        .collect()
}

/// Files of whole motions, named as their windows are but for the end.
fn uncut(shared: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![shared.join("waves/motions")];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.to_str().unwrap().ends_with(FULL) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

const FULL: &str = "_full.csv";

fn opened(path: &Path) -> Recording {
    Recording::open(path, &CsvOptions::default()).unwrap()
}

/// Thresholds were chosen on those of the windows whose names have an even sum of bytes; both arms of a take go together.
fn is_chosen_on(name: &str) -> bool {
    let take = name.replace("_L_", "_").replace("_R_", "_");
    take.bytes().map(u64::from).sum::<u64>() % 2 == 0
}

#[test]
fn parts_of_whole_motions_are_the_windows_that_people_chose() {
    let Some(shared) = common::shared("real uncut recordings") else {
        return;
    };
    let index = index(&shared);
    let mut counts = [[0; 2]; 2];
    let mut by_tempo = [[0; 2]; 2];
    let mut covered = 0;
    for file in uncut(&shared) {
        let name = file.file_name().unwrap().to_str().unwrap();
        let stem = name.trim_end_matches(FULL);
        let parts = opened(&file).rhythmic_parts();
        let found: Vec<String> = parts
            .iter()
            .map(|p| format!("{:.2}..{:.2}", p.start, p.end))
            .collect();
        let own = index.iter().filter(|row| {
            let file = row.file.rsplit('/').next().unwrap();
            file.starts_with(stem)
        });
        let mut windows = 0;
        for row in own {
            let best = parts
                .iter()
                .map(|p| overlap(p, row.start, row.end))
                .fold(0.0, f64::max);
            for [all, good] in [
                &mut counts[usize::from(is_chosen_on(name))],
                &mut by_tempo[usize::from(row.frequency > SLOW)],
            ] {
                *all += 1;
                *good += usize::from(best >= 0.8);
            }
            windows += 1;
            let within = |p: &RhythmicPart| p.end.min(row.end) - p.start.max(row.start);
            let most = parts.iter().map(within).fold(0.0, f64::max);
            covered += usize::from(most >= 0.9 * (row.end - row.start));
            println!(
                "{best:.2} {stem}: {:.2}..{:.2}, found {found:?}",
                row.start, row.end
            );
        }
        if windows == 0 {
            println!("no window in {stem}, found {found:?}");
        }
    }
    let [[others, good_others], [chosen, good_chosen]] = counts;
    let (good, all) = (good_chosen + good_others, chosen + others);
    println!("IoU of 0.8: {good_chosen} of {chosen} chosen on, {good_others} of {others} others");
    let [[slow, good_slow], [fast, good_fast]] = by_tempo;
    println!("above {SLOW} Hz: {good_fast} of {fast}, below: {good_slow} of {slow}");
    println!("nine tenths of the window are in the part: {covered} of {all}");
    assert!(10 * good_fast >= 9 * fast && 10 * covered >= 9 * all);
    // Slow waves go on where the window ends; see `src/DESIGN.md`.
    assert!(4 * good >= 3 * all);
}

#[test]
fn windows_are_whole_and_stay_as_they_are() {
    let Some(shared) = common::shared("windows of real recordings") else {
        return;
    };
    let (mut all, mut whole, mut none, mut cut) = (0, 0, Vec::new(), Vec::new());
    for row in index(&shared) {
        let folder = Path::new(&row.file).parent().unwrap();
        let name = Path::new(&row.file).file_name().unwrap();
        for file in [PathBuf::from(&row.file), folder.join("alt_zxy").join(name)] {
            let path = shared.join("waves").join(&file);
            if !path.is_file() {
                continue;
            }
            let recording = opened(&path);
            let parts = recording.rhythmic_parts();
            let longest = parts.iter().map(RhythmicPart::duration).fold(0.0, f64::max);
            all += 1;
            whole += usize::from(longest >= 0.8 * recording.span());
            if parts.is_empty() {
                none.push(file.clone());
            }
            if recording.gestures() != std::slice::from_ref(&recording) {
                cut.push(file);
            }
        }
    }
    println!("{whole} of {all} windows are whole; without a rhythm: {none:?}; cut: {cut:?}");
    // Two are one exercise in both orders, as irregular as noise is.
    assert!(none.len() <= 2 && whole + none.len() == all && cut.is_empty());
}
