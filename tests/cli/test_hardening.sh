#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Program, shared library and module as they are built, and as they lie in the package: canaries on the stack, checked
# lengths (FORTIFY), full RELRO with addresses bound at the start, position independent, no executable stack.
set -u
if [ -n "${FOILGAUGE_TEST_BRIEF:-}" ]; then
  echo "skipped: a build with sanitizers has its own checks"
  exit 77
fi
command -v readelf >/dev/null || { echo "skipped: no readelf"; exit 77; }
. tests/support/cli.sh
build=$(dirname "$program")

# check FILE: what the dynamic section, the program headers and the imported symbols say.
check() {
  local file=$1
  readelf -hW "$file" | grep -q 'Type: *DYN' || fail "$file is not position independent"
  readelf -lW "$file" | grep -q GNU_RELRO || fail "$file has no RELRO"
  readelf -dW "$file" | grep -Eq 'BIND_NOW|FLAGS_1.*NOW' || fail "$file does not bind all addresses at its start"
  readelf -lW "$file" | grep GNU_STACK | grep -q 'RWE' && fail "$file has an executable stack"
  readelf --dyn-syms -W "$file" | grep -q '__stack_chk_fail' || fail "$file has no canaries on the stack"
  readelf --dyn-syms -W "$file" | grep -Eq '__[a-z_]+_chk@' || fail "$file has no checked calls (FORTIFY)"
}

check "$program"
check "$(find "$build" -maxdepth 1 -name 'libfoilgauge.so.*.*.*' -type f)"
check "$build/foilgauge-opencv.so"

# Stripped and packed: of the package that users install.
if command -v cpack >/dev/null && command -v dpkg-shlibdeps >/dev/null && command -v dpkg-deb >/dev/null; then
  cpack --config "$build/CPackConfig.cmake" -B "$work/made" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip >"$work/log" 2>&1 ||
    fail "cpack: $(tail -n 5 "$work/log")"
  dpkg-deb -x "$(ls "$work"/made/foilgauge_*.deb)" "$work/open"
  count=0
  while read -r file; do
    check "$file"
    count=$((count + 1))
  done < <(find "$work/open" -type f \( -path '*/bin/*' -o -name '*.so*' \))
  [ "$count" -eq 3 ] || fail "$count binaries in the package, not program, library and module"
fi
exit $failed
