#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A hub shows the parts of its stations: each part once, the newest event of a foil in force, in SQLite and, where it is
# installed, in PostgreSQL, in the order in which they came; a hub that is killed, is gone for a while or answers late loses nothing and has nothing twice.
# Usage: test_station_hub.sh PROGRAM
name=test_station_hub
. "$(dirname "$0")/../support/station.sh"
hub= second= cluster=
at_end() {
  for child in $hub $second; do kill -9 "$child" 2>/dev/null || true; done
  [ -z "$cluster" ] || as_postgres "$cluster/pg_ctl" -D "$work/pg" -m immediate stop >/dev/null 2>&1 || true
}
as_postgres() {
  if [ "$(id -u)" = 0 ]; then setpriv --reuid=postgres --regid=postgres --clear-groups "$@"; else "$@"; fi
}
echo "a-token-of-sixteen" >"$work/token"
for seed in 1 2 3; do draw $seed "$work/$seed.png"; done

# try DATABASE: all of it with that database.
try() {
  mkdir -p "$work/a" "$work/b"
  checks - "$program" "$work" "$1" "$cluster/psql" >&2 <<'PY' || fail "the hub in ${1%%:*}"
import json, os, re, shutil, signal, sqlite3, socket, subprocess, sys, time, urllib.error, urllib.parse, urllib.request
program, work, database, psql = sys.argv[1:]
processes = {}
with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
token = "a-token-of-sixteen"

def start(name, *arguments):
    path = f"{work}/address-{name}"
    processes[name] = subprocess.Popen([program, *arguments], stdout=open(path, "w"), stderr=open(work + "/said", "a"))
    return wait_until(lambda: open(path).read().split("?")[0].strip())
def start_hub():
    return start("hub", "hub", "--database", database, "--port", str(port), "--token-file", work + "/token")
def start_station(name):
    return start(name, "station", f"{work}/{name}", "--recipe", work + "/recipe.json", "--port", "0", "--name", "hall " + name,
                 "--hub", f"http://127.0.0.1:{port}/", "--hub-token-file", work + "/token")
def kill(name):
    processes[name].send_signal(signal.SIGKILL)
    processes[name].wait()
def ask(path, body=None, bearer=token, **headers):
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", body, {"Authorization": "Bearer " + bearer, **headers})
    try:
        return urllib.request.urlopen(request).read().decode()
    except urllib.error.HTTPError as error:
        return error.code
def state(**search):
    return json.loads(ask("/api/parts?" + urllib.parse.urlencode(search)))
def drop(seed, name, serial):
    shutil.copy(f"{work}/{seed}.png", f"{work}/{name}/.new")
    os.rename(f"{work}/{name}/.new", f"{work}/{name}/{serial}.png")
def correct(base, foil, serial):
    form = re.search('name="form" value="([0-9a-f]+)"', urllib.request.urlopen(base + f"foil?id={foil}").read().decode()).group(1)
    urllib.request.urlopen(base + "correct", urllib.parse.urlencode({"form": form, "foil": foil, "serial": serial, "by": "Ada"}).encode())
def serials():
    return sorted((part["station"], part["serial"]) for part in state()["parts"])
try:
    # A station that begins before its hub keeps its parts for it.
    a = start_station("a")
    drop(1, "a", "A1")
    drop(2, "a", "A2")
    time.sleep(0.5)
    start_hub()
    wait_until(lambda: ask("/api/parts") != 401 and serials() == [("hall a", "A1"), ("hall a", "A2")])
    assert ask("/api/parts", bearer="another-token-of-16") == 401 and ask("/api/parts", b"{}", bearer="x" * 16) == 401
    assert ask("/api/parts", b"{}") == 422 and ask("/api/parts", b"[1") == 422
    b = start_station("b")
    drop(1, "b", "B1")  # the same scan at another station is its part
    wait_until(lambda: len(serials()) == 3)
    # A correction is the foil's newest event.
    correct(a, 1, "A9")
    wait_until(lambda: serials() == [("hall a", "A2"), ("hall a", "A9"), ("hall b", "B1")])
    part = state(serial="A9")["parts"][0]
    whole = json.loads(ask(f"/api/part?source={part['source']}&foil={part['foil']}"))
    assert whole["kind"] == "corrected" and whole["serial"] == "A9" and whole["values"]
    # The same event again is known; an earlier one does not undo a later one; a page elsewhere cannot post.
    body = json.dumps(whole).encode()
    assert ask("/api/parts", body) == "known\n"
    assert ask("/api/parts", body, Origin="http://elsewhere.example.com") == 403
    assert [row["parts"] for row in state()["stations"]] == [2, 1], state()["stations"]
    assert state(station="hall b")["parts"][0]["serial"] == "B1" and len(state(lot="none")["parts"]) == 0
    # The hub is gone, parts go on, the hub is killed in the middle, and has all when it is back.
    kill("hub")
    for number in range(12):
        correct(a, 1, f"A9-{number}")
    drop(3, "b", "B3")
    time.sleep(0.3)
    for _ in range(3):
        start_hub()
        time.sleep(0.4)
        kill("hub")
        kill("a")
        a = start_station("a")
    start_hub()
    wait_until(lambda: serials() == [("hall a", "A2"), ("hall a", "A9-11"), ("hall b", "B1"), ("hall b", "B3")], 60)
    def own(name):
        return sqlite3.connect(f"{work}/{name}/foilgauge.sqlite").execute("SELECT count(*) FROM events").fetchone()[0]
    source = {part["station"]: part["source"] for part in state()["parts"]}
    if not database.startswith("postgresql"):
        rows = sqlite3.connect(database).execute("SELECT source, count(*), max(event) FROM hub_events GROUP BY source").fetchall()
        assert {row[0]: row[1:] for row in rows} == {source["hall " + name]: (own(name), own(name)) for name in "ab"}, rows
    def show():
        return plain(urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{port}/", headers={"Cookie": "foilgauge=" + token})).read().decode())
    page = show()
    assert "hall a" in page and ">B3</a>" in page and page.count("<table") == 2, page
    assert ask("/api/parts.csv").count("\n") == 5, ask("/api/parts.csv")
    # A station's wrong clock moves no part: they are in the order in which they first came, by the hub's clock.
    def post(event, foil, serial, measured_at):
        time.sleep(1.1)
        ask("/api/parts", json.dumps({**whole, "source": "c" * 32, "station": "hall c", "event": event, "foil": foil, "serial": serial,
                                      "measured_at": measured_at}).encode())
    def order():
        return [part["serial"] for part in state()["parts"]][:3]
    post(1, 1, "C1", "2099-01-01T00:00:00Z")
    post(2, 2, "C2", "2001-01-01T00:00:00Z")
    post(3, 3, "C3", "2026-01-01T00:00:00Z")
    assert order() == ["C3", "C2", "C1"], order()
    post(4, 1, "C1b", "2099-01-01T00:00:00Z")
    assert order() == ["C3", "C2", "C1b"], order()
    assert [row["parts"] for row in state()["stations"]] == [2, 2, 3], state()["stations"]
    assert [part["measured_at"][:4] for part in state(station="hall c")["parts"]] == ["2026", "2001", "2099"]
    # A verdict that does not hold is none, neither on the page nor in a search.
    ask("/api/parts", json.dumps({**whole, "source": "c" * 32, "station": "hall c", "event": 5, "foil": 3, "serial": "C3", "verdict": "pass",
                                  "withheld": "The scanner's check is due"}).encode())
    row = re.search(r"<tr>(?:(?!<tr>).)*>C3<.*?</tr>", show(), re.S).group(0)
    assert ">NO VERDICT<" in row and "PASS" not in row and "pass" not in row, row
    assert "C3" not in [part["serial"] for part in state(verdict="pass")["parts"]]
    assert [part["serial"] for part in state(verdict="withheld")["parts"]] == ["C3"]
    # A database of before, which has no times of receipt, gets them of its events.
    before = state()["parts"]
    kill("hub")
    old = ["DROP INDEX hub_parts_by_receipt", "ALTER TABLE hub_parts DROP COLUMN received_at"]
    for statement in old:
        if database.startswith("postgresql"):
            subprocess.run([psql, "-q", "-v", "ON_ERROR_STOP=1", "-c", statement, database], check=True)
        else:
            with sqlite3.connect(database) as connection:
                connection.execute(statement)
    for _ in range(2):
        start_hub()
        wait_until(lambda: ask("/api/parts") != 401)
        assert state()["parts"] == before, (state()["parts"], before)
        kill("hub")
finally:
    for process in processes.values():
        if process.poll() is None:
            process.kill()
            process.wait()
PY
  rm -rf "$work/a" "$work/b"
}
try "$work/hub.sqlite"
kinds=SQLite
cluster=$(ls -d /usr/lib/postgresql/*/bin 2>/dev/null | tail -n 1)
"$program" hub --database postgresql://nobody@127.0.0.1:1/none --port 0 >"$work/out" 2>&1 && fail "a database that is not there"
if [ -z "$cluster" ] || grep -q 'no PostgreSQL' "$work/out"; then
  cluster=
  echo "$name: skipped PostgreSQL: no libpq at build, or no server"
else
  mkdir "$work/pg" && chmod 755 "$work"
  [ "$(id -u)" != 0 ] || chown postgres "$work/pg"
  port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
  as_postgres "$cluster/initdb" -D "$work/pg" -A trust -U postgres --no-sync >"$work/out" 2>&1 || fail "$(cat "$work/out")"
  as_postgres "$cluster/pg_ctl" -D "$work/pg" -w -o "-p $port -k $work/pg -c listen_addresses=127.0.0.1" start >"$work/out" 2>&1 || fail "$(cat "$work/out")"
  try "postgresql://postgres@127.0.0.1:$port/postgres"
  kinds="SQLite and PostgreSQL"
fi
echo "$name: two stations and a hub in $kinds, killed four times: each part once"
