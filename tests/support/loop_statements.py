# SPDX-License-Identifier: GPL-3.0-or-later
"""Every statement of the loop's JSON stands on its page and in its text: verdict, claims, class, advice, rejected
candidates, curves, notes, errors. Arguments: report.json page.html text.txt"""
import html, json, math, re, sys

report = json.load(open(sys.argv[1]))
page = html.unescape(open(sys.argv[2], encoding="utf-8").read())
text = open(sys.argv[3], encoding="utf-8").read()
missing = []


def page_says(words, what):
    if words not in page: missing.append(f"page: {what}: {words}")


def text_says(words, what):
    if words not in text: missing.append(f"text: {what}: {words}")


def both(words, what):
    page_says(words, what)
    text_says(words, what)


def error_says(title, before, after):
    page_says(f"<td>{title}</td><td>{length(before)}</td><td>{length(after)}</td>", "error")
    if not re.search(rf"(?m)^{re.escape(title)} +{before:.4g} +{after:.4g}$", text): missing.append(f"text: error: {title}")


def length(um):
    return f"{1000 * um:.3g} nm" if abs(um) < 1e-3 and um else f"{um:.3g} µm"


def tag(effect, verdict, what, response=None):
    """A row of a table of candidates."""
    name = "bump radius" if response == "bump_radius_mm" else "bump angle" if response else ""
    row = re.escape(name) + r"<i>" + re.escape(effect) + r'</i></td><td class="w"><span class="tag \w+">' + re.escape(verdict) + "<"
    if not re.search(row, page): missing.append(f"page: {what}: {effect} {verdict} {name}")


page_says(f">{report['verdict']}<", "verdict")
if not text.startswith(report["verdict"] + ":"): missing.append("text: verdict")
for claim in report["claims"]:
    tag(claim["id"], claim["verdict"], "claim", claim.get("response"))
    text_says(f"  {claim['verdict']:5s} {claim['id']}", "claim")
    for member in claim.get("alias_class", []) if claim["level"] == "points" else []:
        page_says(f"<code>{member}</code>", "class")
        text_says(f"\n  {member}\n", "class")
for one in report["rejected"]:
    tag(one["id"], one["verdict"], "not claimed", one.get("response"))
    text_says(f"  {one['verdict']}: {one['id']}" + (f" of {one['response']}" if "response" in one else ""), "not claimed")
    if one.get("not_confirmed"): both("not confirmed from disc to disc", "not confirmed")
for advice in report["separating_measurement"]:
    both(advice, "advice")
if "To tell" in page and not report["separating_measurement"]: missing.append("page: advice that the JSON has not")
if "To tell" in text and not report["separating_measurement"]: missing.append("text: advice that the JSON has not")
for note in report["notes"]:
    both(note, "note")
if report["unattributed"] and report["unattributed"]["coordinate"] != "bump.index":
    for curve in [report["unattributed"]] + report["unattributed"]["others"]:
        text_says(f"unattributed, over {curve['coordinate']}", "curve")
        page_says(">unattributed<", "curve")
for name, title in (("rms", "rms"), ("robust_sd", "robust sd"), ("p95", "95th percentile"), ("maximum", "maximum")):
    before, after = report["before"][name], report["after"][name]
    if before is None: continue
    error_says(title, before, after)
ratio = report["error_ratio"]
aside = any(scan["hold_out"] for scan in report["inputs"])
if aside or ratio["folds"]:
    title = "scans kept aside" if aside else f"{ratio['fold_of']} that took no part in the fit"
    before, after = report["before"]["held_out_rms"], report["after"]["held_out_rms"]
    error_says(title, before, after)
if "half_width" in report["before"]:
    before, after = (report[side]["half_width"]["rms"] for side in ("before", "after"))
    error_says("half the width, rms", before, after)
if missing: print("\n".join(missing))
sys.exit(bool(missing))
