//! Source frames of real recordings against the angles that were extracted from them by others.

use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use undulate::{ArmMotion, BoneMap, Bvh, CsvOptions, Recording, ShoulderOrder, Side};

use crate::common::shared;

/// What is asked of every angle \[rad\]. The tables have five decimals, the roll of the elbow's axis four.
const BAR: f64 = 1e-4;

/// All files `source/*.bvh.gz` below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.to_str().unwrap().ends_with(".bvh.gz") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn unpacked(path: &Path) -> String {
    let mut text = String::new();
    let file = std::fs::File::open(path).unwrap();
    flate2::read::GzDecoder::new(file)
        .read_to_string(&mut text)
        .unwrap();
    text
}

/// Of each table the roll of the whole motion that it was cut from.
fn rolls(index: &Path) -> HashMap<String, f64> {
    let mut reader = csv::Reader::from_path(index).unwrap();
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let (file, roll) = (column("file"), column("hinge_roll_rad"));
    reader
        .records()
        .map(|row| {
            let row = row.unwrap();
            let name = row[file].rsplit('/').next().unwrap().to_owned();
            (name, row[roll].parse().unwrap())
        })
        .collect()
}

/// The largest difference of an angle at any time.
fn difference(motion: &ArmMotion, order: ShoulderOrder, table: &Recording) -> f64 {
    let found = motion.angles("found", order).unwrap().recording;
    assert_eq!(found.joints(), table.joints());
    assert_eq!(found.times().len(), table.times().len(), "{}", table.name());
    (found.positions() - table.positions()).amax()
}

#[test]
fn angles_are_those_that_others_extracted() {
    let Some(folder) = shared("source frames of real recordings") else {
        return;
    };
    let folder = folder.join("waves");
    let rolls = rolls(&folder.join("motions_index.csv"));
    let sources = sources(&folder.join("motions"));
    assert!(sources.len() > 50);
    let (mut worst, mut own_within) = (0.0f64, 0);
    println!(
        "largest difference [rad], xzy and zxy: with the roll of the whole motion; with that of the window alone"
    );
    for source in &sources {
        let name = source
            .file_name()
            .unwrap()
            .to_str()
            .unwrap()
            .replace(".bvh.gz", ".csv");
        let folder = source.parent().unwrap().parent().unwrap();
        let side = if name.contains("_L") {
            Side::Left
        } else {
            Side::Right
        };
        let bvh = Bvh::from_text(&unpacked(source)).unwrap();
        let map = BoneMap::recognise(&bvh).unwrap();
        let own = ArmMotion::from_bvh(&bvh, &map, side).unwrap();
        let given = own.clone().with_hinge_roll(rolls[&name]).unwrap();
        let tables = [
            (ShoulderOrder::Xzy, folder.join(&name)),
            (ShoulderOrder::Zxy, folder.join("alt_zxy").join(&name)),
        ];
        let [given, own] = [given, own].map(|motion| {
            tables.each_ref().map(|(order, path)| {
                let table = Recording::open(path, &CsvOptions::default()).unwrap();
                difference(&motion, *order, &table)
            })
        });
        println!(
            "{name:50} {:.1e} {:.1e}   {:.1e} {:.1e}   {}",
            given[0],
            given[1],
            own[0],
            own[1],
            map.skeleton().unwrap()
        );
        worst = given.into_iter().fold(worst, f64::max);
        own_within += usize::from(own[0].max(own[1]) <= BAR);
    }
    println!(
        "{} sources: at most {worst:.1e} rad; {own_within} within {BAR} rad by their window's own roll",
        sources.len()
    );
    assert!(worst <= BAR, "{worst}");
}
