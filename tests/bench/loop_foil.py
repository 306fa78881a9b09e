# SPDX-License-Identifier: GPL-3.0-or-later
"""A rendered foil's true midline, the measurand (least-squares circles through it as it is), and how far a measured
foil's circles lie from it."""

from dataclasses import dataclass

import numpy as np

# Of a bump's arc, where edges are measured; the rest runs into its fillets.
ARC_SHARE = 0.85
# Of an arc or land beside a fillet or a cut, where blur mixes the two.
MARGIN_MM = 0.03


def natural_spline(knots, at, period=0.0):
    """A natural cubic spline as the renderer draws it: constant beyond the knots; closed with a period."""
    x, y = np.array(knots, dtype=float).T
    at = np.asarray(at, dtype=float)
    if period:
        at = x[0] + np.mod(at - x[0], period)
        x, y = np.append(x, x[0] + period), np.append(y, y[0])
    h, slope = np.diff(x), np.diff(y) / np.diff(x)
    n = len(x)
    matrix, right = np.eye(n), np.zeros(n)
    for i in range(1, n - 1):
        matrix[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        right[i] = 6 * (slope[i] - slope[i - 1])
    if period:
        matrix[-1, 0] = -1
        matrix[0, 0], matrix[0, 1] = 2 * (h[0] + h[-1]), h[0]
        matrix[0, n - 2] += h[-1]
        right[0] = 6 * (slope[0] - slope[-1])
    bend = np.linalg.solve(matrix, right)
    at = np.clip(at, x[0], x[-1])
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, n - 2)
    b = (at - x[i]) / h[i]
    a = 1 - b
    cubic = (a**3 - a) * bend[i] + (b**3 - b) * bend[i + 1]
    return a * y[i] + b * y[i + 1] + cubic * h[i] ** 2 / 6


class Midline:
    """Points of the arcs and lands of one foil as a spec asks for it. Own frame: O at the origin, the
    middle along x, bump numbers along rising angle. Arrays, one entry per point: xy, normal (outwards
    from the arc's own centre), psi, u (bumps: -1 to 1 between the fillets; lands: NaN), bump (index
    from 0; lands: -1)."""

    def __init__(self, foil, design, step_mm=0.1, margin_mm=None):
        """margin_mm: arcs and lands are whole but for it at each end; None: arcs by ARC_SHARE."""
        self.count = design["bump_count"]
        overall, fillet = foil["overall_radius_mm"], design["fillet_radius_mm"]
        radius = np.array(foil["radius_mm"])
        half = np.radians(design["bump_angle_deg"]) * design["bump_radius_mm"] / radius / 2
        distance = radius * np.cos(half) + np.sqrt(overall**2 - (radius * np.sin(half)) ** 2)
        of, cf = overall - fillet, radius + fillet
        land = np.arccos((of**2 + distance**2 - cf**2) / (2 * of * distance))
        arc = np.arccos((distance**2 + cf**2 - of**2) / (2 * distance * cf))
        axis = (np.arange(self.count) - 0.5 * (self.count - 1)) * np.radians(design["pitch_deg"])
        self.overall, self.radius, self.distance, self.axis = overall, radius, distance, axis
        self.height = overall - (distance - radius)
        start = axis[0] - land[0] - foil["first_land_mm"] / overall
        end = axis[-1] + land[-1] + foil["last_land_mm"] / overall
        self.half_span, self.span = (end - start) / 2, (start, end)
        self.direction = np.radians(foil["rotate_deg"])
        self.mirror = -1.0 if foil.get("mirror") else 1.0
        pieces = []
        for i in range(self.count):
            n = max(5, int(2 * arc[i] * radius[i] / step_mm))
            u = np.linspace(-ARC_SHARE, ARC_SHARE, n)
            if margin_mm is not None:
                u = (1 - margin_mm / (arc[i] * radius[i])) * (2 * np.arange(n) + 1 - n) / n
            angle = axis[i] + np.pi - u * arc[i]
            normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            centre = distance[i] * np.array([np.cos(axis[i]), np.sin(axis[i])])
            pieces.append((centre + radius[i] * normal, normal, u, np.full(n, i)))
        edges = np.concatenate([[start], np.stack([axis - land, axis + land], axis=1).ravel(), [end]])
        for low, high in edges.reshape(-1, 2):
            n, margin = int((high - low) * overall / step_mm), (margin_mm or 0) / overall
            angle = np.linspace(low + margin, high - margin, n + 2)[1:-1]
            normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            pieces.append((overall * normal, normal, np.full(n, np.nan), np.full(n, -1)))
        self.xy, self.normal, self.u, self.bump = (np.concatenate(p) for p in zip(*pieces))
        self.psi = np.arctan2(self.xy[:, 1], self.xy[:, 0])

    def radial_share(self):
        radial = self.xy / np.linalg.norm(self.xy, axis=1, keepdims=True)
        return np.sum(radial * self.normal, axis=1)

    def part_shift_um(self, effects):
        """Shift by the spec's part effects, along the normal."""
        shift = np.zeros(len(self.xy))
        for e in effects:
            share = np.sign(self.radial_share()) if e.get("along") == "normal" else self.radial_share()
            if e["id"] == "part.ovality":
                wave = np.cos(2 * (self.psi - np.radians(e.get("phase_deg", 0))))
                shift += e["amplitude_um"] * wave * share
            elif e["id"] == "part.spiral":
                shift += e["amplitude_um"] * (self.psi / self.half_span) ** 3 * share
            elif e["id"] == "free.foil.s":
                shift += natural_spline(e["knots"], self.psi / self.half_span) * share
            elif self.on_bumps(e) is not None:
                shift += np.where(self.bump >= 0, self.on_bumps(e), 0)
        return shift

    def on_bumps(self, effect):
        u = np.nan_to_num(self.u)
        if effect["id"] == "part.bump_crown":
            return effect["amplitude_um"] * (1 - u * u) ** 2
        if effect["id"] == "part.bump_skew":
            return effect["amplitude_um"] * u * (1 - u * u) ** 2 * np.sqrt(5) * 25 / 16
        if effect["id"] == "free.bump.index":  # single bumps, at their middle
            number = self.bump + 1
            on = np.isin(number, effect["bumps"]) if "bumps" in effect else number >= effect.get("first", effect["every"])
            if "bumps" not in effect:
                on &= (number - effect.get("first", effect["every"])) % effect["every"] == 0
            return effect["amplitude_um"] * on * (1 - u * u) ** 2
        return natural_spline(effect["knots"], u) if effect["id"] == "free.bump.phi" else None

    def claimed_shift_um(self, report, sense):
        """The part's own deviation as a report describes it, along the normal: (sum, columns whose sign
        the report does not state). Effects move along the normal, or along the radius where the claim's
        form says so; a shape runs over [-1, 1] of the foil, or of the bump. sense: -1 where the report
        counts from the other end, as it may on a foil without a lip."""
        half = 0.5 * (self.axis[-1] - self.axis[0]) * (1 + 1 / self.count)
        u, on, psi = sense * np.nan_to_num(self.u), self.bump >= 0, sense * self.psi
        total, unsigned = np.zeros(len(self.xy)), []
        said = [(c["id"], c.get("form"), c["parameters"], c.get("shape")) for c in report["claims"]]
        curve = report["unattributed"]
        if curve and curve["coordinate"] in ("foil.s", "bump.phi", "bump.index"):
            form = "radial" if curve.get("moves") == "along the radius" else None
            said.append((curve["coordinate"], form, {}, curve.get("shape")))
        for name, form, p, shape in said:
            share = self.radial_share()
            share = share if form == "radial" else np.sign(share)
            if name == "part.ovality":
                total += p["amplitude_um"] * np.cos(2 * (psi - np.radians(p["phase_deg"]))) * share
            elif name == "part.spiral":
                total += p["amplitude_um"] * (psi / half) ** 3 * share
            elif name == "foil.s" and shape:
                middle, reach = 0.5 * (psi.max() + psi.min()), 0.5 * np.ptp(psi)
                total += np.interp((psi - middle) / reach, *np.array(shape).T) * share
            elif name == "bump.index" and shape and curve["moves"] == "along the normal":
                total += np.where(on, np.interp(self.along_bumps(sense), *np.array(shape).T), 0)
            elif name in ("bump.phi", "part.bump_crown", "part.bump_skew") and shape:
                total += np.where(on, np.interp(u, *np.array(shape).T), 0)
            elif name == "part.bump_crown":
                unsigned.append(np.where(on, p["amplitude_um"] * (35 * u**4 - 30 * u**2 + 3) / 8, 0))
            elif name == "part.bump_skew":
                unsigned.append(np.where(on, p["amplitude_um"] * (5 * u**3 - 3 * u) / 2, 0))
        return total, unsigned

    def along_bumps(self, sense):
        """As a report counts: a bump's number at its middle, nearly half a number to either end of its arc."""
        number = self.bump + 1 if sense > 0 else self.count - self.bump
        return number + 0.45 * sense * np.nan_to_num(self.u)

    def beside_circles(self, columns, left):
        """Residuals of a deviation from circles fitted to it: those of the bumps, of the lands, that are `left`."""
        columns = np.array(columns)
        for index in [i for i in range(self.count) if "bumps" in left] + [-1] * ("lands" in left):
            on = self.bump == index
            circle = np.column_stack([np.ones(on.sum()), self.normal[on]])
            columns[..., on] -= (circle @ np.linalg.lstsq(circle, columns[..., on].T, rcond=None)[0]).T
        return columns

    def to_scan(self, points):
        """Directions, or places about O, turned as the foil lies on the scan."""
        c, s = np.cos(self.direction), np.sin(self.direction)
        turned = points * [1, self.mirror]
        return turned @ np.array([[c, s], [-s, c]])


@dataclass
class Measurand:
    """Least-squares circles (ISO 12181) through bumps and lands as they are; form errors peak to valley."""

    overall: float
    radius: np.ndarray
    height: np.ndarray
    overall_form_um: float
    form_um: np.ndarray


def circle_through(points):
    """(centre, radius, peak-to-valley deviation in um): Gauss-Newton on orthogonal distances."""
    columns = np.column_stack([2 * points, np.ones(len(points))])
    x, y, c = np.linalg.lstsq(columns, np.sum(points**2, axis=1), rcond=None)[0]
    centre, radius = np.array([x, y]), float(np.sqrt(c + x * x + y * y))
    for _ in range(10):
        offset = points - centre
        far = np.linalg.norm(offset, axis=1)
        step = np.linalg.lstsq(np.column_stack([offset / far[:, None], np.ones(len(far))]), far - radius, rcond=None)[0]
        centre, radius = centre + step[:2], radius + step[2]
    return centre, float(radius), 1000 * float(np.ptp(np.linalg.norm(points - centre, axis=1)))


def measurand_of(foil, design, deviation_um):
    """deviation_um: midline to its shift along the normal."""
    midline = Midline(foil, design, 0.02, MARGIN_MM)
    points = midline.xy + midline.normal * (deviation_um(midline) / 1000)[:, None]
    centre, overall, form = circle_through(points[midline.bump == -1])
    bumps = [circle_through(points[midline.bump == i]) for i in range(midline.count)]
    radius = np.array([b[1] for b in bumps])
    height = overall - np.array([np.linalg.norm(b[0] - centre) for b in bumps]) + radius
    return Measurand(overall, radius, height, form, np.array([b[2] for b in bumps]))


def profile_error_um(midline, centre_mm, shift_um, foil, report):
    """rms distance of the true midline (its arcs moved by shift_um) from the circles of a measured foil
    and what a report (or None) claims to deviate from them; the foil's place and direction are left
    free. The circles hold what circles take of the deviation already."""
    normal = midline.to_scan(midline.normal)
    points = midline.to_scan(midline.xy) + centre_mm + normal * shift_um[:, None] / 1000
    distance = np.full(len(points), np.nan)
    own = {}
    for index in range(midline.count):
        true = midline.distance[index] * np.array([np.cos(midline.axis[index]), np.sin(midline.axis[index])])
        place = midline.to_scan(true[None])[0] + centre_mm
        own[index] = min(foil["bumps"], key=lambda b: np.hypot(*(np.array(b["centre_mm"]) - place)))
    own[-1] = foil["overall"]
    for index, circle in own.items():
        on = midline.bump == index
        distance[on] = np.linalg.norm(points[on] - circle["centre_mm"], axis=1) - circle["radius_mm"]
    offset = points - centre_mm
    turn = offset[:, 0] * normal[:, 1] - offset[:, 1] * normal[:, 0]
    rigid = np.stack([normal[:, 0], normal[:, 1], turn], axis=1)
    sense = 1 if own[0]["number"] <= own[midline.count - 1]["number"] else -1
    claimed, unsigned = 0, []
    if report:
        total, unsigned = midline.claimed_shift_um(report, sense)
        claimed, *unsigned = midline.beside_circles([total, *unsigned], ["bumps", "lands"])
    best = np.inf
    for signs in range(2 ** len(unsigned)):
        rest = distance * 1000 - claimed
        for k, column in enumerate(unsigned):
            rest = rest - (column if signs >> k & 1 else -column)
        rest = rest - rigid @ np.linalg.lstsq(rigid, rest, rcond=None)[0]
        best = min(best, float(np.sqrt(np.mean(rest**2))))
    return best
