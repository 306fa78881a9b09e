#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The packages for Debian: installed on a root that holds nothing else, used from there, removed without a trace.
set -u
. tests/support/package.sh
need cpack dpkg dpkg-deb dpkg-shlibdeps
. tests/support/cli.sh
make_packages

field() { dpkg-deb -f "$1" "$2"; }
version=$("$program" version | cut -d' ' -f2)
[ "$(field "$deb" Version)" = "$version" ] || fail "version $(field "$deb" Version)"
[ "$(field "$dev" Depends)" = "foilgauge (= $version)" ] || fail "foilgauge-dev depends on $(field "$dev" Depends)"
# Both say under which licence, of every part; the files that the copyright names are in the sources.
for made in "$deb:foilgauge" "$dev:foilgauge-dev"; do
  copyright=$work/${made##*:}.copyright
  dpkg-deb --fsys-tarfile "${made%:*}" | tar -xO "./usr/share/doc/${made##*:}/copyright" >"$copyright" || fail "${made##*:} has no copyright"
  head -n 1 "$copyright" | grep -q '^Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/$' ||
    fail "${made##*:}: the copyright is not machine readable"
  awk '/^$/ { files = 0 } /^Files:/ { files = 1 } /^License:/ && files { print $2 }' "$copyright" | sort -u >"$work/used"
  awk '/^$/ { files = 0 } /^Files:/ { files = 1 } /^License:/ && !files { print $2 }' "$copyright" | sort -u >"$work/told"
  grep -qx GPL-3.0-or-later "$work/used" || fail "${made##*:} is not under GPL-3.0-or-later"
  diff "$work/used" "$work/told" || fail "${made##*:}: a licence is named and not told"
done
(cd "$root" && for files in $(sed -n 's/^Files: //p' "$copyright"); do ls -d $files; done) >/dev/null || fail "the copyright names files that are none"
# Data of others, as tests/data/SOURCES.md names them, stand in the copyright; all else is the project's own.
(cd "$root/tests/data" && ls -d */) | grep -vxE 'truth/|split_plot/' | while read -r folder; do
  grep -qF "tests/data/$folder" "$copyright" || echo "$folder"
done >"$work/untold"
[ -s "$work/untold" ] && fail "tests/data holds what the copyright does not tell: $(cat "$work/untold")"
if command -v lintian >/dev/null; then
  lintian --allow-root "$deb" "$dev" >"$work/lintian" 2>&1
  [ -s "$work/lintian" ] && fail "lintian: $(head -n 5 "$work/lintian")"
fi
# Every library that the program, the shared library and the module are linked with is of a package that is depended on.
dpkg-deb -x "$deb" "$work/open"
dangling=$(find "$work/open" -xtype l)
[ -z "$dangling" ] || fail "links to nothing: $dangling"
links "$work/open/usr/share/doc/foilgauge/README.md"
depends=$(field "$deb" Depends)
find "$work/open" -type f -exec readelf -d {} + 2>/dev/null | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | sort -u >"$work/needed"
[ "$(wc -l <"$work/needed")" -gt 8 ] || fail "what is needed is not found"
dpkg-query -S $(sed 's|^|*/|' "$work/needed") 2>/dev/null >"$work/owners"
while read -r library; do
  owners=$(grep "/$library\$" "$work/owners" | cut -d: -f1 | sort -u)
  echo "$depends" | tr ',' '\n' | awk '{ print $1 }' | grep -qxF "${owners:-nobody}" ||
    fail "$library is of '$owners': not in '$depends'"
done <"$work/needed"

# A root with a shell and the libraries of the packages that are depended on, and nothing else.
root=$work/root
mkdir -p "$root/bin" "$root/sbin" "$root/etc" "$root/tmp" "$root/var/lib/dpkg/updates" "$root/var/lib/dpkg/info"
touch "$root/var/lib/dpkg/status"
cp -L /bin/sh "$root/bin/sh"
cp -L /sbin/ldconfig "$root/sbin/ldconfig"
ldd /bin/sh "$program" | grep -oE '/[^ :]+\.so[^ :]*' | sort -u | xargs cp -L --parents -t "$root"
listing() { (cd "$root" && find . -path ./var -prune -o ! -path ./etc/ld.so.cache -print | sort); }
listing >"$work/before"
dpkg_there() { dpkg --root="$root" --force-depends --log=/dev/null "$@" >"$work/log" 2>&1; }

dpkg_there -i "$deb" "$dev" || fail "dpkg -i: $(tail -n 3 "$work/log")"
[ -f "$root/usr/include/foilgauge/measure.h" ] || fail "no headers"
find "$root/usr" -type f -perm /022 | grep . && fail "others may write what is installed"
cat >"$root/tmp/spec.json" <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5, "foils": [{"rotate_deg": -90}], "scanner": {"dpi": 1200}}
SPEC
expect 0 "" chroot "$root" foilgauge render /tmp/spec.json -o /tmp/foil.png
expect 0 "" chroot "$root" foilgauge measure /tmp/foil.png -o /tmp/a.json
# OpenCV and all that comes with it lie on the real root.
expect 0 "" "$root/usr/bin/foilgauge" measure "$root/tmp/foil.png" -o "$work/a.json" --overlay "$work/a.png"
rm "$root"/tmp/*

dpkg_there -r foilgauge-dev foilgauge || fail "dpkg -r: $(tail -n 3 "$work/log")"
listing >"$work/after"
diff "$work/before" "$work/after" >"$work/differ" || fail "left behind: $(head -n 5 "$work/differ")"
exit $failed
