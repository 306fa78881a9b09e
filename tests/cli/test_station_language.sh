#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pages in English and German: every text of every page has its words, no page mixes them, names stay as they are, numbers,
# dates and CSV have the language's form; the browser chooses, and the recipe before it.
# Usage: test_station_language.sh PROGRAM
name=test_station_language
. "$(dirname "$0")/../support/station.sh"
# A place that a sentence names twice would have one value at both.
! grep -nE '^msgid.*(\{[a-z0-9]+\}).*\1' "$(dirname "$0")/../../src/language/"*.po || fail "a place of a sentence is there twice"
missing=$(dirname "$program")/tests/missing_words
[ -x "$missing" ] || fail "missing_words is not built beside $program"
mkdir "$work/scans" "$work/pages"
radius() { # SEED RADIUS FILE
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200},
    "foils": [{"rotate_deg": -90, "design": {"bump_count": 2, "bump_radius_mm": %s}}]}' "$1" "$2" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$3"
}
radius 1 3.32 "$work/1.png"
radius 2 3.4 "$work/2.png"
printf '{"schema": "foilgauge/render/1", "seed": 3, "scanner": {"dpi": 300}, "foils": [{"rotate_deg": -90,
  "design": {"bump_count": 2}, "crushed": [{"bump": 2, "height_factor": 0.4}]}]}' >"$work/spec.json"
"$renderer" render "$work/spec.json" -o "$work/3.png"
printf '{"schema": "foilgauge/render/1", "seed": 4, "scanner": {"dpi": 1200}, "foils": [{"rotate_deg": -90, "design": {"bump_count": 1}}]}' >"$work/spec.json"
"$renderer" render "$work/spec.json" -o "$work/4.png"
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1",
 "station": {"file_name": "{lot}_{serial}", "receive_s": 0.4, "reasons": "S1 scratch"},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2, "calibration": "not needed: Renderer",
            "tolerances": {"radius_mm": {"min": 3.3, "max": 3.34}, "height_mm": {"max": 3}}}}
R
draw_more() { # NAME SPEC
  echo "{\"schema\": \"foilgauge/render/1\", \"seed\": 5, $2}" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$work/$1.png" || fail "render $1"
}
foil='"foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]'
draw_more colour "\"scanner\": {\"dpi\": 1200, \"colour_lines\": {\"gap_px\": [4, 0, -4], \"dx_px\": [0.3, 0, -0.2]}}, $foil"
draw_more board '"scanner": {"dpi": 1200}, "grids": [{"marks": "dots", "centre_mm": [10, 10], "pitch_mm": 2.5, "columns": 7, "rows": 7, "mark_mm": 1}]'
echo '{"schema": "foilgauge/design/1", "form": "grid", "marks": "dots", "pitch_mm": 2.5, "u_pitch_mm": 0.0025}' >"$work/board.json"
"$program" loop "$work/board.png" --design "$work/board.json" --scanner left -o "$work/board.out" --model-out "$work/model.json" || fail "a model"
"$program" measure "$work/colour.png" --html "$work/colour.html" -o "$work/out.json" 2>"$work/said" || fail "colour: $(cat "$work/said")"
"$program" measure "$work/1.png" --gauge leaf:0.1:0.0005 --html "$work/gauge.html" -o "$work/out.json" 2>"$work/said" || fail "gauge: $(cat "$work/said")"
"$program" measure "$work/1.png" --model "$work/model.json" --html "$work/model.html" -o "$work/out.json" 2>"$work/said" || fail "model: $(cat "$work/said")"
"$renderer" render "$(dirname "$0")/../../samples/render/cantilever.json" -o "$work/beams.png" || fail "render beams"
"$program" measure "$work/beams.png" --design "$(dirname "$0")/../../samples/cantilever_design.json" --html "$work/beams.html" -o "$work/out.json" \
  2>"$work/said" || fail "beams: $(cat "$work/said")"
# Foils scanned again by two operators: a gauge study.
for foil in 6 7; do for scan in 0 1 2 3; do radius $foil$scan 3.3$foil "$work/g$foil$scan.png"; done; done
(echo scan,foil,operator; for foil in 6 7; do for scan in 0 1 2 3; do echo "g$foil$scan.png,$foil,$((scan / 2))"; done; done) >"$work/study.csv"
echo '{"schema": "foilgauge/design/1", "bump_count": 2, "calibration": "flatbed"}' >"$work/study.json"
"$program" lot "$work/study.csv" --design "$work/study.json" --pages none -o "$work/study" >"$work/said" 2>&1 || fail "study: $(cat "$work/said")"
grep -q 'Gauge repeatability' "$work/study/index.html" || fail "no gauge study"
"$program" lot "$work/1.png" "$work/2.png" --model "$work/model.json" --pages none -o "$work/lot" >"$work/said" 2>&1 || fail "lot: $(cat "$work/said")"
start "$work/scans" $recipe
checks - "$work" "$missing" >&2 <<'PY' || fail "languages"
import html, os, re, shutil, sqlite3, subprocess, sys, urllib.error, urllib.parse, urllib.request
work, missing = sys.argv[1:]
base = open(work + "/address").read().strip().rstrip("/")
kept = []
def ask(path, language="en", fields=None):
    data = urllib.parse.urlencode({"form": token, **fields}).encode() if fields else None
    try:
        with urllib.request.urlopen(urllib.request.Request(base + path, data, {"Accept-Language": language})) as answer:
            return answer.read().decode()
    except urllib.error.HTTPError as error:
        return error.read().decode()
token = ""
token = re.search('name="form" value="([0-9a-f]+)"', ask("/orders")).group(1)
# Words that no German text has.
ENGLISH = re.compile(r"\b(the|of|is|are|and|with|which|this|that|by|from|foils?|without|not|lot|scans again|found|open)\b")
def texts(page):
    page = re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S)
    page = re.sub(r'<(\w+)[^>]*translate="no"[^>]*>.*?</\1>', "", page, flags=re.S)
    titles = re.findall(r'(?:title|placeholder|aria-label|data-words)="([^"]*)"', page)
    return [html.unescape(one).strip() for one in re.sub(r"<[^>]*>", "\n", page).splitlines() + titles if one.strip()]
def keep(path, fields=None):
    """Keeps the English page for the search of texts without words, and reads the German one."""
    english = ask(path, "en", fields)
    with open("%s/pages/%03d.html" % (work, len(kept)), "w", encoding="utf-8") as file:
        file.write(english)
    kept.append(path)
    if fields:
        return english
    german = ask(path, "de")
    assert '<html lang="de"' in german and '<html lang="en"' in english, path
    for text in texts(german):
        if not re.search(r"foilgauge (measure|film)|--resume|lot\.json|J\. \w+|Lindeman|m_i m_j", text):  # commands, papers, equations
            assert not ENGLISH.search(text), (path, text)
    return german
database = sqlite3.connect(work + "/scans/foilgauge.sqlite")
count = lambda table: database.execute("SELECT count(*) FROM " + table).fetchone()[0]
def drop(name, file=None, text=None):
    before = count("arrivals")
    if file:
        shutil.copy(file, work + "/scans/.new")
    else:
        open(work + "/scans/.new", "wb").write(text)
    os.rename(work + "/scans/.new", work + "/scans/" + name)
    wait_until(lambda: count("arrivals") > before)

tabs = "/", "/history", "/trends", "/scanner", "/lots", "/orders"
for path in tabs + ("/outbox", "/nothing", "/foil?id=9", "/lot?name=9"):
    keep(path)
keep("/order", dict(number="of the"))
keep("/orders?unknown=of+the")
keep("/order", dict(number="of the", lot="The Lot", pieces="3"))
drop("7_Now.png", work + "/1.png")
assert ">I.O.<" in keep("/")
drop("7_Search.png", work + "/2.png")
now = keep("/")
# A serial number that is a word of the pages stays; a number and a date have their form.
assert 'translate="no">Search</span>' in now and "3,34" in now and re.search(r"\d\d\.\d\d\.20\d\d \d\d:\d\d:\d\d", now), now
assert "Ausschuss, Nacharbeit, Sonderfreigabe" in now and ">N.I.O.<" in now
drop("7_again.png", work + "/1.png")
keep("/")
drop("7_half.png", text=open(work + "/1.png", "rb").read()[:2000])
keep("/")
drop("notes.txt", text=b"no scan\n")
keep("/")
drop("7_crushed.png", work + "/3.png")
keep("/")
drop("7_other.png", work + "/4.png")
keep("/")
for path in ("/foil?id=1", "/foil?id=2", "/foil?id=3", "/foil?id=4", "/report?foil=1", "/report?foil=2", "/report?foil=3", "/trends?by=lots", "/why?q=bump:radius_mm", "/history?verdict=open",
             "/history?serial=nobody", "/lots?close=1&lot=7", "/orders", "/trends?q=foil:overall.radius_mm"):
    keep(path)
keep("/correct", dict(foil=1, back="/foil", was_serial="other", serial="SN", was_lot="", lot="The Lot", was_die="", die="", was_operator="",
                      operator="Ada", by="Ada"))
keep("/dispose", dict(foil=2, kind="scrap", reason="of the", note="with", by=""))
keep("/dispose", dict(foil=2, kind="scrap", reason="of the", note="with", by="and"))
foil = keep("/foil?id=2")
assert "Ausschuss</b>" in foil and 'translate="no">and</span>' in foil, foil
keep("/close", dict(lot="7", by=""))
keep("/close", dict(lot="7", by="Ada", open=9))
wait_until(lambda: "wird abgeschlossen" not in ask("/lots", "de"))
assert "abgeschlossen" in keep("/lots")
assert "Erweiterungsfaktor" in keep("/report?foil=1")
assert "Banddicke" in keep("/lot?name=7")
keep("/order-close", dict(order=1, by="Ada"))
keep("/orders")
# The time that a page's script writes has the form of the page.
assert re.search(r'data-at="\d\d\.\d\d\.\d{4} ', ask("/", "de")) and re.search(r"^\d+ \d\d\.\d\d\.\d{4} ", ask("/alive", "de"))
# JSON names never change: QIF, DFQ and the columns of CSV are those of `lot`.
table = ask("/download", "de", dict(lot="7", file="foils.csv"))
plain_table = ask("/download", "en", dict(lot="7", file="foils.csv"))
assert table.startswith("\ufeff") and table[1:].splitlines()[0] == plain_table.splitlines()[0].replace(",", ";"), table[:200]
assert re.search(r";3,3[0-9]+;", table) or re.search(r";20,7[0-9]+;", table), table
assert ask("/download", "de", dict(lot="7", file="results.dfq")) == ask("/download", "en", dict(lot="7", file="results.dfq"))
# Reports of what these scans have not: colour lines, gauges, a scanner's model, a scale of which nothing is known; a lot of them.
more = [work + "/" + name for name in ("colour.html", "gauge.html", "model.html", "beams.html", "lot/index.html", "study/index.html")]
said = subprocess.run([missing, "de"] + ["%s/pages/%03d.html" % (work, i) for i in range(len(kept))] + more, capture_output=True, text=True)
assert said.returncode == 0, "no words in de.po: " + said.stdout + said.stderr
print("languages: %d pages" % len(kept))
PY
# The recipe's language goes before the browser's; one that the program has not is refused.
stop TERM
sed 's/"station": {/"station": {"language": "de", /' "$work/recipe.json" >"$work/german.json"
start "$work/scans" --recipe "$work/german.json"
address=$(cat "$work/address")
curl -s -H 'Accept-Language: en' -o "$work/now.html" "$address" || fail "no page"
grep -q '<html lang="de"' "$work/now.html" || fail "the recipe's language"
stop TERM
sed 's/"language": "de"/"language": "xx"/' "$work/german.json" >"$work/unknown.json"
if "$program" station "$work/scans" --recipe "$work/unknown.json" --once 2>"$work/said"; then fail "an unknown language"; fi
grep -q 'language: there are no pages in "xx"' "$work/said" || fail "an unknown language is not told"
"$program" station "$work/scans" --recipe "$work/german.json" --digest-page "$work/digest.html" >"$work/digest.txt" || fail "digest"
grep -q '^Was sich geändert hat' "$work/digest.txt" || fail "the digest's text is not German: $(cat "$work/digest.txt")"
grep -q '<html lang="de"' "$work/digest.html" || fail "the digest's page is not German"
