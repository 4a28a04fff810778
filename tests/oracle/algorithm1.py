"""Reference values for the Fourier movement model, computed the literal way.

Run (needs numpy):

    python3 tests/oracle/algorithm1.py > tests/oracle/algorithm1.json
    python3 tests/oracle/algorithm1.py MODEL.json CSV...

The first form prints a JSON list of three fitting problems with their answers.
The second refits the CSV demonstrations and prints how far the model file's
mean and covariance are from the result (relative Frobenius errors).

Formulas. D joints, period T, w = 2 pi / T, harmonics k = -K..K, M demonstrations:

    y_d(t) = sum_k w_{d,k} exp(i k w t)
    weights    argmin || (Phi kron I_D) w - y ||^2,  Phi[n, j] = exp(i k_j w t_n),
               y stacked time-major, then joint
    chart      x = [ln |w_{d,k}|, d-major, k = 1..K;  arg w_{d,k} in (-pi, pi],
               same order;  Re w_{d,0}],  n = 2 D K + D coordinates
    Gaussian   mu = mean of x,  Sigma = (1/M) sum (x - mu)(x - mu)^T
    condition  G = Sigma A^T (A Sigma A^T)^-1  on A x = b:
               mu' = mu + G (b - A mu),  Sigma' = Sigma - G A Sigma

Observed moduli are given as |w|, and enter b as ln |w|; phases and offsets as they are.
"""

import csv
import json
import sys

import numpy as np

SEED = 20240607


def design(times, period, K):
    k = np.arange(-K, K + 1)
    return np.exp(2j * np.pi / period * np.outer(times, k))


def solve_kronecker(times, samples, period, K):
    """Weights (D x (2K+1)) from the full Kronecker system."""
    D = samples.shape[1]
    phi = design(times, period, K)
    assert np.linalg.cond(phi) < 10
    y = samples.ravel().astype(complex)
    w, _, rank, _ = np.linalg.lstsq(np.kron(phi, np.eye(D)), y, rcond=None)
    assert rank == D * (2 * K + 1)
    return w.reshape(2 * K + 1, D).T


def solve_by_joint(times, samples, period, K):
    """The same weights, one joint (one right-hand side) at a time."""
    phi = design(times, period, K)
    return np.array([np.linalg.lstsq(phi, y.astype(complex), rcond=None)[0] for y in samples.T])


def chart(w, K):
    positive = w[:, K + 1:]
    moduli, phases = np.abs(positive).ravel(), np.angle(positive).ravel()
    return np.concatenate([np.log(moduli), phases, w[:, K].real])


def gaussian(x):
    x = np.asarray(x)
    mean = x.mean(axis=0)
    return mean, (x - mean).T @ (x - mean) / len(x)


def condition(mean, cov, A, b):
    S = A @ cov @ A.T
    assert np.linalg.cond(S) < 1e4
    gain = cov @ A.T @ np.linalg.inv(S)
    return mean + gain @ (b - A @ mean), cov - gain @ A @ cov


def jittered_times(rng, period, gap):
    """20 to 30 increasing stamps from 0 to at most T, optionally with one 0.2 T gap."""
    N = int(rng.integers(20, 31))
    t = (np.arange(N) + rng.uniform(0.1, 0.9, N)) / N
    t[0] = 0.0
    if gap:
        t = 0.83 * t + 0.17 * (np.arange(N) >= N // 2)
    return np.round(period * t, 6)


def make_samples(rng, demo_times, period, D, K):
    """Noisy motions with harmonics up to K + 1, varied a little per demonstration."""
    k = np.arange(1, K + 2)
    amplitude = rng.uniform(0.4, 0.9, (D, K + 1)) / np.sqrt(k)
    phase = rng.uniform(-2.0, 2.0, (D, K + 1))
    offset = rng.uniform(-0.8, 0.8, D)
    out = []
    for t in demo_times:
        a = amplitude * np.exp(rng.normal(0, 0.15, (D, K + 1)))
        a[:, K] *= 0.1  # outside the model's band
        p = phase + rng.uniform(-0.4, 0.4, (D, K + 1))
        o = offset + rng.normal(0, 0.1, D)
        angle = 2 * np.pi / period * np.outer(t, k)[:, None, :] + p
        y = o + (a * np.cos(angle)).sum(axis=2)
        out.append(np.round(y + rng.normal(0, 0.02, y.shape), 6))
    return out


def index_of(coordinate, joints, K):
    kind, joint, *k = coordinate.split(":")
    d, block = joints.index(joint), len(joints) * K
    if kind == "offset":
        return 2 * block + d
    return (block if kind == "phase" else 0) + d * K + int(k[0]) - 1


def conditioned_case(mean, cov, joints, K, shifts):
    """Observe coordinates a given number of standard deviations off the mean."""
    observations, b = [], []
    for coordinate, shift in shifts.items():
        i = index_of(coordinate, joints, K)
        sd = np.sqrt(cov[i, i])
        modulus = coordinate.startswith("modulus")
        charted = mean[i] + shift * sd
        value = round(float(np.exp(charted) if modulus else charted), 6)
        b.append(np.log(value) if modulus else value)
        assert 1e-3 < abs(b[-1] - mean[i]) < sd
        observations.append({"index": i, "coordinate": coordinate, "value": value})
    A = np.eye(len(mean))[[o["index"] for o in observations]]
    new_mean, new_cov = condition(mean, cov, A, np.array(b))
    assert np.abs(A @ new_mean - b).max() < 1e-12
    assert max(np.abs(new_cov @ A.T).max(), np.abs(new_cov - new_cov.T).max()) < 1e-13
    assert np.linalg.eigvalsh(new_cov).min() > -1e-13
    return {"observations": observations, "mean": new_mean.tolist(), "covariance": new_cov.tolist()}


def problem(name, period, K, joints, demo_times, rng, cases):
    demo_samples = make_samples(rng, demo_times, period, len(joints), K)
    weights, x = [], []
    for t, y in zip(demo_times, demo_samples):
        assert np.all(np.diff(t) > 0) and t[0] >= 0 and t[-1] <= period
        w = solve_kronecker(t, y, period, K)
        assert np.abs(w - w[:, ::-1].conj()).max() < 1e-13  # real motion
        assert np.abs(w - solve_by_joint(t, y, period, K)).max() < 1e-13
        assert np.abs(w[:, K + 1:]).min() > 0.05
        assert np.abs(np.angle(w[:, K + 1:])).max() < 2.7  # no branch ambiguity
        weights.append([[[z.real, z.imag] for z in row[K:].tolist()] for row in w])
        x.append(chart(w, K))
    mean, cov = gaussian(x)
    return {
        "name": name, "period": period, "harmonics": K, "joints": joints,
        "demonstrations": [{"times": t.tolist(), "samples": y.tolist()}
                           for t, y in zip(demo_times, demo_samples)],
        "weights": weights, "mean": mean.tolist(), "covariance": cov.tolist(),
        "conditioned": [conditioned_case(mean, cov, joints, K, c) for c in cases],
    }


def generate():
    rng = np.random.default_rng(SEED)
    two, three = ["a", "b"], ["a", "b", "c"]
    T, N = 2.5, 24
    yield problem("open", T, 4, two, [np.arange(N) * T / N] * 5, rng, [
        {"modulus:a:2": 0.6},
        {"modulus:b:3": -0.5, "phase:b:1": 0.4, "offset:a": 0.3}])
    T, N = 20 / 3, 23
    yield problem("closed", T, 5, three, [T * (np.arange(N) / (N - 1))] * 6, rng, [
        {"modulus:c:5": -0.7},
        {"modulus:a:1": 0.5, "phase:c:4": -0.3, "offset:b": 0.6}])
    T = 3.1
    times = [jittered_times(rng, T, gap=(m == 2)) for m in range(5)]
    yield problem("arbitrary", T, 4, two, times, rng, [
        {"modulus:b:1": 0.5},
        {"modulus:a:4": 0.4, "phase:a:2": -0.6, "offset:b": -0.5}])


def read_demonstration(path, joints, period):
    with open(path, newline="") as f:
        rows = list(csv.DictReader(f))
    t = np.array([float(r["time_s"]) for r in rows])
    y = np.array([[float(r[j]) for j in joints] for r in rows])
    used = t - t[0] <= period * (1 + 1e-9)
    return (t - t[0])[used], y[used]


def compare(model_path, csv_paths):
    with open(model_path) as f:
        model = json.load(f)
    joints, T, K = model["joints"], model["period_s"], model["harmonics"]
    x = [chart(solve_by_joint(*read_demonstration(p, joints, T), T, K), K) for p in csv_paths]
    mean, cov = gaussian(x)
    error = np.array(model["mean"]) - mean
    phases = slice(len(joints) * K, 2 * len(joints) * K)
    error[phases] -= 2 * np.pi * np.round(error[phases] / (2 * np.pi))
    factor = np.array(model["factor"]).reshape(-1, len(mean))  # one column of the factor per row
    norm, cov_gap = np.linalg.norm, factor.T @ factor - cov
    print(f"mean {norm(error) / norm(mean):.1e} covariance {norm(cov_gap) / norm(cov):.1e}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        compare(sys.argv[1], sys.argv[2:])
    else:
        print("[" + ",\n".join(json.dumps(p) for p in generate()) + "]")
