#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The packages for Debian on a system that has nothing else: apt finds all that they need, the program measures, draws, serves
# and computes a film there, its manual is read, a program of ten lines is compiled and linked, and nothing is left when they go.
# FOILGAUGE_MIRROR: where packages come from; without a network the test is skipped.
set -u
. tests/support/package.sh
need cpack dpkg-deb dpkg-shlibdeps mmdebstrap unshare python3
. /etc/os-release
[ "$ID" = debian ] || { echo "skipped: packages of $ID are none of Debian"; exit 77; }
suite=$VERSION_CODENAME
mirror=${FOILGAUGE_MIRROR:-http://deb.debian.org/debian}
python3 -c 'import sys, urllib.request; urllib.request.urlopen(sys.argv[1], timeout=20)' "$mirror/dists/$suite/InRelease" 2>/dev/null ||
  { echo "skipped: no $mirror"; exit 77; }
. tests/support/cli.sh
make_packages
if command -v lintian >/dev/null; then
  lintian --allow-root "$deb" "$dev" >"$work/lintian" 2>&1 || fail "lintian: $(head -n 5 "$work/lintian")"
fi

system=$work/system
mmdebstrap --variant=minbase --include=man-db "$suite" "$system" "$mirror" >"$work/log" 2>&1 ||
  fail "mmdebstrap: $(tail -n 3 "$work/log")"
cp /etc/resolv.conf "$system/etc/"
# inside COMMAND...: in the new system, with a /proc and a /dev that go with the command.
inside() {
  unshare --mount --pid --fork sh -c 'system=$1; shift; mount -t proc proc "$system/proc" && mount --rbind /dev "$system/dev" &&
    exec chroot "$system" "$@"' sh "$system" env LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}
apt() { inside apt-get -y --no-install-recommends "$@" >"$work/log" 2>&1 || fail "apt-get $1: $(tail -n 3 "$work/log")"; }
installed() { inside dpkg-query -W -f '${binary:Package}\n' | sort; }

installed >"$work/before"
cp "$deb" "$dev" "$system/tmp/"
apt update
apt install "/tmp/$(basename "$deb")"
installed | comm -13 "$work/before" - >"$work/brought"
echo "foilgauge brings $(wc -l <"$work/brought") packages: $(paste -sd ' ' "$work/brought")"
grep -E 'mpi|petsc|trilinos|scalapack' "$work/brought" && fail "what no foil needs is brought"
inside ldd /usr/bin/foilgauge /usr/lib/foilgauge/foilgauge-opencv.so | grep 'not found' && fail "a library is missing"

doc=/usr/share/doc/foilgauge
listened="stdout stderr"
expect 0 "^foilgauge [0-9]" inside foilgauge version
expect 0 "" inside foilgauge measure $doc/samples/gen2_foil.png -o /tmp/a.json --overlay /tmp/a.png --html /tmp/a.html
"$program" measure "$root/samples/gen2_foil.png" -o "$work/here.json" 2>"$work/log" || fail "measured here: $(cat "$work/log")"
radius='"%.6f" % r["foils"][0]["bumps"][4]["radius_mm"]'
[ "$(value "$system/tmp/a.json" "$radius")" = "$(value "$work/here.json" "$radius")" ] || fail "another radius there"
[ -s "$system/tmp/a.png" ] && [ -s "$system/tmp/a.html" ] || fail "no overlay, or no page"
expect 0 "^Usage: foilgauge station" inside foilgauge station --help
expect 0 "critical" inside foilgauge film --load 5 --speed 60000
mkdir "$system/tmp/shop"
cp "$root/samples/gen2_foil.png" "$system/tmp/shop/"
expect 0 "1 measured" inside foilgauge station /tmp/shop --once
# Libraries that the program loads itself: of TIFFs (an empty one of 300 by 300 px), and of the station's pages.
python3 - "$system/tmp/empty.tif" <<'PY'
import struct, sys
tags = [(256, 3, 300), (257, 3, 300), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 200), (277, 3, 1), (278, 3, 300),
        (279, 4, 90000), (282, 5, 180), (283, 5, 180), (296, 3, 2)]
head = struct.pack("<2sHIH", b"II", 42, 8, len(tags))
head += b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags) + bytes(4)
open(sys.argv[1], "wb").write(head.ljust(180, b"\0") + struct.pack("<II", 600, 1).ljust(20, b"\0") + b"\xc8" * 90000)
PY
expect 65 "no foil in the picture" inside foilgauge measure /tmp/empty.tif
inside timeout -s INT 60 foilgauge station /tmp/shop --port 0 >"$work/address" 2>"$work/said" &
station=$!
for ((i = 0; i < 300; i++)); do
  grep -q http "$work/address" && break
  sleep 0.1
done
python3 -c 'import sys, urllib.request
page = urllib.request.urlopen(open(sys.argv[1]).read().strip()).read().decode()
assert "gen2_foil" in page, page[:500]' "$work/address" || fail "no page of the station: $(head -n 3 "$work/said")"
wait $station
expect 0 "FOILGAUGE-MEASURE\(1\)" inside man -P cat foilgauge-measure
expect 0 "gas film" inside man -P cat foilgauge-film

# The library by pkg-config, with what Debian's compiler brings and no other header.
apt install gcc libc6-dev pkgconf "/tmp/$(basename "$dev")"
cat >"$system/tmp/ten.c" <<'C'
#include <stdio.h>
#include <foilgauge/design.h>
#include <foilgauge/version.h>
int main(void) {
  fg_design design;
  fg_design_default(&design);
  return printf("library %s\n", fg_version()) < 0;
}
C
expect 0 "" inside sh -c 'gcc -Wall -Werror /tmp/ten.c -o /tmp/ten $(pkg-config --cflags --libs foilgauge)'
expect 0 "^library $("$program" version | cut -d' ' -f2)" inside /tmp/ten

rm -rf "$system"/tmp/*
apt purge foilgauge foilgauge-dev
inside find / -xdev -path /proc -prune -o -iname '*foilgauge*' ! -path '/var/log/*' ! -path '/var/cache/*' -print >"$work/left"
[ -s "$work/left" ] && fail "left behind: $(head -n 5 "$work/left")"
exit $failed
