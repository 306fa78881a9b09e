#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pages of a running station: bad bumps are marked, news is told, the scan command runs beside the
# pages and its failures are cards, a report is measured again only from the same scan.
# Usage: test_station_pages.sh PROGRAM
name=test_station_pages
. "$(dirname "$0")/../support/station.sh"
# A folder's name that no shell must take for more than a name.
folder="$work/in ';touch pwned;' \$(touch pwned)"
mkdir "$folder"
draw 1 "$folder/A_1.png"
draw 2 "$work/good.png"
draw 3 "$work/late.png"
cat >"$work/scan.sh" <<'S'
#!/bin/sh
# The file `mode` holds the scanner's behaviour.
mode=$(cat "$(dirname "$0")/mode")
case $mode in
fail) echo "warming up"; echo "scanimage: device busy" >&2; printf x >"$1"; exit 3 ;;
none) exit 0 ;;
slow) sleep 0.6; cp "$(dirname "$0")/good.png" "$1" ;;
esac
S
chmod +x "$work/scan.sh"
cat >"$work/recipe.json" <<R
{"schema": "foilgauge/recipe/1",
 "station": {"file_name": "{serial}_{lot}", "scan_command": "'$work/scan.sh' '{file}'"},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2,
            "calibration": "not needed: the scan is rendered", "tolerances": {"radius_mm": {"min": 0.1, "max": 3}}}}
R
"$program" station "$folder" --recipe "$work/recipe.json" --port 0 >"$work/address" 2>"$work/err" &
station=$!
checks - "$work" "$folder" >&2 <<'PY' || fail "pages: $(cat "$work/err")"
import os, re, shutil, socket, sqlite3, sys, threading, time, urllib.error, urllib.parse, urllib.request
work, folder = sys.argv[1:]
base = wait_until(lambda: open(work + "/address").read().strip())
def ask(path, fields=None, **headers):
    data = urllib.parse.urlencode(fields).encode() if fields else None
    request = urllib.request.Request(base + path.lstrip("/"), data, headers)
    try:
        with urllib.request.urlopen(request) as answer:
            return answer.status, plain(answer.read().decode())
    except urllib.error.HTTPError as error:
        return error.code, plain(error.read().decode())
def page(path="/"):
    code, body = ask(path)
    assert code == 200, (path, code, body)
    return body

# The verdict, the ring and the label at each of both bumps.
now = wait_until(lambda: "FAIL" in page() and 'class="picture"' in page() and page())
assert now.count('stroke="#ff5252"') >= 2, now
for bump in "1", "2":
    assert re.search(r'fill="#ff5252"[^>]*>%s: R [0-9.]+ mm, max 3<' % bump, now), bump

# A waiting reader is told when there is news, at once.
def events(last):
    text = ask("/events", **{"Last-Event-ID": last})[1]
    return re.search(r"id: (\d+)\ndata: (\w+)", text).groups()
last = events("-1")[0]
told = []
waiting = threading.Thread(target=lambda: told.append(events(last)))
waiting.start()
time.sleep(0.3)
assert not told
shutil.copy(work + "/late.png", folder + "/.B_1.png")
os.rename(folder + "/.B_1.png", folder + "/B_1.png")
waiting.join(10)
assert told and told[0][1] == "new" and told[0][0] != last, told

# The scan command.
form = re.search('name="form" value="([0-9a-f]+)"', page())[1]
def scan(mode):
    open(work + "/mode", "w").write(mode)
    assert ask("/scan", {"form": form})[0] == 200
    if mode == "slow":
        assert ">Scanning …</button>" in page() and "disabled" in page()
        assert ask("/scan", {"form": form})[0] == 200
    wait_until(lambda: "disabled>Scanning" not in page())
scan("fail")
assert "ended with exit code 3: warming up scanimage: device busy" in page(), page()
scan("none")
assert "the scan command wrote no file" in page()
scan("slow")
wait_until(lambda: re.search(r'<div class="call fail.*station-\d{8}-\d{6}-\d{3}\.png', page()))
assert not [name for name in os.listdir(folder) if name.startswith(".station")]
assert len([name for name in os.listdir(folder) if name.startswith("station-")]) == 1
rows = sqlite3.connect(folder + "/foilgauge.sqlite").execute("SELECT source FROM scans ORDER BY id")
assert [row[0] for row in rows] == ["folder", "folder", "scanner"]
assert not [1 for place in (folder, work, ".") if os.path.exists(place + "/pwned")]

# The report: measured again, or from the record, and the same values.
again = page("/report?foil=1")
radius = re.search(r"<tr><td>1</td><td class=\"fail\">([0-9.]+)", again)[1]
assert "Residual along the foil" in again and "From the record" not in again
assert radius in page("/foil?id=1")
# A picture that is not kept any more is drawn from the scan.
database = sqlite3.connect(folder + "/foilgauge.sqlite")
database.execute("DELETE FROM pictures WHERE foil = 1")
database.commit()
assert "/picture?foil=1" in page("/foil?id=1") and "<figure" not in page("/foil?id=1")
assert re.search('<figure class="scroll">.{50000}', page("/picture?foil=1"), re.S)
open(folder + "/A_1.png", "ab").write(b"x")
changed = page("/report?foil=1")
assert "another file" in page("/picture?foil=1")
assert "From the record" in changed and "another file" in changed and radius in changed
os.remove(folder + "/A_1.png")
gone = page("/report?foil=1")
assert "From the record" in gone and "No such file" in gone and radius in gone

# Requests that no browser sends.
address = base[7:].rstrip("/")
def raw(text):
    host, port = address.split(":")
    with socket.create_connection((host, int(port)), 10) as to:
        to.sendall(text.replace("HOST", "Host: " + address).encode("latin-1"))
        return to.recv(64).split(b" ")[1].decode()
for text, code in [
    ("GET /..%2f..%2fetc/passwd HTTP/1.1\r\nHOST\r\n\r\n", "404"),
    ("GET /foilgauge.sqlite HTTP/1.1\r\nHOST\r\n\r\n", "404"),
    ("HEAD / HTTP/1.1\r\nHOST\r\n\r\n", "200"),
    ("PUT / HTTP/1.1\r\nHOST\r\nContent-Length: 1\r\n\r\nx", "405"),
    ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", "421"),
    ("GET / HTTP/1.0\r\n\r\n", "421"),
    ("GET /history?serial=%ff HTTP/1.1\r\nHOST\r\n\r\n", "400"),
    ("GET /history?serial=%00 HTTP/1.1\r\nHOST\r\n\r\n", "400"),
    ("GET /history?" + "a=1&" * 40 + " HTTP/1.1\r\nHOST\r\n\r\n", "400"),
    ("GET /history?serial=%3Cscript%3E HTTP/1.1\r\nHOST\r\n\r\n", "200"),
    ("GET / HTTP/1.1\r\nHOST\r\nX: " + "x" * 40000 + "\r\n\r\n", "431"),
    ("POST /correct HTTP/1.1\r\nHOST\r\nContent-Length: 999999\r\n\r\n", "413"),
    ("POST /correct HTTP/1.1\r\nHOST\r\nOrigin: http://evil.example\r\nContent-Length: 42\r\n\r\n"
     "form=%s&a=b" % form, "403")]:
    assert raw(text.replace("Content-Length: 42", "Content-Length: %d" % len("form=%s&a=b" % form))) \
        == code, (text[:60], code)

# Pages that were left shut nobody out.
last = events("-1")[0]
left = []
for _ in range(40):
    left.append(socket.create_connection(tuple(address.split(":")), 10))
    left[-1].sendall(("GET /events HTTP/1.1\r\nHost: %s\r\nLast-Event-ID: %s\r\n\r\n" % (address, last)).encode())
started = time.time()
page("/history")
assert time.time() - started < 2
PY
kill "$station"
wait "$station" 2>/dev/null || true
station=
echo "pages: marks, news, scan command, reports, hostile requests"
