"""Writes crates/optimization/tests/golden/gaussian_process.json: reference values for crates/optimization/src/gaussian_process and optimizer/expected_improvement.rs.

pip install numpy==2.4.6 scikit-learn==1.9.1 mpmath==1.4.1
python3 tools/golden_gaussian_process.py > crates/optimization/tests/golden/gaussian_process.json
"""

import json
import warnings

import mpmath
import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

warnings.simplefilter("ignore", ConvergenceWarning)
rng = np.random.default_rng(1)


def kernel(lengths, variance, noise):
    return ConstantKernel(variance, (1e-2, 1e2)) * Matern(lengths, (0.02, 20.0), nu=2.5) + WhiteKernel(noise, (1e-8, 1.0))


def log_improvement(mean, sd, best):
    """The logarithm is computed with 400 digits, because far from the best the improvement is smaller than any floating-point number."""
    with mpmath.workdps(400):
        z = (mpmath.mpf(best) - mean) / sd
        return float(mpmath.log(sd * (z * mpmath.ncdf(z) + mpmath.npdf(z))))


def reference(points, values, lengths, variance, noise):
    values = (values - values.mean()) / values.std()
    known = ConstantKernel(variance) * Matern(lengths, nu=2.5)
    posterior = GaussianProcessRegressor(known, alpha=noise, optimizer=None).fit(points, values)
    # With the noise as a part of the kernel, scikit-learn gives the slope along its logarithm, too; its order of
    # hyperparameters is variance, lengths, noise.
    whole = GaussianProcessRegressor(kernel(lengths, variance, noise), alpha=0.0, optimizer=None).fit(points, values)
    likelihood, slope = whole.log_marginal_likelihood(whole.kernel_.theta, eval_gradient=True)
    fitted = GaussianProcessRegressor(kernel(lengths, variance, noise), alpha=0.0, n_restarts_optimizer=40, random_state=1)
    fitted.fit(points, values)
    queries = []
    for point in rng.random((8, points.shape[1])):
        mean, sd = posterior.predict(point[None], return_std=True)
        mean, sd, best = mean[0], sd[0], values.min()
        query = {"point": point.tolist(), "mean": mean, "sd": sd, "best": best}
        queries.append(query | {"log_improvement": log_improvement(mean, sd, best)})
    return {
        "points": points.tolist(),
        "values": values.tolist(),
        "lengths": lengths,
        "variance": variance,
        "noise": noise,
        "log_likelihood": likelihood,
        "slope": [*slope[1:-1], slope[0], slope[-1]],
        "queries": queries,
        "best_log_likelihood": fitted.log_marginal_likelihood_value_,
    }


def smooth(x):
    return (x[:, 0] - 0.62) ** 2


def valley(x):
    return 1 + np.linalg.norm(x - 0.4, axis=1) + 0.02 * np.sin(47 * x).prod(axis=1)


def lopsided(x):
    return np.sin(6 * x[:, 0]) + 0.3 * x[:, 1] ** 2 + 0.01 * x[:, 2]


draw = lambda n, d: np.round(rng.random((n, d)), 6)
cases = []
x = draw(12, 1)
cases.append(reference(x, smooth(x), [0.3], 1.5, 1e-6))
x = draw(30, 2)
cases.append(reference(x, valley(x), [0.4, 0.7], 0.8, 1e-2))
x = draw(40, 3)
cases.append(reference(x, lopsided(x) + 0.05 * rng.standard_normal(40), [0.2, 1.0, 3.0], 2.0, 0.05))
x = draw(25, 2)
x = np.vstack([x, x[:10]])
cases.append(reference(x, valley(x) + 0.1 * rng.standard_normal(35), [0.5, 0.1], 1.0, 0.1))
print(json.dumps(cases, indent=1))
