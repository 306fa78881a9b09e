#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A gauge of known width beside the part: found, measured as the part is, and every edge moved to the level that it
# tells, whatever the tone curve; one that is missing, spoiled or contradicted is told.
#   test_gauges.sh PROGRAM
. tests/support/cli.sh

cat >draw.py <<'P'
import json
import math
import os
import subprocess
import sys

program, renderer = sys.argv[1:3]
LONG = bool(os.environ.get("FOILGAUGE_TEST_LONG"))
BRIEF = not LONG and bool(os.environ.get("FOILGAUGE_TEST_BRIEF"))
CURVE = [[0, 0], [60, 110], [128, 190], [255, 255]]
S = [[0, 0], [64, 20], [128, 128], [192, 236], [255, 255]]


def leaf(thickness=0.1, radius=2000, length=12, top=18, x=24, turn=0):
    direction = math.radians(-90 + turn)
    centre = [x - radius * math.cos(direction), top - radius * math.sin(direction)]
    design = {"form": "arc", "overall_radius_mm": radius, "subtended_angle_deg": math.degrees(length / radius),
              "thickness_mm": thickness}
    return {"design": design, "rotate_deg": -90 + turn, "centre_mm": centre}


FOIL = {"design": {"bump_count": 4}, "centre_mm": [24, 30], "rotate_deg": -90, "radius_springback": {"mean": 0.02, "sd": 0.006}}
WIDE = dict(FOIL, design={"bump_count": 9})
ARC = {"design": {"form": "arc", "overall_radius_mm": 20.73, "subtended_angle_deg": 110, "thickness_mm": 0.1},
       "centre_mm": [24, 30], "rotate_deg": -90}


def scan(name, foils, discs=(), dpi=2400, light=True, curve=None, options=(), blur=1.0, gamma=1):
    scanner = {"dpi": dpi, "background": 31 if light else 205, "contrast": 168 if light else -170, "blur_px": blur, "noise": 1.2}
    if curve:
        scanner["tone_curve"] = curve
    if gamma != 1:
        scanner["gamma"] = gamma
    spec = {"schema": "foilgauge/render/1", "seed": 3, "foils": foils, "discs": list(discs), "scanner": scanner}
    json.dump(spec, open(name + ".json", "w"))
    subprocess.run([renderer, "render", name + ".json", "-o", name + ".png"], check=True)
    run = subprocess.run([program, "measure", name + ".png", "-o", name + ".out", "--html", name + ".html", *options],
                         capture_output=True, text=True)
    report = json.load(open(name + ".out"))
    report["said"], report["code"] = run.stderr, run.returncode
    return report


def pin(diameter, x=24, y=22, hole=False):
    return {"centre_mm": [x, y], "radius_mm": diameter / 2, "hole": hole}


def right(name, report, foil=0, mm=0.1):
    foil = report["foils"][foil]
    off, u = foil["thickness_mm"] - mm, foil["u_thickness_mm"]
    assert abs(off) < 2 * u, (name, off, u)
    return off, u


LEAF = ["--gauge", "leaf:0.1:0.0005"]
P
cat >curves.py <<'P'
from draw import *

USUAL = [(2400, True, "curve")] if BRIEF else [(2400, False, "s")]
for dpi in 2400, 4800:
    for light in True, False:
        for kind, curve in ("plain", None), ("curve", CURVE), ("s", S):
            if not LONG and (dpi, light, kind) not in USUAL:
                continue
            name = f"{kind}{dpi}{light}"
            report = scan(name, [FOIL, leaf()], dpi=dpi, light=light, curve=curve, options=LEAF)
            gauge, = report["gauges"]
            assert gauge["found"] and gauge["used"] and report["specks"] == 0 and len(report["foils"]) == 1, (name, gauge)
            assert report["picture"]["level"] is not None
            off, u = right(name, report)
            assert abs(off) < 0.0005 and u < (0.0018 if curve else 0.0006), (name, off, u)
            assert scan(name, [FOIL], dpi=dpi, light=light, curve=curve)["foils"][0]["u_thickness_mm"] > 3 * u, name
P
checks curves.py "$program" "$renderer" || fail "a leaf beside the foil"
checks - "$program" "$renderer" <<'P' || fail "gauges of other sizes, places and kinds"
from draw import *
LEVEL = {"curve": CURVE}
for name, foils, discs, gauges in (
        ("short", [FOIL, leaf(length=5)], [], ["leaf:0.1:0.0005"]),
        ("long", [FOIL, leaf(length=36, top=26)], [], ["leaf:0.1:0.0005"]),
        ("bent", [FOIL, leaf(radius=30)], [], ["leaf:0.1:0.0005"]),
        ("turned", [FOIL, leaf(turn=30, top=22)], [], ["leaf:0.1:0.0005"]),
        ("thin", [FOIL, leaf(0.05)], [], ["leaf:0.05:0.0005"]),
        ("thick", [FOIL, leaf(0.5)], [], ["leaf:0.5:0.0005"]),
        ("two", [FOIL, leaf(0.05), leaf(0.2, top=22)], [], ["leaf:0.2:0.0005", "leaf:0.05:0.0005"]),
        ("pin", [FOIL], [pin(1)], ["pin:1:0.0005"]),
        ("large", [FOIL], [pin(5)], ["pin:5:0.0005"]),
        ("ring", [FOIL], [pin(5), pin(3, hole=True)], ["ring:3:0.0005"]),
        ("pin_leaf", [FOIL, leaf()], [pin(1, y=24)], ["pin:1:0.0005", "leaf:0.1:0.0005"])):
    if not LONG and name in ("long", "turned", "thin", "thick", "large", "pin", "pin_leaf") or BRIEF and name != "ring":
        continue
    options = [word for gauge in gauges for word in ("--gauge", gauge)]
    report = scan(name, foils, discs, options=options, **LEVEL)
    assert all(gauge["used"] for gauge in report["gauges"]), (name, report["gauges"])
    assert len(report["foils"]) == 1 and not report.get("gauges_contradict"), name
    right(name, report)
# The border cuts the leaf; the foil is a plain arc.
open("arc.design", "w").write(json.dumps({"schema": "foilgauge/design/1", **ARC["design"]}))
if not BRIEF:
    report = scan("arc", [ARC, leaf(x=4.9, top=24)], options=[*LEAF, "--design", "arc.design"], **LEVEL)
    assert report["gauges"][0]["used"] and len(report["foils"]) == 1, report["gauges"]
    right("arc", report)
# One leaf where two are stated: the note says that it is taken.
report = scan("twice", [ARC, leaf(x=4.9, top=24)], options=[*LEAF, *LEAF, "--design", "arc.design"], **LEVEL)
notes = [gauge["note"] for gauge in report["gauges"] if not gauge["found"]]
assert len(notes) == 1 and notes[0].endswith(", and is taken for another stated gauge"), notes
# A ring's hole and the ring itself are found wherever they lie.
for step in range(8) if LONG else () if BRIEF else (5,):
    y = 22 - 0.1 * step
    report = scan("place", [FOIL], [pin(4, y=y), pin(1.6, y=y, hole=True)], options=["--gauge", "hole:1.6:0.0005", "--gauge", "pin:4:0.0005"])
    for gauge in report["gauges"]:
        assert gauge["used"] and abs(gauge["measured_mm"] - gauge["width_mm"]) < 0.0003, (step, gauge)
    assert len(report["foils"]) == 1 and report["specks"] == 0, step
# Scans of discs: the gauges are among them.
open("discs.design", "w").write(json.dumps({"schema": "foilgauge/design/1", "form": "discs",
    "gauges": [{"kind": "pin", "width_mm": 1, "u_mm": 0.0003}, {"kind": "pin", "width_mm": 4, "u_mm": 0.0003}]}))
report = scan("discs", [], [pin(1, 5, 5), pin(4, 12, 5), pin(2, 18, 5), pin(6, 10, 12), pin(3, 10, 12, hole=True)],
              options=["--design", "discs.design"], **LEVEL)
assert all(gauge["used"] for gauge in report["gauges"]), report["gauges"]
for disc in report["discs"]:
    true = round(disc["diameter_mm"])
    assert abs(disc["diameter_mm"] - true) < 2 * disc["u_diameter_mm"] and abs(disc["diameter_mm"] - true) < 0.0015, disc["diameter_mm"]
P
expect 65 'a leaf of 100 mm: is it in mm' "$program" measure none.png --gauge leaf:100:0.5
checks - "$program" "$renderer" <<'P' || fail "gauges that tell nothing"
from draw import *
plain = scan("alone", [FOIL])["foils"][0]["thickness_mm"]
missing = scan("missing", [FOIL], options=LEAF)
assert not missing["gauges"][0]["found"] and "no straight strip" in missing["gauges"][0]["note"]
assert missing["foils"][0]["thickness_mm"] == plain and "0 of 1 stated gauges found, 0 used (no straight strip lies in the scan): widths keep" in missing["said"]
assert "NOT FOUND" in open("missing.html").read()
other = scan("other", [FOIL, leaf(0.15)], options=LEAF)
assert not other["gauges"][0]["found"] and "reads 0.15" in other["gauges"][0]["note"] and other["specks"] == 1
assert len(other["foils"]) == 1 and abs(other["foils"][0]["thickness_mm"] - plain) < 1e-4
# A gauge lies on the foil: neither is mistaken for the other.
touch = scan("touch", [WIDE, leaf(top=18, x=2)], options=LEAF)
assert not touch["gauges"][0]["used"], touch["gauges"]
# A wrong stated width: revealed by the tone curve that it would demand, and by a second gauge.
wrong = scan("wrong", [FOIL, leaf(0.12)], options=LEAF)
assert "check that the stated width" in wrong["gauges"][0]["note"] or not wrong["gauges"][0]["used"], wrong["gauges"]
two = scan("contradict", [FOIL, leaf(0.1), leaf(0.21, top=22)], options=[*LEAF, "--gauge", "leaf:0.2:0.0005"])
assert two["gauges_contradict"] and "contradict" in two["said"] and "contradict" in open("contradict.html").read()
right("contradict", two)
P
# A plate of known diameters tells the level, apart from the scanner's scale, for scans of the same settings.
checks - "$program" "$renderer" <<'P' || fail "the level in a scanner's model"
from draw import *
PINS = [(2.4, 2.6, 2), (10, 3.5, 3), (20, 4.6, 4), (32, 5.1, 5), (4.2, 15, 2.5), (14.4, 16.1, 5.5), (40, 24, 6)]
open("plate.design", "w").write(json.dumps({"schema": "foilgauge/design/1", "form": "discs", "u_diameters_mm": 0.0004,
                                            "diameters_mm": [pin[2] for pin in PINS]}))
models = {}
for name, curve, scale in ("straight", None, 0), ("curved", CURVE, 0.001):
    scanner = {"dpi": 2400, "background": 31, "contrast": 168, "blur_px": 1.0, "noise": 1.2}
    if curve:
        scanner["tone_curve"] = curve
    effects = [{"id": "scan.scale_y", "value": scale}] if scale else []
    json.dump({"schema": "foilgauge/render/1", "seed": 5, "discs": [pin(d, x, y) for x, y, d in PINS], "effects": effects,
               "scanner": scanner}, open("plate.json", "w"))
    subprocess.run([renderer, "render", "plate.json", "-o", "plate.png"], check=True)
    subprocess.run([program, "loop", "plate.png", "--design", "plate.design", "--model-out", name + ".model", "-o", "loop.out"],
                   check=True, capture_output=True)
    models[name] = json.load(open(name + ".model"))
    assert models[name]["tone"]["gauges"] == 7, models[name]["tone"]
tone = models["curved"]["tone"]
assert abs(models["straight"]["tone"]["level"] - 0.5) < 0.005 and abs(tone["level"] - 0.696) < 2 * tone["u_level"] < 0.04, tone
# A scale of both axes, which the gauges do not show, is 0 and as uncertain as they leave it: 18 mm from the middle.
fields = {field["id"]: field for field in models["curved"]["fields"]}
assert set(fields) == {"scan.scale_y", "scan.scale"} and fields["scan.scale"]["amplitude_mm"] == [0], fields
assert 0.0005 < fields["scan.scale"]["u_amplitude_mm"][0] < 0.02, fields
free = dict(models["curved"], fields=[])  # the foils below are scanned without its scale
json.dump(free, open("free.model", "w"))
report = scan("by_model", [WIDE], curve=CURVE, options=["--model", "free.model"])
off, u = right("by_model", report)
assert u < 0.002 and abs(off) < 0.0005 and "tone_note" not in report, (off, u)
# Other settings than the plate's: it is not applied, and that is said.
for name, options in ("linear", {}), ("blurred", {"curve": CURVE, "blur": 1.7}):
    with_it = scan(name, [FOIL], options=["--model", "free.model"], **options)
    assert "not applied" in with_it["tone_note"] and "not applied" in with_it["said"], name
    assert "not applied" in open(name + ".html").read(), name
    assert with_it["foils"][0]["u_thickness_mm"] > 0.003, name
# The edges of a scan reveal a changed exponent as far as they can; u covers the rest.
for gamma in (0.8, 0.97, 1, 1.03, 1.1, 1.3) if LONG else (0.8,) if BRIEF else (0.8, 1):
    other = scan("exponent", [WIDE], gamma=gamma, options=["--model", "straight.model"])
    off, u = right(f"gamma {gamma}", other)
    assert ("tone_note" in other) == (not 0.96 < gamma < 1.04) or gamma in (0.97, 1.03), (gamma, off, u)
    assert u < 0.0012 if gamma == 1 else "tone_note" not in other or u > 0.003, (gamma, u)
# Steep tone curve: diameters tell a scale no better than their own u and the edges' level allow.
# Spoiled picture: said, and no model of it.
for name, more in (("steep", {"gamma": 2.2}), ("cut", {"tone_curve": [[0, 0], [150, 255], [255, 255]]}),
                   ("shadow", {"shadow": {"amplitude": 0.2, "direction_deg": 100, "length_px": 8, "gap_px": 2}})):
    if not LONG and name == "cut" or BRIEF and name == "steep":
        continue
    scanner = {"dpi": 2400, "background": 31, "contrast": 168, "blur_px": 1.2, "noise": 1, **more}
    json.dump({"schema": "foilgauge/render/1", "seed": 3, "discs": [pin(d, x, y) for x, y, d in PINS], "scanner": scanner},
              open("plate.json", "w"))
    subprocess.run([renderer, "render", "plate.json", "-o", "plate.png"], check=True)
    run = subprocess.run([program, "loop", "plate.png", "--design", "plate.design", "--model-out", name + ".model"],
                         capture_output=True, text=True)
    if name == "steep":
        assert run.returncode == 0, run.stderr
        for field in json.load(open("steep.model"))["fields"]:
            assert field["id"] == "scan.scale" and abs(field["amplitude_mm"][0]) < 2 * field["u_amplitude_mm"][0], field
    else:
        assert run.returncode == 65 and "state of the picture" in run.stderr and "no model is written" in run.stderr, run.stderr
        assert not os.path.exists(name + ".model"), name
# The level of JPEGs goes to JPEGs alone.
for findings in [], ["block_noise"]:
    other = dict(models["straight"], fields=[], tone=dict(models["straight"]["tone"], findings=findings))
    json.dump(other, open("lossy.model", "w"))
    note = scan("lossless", [FOIL], options=["--model", "lossy.model"]).get("tone_note", "")
    assert ("compressed with loss" in note) == bool(findings), (findings, note)
# A gauge on the glass goes before the model; a model without tone is as it was.
both = scan("both", [FOIL, leaf()], curve=CURVE, options=["--model", "free.model", *LEAF])
assert both["gauges"][0]["used"] and "tone_note" not in both
right("both", both)
old = dict(free)
del old["tone"]
json.dump(old, open("old.model", "w"))
assert "tone_note" not in scan("old", [FOIL], options=["--model", "old.model"])
for wrong in {"level": 2}, {"u_level": None}, {"gauges": 0}, {"blur_px": "x"}, {"shown_level": 2}, {"findings": ["dust"]}:
    json.dump(dict(free, tone=dict(free["tone"], **wrong)), open("bad.model", "w"))
    run = subprocess.run([program, "measure", "by_model.png", "--model", "bad.model", "-o", "never.out"], capture_output=True, text=True)
    assert run.returncode == 65 and "tone." in run.stderr, (wrong, run.stderr)
P
for bad in leaf leaf:0.1 leaf:x:0.1 leaf:0.1:0.0005:1 wire:0.1:0.0005 leaf:0.1:nan ""; do
  expect 64 "KIND:WIDTH:U" "$program" measure alone.png --gauge "$bad"
done
expect 65 "at most a tenth" "$program" measure alone.png --gauge leaf:0.1:0.05
expect 65 "no width is known exactly" "$program" measure alone.png --gauge leaf:0.1:0
expect 65 "must be from" "$program" measure alone.png --gauge leaf:-0.1:0.0005
design() { echo "{\"schema\": \"foilgauge/design/1\", \"gauges\": $1}" >bad.design; }
while IFS='|' read -r gauges words; do
  design "$gauges"
  expect 65 "$words" "$program" measure alone.png --design bad.design
done <<'T'
{}|must be an array
[1]|must be an object
[{"kind": "wire", "width_mm": 0.1, "u_mm": 0.001}]|must be "leaf"
[{"kind": "leaf", "width_mm": 0.1}]|u_mm is missing
[{"kind": "leaf", "width_mm": 0.1, "u_mm": 0.001, "x": 1}]|is not known
[{"kind": "leaf", "width_mm": 0.1, "width_mm": 0.1, "u_mm": 0.001}]|given twice
[{"kind": "leaf", "width_mm": 1000, "u_mm": 0.001}]|must be from
[{"kind": "leaf", "width_mm": 0.1, "u_mm": -1}]|no width is known exactly
T
exit $failed
