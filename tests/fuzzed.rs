//! All seeds of the fuzzer, and every input that ever broke something, on any toolchain; each also cut short, and with bytes changed. To
//! go on from them: `cargo +nightly fuzz run urdf fuzz/corpus/urdf fuzz/seeds/urdf`.

#[path = "../fuzz/src/lib.rs"]
mod fuzz;

use std::path::{Path, PathBuf};

use undulate::rand::RngExt;
use undulate::stream;

/// Of each seed, so many others are made.
const OTHERS: u64 = 40;

fn files(kind: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let Ok(entries) = std::fs::read_dir(folder.join(kind).join(target)) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    files.sort();
    files
}

/// Cut short, or with a few bytes changed: digits, signs and brackets mostly, which texts are made of.
fn changed(data: &[u8], number: u64) -> Vec<u8> {
    const BYTES: &[u8] = b"0123456789-+.eE,:;<>/\"'{}[]() \n#naif\x00\xff";
    let mut random = stream(11, number);
    let mut data = data.to_vec();
    if number.is_multiple_of(4) {
        data.truncate(random.random_range(0..=data.len()));
    }
    for _ in 0..random.random_range(1..8) {
        if !data.is_empty() {
            let at = random.random_range(0..data.len());
            data[at] = BYTES[random.random_range(0..BYTES.len())];
        }
    }
    data
}

#[test]
fn no_seed_and_nothing_near_it_breaks_anything() {
    for (name, target) in fuzz::TARGETS {
        let seeds = files("seeds", name);
        assert!(!seeds.is_empty(), "{name} has no seeds");
        for seed in seeds {
            println!("{}", seed.display());
            let data = std::fs::read(&seed).unwrap();
            target(&data);
            (0..OTHERS).for_each(|number| target(&changed(&data, number)));
        }
    }
}

#[test]
fn what_broke_something_once_does_no_more() {
    for (name, _) in fuzz::TARGETS {
        for file in files("regressions", name) {
            println!("{}", file.display());
            fuzz::run(name, &std::fs::read(file).unwrap());
        }
    }
}
