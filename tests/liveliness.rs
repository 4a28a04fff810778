//! Waves drawn with learned jitter vary as the demonstrations do, by the same measure.

mod common;

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use rand_distr::StandardNormal;
use undulate::{CsvOptions, CycleFit, CycleFits, CycleRing, Recording, Variation, Wave, synthetic};

/// Cycles of a drawn wave.
const CYCLES: usize = 10;
const HARMONICS: usize = 4;
/// Draws from each demonstration.
const DRAWS: u64 = 8;
/// Medians agree to this.
const BAR: f64 = 0.25;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    (values[(values.len() - 1) / 2] + values[values.len() / 2]) / 2.0
}

/// `wave` as a recording as long as a demonstration of it: a shorter look shows less variation.
fn seen_for(wave: &Wave, seconds: f64) -> Recording {
    let span = seconds.min(wave.period());
    let times: Vec<f64> = (0..=400).map(|n| span * f64::from(n) / 400.0).collect();
    let rows: Vec<_> = times
        .iter()
        .map(|t| wave.position(*t).transpose())
        .collect();
    Recording::new(
        "drawn",
        wave.joints().clone(),
        times,
        DMatrix::from_rows(&rows),
    )
    .unwrap()
}

/// The demonstration's own mean cycle with jitter of `share` of its levels.
fn draw(fits: &CycleFits, fit: &CycleFit, share: f64, seed: u64) -> Wave {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normals = || -> Vec<f64> {
        (0..CYCLES)
            .map(|_| StandardNormal.sample(&mut rng))
            .collect()
    };
    let scaled =
        |x: Vec<f64>, level: f64| -> Vec<f64> { x.iter().map(|x| share * level * x).collect() };
    let amplitude = scaled(fits.amplitude().on_ring(&normals()), fit.amplitude_jitter);
    let tempo = scaled(fits.tempo().on_ring(&normals()), fit.tempo_jitter);
    CycleRing::new(CYCLES)
        .unwrap()
        .wave(&fit.wave, &amplitude, &tempo)
        .unwrap()
}

fn check(name: &str, recordings: &[Recording]) {
    let fits = CycleFits::new(recordings, HARMONICS).unwrap();
    let own = |fit: &CycleFit| recordings.iter().find(|r| r.name() == fit.name).unwrap();
    let demonstrated: Vec<Variation> = fits
        .fits()
        .iter()
        .map(|f| Variation::of(own(f)).unwrap())
        .collect();
    let drawn = |share: f64| -> Vec<Variation> {
        fits.fits()
            .iter()
            .enumerate()
            .flat_map(|(m, f)| (0..DRAWS).map(move |s| (m, f, s)))
            .map(|(m, f, s)| {
                let wave = draw(&fits, f, share, 1000 * m as u64 + s);
                Variation::of(&seen_for(&wave, own(f).span())).unwrap()
            })
            .collect()
    };
    let lively = drawn(1.0);
    let of =
        |all: &[Variation], what: fn(&Variation) -> f64| median(all.iter().map(what).collect());
    for (what, value) in [
        ("envelope", (|v| v.envelope) as fn(&Variation) -> f64),
        ("tempo", |v| v.tempo),
    ] {
        let (expected, found) = (of(&demonstrated, value), of(&lively, value));
        println!("{name}: {what} demonstrated {expected:.3}, drawn {found:.3}");
        assert!(
            (found / expected - 1.0).abs() < BAR,
            "{name}: {what} {expected} {found}"
        );
        // A cycle without jitter would not pass.
        assert!(of(&drawn(0.0), value) < 0.3 * expected, "{name}: {what}");
    }
    // Amplitude means amplitude.
    let swing: Vec<f64> = lively
        .iter()
        .enumerate()
        .map(|(i, v)| {
            let own = &demonstrated[i / DRAWS as usize];
            v.swing[own.dominant] / own.swing[own.dominant]
        })
        .collect();
    assert!((median(swing) - 1.0).abs() < 0.03, "{name}");
}

#[test]
fn the_demonstrators_draws_vary_as_its_demonstrations() {
    check("synthetic", synthetic(0).unwrap().recordings());
}

#[test]
fn draws_vary_as_people_do() {
    let Some(shared) = common::shared("the liveliness of real sets") else {
        return;
    };
    let waves = shared.join("waves");
    let mut sets: Vec<_> = std::fs::read_dir(waves.join("sets"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            let name = path.file_name().unwrap().to_string_lossy();
            // The others hold four kinds of wave, or three cycles each.
            name.starts_with(['A', 'B', 'C', 'D', 'E'])
        })
        .collect();
    sets.sort();
    assert_eq!(sets.len(), 5);
    for set in sets {
        let recordings: Vec<Recording> = std::fs::read_to_string(&set)
            .unwrap()
            .lines()
            .filter(|line| !line.trim().is_empty())
            .map(|line| Recording::open(&waves.join(line.trim()), &CsvOptions::default()).unwrap())
            .collect();
        check(&set.file_stem().unwrap().to_string_lossy(), &recordings);
    }
}
