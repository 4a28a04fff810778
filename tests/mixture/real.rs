//! Kinds of real recordings.

use std::path::Path;

use undulate::{
    CsvOptions, CycleFits, Demonstrations, Duration, Example, Grouping, GroupingOptions, Kinds,
    LearnOptions, Recording,
};

use crate::common;

fn recordings(root: &Path, sets: &[&str]) -> Vec<(String, Recording)> {
    let mut found = Vec::new();
    for set in sets {
        let lists = std::fs::read_dir(root.join("sets")).unwrap();
        let list = lists.map(|e| e.unwrap().path()).find(|p| {
            p.file_name().unwrap().to_string_lossy().starts_with(set)
        });
        let files = Recording::files_listed(&list.unwrap(), Some(root)).unwrap();
        for file in files {
            let recording = Recording::open(&file, &CsvOptions::default()).unwrap();
            found.push(((*set).to_owned(), recording));
        }
    }
    found
}

#[test]
fn scratch() {
    let Some(shared) = common::shared("kinds of real recordings") else {
        return;
    };
    let root = shared.join("waves");
    for sets in [vec!["A", "D"], vec!["A", "D", "B"], vec!["A", "D", "B", "C"], vec!["A"], vec!["B"]] {
        let labelled = recordings(&root, &sets);
        let all: Vec<Recording> = labelled.iter().map(|(_, r)| r.clone()).collect();
        let fits = CycleFits::new(&all, 4).unwrap();
        let label = |name: &str| &labelled.iter().find(|(_, r)| r.name() == name).unwrap().0;
        let examples: Vec<Example> = fits.fits().iter().map(Example::from).collect();
        let options = LearnOptions::default();
        let form = options.form_of_cycles(&fits, 10).unwrap();
        let start = std::time::Instant::now();
        let grouping = Grouping::find(&examples, &form, &GroupingOptions::default()).unwrap();
        println!("{sets:?} cycles: {:?}", start.elapsed());
        for h in grouping.held_out() { println!("  {h:?}"); }
        for (m, fit) in fits.fits().iter().enumerate() {
            print!(" {}{}", label(&fit.name), grouping.names()[grouping.kind(m)]);
        }
        println!("\n {:?}", grouping.log_likelihoods());
        let demonstrations = Demonstrations::new(all, Duration::Auto).unwrap();
        println!("T {}", demonstrations.period());
        let samples = demonstrations.recordings().iter().map(|r| r.times().len());
        let harmonics = samples.min().unwrap().saturating_sub(2) / 2;
        let waves = demonstrations.fit(harmonics.min(25)).unwrap();
        let examples = options.examples(&waves).unwrap();
        let form = options.form(&examples).unwrap();
        let start = std::time::Instant::now();
        let few = GroupingOptions { kinds: Kinds::UpTo(4), ..GroupingOptions::default() };
        let grouping = Grouping::find(&examples, &form, &few).unwrap();
        println!("{sets:?} common: {:?}", start.elapsed());
        for h in grouping.held_out() { println!("  {h:?}"); }
        for (m, r) in demonstrations.recordings().iter().enumerate() {
            print!(" {}{}", label(r.name()), grouping.names()[grouping.kind(m)]);
        }
        println!("\n {:?}", grouping.log_likelihoods());
    }
}
