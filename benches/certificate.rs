//! A wave proven clear, beside plain parry on samples of it, in the same run. With `UNDULATE_SHARED` set, on the UR5 there, with the hulls of its
//! collision meshes and the pairs that its SRDF leaves; else on the shipped arm.

use std::hint::black_box;
use std::path::PathBuf;

use criterion::{Criterion, criterion_group, criterion_main};
use rand::Rng;
use undulate::{
    Certification, CollisionModel, CollisionOptions, LoadOptions, MeshFiles, Robot, Srdf, Wave,
    shipped, stream,
};

#[path = "../tests/common/dense.rs"]
mod dense;
#[path = "../tests/common/waves.rs"]
mod waves;

/// Waves of a period as people's, with as many harmonics.
const HARMONICS: usize = 26;
const PERIOD: f64 = 6.7;

fn robot() -> (Robot, CollisionOptions) {
    match std::env::var_os("UNDULATE_SHARED") {
        Some(folder) => {
            let folder = PathBuf::from(folder).join("robots/ur5");
            let options = LoadOptions {
                meshes: MeshFiles::Folders(vec![folder.clone()]),
                ..LoadOptions::default()
            };
            let robot = Robot::open_with(&folder.join("ur5_robot.urdf"), options).unwrap();
            let srdf = Srdf::open(&folder.join("ur5.srdf")).unwrap();
            // The flange's box, of which the SRDF knows nothing.
            let flange = robot
                .links()
                .iter()
                .map(|l| (l.name.clone(), "ee_link".to_owned()));
            let options = CollisionOptions {
                disabled: srdf.disabled().to_vec(),
                left_out: flange.collect(),
                ..CollisionOptions::default()
            };
            (robot, options)
        }
        None => (
            shipped::robot("wave_arm").unwrap(),
            CollisionOptions::default(),
        ),
    }
}

/// Waves that come as near to touching as 2 to 4 cm.
fn near(robot: &Robot, model: &CollisionModel, count: usize) -> Vec<Wave> {
    let mut prover = model.prover();
    let mut found = Vec::new();
    for number in 0.. {
        let wave = waves::random_wave(robot, HARMONICS, PERIOD, 0.6, &mut stream(3, number));
        if prover.certify(&wave, 0.02, &[]).unwrap().is_clear()
            && prover.minimum_clearance(&wave, 1e-4).unwrap().lower < 0.04
        {
            found.push(wave);
        }
        if found.len() == count {
            break;
        }
    }
    found
}

fn certificate(c: &mut Criterion) {
    let (robot, options) = robot();
    let model = CollisionModel::new(&robot, &options).unwrap();
    let waves = near(&robot, &model, 20);
    let mut prover = model.prover();
    println!(
        "{}: {} pairs checked",
        robot.name(),
        model.pairs().iter().filter(|p| p.is_checked()).count()
    );
    let mut intervals: Vec<_> = waves
        .iter()
        .map(|wave| match prover.certify(wave, 0.0, &[]).unwrap() {
            Certification::Clear { work, .. } => (work.intervals, work.distances),
            other => panic!("{other:?}"),
        })
        .collect();
    intervals.sort_unstable();
    println!("intervals and distances of the waves: {intervals:?}");
    let mut next = (0..waves.len()).cycle();
    c.bench_function("certificate", |b| {
        b.iter(|| {
            prover
                .certify(black_box(&waves[next.next().unwrap()]), 0.0, &[])
                .unwrap()
                .is_clear()
        })
    });
    let mut next = (0..waves.len()).cycle();
    c.bench_function("minimum clearance to 0.1 mm", |b| {
        b.iter(|| {
            prover
                .minimum_clearance(black_box(&waves[next.next().unwrap()]), 1e-4)
                .unwrap()
                .lower
        })
    });
    // Along a wave, as a controller would ask.
    let path: Vec<Vec<f64>> = (0..3350)
        .map(|n| waves[0].position(0.002 * f64::from(n)).as_slice().to_vec())
        .collect();
    let mut checker = model.checker();
    let mut next = (0..path.len()).cycle();
    c.bench_function("contact at a configuration", |b| {
        b.iter(|| {
            checker
                .collision(black_box(&path[next.next().unwrap()]))
                .is_some()
        })
    });
    let mut next = (0..path.len()).cycle();
    c.bench_function("clearance at a configuration", |b| {
        b.iter(|| {
            checker
                .clearance(black_box(&path[next.next().unwrap()]))
                .unwrap()
                .distance
        })
    });
    let dense = dense::Dense::new(&robot, &model);
    let mut next = (0..path.len()).cycle();
    c.bench_function("plain parry: clearance at a configuration", |b| {
        b.iter(|| {
            dense.at(
                &robot,
                black_box(&path[next.next().unwrap()]),
                f64::INFINITY,
            )
        })
    });
    let mut rng = stream(1, 0);
    c.bench_function("plain parry: clearance of a wave at 500 Hz", |b| {
        b.iter(|| dense.clearance(&robot, &waves[(rng.next_u64() % 20) as usize], 500.0, 0.0))
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50);
    targets = certificate
}
criterion_main!(benches);
