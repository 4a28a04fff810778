//! Rank normalisation, and the quantile function of the standard normal distribution that it needs.

/// The normal scores of values: Phi^-1((r - 3/8) / (S + 1/4)) with rank r of S, ties at their mean rank
/// (Vehtari, Gelman, Simpson, Carpenter and Buerkner, "Rank-normalization, folding, and localization: an improved R-hat for
/// assessing convergence of MCMC", Bayesian Analysis 16(2), 2021, equation (14); Blom 1958).
pub(super) fn normal_scores(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut scores = vec![0.0; values.len()];
    let mut first = 0;
    while first < order.len() {
        // `==`, not the order's bits: 0 and -0 are a tie.
        let tied = order[first..]
            .iter()
            .take_while(|i| values[**i] == values[order[first]])
            .count();
        // Ranks first + 1 ..= first + tied.
        let rank = first as f64 + (tied as f64 + 1.0) / 2.0;
        let score = normal_quantile((rank - 0.375) / (values.len() as f64 + 0.25));
        for i in &order[first..first + tied] {
            scores[*i] = score;
        }
        first += tied;
    }
    scores
}

/// Phi^-1(p) to about 1e-16 of its value (Wichura, "Algorithm AS 241: the percentage points of the normal distribution",
/// Applied Statistics 37(3), 1988, PPND16), for p from 1.4e-11 to 1 less that: no rank among fewer than 4e10 is outside,
/// and the third of its ranges is left out.
fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * horner(r, &CENTRE.0) / horner(r, &CENTRE.1);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    let r = libm::sqrt(-libm::log(tail)) - 1.6;
    let quantile = horner(r, &TAIL.0) / horner(r, &TAIL.1);
    if q < 0.0 { -quantile } else { quantile }
}

fn horner(x: f64, coefficients: &[f64; 8]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

const CENTRE: ([f64; 8], [f64; 8]) = (
    [
        3.387_132_872_796_366_5,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
);

const TAIL: ([f64; 8], [f64; 8]) = (
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        0.000_774_545_014_278_341_4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        0.000_547_593_808_499_534_5,
        1.050_750_071_644_416_9e-9,
    ],
);

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;

    #[test]
    fn quantiles_agree_with_the_distribution_function() {
        let normal = Normal::standard();
        for i in 1..2000 {
            let share = f64::from(i) / 2000.0;
            for p in [share, share.powi(3) * 1e-2, share.powi(6) * 1e-6 + 1.4e-11] {
                let x = normal_quantile(p);
                // An error e of x is one of e phi(x) of p.
                let error = (normal.cdf(x) - p).abs() / (p * (1.0 + x.abs()));
                // statrs has eleven digits.
                assert!(error < 1e-10, "{p}: {x}, {error:e}");
                assert!((x + normal_quantile(1.0 - p)).abs() < 1e-4 || p > 1e-9);
            }
        }
        assert_eq!(normal_quantile(0.5), 0.0);
    }

    #[test]
    fn ties_share_their_mean_rank() {
        let scores = normal_scores(&[3.0, -0.0, 0.0, 7.0, 3.0, 3.0]);
        assert_eq!(scores[1], scores[2]);
        assert_eq!(scores[0], scores[5]);
        assert_eq!(scores[0], normal_quantile((4.0 - 0.375) / 6.25));
        assert_eq!(scores[1], normal_quantile((1.5 - 0.375) / 6.25));
    }
}
