"""Reference values for R-hat and effective sample sizes, from ArviZ 0.23.4.

Run (needs arviz < 1 and numpy):

    python3 tests/oracle/diagnostics.py > tests/oracle/diagnostics.json

Prints a JSON list of cases: a name, one series a chain, and ArviZ's rank-normalised split R-hat ("rank"), bulk and tail
effective sample sizes (Vehtari, Gelman, Simpson, Carpenter and Buerkner, Bayesian Analysis 16(2), 2021).
Series have three decimals: that keeps the file small and makes ties.
"""

import json
import sys

import arviz
import numpy as np

SEED = 20240607


def autoregressive(rng, chains, draws, rho):
    x = np.empty((chains, draws))
    x[:, 0] = rng.standard_normal(chains)
    for t in range(1, draws):
        x[:, t] = rho * x[:, t - 1] + np.sqrt(1 - rho**2) * rng.standard_normal(chains)
    return x


def cases():
    rng = np.random.default_rng(SEED)
    yield "independent", rng.standard_normal((4, 200))
    yield "odd number of draws", rng.standard_normal((4, 151))
    yield "autocorrelated", autoregressive(rng, 4, 300, 0.9)
    yield "hardly moving", autoregressive(rng, 4, 200, 0.995)
    yield "antithetic", autoregressive(rng, 4, 200, -0.6)
    yield "strongly antithetic", autoregressive(rng, 5, 120, -0.95)
    yield "one chain elsewhere", rng.standard_normal((4, 150)) + np.array([[0], [0], [0], [1.5]])
    yield "one chain wider", rng.standard_normal((4, 150)) * np.array([[1], [1], [1], [3]])
    yield "drifting", autoregressive(rng, 4, 150, 0.5) + np.linspace(0, 2, 150)
    yield "heavy tails", rng.standard_cauchy((4, 150))
    yield "whole numbers", rng.poisson(2.0, (6, 100)).astype(float)
    yield "shortest", rng.standard_normal((2, 8))


def main():
    problems = []
    for name, x in cases():
        x = np.round(x, 3)
        problems.append({
            "name": name,
            "chains": x.tolist(),
            "r_hat": float(arviz.rhat(x, method="rank")),
            "bulk_ess": float(arviz.ess(x, method="bulk")),
            "tail_ess": float(arviz.ess(x, method="tail")),
        })
    sys.stdout.write("[\n" + ",\n".join(json.dumps(p, separators=(",", ":")) for p in problems) + "\n]\n")


if __name__ == "__main__":
    main()
