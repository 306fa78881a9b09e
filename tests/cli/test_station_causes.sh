#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Causes at the station: a planted one is found by "Why?" and by --digest, tied with the die on the same foils, accepted
# with name and reason, drawn and withdrawn; a context by serial and by time; a clean year has none.
# Usage: test_station_causes.sh PROGRAM
set -euo pipefail
. "$(dirname "$0")/../support/checks.sh"
[ -x /usr/bin/python3 ] || { echo "skipped: python3 is not on this machine"; exit 77; }
program=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "test_station_causes: $*" >&2
  exit 1
}
checks - "$program" "$work" "$(dirname "$0")/../bench" >&2 <<'PY' || fail "causes"
import os, re, shutil, sqlite3, subprocess, sys, time, urllib.error, urllib.parse, urllib.request
program, work, bench_folder = sys.argv[1:]
sys.path.insert(0, bench_folder)
import station_causes
station_causes.FOILGAUGE = program
bench = station_causes.Bench(work, 1000)

folder = os.path.join(work, "year")
text, _ = bench.year(5, {"coil": {"K7": 0.01}, "scanner": {"S2": 0.004}}, collinear=True, keep=folder)
found, _ = station_causes.read_findings(text)
of_pair = [words for name, tied, words in found if "coil K7" in words or "die B" in words]
assert of_pair and "tied with" in of_pair[0] and "would tell" in of_pair[0], text
assert any(name == "scanner" for name, _, _ in found), text
value = float(re.search(r"[+−](\d\.\d+) %", of_pair[0]).group(1))
assert abs(value - 1.0) < 0.25, of_pair[0]
clean, _ = bench.year(6, {})
assert "no column explains" in clean, clean

# A page of it, and a folder without a database.
page = os.path.join(work, "digest.html")
station = [program, "station", folder, "--recipe", bench.recipe]
subprocess.run(station + ["--digest-page", page], check=True, capture_output=True)
assert "<h2>bump radius, mm</h2>" in open(page, encoding="utf-8").read()
os.mkdir(os.path.join(work, "empty"))
said = subprocess.run([program, "station", os.path.join(work, "empty"), "--digest"], capture_output=True, text=True)
assert said.returncode == 71 or said.returncode != 0 and "there is no database" in said.stderr, said
assert not os.listdir(os.path.join(work, "empty"))

# Contexts: by serial a word that is the cause; a time that is none, a file without key.
serials = os.path.join(work, "serials.csv")
database = sqlite3.connect(os.path.join(folder, "foilgauge.sqlite"))
with open(serials, "w") as file:
    file.write("serial,glue\n")
    for serial, scanner in database.execute("SELECT serial, scanner FROM foils"):
        file.write(f"{serial},{'G9' if scanner == 'S2' else 'G1'}\n")
text = subprocess.run(station + ["--context", serials, "--digest"], check=True, capture_output=True, text=True).stdout
found, _ = station_causes.read_findings(text)
assert any(name in ("glue", "scanner") and tied and "on the same foils" in words for name, tied, words in found), text
for content, words in (("time,t\n2026-13-01,1\n", "is no time"), ("day,t\n1,1\n", "column `serial` or `time`")):
    with open(serials, "w") as file:
        file.write(content)
    said = subprocess.run(station + ["--context", serials, "--digest"], capture_output=True, text=True)
    assert words in said.stdout + said.stderr, (content, said)

# A clock that was ahead for one scan: the last day is that of the newest scan.
day = re.search(r"The 24 hours until \S+: \d+ foils?", text).group()
first = database.execute("SELECT id, at FROM scans ORDER BY id LIMIT 1").fetchone()
database.execute("UPDATE scans SET at = ? WHERE id = ?", (4102444800000, first[0])), database.commit()
text = subprocess.run(station + ["--digest"], check=True, capture_output=True, text=True).stdout
database.execute("UPDATE scans SET at = ? WHERE id = ?", (first[1], first[0])), database.commit()
assert day in text, (day, text)

# The page: asked, found, accepted, drawn, withdrawn.
running = subprocess.Popen(station + ["--context", os.path.join(folder, "temperature.csv"), "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
try:
    base = running.stdout.readline().strip()
    def get(path):
        return station_causes.ask(base, path)
    token = re.search('name="form" value="([0-9a-f]+)"', get("/trends")).group(1)
    def post(path, **fields):
        try:
            return 200, station_causes.ask(base, path, {"form": token, "q": "bump:radius_mm", **fields})
        except urllib.error.HTTPError as error:
            return error.code, plain(error.read().decode())
    time.sleep(0.5)
    assert "temperature.csv" not in get("/"), "a context is no scan"
    post("/why")
    for _ in range(600):
        answer = get("/why?q=bump:radius_mm")
        if "Searching for causes" not in answer:
            break
        time.sleep(0.1)
    words = re.findall('name="cause" value="(\\d+)"><input type="hidden" name="words" value="([^"]+)"', answer)
    assert words and "With the causes taken out" in answer, answer
    number, first = words[0]
    assert post("/accept", cause=number, words=first, by="")[0] == 422
    assert post("/accept", cause="7", words=first, by="Ada")[0] == 422
    code, answer = post("/accept", cause=number, words=first, by="Ada", note="seen at the press")
    assert code == 200 and "Accepted causes" in answer and re.search("accepted by (<[^>]*>)?Ada", answer) and "seen at the press" in answer, answer
    assert "limits are taken about these causes" in answer
    rows = database.execute("SELECT by, note, words, withdrawn_at FROM causes").fetchall()
    assert rows == [("Ada", "seen at the press", first, 0)], rows
    values = database.execute("SELECT sum(value) FROM measured").fetchall()
    steps = [path for path in re.findall('class="control" d="([^"]+)"', get("/trends?newest=all")) if "V" in path]
    assert steps, "the limits do not follow the cause"
    assert database.execute("SELECT sum(value) FROM measured").fetchall() == values
    code, answer = post("/withdraw", cause="1", by="Bea")
    assert code == 200 and re.search("withdrawn by (<[^>]*>)?Bea", answer) and "limits are taken about" not in answer, answer
    steps = [path for path in re.findall('class="control" d="([^"]+)"', get("/trends?newest=all")) if "V" in path]
    assert not steps
finally:
    running.terminate()
    running.wait()
print("causes: found, tied, accepted, withdrawn")
PY
