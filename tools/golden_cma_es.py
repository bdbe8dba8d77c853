"""Writes crates/optimization/tests/golden/cma_es.csv: how many evaluations pycma needs on the test functions of Hansen's tutorial.

pip install numpy==2.4.6 cma==4.5.0 && python3 tools/golden_cma_es.py > crates/optimization/tests/golden/cma_es.csv
"""

import cma
import numpy as np

TARGET = 1e-10
RUNS = 51


def sphere(x):
    return np.sum(x**2)


def cigar(x):
    return x[0] ** 2 + 1e6 * np.sum(x[1:] ** 2)


def tablet(x):
    return 1e6 * x[0] ** 2 + np.sum(x[1:] ** 2)


def ellipsoid(x):
    return np.sum(1e6 ** (np.arange(len(x)) / (len(x) - 1)) * x**2)


def different_powers(x):
    return np.sum(np.abs(x) ** (2 + 4 * np.arange(len(x)) / (len(x) - 1)))


def rosenbrock(x):
    return np.sum(100 * (x[:-1] ** 2 - x[1:]) ** 2 + (x[:-1] - 1) ** 2)


print("function,dimensions,start,step,first_quartile,median,third_quartile,arrived")
for function in [sphere, cigar, tablet, ellipsoid, different_powers, rosenbrock]:
    start, step = (0.0, 0.5) if function is rosenbrock else (3.0, 2.0)
    for n in [2, 5, 10]:
        evaluations = []
        for seed in range(1, RUNS + 1):
            options = {"seed": seed, "verbose": -9, "ftarget": TARGET, "tolfun": 0, "tolfunhist": 0, "tolx": 0, "maxfevals": 100_000}
            run = cma.CMAEvolutionStrategy(n * [start], step, options)
            run.optimize(function)
            if run.result.fbest <= TARGET:
                evaluations.append(run.result.evals_best)
        quartiles = np.percentile(evaluations, [25, 50, 75])
        numbers = ",".join(f"{value:.0f}" for value in quartiles)
        print(f"{function.__name__},{n},{start},{step},{numbers},{len(evaluations) / RUNS:.2f}", flush=True)
