#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Files that `cmake --install` puts in place work there, wherever that is: the program, its module, its manual, the library
# with the public symbols and no other, in C and in C++, by pkg-config and by find_package.
set -u
if [ -n "${FOILGAUGE_TEST_BRIEF:-}" ]; then
  echo "skipped: nothing is installed of a build with sanitizers"
  exit 77
fi
. tests/support/cli.sh
build=$(dirname "$program")
usr=$work/usr

cmake --install "$build" --prefix "$usr" >"$work/log" 2>&1 || fail "install: $(tail -n 3 "$work/log")"
for there in bin/foilgauge lib/foilgauge/foilgauge-opencv.so include/foilgauge/measure.h lib/pkgconfig/foilgauge.pc \
  lib/cmake/foilgauge/foilgaugeConfig.cmake share/man/man1/foilgauge.1 share/man/man1/foilgauge-measure.1 \
  share/bash-completion/completions/foilgauge share/foilgauge/schema/measure.schema.json \
  share/doc/foilgauge/samples/render/clean.json lib/systemd/system/foilgauge-station.service; do
  find "$usr" -path "*/${there##*lib/}" -type f | grep -q . || fail "$there is not installed"
done
links "$usr/share/doc/foilgauge/README.md"
links "$root/README.md"
grep -q 'man 1 foilgauge-measure' "$usr/share/doc/foilgauge/README.md" || fail "the installed README names no page of the manual"
! grep -rlF "$build" "$usr" || fail "what is installed names the folder where it was built"

# The program where it was put, with a picture, which needs the module.
cat >"$work/spec.json" <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 5, "foils": [{"rotate_deg": -90}], "scanner": {"dpi": 1200}}
SPEC
expect 0 "" "$usr/bin/foilgauge" render "$work/spec.json" -o "$work/foil.png"
expect 0 "" "$usr/bin/foilgauge" measure "$work/foil.png" -o "$work/a.json" --overlay "$work/a.png"

# Symbols: the functions that the public headers declare (the compiler lists them), and no other.
for header in "$usr"/include/foilgauge/*.h; do echo "#include \"foilgauge/${header##*/}\""; done >"$work/all.c"
cc -I"$usr/include" -fsyntax-only -aux-info "$work/declared" "$work/all.c" || fail "all headers"
grep -F "$usr/include/foilgauge/" "$work/declared" |
  sed -n 's|.*\*/ extern [^(]*\b\(fg_[a-z0-9_]*\) (.*|\1|p' | sort -u >"$work/public"
library=$(find "$usr" -name 'libfoilgauge.so.*.*.*')
nm -D --defined-only "$library" | awk '$2 != "A" { print $3 }' | sed 's/@.*//' | sort -u >"$work/exported"
[ "$(wc -l <"$work/public")" -gt 200 ] || fail "the public functions are not found"
diff "$work/public" "$work/exported" >"$work/differ" ||
  fail "exported is not what is public (< declared, > exported): $(head -n 5 "$work/differ")"
readelf -d "$library" | grep -qE 'SONAME.*libfoilgauge\.so\.[0-9]+\.[0-9]+\]' || fail "soname"
readelf -d "$library" | grep -qE 'NEEDED.*opencv|RUNPATH|RPATH' && fail "the library needs what it must not"

# Every public header by itself.
(
  cd "$usr/include/foilgauge" || exit 1
  cc -std=c11 -pedantic -Wall -Wextra -Werror -I.. -fsyntax-only -x c ./*.h &&
    c++ -std=c++17 -pedantic -Wall -Wextra -Werror -I.. -fsyntax-only -x c++ ./*.h
) >"$work/log" 2>&1 || fail "a public header does not stand alone: $(head -n 3 "$work/log")"

# The same ten lines in both languages: the radius of the first bump.
cat >"$work/ten.c" <<'C'
#include <stdio.h>
#include <foilgauge/measure.h>
#include <foilgauge/version.h>
int main(int argc, char **argv) {
  fg_context ctx = {""};
  fg_design design;
  fg_measurement m;
  static fg_measure_options options;
  fg_design_default(&design);
  if (argc < 2 || fg_measure_scan(&ctx, argv[1], &design, &options, &m) != FG_OK) return puts(ctx.message), 1;
  printf("%s %.9f\n", fg_version(), m.foils[0].bumps[0].radius_mm);
  fg_measurement_free(&m);
}
C
cp "$work/ten.c" "$work/ten.cpp"
wanted="$("$program" version | cut -d' ' -f2) $(python3 -c '
import json, sys
print("%.9f" % json.load(open(sys.argv[1]))["foils"][0]["bumps"][0]["radius_mm"])' "$work/a.json")"

# says NAME COMMAND...
says() {
  local name=$1 said
  shift
  said=$("$@" "$work/foil.png" 2>&1)
  [ "$said" = "$wanted" ] || fail "$name says '$said', not '$wanted'"
}

export PKG_CONFIG_PATH
PKG_CONFIG_PATH=$(dirname "$(find "$usr" -name foilgauge.pc)")
libraries=$(dirname "$library")
flags=$(pkg-config --cflags --libs foilgauge) || fail "pkg-config"
cc -std=c11 -Wall -Wextra -Werror "$work/ten.c" -o "$work/by_c" $flags || fail "C by pkg-config"
c++ -std=c++17 -Wall -Wextra -Werror "$work/ten.cpp" -o "$work/by_cpp" $flags || fail "C++ by pkg-config"
says "C by pkg-config" env LD_LIBRARY_PATH="$libraries" "$work/by_c"
says "C++ by pkg-config" env LD_LIBRARY_PATH="$libraries" "$work/by_cpp"

mkdir "$work/user"
cat >"$work/user/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.16)
project(user LANGUAGES C CXX)
find_package(foilgauge 0.1 REQUIRED)
add_executable(shared ../ten.c)
target_link_libraries(shared foilgauge::foilgauge)
add_executable(static ../ten.cpp)
target_link_libraries(static foilgauge::foilgauge_static)
CMAKE
cmake -S "$work/user" -B "$work/user/b" -DCMAKE_PREFIX_PATH="$usr" -DCMAKE_C_COMPILER_WORKS=1 \
  -DCMAKE_CXX_COMPILER_WORKS=1 >"$work/log" 2>&1 && cmake --build "$work/user/b" >>"$work/log" 2>&1 ||
  fail "find_package: $(tail -n 5 "$work/log")"
says "C by find_package" "$work/user/b/shared"
says "C++, static, by find_package" "$work/user/b/static"
! readelf -d "$work/user/b/static" | grep -q libfoilgauge || fail "the static program needs the shared library"

exit $failed
