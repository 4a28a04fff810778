//! R-hat and effective sample sizes against ArviZ, `tests/oracle/diagnostics.py`; and what is refused.

use serde::Deserialize;
use undulate::{Diagnostics, ErrorKind};

/// Relative.
const TOLERANCE: f64 = 1e-10;

#[derive(Deserialize)]
struct Case {
    name: String,
    chains: Vec<Vec<f64>>,
    r_hat: f64,
    bulk_ess: f64,
    tail_ess: f64,
}

#[test]
fn diagnostics_agree_with_arviz() {
    let cases: Vec<Case> = serde_json::from_str(include_str!("oracle/diagnostics.json")).unwrap();
    assert_eq!(cases.len(), 12);
    for case in &cases {
        let found = Diagnostics::of(&case.chains).unwrap();
        for (what, found, expected) in [
            ("R-hat", found.r_hat(), case.r_hat),
            ("bulk", found.bulk_ess(), case.bulk_ess),
            ("tail", found.tail_ess(), case.tail_ess),
        ] {
            assert!(
                (found - expected).abs() < TOLERANCE * expected,
                "{}, {what}: {found} {expected}",
                case.name
            );
        }
        let mixed = ["independent", "antithetic", "heavy tails"].contains(&case.name.as_str());
        assert_eq!(
            found.mixed(),
            mixed || case.name == "odd number of draws",
            "{}",
            case.name
        );
        assert_eq!(found.mixed(), !found.to_string().contains("NOT MIXED"));
    }
}

#[test]
fn constants_have_not_mixed() {
    let everywhere = Diagnostics::of(&vec![vec![3.0; 1000]; 4]).unwrap();
    assert!(everywhere.r_hat().is_nan() && !everywhere.mixed());
    let stuck: Vec<Vec<f64>> = (0..4).map(|c| vec![f64::from(c); 1000]).collect();
    let stuck = Diagnostics::of(&stuck).unwrap();
    // Infinite but for rounding.
    assert!(stuck.r_hat() > 1e6 && !stuck.mixed());
    let fine: Vec<Vec<f64>> = (0..4)
        .map(|c| {
            (0..1000)
                .map(|i| f64::from((i * 7919 + c * 131) % 997))
                .collect()
        })
        .collect();
    let fine = Diagnostics::of(&fine).unwrap();
    assert!(fine.mixed(), "{fine}");
    for worse in [fine.worse(&everywhere), everywhere.worse(&fine)] {
        assert!(!worse.mixed() && worse.r_hat().is_nan());
    }
    assert_eq!(fine.worse(&stuck).r_hat(), stuck.r_hat());
}

#[test]
fn what_is_no_set_of_chains_is_refused() {
    let refused = |chains: &[Vec<f64>]| {
        let error = Diagnostics::of(chains).unwrap_err();
        (error.kind(), error.to_string())
    };
    let (kind, text) = refused(&[vec![0.0; 10]]);
    assert_eq!(kind, ErrorKind::Shape);
    assert_eq!(
        text,
        "1 chains of 10 draws, expected at least two chains of at least 4 draws"
    );
    assert_eq!(refused(&[]).0, ErrorKind::Shape);
    assert_eq!(refused(&vec![vec![1.0, 2.0, 3.0]; 4]).0, ErrorKind::Shape);
    let (_, text) = refused(&[vec![0.0; 10], vec![0.0; 9]]);
    assert_eq!(text, "chain 1: 9 draws, expected 10, as in the first chain");
    let mut chains = vec![vec![0.5; 10]; 3];
    chains[2][7] = f64::NAN;
    let (kind, text) = refused(&chains);
    assert_eq!(kind, ErrorKind::Value);
    assert_eq!(
        text,
        "chain 2, draw 7: statistic is NaN, expected a finite number"
    );
}

#[test]
fn ten_thousand_draws_a_chain_take_no_quadratic_time() {
    // A random walk: correlations at all lags.
    let mut state = 1u64;
    let chains: Vec<Vec<f64>> = (0..4)
        .map(|_| {
            let mut place = 0.0;
            let step = |_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                place += (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                place
            };
            (0..10_000).map(step).collect()
        })
        .collect();
    let begin = std::time::Instant::now();
    assert!(!Diagnostics::of(&chains).unwrap().mixed());
    // Milliseconds; a sum for each of 5000 lags would be seconds without optimisation.
    assert!(begin.elapsed().as_secs_f64() < 1.0);
}
