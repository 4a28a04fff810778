//! `undulate compare`: the library's comparison as words, JSON and a picture.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files, json};
use undulate::{Comparison, ComparisonOptions, ModelKind, Statistic, synthetic};

const QUICK: [&str; 5] = ["compare", "-n", "2", "--folds", "2"];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    QUICK.iter().chain(more).copied().collect()
}

#[test]
fn json_is_the_librarys_comparison_on_any_number_of_threads_but_for_times() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut one = json(at, &with(&["--jobs", "1"]));
    let mut two = json(at, &with(&["--jobs", "2"]));
    for value in [&mut one, &mut two] {
        let seconds = value.as_object_mut().unwrap().remove("seconds").unwrap();
        for kind in ModelKind::ALL {
            assert!(seconds[kind.name()]["learn"].as_f64().unwrap() > 0.0);
        }
    }
    assert_eq!(one, two);
    let options = ComparisonOptions {
        draws: 2,
        folds: Some(2),
        ..ComparisonOptions::default()
    };
    let demonstrations = synthetic(0).unwrap();
    let found = Comparison::new(demonstrations.recordings(), &options, || ()).unwrap();
    for (statistic, estimate) in Statistic::ALL.iter().zip(&found.demonstrated) {
        let told = &one["demonstrated"][statistic.key()];
        assert_eq!(told["value"].as_f64(), Some(estimate.value), "{told}");
    }
    for (told, model) in one["models"].as_array().unwrap().iter().zip(&found.models) {
        assert_eq!(told["model"], model.kind.name());
        let refused = told["given"]["swing"].get("refused").is_some();
        assert_eq!(refused, model.kind != ModelKind::Cycle);
    }
    assert_eq!(one["paired"].as_array().unwrap().len(), found.paired.len());
}

#[test]
fn recordings_of_other_joints_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, joints) in [("a.csv", 3), ("b.csv", 3), ("c.csv", 3), ("d.csv", 2)] {
        let names: Vec<String> = (0..joints).map(|d| format!("j{d}")).collect();
        let mut text = format!("time_s,{}\n", names.join(","));
        for n in 0..400 {
            let t = 0.01 * f64::from(n);
            let row: Vec<String> = (0..joints)
                .map(|d| {
                    ((10.0 + f64::from(name.as_bytes()[0] % 5)) * t + f64::from(d))
                        .sin()
                        .to_string()
                })
                .collect();
            text.push_str(&format!("{t},{}\n", row.join(",")));
        }
        std::fs::write(at.join(name), text).unwrap();
    }
    let words = fails(at, 1, &["compare", ".", "-n", "3"]);
    assert!(words.contains("joints j0, j1, expected"), "{words}");
}

#[test]
fn words_name_every_model_and_figures_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words = done(at, &with(&["-o", "compare.svg"]));
    for kind in ModelKind::ALL {
        assert!(words.contains(kind.name()), "{words}");
    }
    assert!(
        words.contains("cannot") && words.contains("wrote compare.svg"),
        "{words}"
    );
    done(at, &with(&["-o", "compare.png"]));
    assert_eq!(files(at), ["compare.png", "compare.svg"]);
    let svg = std::fs::read_to_string(at.join("compare.svg")).unwrap();
    for kind in ModelKind::ALL {
        assert!(svg.contains(&format!(">\n{}\n</text>", kind.short_name())));
    }
}

#[test]
fn what_cannot_be_asked_for_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    assert!(fails(at, 2, &["compare", "--folds", "1"]).contains("1 folds"));
    assert!(fails(at, 2, &["compare", "-n", "1"]).contains("1 draws"));
    assert!(fails(at, 2, &["compare", "--confidence", "1"]).contains("confidence of 1"));
    assert!(fails(at, 2, &["compare", "-o", "compare.pdf"]).contains(".svg or .png"));
    assert!(fails(at, 2, &["compare", "--jobs", "0"]).contains("0 jobs"));
}
