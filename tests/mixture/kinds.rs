//! Kinds that are there are found: of the synthetic demonstrator, and of real recordings.

use std::path::Path;

use undulate::{
    CsvOptions, CycleFits, Example, Grouping, GroupingOptions, Kinds, LearnOptions, Recording,
    synthetic,
};

use crate::common;

/// Fits of cycles with a label each.
fn cycles(recordings: &[(usize, Recording)]) -> (CycleFits, Vec<usize>) {
    let all: Vec<Recording> = recordings.iter().map(|(_, r)| r.clone()).collect();
    let fits = CycleFits::new(&all, 4).unwrap();
    let label = |name: &str| recordings.iter().find(|(_, r)| r.name() == name).unwrap().0;
    let labels = fits.fits().iter().map(|fit| label(&fit.name)).collect();
    (fits, labels)
}

fn find(fits: &CycleFits, kinds: Kinds) -> Grouping {
    let examples: Vec<Example> = fits.fits().iter().map(Example::from).collect();
    let form = LearnOptions::default().form_of_cycles(fits, 10).unwrap();
    let options = GroupingOptions {
        kinds,
        ..GroupingOptions::default()
    };
    Grouping::find(&examples, &form, &options).unwrap()
}

/// Whether two demonstrations are of one kind where they have one label, and only there.
fn agrees(grouping: &Grouping, labels: &[usize]) -> bool {
    let pairs = (0..labels.len()).flat_map(|m| (0..m).map(move |j| (m, j)));
    let mut pairs =
        pairs.map(|(m, j)| (grouping.kind(m) == grouping.kind(j)) == (labels[m] == labels[j]));
    pairs.all(|same| same)
}

/// The slowest five and the fastest five of so many demonstrators.
fn slow_and_fast(demonstrators: u64) -> Vec<(usize, Recording)> {
    let mut recordings = Vec::new();
    for seed in 0..demonstrators {
        for (m, recording) in synthetic(seed).unwrap().recordings().iter().enumerate() {
            let label = match m {
                0..5 => 0,
                10.. => 1,
                _ => continue,
            };
            let name = format!("{seed} {m}");
            let (times, positions) = (recording.times().to_vec(), recording.positions().clone());
            let joints = recording.joints().clone();
            let renamed = Recording::new(name, joints, times, positions).unwrap();
            recordings.push((label, renamed));
        }
    }
    recordings
}

#[test]
fn slow_and_fast_waves_are_told_apart() {
    let (fits, labels) = cycles(&slow_and_fast(2));
    assert_eq!(labels.len(), 20);
    let two = find(&fits, Kinds::Number(2));
    assert!(agrees(&two, &labels), "{}", two.responsibilities());
    // That there are two takes more to see: slow and fast are ends of one direction, which one kind has as well.
    let (fits, labels) = cycles(&slow_and_fast(5));
    let found = find(&fits, Kinds::UpTo(3));
    println!("{:?}", found.held_out());
    assert!(agrees(&found, &labels), "{}", found.responsibilities());
    assert_eq!(found.names(), ["a", "b"]);
    // The same again is the same.
    assert_eq!(found, find(&fits, Kinds::UpTo(3)));
}

#[test]
fn one_kind_is_not_taken_apart() {
    let slow: Vec<_> = slow_and_fast(2)
        .into_iter()
        .filter(|(label, _)| *label == 0)
        .collect();
    let (fits, _) = cycles(&slow);
    let found = find(&fits, Kinds::UpTo(3));
    println!("{:?}", found.held_out());
    assert_eq!(found.names(), ["a"]);
}

fn set(root: &Path, label: usize, name: &str) -> Vec<(usize, Recording)> {
    let lists = std::fs::read_dir(root.join("sets")).unwrap();
    let mut lists = lists.map(|entry| entry.unwrap().path());
    let starts = |path: &Path| {
        path.file_name()
            .unwrap()
            .to_string_lossy()
            .starts_with(name)
    };
    let list = lists.find(|path| starts(path)).unwrap();
    let files = Recording::files_listed(&list, Some(root)).unwrap();
    let open = |file: &std::path::PathBuf| Recording::open(file, &CsvOptions::default()).unwrap();
    files.iter().map(|file| (label, open(file))).collect()
}

/// Which kinds there are in sets of real recordings is nobody's secret, but not asserted beyond this: a set of one style stays whole, and waves of another
/// style and shoulder order are kept apart.
#[test]
fn real_sets_are_not_mixed_up() {
    let Some(shared) = common::shared("kinds of real recordings") else {
        return;
    };
    let root = shared.join("waves");
    for name in ["A", "B"] {
        let (fits, _) = cycles(&set(&root, 0, name));
        let found = find(&fits, Kinds::UpTo(5));
        assert_eq!(found.names(), ["a"], "set {name}");
    }
    let both = [set(&root, 0, "A"), set(&root, 1, "B")].concat();
    let (fits, labels) = cycles(&both);
    let found = find(&fits, Kinds::UpTo(5));
    println!("{:?}", found.held_out());
    assert!(agrees(&found, &labels), "{}", found.responsibilities());
}

#[test]
fn kinds_do_not_depend_on_the_order_of_recordings() {
    let forward = slow_and_fast(2);
    let backward: Vec<_> = forward.iter().rev().cloned().collect();
    for kinds in [Kinds::Number(3), Kinds::UpTo(2)] {
        let (fits, _) = cycles(&forward);
        let first = find(&fits, kinds);
        let (turned, _) = cycles(&backward);
        let second = find(&turned, kinds);
        // The kind by the other order, as a label.
        let labels: Vec<usize> = fits
            .fits()
            .iter()
            .map(|fit| {
                turned
                    .fits()
                    .iter()
                    .position(|t| t.name == fit.name)
                    .unwrap()
            })
            .map(|m| second.kind(m))
            .collect();
        assert!(agrees(&first, &labels), "{labels:?}");
    }
}
