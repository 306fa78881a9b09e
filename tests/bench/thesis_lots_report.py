# SPDX-License-Identifier: GPL-3.0-or-later
"""thesis_lots_report.py FOLDER OUT: the thesis's two lots over each other (figure 5.22) beside its printed figures: lots.md, lots.svg."""

import json
import pathlib
import re
import statistics
import sys

# Chapter 5, figures 5.11 and 5.22 and their text; the sinusoidal lot's mode is not printed, the classical one's relative s neither.
THESIS = {
    "classical": {"mean": 1.05, "mode": 1.02, "min": 0.95, "max": 1.30},
    "sinusoidal": {"mean": 1.0096, "relative_sd_pct": 1.7, "min": 0.95, "max": 1.068},
}
DESIGN_RADIUS_MM = {"classical": 3.32, "sinusoidal": 3.2}
WORDS = {"mean": "mean", "mode": "mode", "relative_sd_pct": "relative s, %", "min": "least", "max": "most"}
# The rules of the page's style sheet for the figure, for the figure alone.
STYLE = (
    "text{font:14px sans-serif;fill:#16202a}path{fill:none}.x,.title{text-anchor:middle}.y{text-anchor:end}.title,.key,.soft{fill:#5b6875}"
    ".grid{stroke:#e6eaee}.zero{stroke:#8a96a1}.hypothesis{stroke:#5b6875;stroke-width:2;stroke-dasharray:7 5}"
)


def truth_of(folder, design_mm):
    radii = [bump["radius_mm"] / design_mm for path in sorted(pathlib.Path(folder).glob("foil*.truth"))
             for bump in json.loads(path.read_text(encoding="utf-8"))["bumps"]]
    mean = statistics.fmean(radii)
    return {"mean": mean, "relative_sd_pct": 100 * statistics.stdev(radii) / mean, "min": min(radii), "max": max(radii)}


def figure_of(page):
    svg = re.search(r'<svg class="plot".*?</svg>', page, re.S).group(0)
    return svg.replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" style="background:#fff" ', 1).replace(
        ">", f"><style>{STYLE}</style>", 1)


TEXT = """# The thesis's lots over each other (figure 5.22)

A classical lot, 14 foils of 9 bumps (thesis_lot.py: figure 5.11's distribution), and a sinusoidal one, 6 foils of 9 bumps
(thesis_lots.py: figure 5.22's), rendered at {dpi} dpi, measured, and put on one page by `foilgauge lot --index`.
`tests/bench/thesis_lots.sh` makes this page, the figure, [the page of the lots](lots.html) and lots.json.

![Densities of R / R_D of the two lots](lots.svg)

| lot | normalised bump radius | thesis | measured here | as rendered |
|---|---|---|---|---|
{rows}

The program's words on these two lots:

{words}

## What agrees, and what does not

The distributions are inputs: what comes back says that rendering, measuring, the lots' reports and the page over them are right. Means, spreads and ranges do, to {worst:.1e}
of the design's radius. The classical **mode** of a kernel density lies somewhat above that of the distribution, because the kernel smooths a skewed peak.
The small humps of the sinusoidal lot are its two ends: 0.95 and 1.068 lie 3.4 standard deviations from the mean, where 54 bumps of a normal distribution have none.
The thesis prints neither radius nor angle of the sinusoidal die, nor does it say how its foils scatter beside their bumps: R_D = 3.2 mm and 60° are ours, and all bumps of a lot are drawn
alike. So the difference of the means, {difference}, is the thesis's, its interval is not. That die and lot cannot be told apart here the page says itself. The lots' designs differ, so lengths and angles are over
each design's. Dates are those of the rendered files, as the script sets them.
"""


def main(folder, out, dpi):
    folder, out = pathlib.Path(folder), pathlib.Path(out)
    index = json.loads((out / "lots.json").read_text(encoding="utf-8"))
    rows, worst = [], 0
    for lot in index["lots"]:
        name = lot["folder"].split("-")[0]
        ours, truth = lot["radius_over_design"], truth_of(folder / name, DESIGN_RADIUS_MM[name])
        worst = max(worst, *(abs(ours[key] - truth[key]) for key in ("mean", "min", "max")))
        for key, words in WORDS.items():
            show = lambda values: f"{values[key]:.4f}" if key in values else ""
            rows.append(f"| {name} | {words} | {THESIS[name].get(key, '')} | {show(ours)} | {show(truth)} |")
    pair = next(p for p in index["comparisons"]["pairs"] if p["quantity"] == "radius_mm")
    (out / "lots.md").write_text(TEXT.format(
        dpi=dpi, rows="\n".join(rows), words="\n".join("- " + line for line in index["summary"]), worst=worst,
        difference=f"{pair['difference']:.4f} of R_D"), encoding="utf-8")
    (out / "lots.svg").write_text(figure_of((out / "lots.html").read_text(encoding="utf-8")) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
