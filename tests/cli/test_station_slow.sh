#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Connections that ask slowly, or take their answers slowly, lock nobody out: 500 of them from 50 addresses, 96 from two,
# bodies byte by byte, answers that nobody reads, pages that wait for news. All of it on addresses of this machine
# (127.0.0.x), for some seconds. Usage: test_station_slow.sh PROGRAM [CONNECTIONS ADDRESSES]
name=test_station_slow
. "$(dirname "$0")/../support/station.sh"
connections=${2:-500}
addresses=${3:-50}

mkdir "$work/in"
draw 1 "$work/in/1.png"
start "$work/in" $recipe
wait_for 20 measured "$work/in" 1
cat >"$work/attack.py" <<'PY'
import re, select, socket, sys, threading, time, urllib.parse, urllib.request
base, connections, addresses, long = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
where = urllib.parse.urlparse(base)
there, host = (where.hostname, where.port), where.netloc.encode()
SLOW = b"GET / HTTP/1.1\r\nHost: %s\r\nX-Slow: " % host
BODY = b"POST /close HTTP/1.1\r\nHost: %s\r\nContent-Length: 60000\r\n\r\n" % host
CHUNKED = b"POST /close HTTP/1.1\r\nHost: %s\r\nTransfer-Encoding: chunked\r\n\r\n" % host
ANSWER = b"GET /report?foil=1 HTTP/1.1\r\nHost: %s\r\n\r\n" % host
PIPELINE = (b"GET /lots HTTP/1.1\r\nHost: %s\r\n\r\n" % host) * 100
NOTHING = b""
def connect(address, first, narrow=False):
    one = socket.socket()
    if narrow:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    one.bind((address, 0))
    one.settimeout(5)
    one.connect(there)
    if first:
        one.sendall(first)
    return one
def address(k):
    return "127.0.0.%d" % (2 + k)
longest, asked = {}, {}
# A page that is locked out comes after the 15 s in which the others are cut off; beside other tests it may take a second.
MOST = 1 if long else 5
def ask(what, path=""):
    began = time.monotonic()
    with urllib.request.urlopen(base + path, timeout=20) as answer:
        assert b"foilgauge" in answer.read()
    took = time.monotonic() - began
    longest[what] = max(longest.get(what, 0), took)
    asked[what] = asked.get(what, 0) + 1
    assert took < MOST, "%s: a page took %.2f s" % (what, took)
def is_closed(one):
    try:
        one.settimeout(0)
        while one.recv(1 << 16):
            pass
        return True
    except BlockingIOError:
        return False
    except OSError:
        return True
def drip(what, first, byte, seconds, count=connections, of=addresses, narrow=False, again=True):
    """`count` connections that send another byte every half second, or open again where they were cut off."""
    open_, end = [connect(address(k % of), first, narrow) for k in range(count)], time.monotonic() + seconds
    cut = 0
    while time.monotonic() < end:
        ask(what)
        for k, one in enumerate(open_):
            try:
                if byte:
                    one.sendall(byte)
            except OSError:
                cut += 1
                if again:
                    open_[k] = connect(address(k % of), first, narrow)
        ask(what)
        time.sleep(0.2)
    return open_, cut
def leave(open_):
    for one in open_:
        one.close()
    ask("afterwards")

ask("nobody else")
ask("nobody else")
for what, first, byte in [("headers", SLOW, b"x"), ("nothing", NOTHING, b""), ("bodies", BODY, b"x"),
                          ("chunks", CHUNKED, b"1\r\nx\r\n")]:
    leave(drip(what, first, byte, 3)[0])
leave(drip("pipelines", PIPELINE, b"", 3, 50, 50)[0])
leave(drip("answers that nobody reads", ANSWER, b"", 3, 150, 50, narrow=True)[0])
leave(drip("two addresses", SLOW, b"x", 3, 96, 2)[0])
leave(drip("one address", SLOW, b"x", 3, 300, 1)[0])

# The clock: whoever has not asked in time is cut off although nobody else comes.
began = time.monotonic()
idle = [connect(address(k), first) for k, first in enumerate([SLOW, BODY, NOTHING, CHUNKED])]
dripping = [connect(address(9), SLOW), connect(address(9), BODY)]
while time.monotonic() - began < 18:
    time.sleep(0.5)
    for one in dripping:
        try:
            one.sendall(b"x")
        except OSError:
            pass
assert all(is_closed(one) for one in idle + dripping), "open after %.0f s" % (time.monotonic() - began)

# Answers that nobody takes, more than the system holds ready, are cut off as well.
if long:
    style = b"GET /style.css HTTP/1.1\r\nHost: %s\r\n\r\n" % host
    size = len(urllib.request.urlopen(base + "style.css").read())
    taken = connect(address(3), NOTHING, narrow=True)
    taken.settimeout(1)
    try:
        taken.sendall(4000 * style)
    except OSError:
        pass
    time.sleep(2 + 15 + size / 16384)
    got = 0
    taken.settimeout(3)
    try:
        while piece := taken.recv(1 << 16):
            got += len(piece)
    except ConnectionResetError:
        pass
    assert got < 4000 * size, "%d bytes came" % got

# Pages that wait for news: those of one address do not end those of another.
last = re.search(rb"id: (\d+)", urllib.request.urlopen(base + "events").read())[1]
WAIT = b"GET /events HTTP/1.1\r\nHost: %s\r\nLast-Event-ID: %s\r\n\r\n" % (host, last)
mine = connect("127.0.0.200", WAIT)
many = [connect(address(0), WAIT) for _ in range(200)]
ask("who wait for news")
time.sleep(0.5)
assert not select.select([mine], [], [], 0)[0], "a page that waits was ended by those of another address"
leave(many)
print("%d connections from %d addresses; the longest of each, s: " % (connections, addresses)
      + ", ".join("%s %.2f (%d)" % (what, took, asked[what]) for what, took in longest.items()))
PY
(ulimit -n 4096 2>/dev/null || true; checks "$work/attack.py" "$(cat "$work/address")" "$connections" "$addresses" "${FOILGAUGE_TEST_LONG-}" >"$work/found" 2>>"$work/said") || fail "slow connections"
[ "$(ls "/proc/$station/fd" | wc -l)" -lt 300 ] || fail "open files"
stop TERM
[ $code -eq 130 ] || fail "exit code $code"
echo "slow: $(cat "$work/found")"
