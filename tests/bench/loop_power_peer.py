# SPDX-License-Identifier: GPL-3.0-or-later
"""The plain search that loop_power.py sets beside the program: the largest F over candidates whose shapes
lie on a grid, against a limit for all of them together that is simulated under white noise. It knows the
noise's covariance (levels of foils), which the program has to estimate; it knows no ties, no correlation, no
unequal spread and no heavy tails."""

import math

import numpy as np
from scipy import stats

SIMULATIONS = 499
LIMIT = 0.01
GRID = 12  # places of a step, lengths of a warm-up, periods of a cycle


def dummies(words):
    words = np.asarray(words)
    return np.column_stack([words == w for w in np.unique(words)[1:]]).astype(float)


def columns_of(design, name):
    if name in design.words:
        return dummies(design.words[name])
    x = design.columns[name]
    return ((x - x.mean()) / x.std())[:, None]


def over_one(name, x):
    z = (x - x.mean()) / x.std()
    yield "table.linear", [name], z[:, None]
    if len(np.unique(x)) > 2:
        yield "table.quadratic", [name], np.column_stack([z, z * z])
        u = np.unique(x)
        for k in np.unique(np.linspace(1, len(u) - 1, min(GRID, len(u) - 1)).round().astype(int)):
            yield "table.threshold", [name], (x >= u[k])[:, None].astype(float)


def over_order(name, x):
    levels = len(np.unique(x))
    for length in levels * np.geomspace(0.05, 0.5, 6):
        yield "table.order_transient", [name], np.exp(-(x - x.min()) / length)[:, None]
    for frequency in np.linspace(1, 0.46 * levels, min(max(2 * GRID, levels), 200)) / levels:
        t = 2 * math.pi * frequency * x
        yield "table.periodic", [name], np.column_stack([np.sin(t), np.cos(t)])


def candidates(design):
    names = list(design.columns) + list(design.words)
    for name, x in design.columns.items():
        yield from over_one(name, x)
    for name in design.words:
        yield "table.factor", [name], columns_of(design, name)
    for i, a in enumerate(names):
        for b in names[i + 1:]:
            both = [u * v for u in columns_of(design, a).T for v in columns_of(design, b).T]
            if len(both) <= 4:
                yield "table.interaction", [a, b], np.column_stack(both)
    for name in design.order:
        yield from over_order(name, design.columns[name])
    for i in range(design.n):
        yield "table.outlier", [i], np.eye(design.n)[:, [i]]


def search(design, y, seed=0):
    """(passes the limit, id, coordinates) of the best candidate."""
    white = np.linalg.inv(np.linalg.cholesky(design.scatter))
    rest = np.linalg.svd(white @ design.x, full_matrices=True)[0][:, design.x.shape[1]:].T @ white
    rng = np.random.default_rng([seed, 7])
    both = np.column_stack([rest @ y, rng.normal(size=(len(rest), SIMULATIONS))])
    rss = np.sum(both**2, axis=0)
    least, best = np.full(SIMULATIONS + 1, 2.0), None
    for identity, where, columns in candidates(design):
        u, s, _ = np.linalg.svd(rest @ columns, full_matrices=False)
        u = u[:, s > 1e-6 * np.linalg.norm(columns)]
        if u.shape[1] == 0:
            continue
        k, free = u.shape[1], len(rest) - u.shape[1]
        takes = np.sum((u.T @ both) ** 2, axis=0)
        p = stats.f.sf(takes / k / ((rss - takes) / free), k, free)
        if p[0] < least[0]:
            best = (identity, where)
        least = np.minimum(least, p)
    family = (1 + np.sum(least[1:] <= least[0])) / (SIMULATIONS + 1)
    return bool(family <= LIMIT), best[0], best[1]
