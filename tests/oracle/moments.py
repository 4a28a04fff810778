"""Mean and covariance of trajectories of a Fourier movement primitive, computed the literal way.

Run (needs numpy):

    python3 tests/oracle/moments.py tests/fixtures/model_v2.json > tests/oracle/moments.json

Reads a model file of version 2 and prints, for three spreads of the start, the mean (n) and the covariance (n x n) of
[y(t_1), y'(t_1), y(t_2), ..], D positions and D velocities at each time.

Formulas. D joints, period T, w = 2 pi / T, harmonics k = 1..K,

    x = [ln |w_{d,k}|, d-major;  phases, same order;  offsets]
    phase of joint d: x of d, plus x of the reference joint for all other joints, where phases are relative
    offset w_{d,0}: x, or exp(x), or -exp(x)
    Sigma = F F^T + sum S (A kron R) S + diag(s)^2,  R_{kl} = rho^|k - l|
    given A x = b with noise N:  G = Sigma A^T (A Sigma A^T + N)^-1,  mu + G (b - A mu),  Sigma - G A Sigma

Position and velocity are written as one sum of 2K + 1 terms a joint, q = -K..K, w_{d,-q} = conj(w_{d,q}):

    y_d(t) = sum_q c_q(t) x_i or c_q(t) s exp(a_q^T x),  c_q = exp(i q w (t + delta)), times i q w in the velocity,

and the moments are raw ones, of pairs of terms, from the moment generating function M(a) = exp(a^T mu + a^T Sigma a / 2):

    E exp(a^T x) = M(a),  E exp(a^T x) exp(b^T x) = M(a + b),
    E x_i exp(a^T x) = (mu_i + (Sigma a)_i) M(a),  E x_i x_j = mu_i mu_j + Sigma_ij,
    E exp(i q w delta) = 1, or 1 for q = 0 and else 0 (uniform), or exp(-(q w s)^2 / 2) (normal).

The product of the means is subtracted at the end. Complex numbers are of extended precision where numpy has it, for that difference.
"""

import json
import sys

import numpy as np

TIMES = [0.0, 0.37, 1.1, 2.2]
STARTS = [("none", 0.0), ("uniform", 0.0), ("normal", 0.21)]
REAL, COMPLEX = np.longdouble, np.clongdouble


def prior(model):
    mean = np.array(model["mean"], REAL)
    factor = np.array(model["factor"], REAL).reshape(-1, len(mean))
    sigma = factor.T @ factor
    for block in model["blocks"]:
        A = np.array(block["correlation"], REAL)
        s = np.array(block["deviations"], REAL)
        k = np.arange(len(s) // len(A))
        R = REAL(block["decay"]) ** np.abs(np.subtract.outer(k, k))
        where = slice(block["start"], block["start"] + len(s))
        sigma[where, where] += np.outer(s, s) * np.kron(A, R)
    for i, s in model["independent"]:
        sigma[i, i] += REAL(s) ** 2
    return mean, sigma


def solve(V, right):
    """V^-1 right by Gauss-Jordan with pivoting: numpy's solvers know no extended precision."""
    work = np.hstack([V, right])
    for i in range(len(V)):
        pivot = i + np.argmax(np.abs(work[i:, i]))
        work[[i, pivot]] = work[[pivot, i]]
        work[i] /= work[i, i]
        for j in range(len(V)):
            if j != i:
                work[j] -= work[j, i] * work[i]
    return work[:, len(V):]


def posterior(model):
    mean, sigma = prior(model)
    given = model["observations"]
    A = np.zeros((len(given), len(mean)), REAL)
    for row, observation in zip(A, given):
        for i, c in observation["row"]:
            row[i] += REAL(c)
    b = np.array([o["value"] for o in given], REAL)
    noise = np.diag(np.array([o["deviation"] for o in given], REAL) ** 2)
    gain = solve(A @ sigma @ A.T + noise, A @ sigma).T
    return mean + gain @ (b - A @ mean), sigma - gain @ (A @ sigma)


def terms(model):
    """Of each joint: (q, index of x, None, None) for x_i, or (q, None, sign, a) for sign exp(a^T x)."""
    joints, K, n = model["joints"], model["harmonics"], len(model["mean"])
    phases, offsets = len(joints) * K, 2 * len(joints) * K
    relative = model["phases"].get("relative") if isinstance(model["phases"], dict) else None
    reference = joints.index(relative["reference"]) if relative else None
    out = []
    for d, form in enumerate(model["offsets"]):
        own = []
        if form == "signed":
            own.append((0, offsets + d, None, None))
        else:
            a = np.zeros(n, COMPLEX)
            a[offsets + d] = 1
            own.append((0, None, 1 if form == "positive" else -1, a))
        for k in range(1, K + 1):
            a = np.zeros(n, COMPLEX)
            a[d * K + k - 1] = 1
            a[phases + d * K + k - 1] = 1j
            if reference is not None and d != reference:
                a[phases + reference * K + k - 1] = 1j
            own += [(k, None, 1, a), (-k, None, 1, a.conj())]
        out.append(own)
    return out


def characteristic(start, q, w):
    name, deviation = start
    if name == "uniform":
        return REAL(q == 0)
    return np.exp(-(REAL(q) * w * REAL(deviation)) ** 2 / 2)


def moments(model, start):
    mean, sigma = posterior(model)
    w = 2 * np.arctan2(REAL(0), REAL(-1)) / REAL(model["period_s"])

    def generating(a):
        return np.exp(a @ mean + a @ sigma @ a / 2)

    def raw(one, other):
        """E of the product of two terms, their times aside."""
        (p, i, s, a), (q, j, r, b) = one, other
        f = characteristic(start, p + q, w)
        if a is None and b is None:
            return f * (mean[i] * mean[j] + sigma[i, j])
        if a is None:
            return f * r * (mean[i] + sigma[i] @ b) * generating(b)
        if b is None:
            return raw(other, one)
        return f * s * r * generating(a + b)

    def first(term):
        q, i, s, a = term
        return characteristic(start, q, w) * (mean[i] if a is None else s * generating(a))

    joints = terms(model)
    flat = [(d, term) for d, own in enumerate(joints) for term in own]
    second = np.array([[raw(one, other) for _, other in flat] for _, one in flat], COMPLEX)
    middle = np.array([first(term) for _, term in flat], COMPLEX)
    # One row for each of [y(t_1), y'(t_1), ..]: what multiplies the terms.
    rows = []
    for t in TIMES:
        for order in (0, 1):
            for d in range(len(joints)):
                rows.append([(1j * term[0] * w) ** order * np.exp(1j * term[0] * w * REAL(t)) * (own == d)
                             for own, term in flat])
    rows = np.array(rows, COMPLEX)
    y = rows @ middle
    yy = rows @ second @ rows.T
    assert np.abs(y.imag).max() < 1e-15 * np.abs(y).max()
    assert np.abs(yy.imag).max() < 1e-15 * np.abs(yy).max()
    return y.real, yy.real - np.outer(y.real, y.real)


def main():
    with open(sys.argv[1]) as f:
        model = json.load(f)
    out = {"times": TIMES, "starts": []}
    for start in STARTS:
        mean, covariance = moments(model, start)
        eigenvalues = np.linalg.eigvalsh(covariance.astype(float))
        assert eigenvalues.min() > -1e-12 * eigenvalues.max()
        out["starts"].append({"spread": start[0], "deviation": start[1],
                              "mean": mean.astype(float).tolist(),
                              "covariance": covariance.astype(float).tolist()})
    print(json.dumps(out))


if __name__ == "__main__":
    main()
