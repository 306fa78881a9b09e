# SPDX-License-Identifier: GPL-3.0-or-later
"""Claims of a report of `foilgauge loop --table`, as names: shared by the benchmarks that judge it."""


def member(name):
    """(id, what stands in its brackets) of "table.linear(humidity_pct)"."""
    identity, _, rest = name.partition("(")
    inside = rest.rstrip(")")
    return identity, frozenset(part.strip() for part in inside.split(",") if part.strip())


def members(claim):
    """The names in a claim's class, its own first. Of lone values the rows stand in the brackets."""
    own = claim["name"]
    if claim["id"] in ("table.outlier", "table.exchanged_runs"):
        rows = sorted(int(v) for k, v in claim["parameters"].items() if "row" in k and v is not None)
        own = f"{claim['id']}({', '.join(str(r) for r in rows)})" if rows else own
    return [own] + [alias["name"] for alias in claim["alias_class"]]


def curve_over(report):
    """The coordinate of the unattributed curve, or "". """
    return (report["unattributed"] or {}).get("coordinate", "")


def classes(report):
    """Of every claim the names in its class; a curve is a class of one."""
    curve = curve_over(report)
    return [members(c) for c in report["claims"]] + ([[f"unattributed({curve})"]] if curve else [])
