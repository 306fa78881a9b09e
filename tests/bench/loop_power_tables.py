# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables whose truth is known, for loop_power.py: three designs, and every kind of effect at a size that
an oracle states.

The oracle knows the effect's form with its non-linear parameters, and the noise. Its standard error of an
amplitude beside the declared model is 1 / sqrt(f' A f), where A is the inverse of the noise's covariance
with the declared columns projected out; an effect of size s is s such errors large. Of what lies in the
noise itself (spread, serial correlation) the size is sqrt(2 E log likelihood ratio) between the truth and
equal, independent noise, both beside the declared model.

Nothing here is shared with the program: effects are written out from their definitions.
"""

import math
import zlib

import numpy as np
from scipy import optimize

RETAINED_LEAST = 0.2  # of a form beside the declared model: what the model takes up is not asked for


class Design:
    """x: the declared columns. scatter: the covariance of the noise. order: where order-like effects live."""

    def __init__(self, name, columns, words, model, x, order, group=None, level=0.0):
        self.name, self.columns, self.words, self.model, self.x = name, columns, words, model, x
        self.order, self.group, self.n = order, group, len(x)
        self.scatter = np.eye(self.n)
        if group:
            same = self.words[group] if group in words else columns[group]
            self.labels = np.unique(same, return_inverse=True)[1]
            self.scatter = self.scatter + level**2 * (self.labels[:, None] == self.labels[None, :])

    def projected(self):
        """The inverse of the noise's covariance beside the declared columns."""
        inverse = np.linalg.inv(self.scatter)
        wx = inverse @ self.x
        return inverse - wx @ np.linalg.solve(self.x.T @ wx, wx.T)

    def values(self, name):
        return self.columns[name] if name in self.columns else np.array(self.words[name])


def word_columns(rng, n, levels, letter):
    index = rng.permutation(np.arange(n) % levels)
    return [f"{letter}{k + 1}" for k in index]


def experiment(rng, grouped=False):
    """24 runs in random order: four temperatures, three durations, each setting twice."""
    points = [(t, d) for t in (480.0, 520.0, 560.0, 600.0) for d in (2.0, 4.0, 6.0)] * 2
    t, d = np.array([points[i] for i in rng.permutation(24)]).T
    columns = {"run": np.arange(1.0, 25), "temperature_C": t, "duration_h": d,
               "humidity_pct": rng.uniform(15, 60, 24).round(1),
               "furnace_position": rng.permutation(np.arange(24) % 6) + 1.0}
    words = {"operator": word_columns(rng, 24, 3, "O"), "coil": [f"K{k // 4 + 1}" for k in range(24)]}
    a, b = (t - 540) / 60, (d - 4) / 2
    return Design("experiment", columns, words, "1 + temperature_C + duration_h + temperature_C:duration_h",
                  np.column_stack([np.ones(24), a, b, a * b]), ["run"], "coil" if grouped else None, 1.0)


def lot(rng, grouped=True):
    """14 foils of 9 bumps; what a foil's bumps share is random."""
    foil, bump = np.repeat(np.arange(14), 9), np.tile(np.arange(1.0, 10), 14)
    columns = {"foil": foil + 1.0, "bump": bump, "room_C": rng.uniform(18, 23, 14).round(2)[foil],
               "furnace_position": (rng.permutation(np.arange(14) % 5) + 1.0)[foil]}
    cavity = np.array(word_columns(rng, 14, 3, "C"))
    words = {"coil": [f"K{1 + k // 5}" for k in foil], "die_cavity": list(cavity[foil])}
    return Design("lot", columns, words, "1", np.ones((126, 1)), ["bump", "foil"], "foil",
                  rng.choice([0.3, 0.7, 1.2]))


def series(rng, grouped=False):
    """200 readings; every other table declares a trend with a column."""
    n = 200
    wander = rng.normal(size=n)
    for i in range(1, n):
        wander[i] += 0.9 * wander[i - 1]
    pressure = rng.uniform(3, 7, n).round(2)
    columns = {"reading": np.arange(1.0, n + 1), "pressure_bar": pressure, "ambient_C": (21 + 0.5 * wander).round(2)}
    words = {"machine": word_columns(rng, n, 3, "M"), "batch": [f"B{k // 20 + 1}" for k in range(n)]}
    model, x = "1", np.ones((n, 1))
    if rng.random() < 0.5:
        model, x = "1 + ambient_C", np.column_stack([np.ones(n), wander - wander.mean()])
    return Design("series", columns, words, model, x, ["reading"], "batch" if grouped else None, 1.0)


DESIGNS = {"experiment": experiment, "lot": lot, "series": series}

# Columns that each design offers a kind, to choose from.
NUMBERS = {"experiment": ["humidity_pct"], "lot": ["room_C"], "series": ["pressure_bar"]}
BENT = {"experiment": ["humidity_pct", "temperature_C", "duration_h"], "lot": ["room_C"], "series": ["pressure_bar"]}
NUMBER_PAIRS = {"experiment": [("temperature_C", "humidity_pct"), ("duration_h", "humidity_pct")],
                "lot": [("room_C", "bump")], "series": [("pressure_bar", "ambient_C")]}
WORD_PAIRS = {"experiment": [("operator", "humidity_pct"), ("operator", "temperature_C")],
              "lot": [("die_cavity", "bump")], "series": [("machine", "pressure_bar")]}
LEVELS = {"experiment": ["operator"], "lot": ["die_cavity"], "series": ["machine"]}
BLOCKS = {"experiment": ["coil"], "lot": ["coil"], "series": ["batch"]}
SPREAD = {"experiment": ["operator", "run", "humidity_pct"], "lot": ["coil", "bump", "foil"],
          "series": ["machine", "reading", "batch"]}


class Truth:
    """form: the added effect, up to its amplitude. accepted: (id, its coordinates); rows: of outliers.
    anywhere: an effect of any id on that coordinate is right."""

    def __init__(self, accepted, form=None, rows=(), anywhere=None):
        self.accepted = {(i, frozenset(c)) for i, c in accepted}
        self.form, self.rows, self.anywhere = form, set(rows), anywhere


def pick(rng, table, design):
    options = table[design.name]
    return options[int(rng.integers(len(options)))]


def centred(x):
    return (x - x.mean()) / x.std()


def place(rng, x, least=0.25):
    """A value with at least that share of the different values on either side."""
    u = np.unique(x)
    k = int(rng.integers(math.ceil(least * len(u)), max(math.floor((1 - least) * len(u)), 1) + 1))
    k = min(max(k, 1), len(u) - 1)
    return (u[k - 1] + u[k]) / 2


def over_order(rng, design):
    c = design.order[int(rng.integers(len(design.order)))]
    return c, design.columns[c], len(np.unique(design.columns[c]))


def linear(rng, d):
    c = pick(rng, NUMBERS, d)
    return Truth([("table.linear", [c])], centred(d.columns[c]))


def quadratic(rng, d):
    c = pick(rng, BENT, d)
    x = d.columns[c]
    return Truth([("table.quadratic", [c])], (x - np.quantile(x, rng.uniform(0.35, 0.65))) ** 2)


def interaction_numbers(rng, d):
    a, b = pick(rng, NUMBER_PAIRS, d)
    return Truth([("table.interaction", [a, b])], centred(d.columns[a]) * centred(d.columns[b]))


LEVELS_OF_A_COLUMN = ("table.factor", "table.group_offset", "table.random_levels")


def by_level(rng, words):
    levels = sorted(set(words))
    while True:
        size = rng.normal(size=len(levels))
        if size.std() > 0.5:
            break
    return np.array([size[levels.index(w)] for w in words])


def interaction_words(rng, d):
    a, b = pick(rng, WORD_PAIRS, d)
    slope = by_level(rng, d.words[a])
    return Truth([("table.interaction", [a, b])], (slope - slope.mean()) * centred(d.columns[b]))


def factor(rng, d):
    c = pick(rng, LEVELS, d)
    return Truth([("table.factor", [c])], by_level(rng, d.words[c]))


def group_offset(rng, d):
    c = pick(rng, BLOCKS, d)
    return Truth([(i, [c]) for i in LEVELS_OF_A_COLUMN], by_level(rng, d.words[c]))


def threshold(rng, d):
    c = pick(rng, NUMBERS, d)
    x = d.columns[c]
    return Truth([("table.threshold", [c])], (x > place(rng, x)).astype(float))


def drift(rng, d):
    c, x, _ = over_order(rng, d)
    return Truth([("table.order_drift", [c]), ("table.linear", [c])], centred(x))


def step(rng, d):
    c, x, _ = over_order(rng, d)
    ids = ("table.threshold", "table.order_step", "table.step")
    return Truth([(i, [c]) for i in ids], (x > place(rng, x)).astype(float))


def transient(rng, d):
    c, x, levels = over_order(rng, d)
    length = levels * rng.uniform(0.06, 0.25)
    return Truth([("table.order_transient", [c]), ("part.lip_decay", [c])], np.exp(-(x - x.min()) / length))


def wave(x, period, phase):
    return np.sin(2 * math.pi * x / period + phase)


def cycle_long(rng, d):
    c, x, levels = over_order(rng, d)
    period = levels / rng.uniform(1.2, 3.0) if levels > 12 else levels / rng.uniform(1.2, 2.0)
    return Truth([("table.periodic", [c])], wave(x, period, rng.uniform(0, 6.28)))


def cycle_short(rng, d):
    c, x, _ = over_order(rng, d)
    return Truth([("table.periodic", [c])], wave(x, rng.uniform(2.2, 4.0), rng.uniform(0, 6.28)))


def outlier(rng, d):
    i = int(rng.integers(d.n))
    return Truth([], np.eye(d.n)[i] * rng.choice([-1, 1]), rows=[i])


def curve(rng, d):
    """A curve that no effect lists: a hump, two humps of opposite sign, or a plateau."""
    c = pick(rng, NUMBERS, d) if rng.random() < 0.5 else over_order(rng, d)[0]
    x = np.argsort(np.argsort(np.unique(d.columns[c]))) / (len(np.unique(d.columns[c])) - 1)
    x = x[np.unique(d.columns[c], return_inverse=True)[1]]
    at = rng.uniform(0.25, 0.4)
    bump = lambda m, w: np.exp(-(((x - m) / w) ** 2) / 2)
    shapes = [lambda: bump(at + 0.15, 0.12), lambda: bump(at - 0.05, 0.1) - bump(at + 0.4, 0.1),
              lambda: ((x > at) & (x < at + 0.35)).astype(float)]
    return Truth([], shapes[int(rng.integers(3))](), anywhere=c)


MEANS = {f.__name__: f for f in (linear, quadratic, interaction_numbers, interaction_words, factor, group_offset,
                                 threshold, drift, step, transient, cycle_long, cycle_short, outlier, curve)}
SCATTERS = ["spread", "serial_correlation"]
KINDS = list(MEANS) + ["masked_outliers", "exchanged_runs"] + SCATTERS
# Right names of noise that is not white: no false claim, and no false suspicion.
ALLOWED = {"unequal_spread": "table.spread", "correlated": "table.serial_correlation"}
CLEAN = ["white", "t4", "t3", "laplace", "unequal_spread", "group_levels", "correlated"]


def retained(form, design):
    whole = form @ np.linalg.inv(design.scatter) @ form
    return float(form @ design.projected() @ form / whole) if whole > 0 else 0.0


def declared_part(rng, design):
    return design.x @ (rng.normal(size=design.x.shape[1]) * 3)


def masked_outliers_table(rng, design, size):
    """Two or three wrong values, each of that size for who leaves the others out: together they hide each other."""
    rows = rng.choice(design.n, int(rng.integers(2, 4)), replace=False)
    a = design.projected()
    own = np.diag(np.linalg.inv(a[np.ix_(rows, rows)]))  # squared standard error of each beside the others
    form = np.zeros(design.n)
    form[rows] = size * np.sqrt(own) * rng.choice([-1, 1], len(rows))
    return Truth([], form, rows=rows.tolist()), declared_part(rng, design) + form + of_scatter(rng, design)


def oracle_z(truth, design, y):
    """Size as the oracle estimates it from this table: the true size on average, with a standard deviation of 1."""
    if truth.form is None:
        return ""
    a = design.projected()
    return float(truth.form @ a @ y / math.sqrt(truth.form @ a @ truth.form))


def of_scatter(rng, design, scatter=None):
    root = np.linalg.cholesky(design.scatter if scatter is None else scatter)
    return root @ rng.normal(size=design.n)


def mean_table(rng, design, kind, size):
    for _ in range(200):
        truth = MEANS[kind](rng, design)
        left = retained(truth.form, design)
        if left >= RETAINED_LEAST or kind == "outlier":
            break
    else:
        return None
    amplitude = size / math.sqrt(truth.form @ design.projected() @ truth.form) * rng.choice([-1, 1])
    truth.form = amplitude * truth.form
    return truth, declared_part(rng, design) + truth.form + of_scatter(rng, design)


def exchanged_table(rng, design, size):
    """Two responses of different settings changed places; the model's own effects are made so large that
    the exchange has the size asked for."""
    if design.name == "lot":
        design.model, design.x = "1 + bump", np.column_stack([np.ones(design.n), design.columns["bump"] - 5])
    elif design.x.shape[1] == 1:
        wander = design.columns["ambient_C"]
        design.model, design.x = "1 + ambient_C", np.column_stack([np.ones(design.n), wander - wander.mean()])
    base = design.x @ rng.normal(size=design.x.shape[1])
    noise = of_scatter(rng, design)
    gap = np.abs(base[:, None] - base[None, :])
    wide = np.argwhere(np.triu(gap > 0.6 * gap.max()))
    i, k = (int(v) for v in wide[rng.integers(len(wide))])
    form = np.zeros(design.n)
    form[i], form[k] = 1, -1
    unit = math.sqrt(form @ design.projected() @ form)
    grow = size / unit / abs(base[k] - base[i])
    y = grow * base + noise
    y[i], y[k] = y[k], y[i]
    return Truth([("table.exchanged_runs", [])], form * (y[i] - y[k]) / 2, rows=[i, k]), y


def log_ratio(scatter, design):
    """sqrt(2 E log likelihood ratio) of that covariance against the design's own, up to its scale, both
    in what the declared columns leave."""
    q = np.linalg.svd(design.x, full_matrices=True)[0][:, design.x.shape[1]:]
    null, true = q.T @ design.scatter @ q, q.T @ scatter @ q
    m = len(null)
    both = np.linalg.solve(null, true)
    value = m * math.log(np.trace(both) / m) - np.linalg.slogdet(both)[1]
    return math.sqrt(max(value, 0.0))


def ar1(design, rho):
    """Correlation along the order, of the readings or of the bumps of a foil, beside a group's level."""
    x = design.columns[design.order[0]]
    far = np.abs(x[:, None] - x[None, :])
    own = rho**far
    if design.name == "lot":
        same = design.labels[:, None] == design.labels[None, :]
        return np.where(same, own, 0.0) + design.scatter - np.eye(design.n)
    return own + design.scatter - np.eye(design.n)


def uneven(design, logs):
    sd = np.exp(logs - logs.mean())
    sd /= math.sqrt(np.mean(sd**2))
    return np.diag(sd**2) + design.scatter - np.eye(design.n)


def scatter_table(rng, design, kind, size):
    if kind == "spread":
        c = pick(rng, SPREAD, design)
        numbers = c in design.columns
        logs = centred(design.columns[c]) if numbers else by_level(rng, design.words[c])
        make, top = (lambda s: uneven(design, s * logs)), 3.0
        truth = Truth([("table.spread", [c])])
    else:
        make, top = (lambda rho: ar1(design, rho)), 0.995
        truth = Truth([("table.serial_correlation", [])], anywhere=None)
    if log_ratio(make(top), design) < size:
        return None  # no such table is that far from white
    strength = optimize.brentq(lambda s: log_ratio(make(s), design) - size, 1e-4, top)
    truth.strength = strength
    return truth, declared_part(rng, design) + of_scatter(rng, design, make(strength))


def effect_table(name, kind, size, seed, index):
    """(design, truth, response), or None where the design has no such effect at that size."""
    rng = np.random.default_rng([seed, index, zlib.crc32(f"{name} {kind} {size}".encode())])
    design = DESIGNS[name](rng)
    if kind == "exchanged_runs":
        made = exchanged_table(rng, design, size)
    elif kind == "masked_outliers":
        made = masked_outliers_table(rng, design, size)
    elif kind in SCATTERS:
        made = scatter_table(rng, design, kind, size)
    else:
        made = mean_table(rng, design, kind, size)
    return (design, *made) if made else None


def clean_table(name, kind, seed, index):
    """(design, response) of a table that lacks nothing, or only what its noise is said to be."""
    rng = np.random.default_rng([seed, index, zlib.crc32(f"{name} clean {kind}".encode())])
    design = DESIGNS[name](rng, grouped=kind == "group_levels" or name == "lot")
    n = design.n
    level = of_scatter(rng, design, design.scatter - np.eye(n) + 1e-9 * np.eye(n)) if design.group else 0
    if kind == "t4":
        e = rng.standard_t(4, n) / math.sqrt(2)
    elif kind == "t3":
        e = rng.standard_t(3, n) / math.sqrt(3)
    elif kind == "laplace":
        e = rng.laplace(size=n) / math.sqrt(2)
    elif kind == "unequal_spread":
        c = pick(rng, SPREAD, design)
        logs = centred(design.columns[c]) if c in design.columns else by_level(rng, design.words[c])
        e = np.linalg.cholesky(uneven(design, 0.6 * logs) - design.scatter + np.eye(n)) @ rng.normal(size=n)
    elif kind == "correlated":
        rho = rng.uniform(0.3, 0.8)
        e = np.linalg.cholesky(ar1(design, rho) - design.scatter + np.eye(n)) @ rng.normal(size=n)
    else:
        e = rng.normal(size=n)
    return design, declared_part(rng, design) + level + e
