#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Nobody without a token can stop a station: malformed requests, and a folder in which somebody replaces scans by
# other things. Usage: test_station_attacked.sh PROGRAM [SECONDS]
name=test_station_attacked
. "$(dirname "$0")/../support/station.sh"
seconds=${2:-6}
token=a-token-of-this-test
echo "$token" >"$work/token"
mkdir "$work/in"
draw 1 "$work/in/1.png"
draw 2 "$work/2.png"
draw 3 "$work/3.png"
start "$work/in" $recipe --token-file "$work/token"
wait_for 20 measured "$work/in" 1

# Requests, whole and broken, from somebody who does not know the token.
cat >"$work/attack.py" <<'PY'
import random, socket, sys, time, urllib.parse, urllib.request
base, seconds = sys.argv[1], float(sys.argv[2])
where = urllib.parse.urlparse(base)
there, host = (where.hostname, where.port), where.netloc.encode()
random.seed(7)
def noise(n):
    return bytes(random.randrange(256) for _ in range(n))
HEAD = b"GET / HTTP/1.1\r\nHost: %s\r\n" % host
POST = b"POST /close HTTP/1.1\r\nHost: %s\r\n" % host
wrong = [
    b"", b"\0", b"\r\n" * 5000, noise(3000), b"GET", b"GET / HTTP/9.9\r\n\r\n", b"GET  HTTP/1.1\r\n\r\n",
    b"GET /" + b"a" * 100000 + b" HTTP/1.1\r\nHost: %s\r\n\r\n" % host,
    b"GET /?" + b"a=1&" * 5000 + b" HTTP/1.1\r\nHost: %s\r\n\r\n" % host,
    b"GET /?token=" + b"x" * 15000 + b" HTTP/1.1\r\nHost: %s\r\n\r\n" % host,
    b"GET /%00%ff?%00=%ff HTTP/1.1\r\nHost: " + host + b"\r\n\r\n",
    HEAD + b"X: y\r\n" * 3000 + b"\r\n", HEAD + b"X: " + b"y" * 200000 + b"\r\n\r\n", HEAD + b" folded\r\n\r\n",
    HEAD + b"Cookie: " + b"foilgauge=;" * 1000 + b"\r\n\r\n", HEAD + b"Cookie: foilgauge=" + noise(100) + b"\r\n\r\n",
    HEAD + b"Last-Event-ID: 99999999999999999999999999\r\n\r\n", HEAD + b"Host: evil\r\n\r\n",
    b"GET / HTTP/1.1\r\nHost: " + b"[" * 300 + b"\r\n\r\n", b"GET / HTTP/1.1\r\nHost: %s\r\n\r\n" % (b"a." * 5000),
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1:99999999999999\r\n\r\n",
    POST + b"Content-Length: -1\r\n\r\n", POST + b"Content-Length: 99999999999999999999\r\n\r\nx",
    POST + b"Content-Length: 60000\r\n\r\n" + b"a=b&" * 15000, POST + b"Content-Length: 5\r\nContent-Length: 50000\r\n\r\nabcde",
    POST + b"Transfer-Encoding: chunked\r\n\r\nFFFFFFFFFFFFFFFF\r\nx", POST + b"Transfer-Encoding: chunked\r\n\r\n-1\r\nx\r\n",
    POST + b"Transfer-Encoding: chunked\r\n\r\n" + b"8000\r\n" + b"x" * 0x8000 + b"\r\n",
    POST + b"Transfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\n3\r\nabc\r\n0\r\n\r\n",
    POST + b"Expect: 100-continue\r\nContent-Length: 60000\r\n\r\n", POST + b"Transfer-Encoding: gzip, chunked\r\n\r\n",
    (HEAD + b"\r\n") * 500, (b"GET /events HTTP/1.1\r\nHost: %s\r\n\r\n" % host) * 200,
    b"OPTIONS * HTTP/1.1\r\nHost: %s\r\n\r\n" % host, b"CONNECT evil:443 HTTP/1.1\r\nHost: %s\r\n\r\n" % host,
    b"TRACE / HTTP/1.1\r\nHost: %s\r\n\r\n" % host, b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
]
page = base.encode().replace(b"/?", b"/lots?")
def ask():
    began = time.monotonic()
    with urllib.request.urlopen(urllib.request.Request("http://%s/lots" % where.netloc,
                                headers={"Cookie": "foilgauge=" + where.query[6:]}), timeout=20) as answer:
        assert b"foilgauge" in answer.read()
    return time.monotonic() - began
end, sent, longest, kept = time.monotonic() + seconds, 0, 0, []
while time.monotonic() < end:
    for what in wrong:
        if random.random() < .3 and what:  # damaged once more
            at = random.randrange(len(what))
            what = what[:at] + noise(random.randrange(4)) + what[at + random.randrange(4):]
        one = socket.socket()
        one.bind(("127.0.0.%d" % random.randrange(2, 60), 0))
        one.settimeout(2)
        try:
            one.connect(there)
            one.sendall(what)
            if random.random() < .2:
                one.settimeout(.05)
                one.recv(4096)
        except OSError:
            pass
        sent += 1
        kept.append(one)
        if len(kept) > 200:
            kept.pop(0).close()
    longest = max(longest, ask())
# Whatever else the machine does, where the test runs for a few seconds among others.
assert longest < (1 if seconds > 6 else 5), longest
print("%d requests, a page after %.2f s at most" % (sent, longest))
PY
(ulimit -n 4096 2>/dev/null || true; checks "$work/attack.py" "$(cat "$work/address")" "$seconds") >"$work/found" 2>>"$work/said" ||
  fail "requests"
# Of the program alone: sanitizers keep freed memory.
[ -n "${FOILGAUGE_TEST_BRIEF:-}" ] || [ "$(awk '/VmHWM/ { print int($2 / 1024) }' "/proc/$station/status")" -lt 250 ] || fail "memory"

# In the folder: a scan becomes a pipe, a link or a folder between the look at it and its reading.
python3 - "$work/in" "$work/2.png" "$seconds" <<'PY'
import os, sys, time
folder, scan, seconds = sys.argv[1], sys.argv[2], float(sys.argv[3])
os.chdir(folder)
data, end, k = open(scan, "rb").read(), time.monotonic() + seconds, 0
def as_pipe(name): os.mkfifo(name)
def as_folder(name): os.mkdir(name)
def as_zero(name): os.symlink("/dev/zero", name)
def as_terminal(name): os.symlink("/dev/tty", name)
def as_loop(name): os.symlink(name, name)
def as_itself(name): os.symlink("/proc/self/mem", name)
makers = [as_pipe, as_folder, as_zero, as_terminal, as_loop, as_itself]
while time.monotonic() < end:
    for make in makers:
        k += 1
        name, other = "swap%d.png" % (k % 20), ".other%d" % k
        with open(".new", "wb") as file:
            file.write(data[:-12] + os.urandom(8) + data[-12:])
        make(other)
        try:
            os.rename(".new", name)
            time.sleep(.0005 * (k % 7))
            os.rename(other, ".gone%d" % k) if os.path.isdir(other) else os.rename(other, name)
        except OSError:
            pass
for name in os.listdir("."):
    if name.startswith((".gone", ".other", "swap", ".new")):
        os.rmdir(name) if os.path.isdir(name) and not os.path.islink(name) else os.unlink(name)
PY
# By its name: a scan that was swapped may be measured still.
kept() { # FILE
  [ "$(python3 -c 'import sqlite3, sys
print(sqlite3.connect(f"file:{sys.argv[1]}?mode=ro", uri=True)
      .execute("SELECT count(*) FROM scans WHERE path = ?1 OR path LIKE ?2", (sys.argv[2], "%/" + sys.argv[2])).fetchone()[0])' \
    "$work/in/foilgauge.sqlite" "$1")" -eq 1 ]
}
cp "$work/3.png" "$work/in/3.png"
wait_for 20 kept 3.png

# The station's own file is replaced: the station says so, and goes on when that is over.
for what in garbage folder pipe other; do
  draw "$((RANDOM + 10))" "$work/next.png"
  : >"$work/said"
  rm -rf "$work/put"
  case $what in
    garbage) head -c 5000 "$work/2.png" >"$work/put" ;;
    folder) mkdir "$work/put" ;;
    pipe) mkfifo "$work/put" ;;
    other) python3 -c 'import sqlite3, sys; sqlite3.connect(sys.argv[1]).executescript("PRAGMA user_version = -5; CREATE TABLE a (b)")' "$work/put" ;;
  esac
  # A station that finds none makes another one meanwhile.
  until rm -f "$work"/in/*.png "$work"/in/foilgauge.sqlite* && mv -T "$work/put" "$work/in/foilgauge.sqlite" 2>/dev/null; do :; done
  wait_for 20 grep -q "it is tried again" "$work/said"
  kill -0 "$station" || fail "$what in the place of the database ends the station"
  rm -rf "$work"/in/foilgauge.sqlite*
  cp "$work/next.png" "$work/in/next.png"
  wait_for 20 measured "$work/in" 1
done
stop TERM
[ $code -eq 130 ] || fail "exit code $code"
echo "attacked: $(cat "$work/found"); files swapped; the database replaced in four ways"
