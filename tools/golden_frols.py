"""Writes crates/sensing/tests/golden/frols.json: forward regression of polynomials, from SysIdentPy.

pip install sysidentpy==0.9 && python3 tools/golden_frols.py > crates/sensing/tests/golden/frols.json

Samples are random places (u, v) and noisy values of known polynomials; regressors are SysIdentPy's own polynomials of them (degree 4,
no lags). The file contains its order of terms, error reduction ratios, coefficients and information criteria.
"""

import itertools
import json
import time
import sys

import numpy as np
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS
from sysidentpy.model_structure_selection.ofr_base import aic, bic
from sysidentpy.parameter_estimation import LeastSquares

DEGREE = 4


def powers():
    """Monomials as SysIdentPy orders them: its code of a term lists inputs, 0 for none."""
    codes = itertools.combinations_with_replacement([0, 1, 2], DEGREE)
    return [[code.count(1), code.count(2)] for code in codes]


def select(places, values, most):
    lagged = np.column_stack([np.ones(len(places)), places])
    regressors = Polynomial(degree=DEGREE).fit(lagged, 0, 1, [[1], [1]], "NFIR")
    search = FROLS(
        basis_function=Polynomial(degree=DEGREE),
        ylag=1,
        xlag=[[1], [1]],
        model_type="NFIR",
        n_terms=most,
        order_selection=False,
        estimator=LeastSquares(),
    )
    search.max_lag = 0
    y = values.reshape(-1, 1)
    ratios, order, chosen = search.error_reduction_ratio(regressors, y, most)
    coefficients = LeastSquares().optimize(chosen, y)
    return regressors, ratios[:most], order[:most], coefficients[:, 0]


def main():
    rng = np.random.default_rng(1)
    expected = np.array(powers())
    cases = []
    for samples, noise in [(40, 0.05), (120, 0.3), (400, 1.0), (1400, 0.1)]:
        places = np.round(rng.uniform(-1, 1, (samples, 2)), 6)
        coefficients = rng.normal(0, 1, len(expected)) * (rng.random(len(expected)) < 0.4)
        monomials = np.column_stack([places[:, 0] ** a * places[:, 1] ** b for a, b in expected])
        values = np.round(2 + monomials @ coefficients + rng.normal(0, noise, samples), 6)
        most = 10
        regressors, ratios, order, found = select(places, values, most)
        assert np.allclose(regressors, monomials), "another order of terms"
        criteria = {"aic": [], "bic": []}
        for count in range(1, most + 1):
            part = regressors[:, order[:count]]
            residual = values - part @ np.linalg.lstsq(part, values, rcond=None)[0]
            square = float(np.mean(residual**2))
            criteria["aic"].append(aic(count, samples, square))
            criteria["bic"].append(bic(count, samples, square))
        cases.append(
            {
                "places": places.tolist(),
                "values": values.tolist(),
                "powers": [expected[i].tolist() for i in order],
                "ratios": [float(r) for r in ratios],
                "coefficients": [float(c) for c in found],
                "aic": [float(v) for v in criteria["aic"]],
                "bic": [float(v) for v in criteria["bic"]],
            }
        )
    json.dump(cases, sys.stdout)
    print()
    # How long 72 models from 1400 samples take, for the table in docs/validation/sensing.md.
    places, values = rng.uniform(-1, 1, (1400, 2)), rng.normal(3, 1, 1400)
    begun = time.process_time()
    for _ in range(72):
        select(places, values, 15)
    print(f"72 models of 15 terms from 1400 samples: {time.process_time() - begun:.2f} CPU s", file=sys.stderr)


main()
