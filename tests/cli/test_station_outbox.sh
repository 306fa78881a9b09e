#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Parts are passed on as they are measured, corrected and disposed: into folders in every format, by HTTP with a token and a
# key, by MQTT; in order, nothing lost, nothing twice, also where the receiver is gone for a while or the station is killed
# between sending a part and noting that.
# Usage: test_station_outbox.sh PROGRAM
name=test_station_outbox
. "$(dirname "$0")/../support/station.sh"
broker=
at_end() { [ -z "$broker" ] || kill "$broker" 2>/dev/null || true; }
for seed in 1 2 3 4; do
  draw $seed "$work/$seed.png"
done
mkdir "$work/scans" "$work/json" "$work/csv" "$work/bumps" "$work/dfq" "$work/qif"
echo "a-token-of-sixteen" >"$work/token"
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1",
 "station": {"pass_on": [{"to": "json"}, {"to": "csv", "format": "csv"}, {"to": "bumps", "format": "bumps_csv"},
   {"to": "dfq", "format": "dfq"}, {"to": "qif", "format": "qif"},
   {"to": "http://127.0.0.1:PORT/parts", "token_file": "token"}MQTT]},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2, "calibration": "not needed: rendered",
            "tolerances": {"radius_mm": {"min": 3.4}}}}
R

# One that does not know ways or formats is refused.
for bad in '' 'ftp://x/y' 'mqtt://host'; do
  printf '{"schema": "foilgauge/recipe/1", "station": {"pass_on": [{"to": "%s"}]}}' "$bad" >"$work/bad.json"
  ! "$program" station "$work/scans" --recipe "$work/bad.json" --once >"$work/out" 2>&1 || fail "'$bad' was taken"
  grep -q pass_on "$work/out" || grep -q "$bad:" "$work/out" || fail "$(cat "$work/out")"
done
mqtt=no
grep -q 'no MQTT' "$work/out" || ! command -v mosquitto >/dev/null || mqtt=yes

checks - "$work" "$program" "$mqtt" >&2 <<'PY' || fail "$(tail -5 "$work/said" 2>/dev/null)"
import csv, http.server, io, json, os, re, shutil, signal, socket, sqlite3, subprocess, sys, threading, time, urllib.parse, urllib.request
import xml.etree.ElementTree as xml
work, program, mqtt = sys.argv[1:]
arrived, seen, behave = [], {}, {"code": 200, "kill_at": None, "station": None}

class Receiver(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        key = self.headers["Idempotency-Key"]
        assert self.headers["Authorization"] == "Bearer a-token-of-sixteen"
        if behave["code"] == 200:
            arrived.append(key)
            assert seen.setdefault(key, body) == body, "one key, two bodies"
        if behave["kill_at"] == len(arrived):  # it has the part; the station never hears of that
            behave["kill_at"] = None
            behave["station"].send_signal(signal.SIGKILL)
            behave["station"].wait()
            self.close_connection = True
            return
        self.send_response(behave["code"])
        self.send_header("Content-Length", "2")
        self.end_headers()
        self.wfile.write(b"ok")
    def log_message(self, *words):
        pass

class Server(http.server.ThreadingHTTPServer):
    def handle_error(self, *who):  # a station that was killed has left
        pass
server = Server(("127.0.0.1", 0), Receiver)
threading.Thread(target=server.serve_forever, daemon=True).start()
broker = listener = None
if mqtt == "yes":
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    def start_broker():
        conf = f"{work}/mosquitto.conf"
        open(conf, "w").write(f"listener {port} 127.0.0.1\nallow_anonymous true\n")
        started = subprocess.Popen(["mosquitto", "-c", conf], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        def answers():
            with socket.socket() as probe:
                return probe.connect_ex(("127.0.0.1", port)) == 0
        wait_until(lambda: answers())
        return started
    broker = start_broker()
recipe = open(work + "/recipe.json").read().replace("PORT", str(server.server_port)).replace(
    "MQTT", f', {{"to": "mqtt://127.0.0.1:{port}/foils/parts"}}' if mqtt == "yes" else "")
open(work + "/recipe.json", "w").write(recipe)

def start():
    address = open(work + "/address", "w+")
    station = subprocess.Popen([program, "station", work + "/scans", "--recipe", work + "/recipe.json", "--port", "0",
                                "--name", "hall 3"], stdout=address, stderr=open(work + "/said", "a"))
    behave["station"] = station
    base = wait_until(lambda: open(work + "/address").read().strip())
    return station, base
def get(base, path):
    return urllib.request.urlopen(base + path.lstrip("/")).read().decode()
def drop(seed, name):
    shutil.copy(f"{work}/{seed}.png", f"{work}/scans/.new")
    os.rename(f"{work}/scans/.new", f"{work}/scans/{name}.png")
def files(folder):
    return sorted(entry for entry in os.listdir(f"{work}/{folder}") if not entry.startswith("."))

try:
    station, base = start()
    drop(1, "F 1")
    folders = ["json", "csv", "bumps", "dfq", "qif"]
    wait_until(lambda: all(len(files(folder)) == 1 for folder in folders) and len(arrived) == 1)
    part = json.load(open(f"{work}/json/{files('json')[0]}"))
    assert part["schema"] == "foilgauge/part/1" and part["station"] == "hall 3" and part["kind"] == "measured", part
    assert part["serial"] == "F 1" and part["verdict"] == "fail" and part["disposition"] is None, part
    assert [v for v in part["values"] if v["of"] == "bump" and v["name"] == "radius_mm" and v["u"] > 0], part["values"]
    assert part["judgements"] and part["judgements"][0]["verdict"] == "fail", part["judgements"]
    assert json.loads(seen[arrived[0]]) == part and part["key"] == arrived[0]
    rows = list(csv.DictReader(open(f"{work}/csv/{files('csv')[0]}")))
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", rows[0]["date"]), rows[0]["date"]
    assert len(rows) == 1 and rows[0]["foil"] == "F 1", rows
    bumps = list(csv.DictReader(open(f"{work}/bumps/{files('bumps')[0]}")))
    of_part = {v["number"]: v["value"] for v in part["values"] if v["of"] == "bump" and v["name"] == "radius_mm"}
    assert {int(row["bump"]): float(row["radius_mm"]) for row in bumps} == of_part, (bumps, of_part)
    dfq = open(f"{work}/dfq/{files('dfq')[0]}").read()
    assert re.search(r"K0014/1 F 1", dfq) and "K0001/1" in dfq, dfq[:400]
    xml.parse(f"{work}/qif/{files('qif')[0]}")

    # A disposition and a correction are passed on, too; with the names of then.
    token = re.search('name="form" value="([0-9a-f]+)"', get(base, "/foil?id=1")).group(1)
    def post(path, **fields):
        return urllib.request.urlopen(base + path, urllib.parse.urlencode({"form": token, **fields}).encode())
    post("dispose", foil="1", kind="scrap", by="Ada", reason="S1", note="bent")
    post("correct", foil="1", serial="F9", by="Ada")
    wait_until(lambda: all(len(files(folder)) == 3 for folder in folders) and len(arrived) == 3)
    disposed, corrected = [json.load(open(f"{work}/json/{entry}")) for entry in files("json")[1:]]
    assert disposed["kind"] == "disposed" and disposed["serial"] == "F 1" and disposed["disposition"]["kind"] == "scrap"
    assert corrected["kind"] == "corrected" and corrected["serial"] == "F9" and corrected["disposition"]["by"] == "Ada"
    dfq = open(f"{work}/dfq/{files('dfq')[1]}").read()
    assert "disposition scrap" in dfq and "reason S1" in dfq, dfq
    qif = open(f"{work}/qif/{files('qif')[1]}").read()
    assert "scrap" in qif

    # The receiver is gone: the others go on, the page says so, and it gets all in order when it is back.
    behave["code"] = 503
    drop(2, "F2")
    wait_until(lambda: all(len(files(folder)) == 4 for folder in folders))
    state = wait_until(lambda: next((r for r in json.loads(get(base, "/api/outbox"))["receivers"]
                                     if r["to"].startswith("http") and r["error"]), None))
    assert state["waiting"] == 1 and "503" in state["error"] and state["passed"] == 3, state
    assert "<b>1</b> not passed on yet" in get(base, "/") and "the receiver answers 503" in get(base, "/outbox")
    behave["code"] = 200
    wait_until(lambda: len(arrived) == 4, 20)
    assert [json.loads(seen[key])["event"] for key in arrived] == [1, 2, 3, 4]

    # Killed after the receiver has a part and before the station notes it: it comes again with its key alone.
    behave["kill_at"] = 5
    drop(3, "F3")
    station.wait()
    station, base = start()
    wait_until(lambda: len(arrived) == 6)
    assert arrived[4] == arrived[5] and len(set(arrived)) == 5, arrived

    # Killed the moment a file appears, and the file taken away: it does not come again; the next one does.
    taken = [json.load(open(f"{work}/json/{entry}"))["event"] for entry in files("json")]
    for entry in files("json"):
        os.remove(f"{work}/json/{entry}")
    for round in range(6):
        token = re.search('name="form" value="([0-9a-f]+)"', get(base, "/foil?id=1")).group(1)
        post("correct", foil="1", serial=f"G{round}", by="Ada")
        end = time.time() + 20
        while not files("json") and time.time() < end:
            pass
        station.send_signal(signal.SIGKILL)
        station.wait()
        for entry in files("json"):
            taken.append(json.load(open(f"{work}/json/{entry}"))["event"])
            os.remove(f"{work}/json/{entry}")
        station, base = start()
    wait_until(lambda: not any(r["waiting"] for r in json.loads(get(base, "/api/outbox"))["receivers"] if not r["to"].startswith("mqtt")))
    for entry in files("json"):
        taken.append(json.load(open(f"{work}/json/{entry}"))["event"])
    assert taken == list(range(1, len(taken) + 1)), taken
    assert len(taken) == 11, taken

    # Another folder under the name, as an empty mount point is: parts wait until somebody has seen to it.
    os.rename(work + "/dfq", work + "/dfq.away")
    token = re.search('name="form" value="([0-9a-f]+)"', get(base, "/foil?id=1")).group(1)
    post("correct", foil="1", serial="H", by="Ada")
    wait_until(lambda: [r for r in json.loads(get(base, "/api/outbox"))["receivers"] if r["format"] == "dfq" and r["error"]])
    os.rename(work + "/dfq.away", work + "/dfq")
    wait_until(lambda: len(files("dfq")) == 12, 20)

    if mqtt == "yes":
        wait_until(lambda: not [r for r in json.loads(get(base, "/api/outbox"))["receivers"] if r["waiting"]], 20)
        client = subprocess.run(["sh", "-c", "command -v mosquitto_sub"], capture_output=True).returncode == 0
        messages = []
        if client:
            listener = subprocess.Popen(["mosquitto_sub", "-p", str(port), "-t", "foils/#", "-q", "1"], stdout=subprocess.PIPE, text=True)
            threading.Thread(target=lambda: messages.extend(iter(listener.stdout.readline, "")), daemon=True).start()
            time.sleep(0.5)
        token = re.search('name="form" value="([0-9a-f]+)"', get(base, "/foil?id=1")).group(1)
        post("correct", foil="1", serial="I", by="Ada")
        of_broker = lambda: next(r for r in json.loads(get(base, "/api/outbox"))["receivers"] if r["to"].startswith("mqtt"))
        wait_until(lambda: of_broker()["passed"] == 13, 20)
        if client:
            wait_until(lambda: '"serial": "I"' in "".join(messages))
        broker.kill()
        broker.wait()
        post("correct", foil="1", serial="J", by="Ada")
        wait_until(lambda: of_broker()["error"], 20)
        broker = start_broker()
        wait_until(lambda: of_broker()["passed"] == 14, 30)
    # A run that ends at once passes on, too.
    station.send_signal(signal.SIGINT)
    station.wait()
    before = len(arrived)
    drop(4, "F4")
    subprocess.run([program, "station", work + "/scans", "--recipe", work + "/recipe.json", "--once"], stderr=subprocess.DEVNULL)
    assert len(arrived) == before + 1 and json.loads(seen[arrived[-1]])["serial"] == "F4"
    events = [json.loads(seen[key])["event"] for key in dict.fromkeys(arrived)]
    assert events == list(range(1, len(events) + 1)), events
    # So does the first run of a folder.
    os.mkdir(work + "/first")
    shutil.copy(f"{work}/1.png", f"{work}/first/E1.png")
    before = len(arrived)
    subprocess.run([program, "station", work + "/first", "--recipe", work + "/recipe.json", "--once"], stderr=subprocess.DEVNULL)
    assert len(arrived) == before + 1 and json.loads(seen[arrived[-1]])["serial"] == "E1"
finally:
    for process in behave["station"], broker, listener:
        if process and process.poll() is None:
            process.kill()
            process.wait()
PY
[ $mqtt = yes ] || echo "$name: skipped MQTT: no libmosquitto at build, or no mosquitto"
echo "$name: parts in five formats, by HTTP$([ $mqtt = yes ] && echo ' and MQTT'); killed seven times, nothing lost, nothing twice"
