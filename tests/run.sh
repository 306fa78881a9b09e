#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds foilgauge and tests it; --help says what each option adds or leaves out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. tests/packages.sh
. tests/long.sh

usage() {
  cat <<'U'
usage: tests/run.sh [--quick | --long [PART...] | --help]

  (nothing)  builds foilgauge twice, for release in build/ and with sanitizers and warnings as errors in build-sanitize/,
             and runs every test in both: some fifteen minutes on two cores, of which the tests take eleven
  --quick    builds for release alone and runs the tests that are labelled `quick`: less than a minute after the build.
             Every room's unit tests and a script for each command are among them
  --long     what takes hours, in parts of less than two hours each on two cores (one that takes longer fails): all of them,
             or those that are named. Several rewrite pages of reports/; what a part says goes to build/long/
U
  long_parts | sed -n 's/^\([a-z-]*\): /               \1: /p'
  cat <<'U'

After a build, `ctest --test-dir build -R NAME` runs the tests with NAME in theirs, and `ctest --test-dir build -L LABEL`
those of a room, a command or a kind: station, loop, lot, render, unit, cli, fuzz (`ctest --test-dir build --print-labels`).
U
}

tier=whole
case "${1-}" in
  '') ;;
  --quick) tier=quick ;;
  --long) tier=long ;;
  --help | -h)
    usage
    exit 0
    ;;
  *) tier= ;;
esac
if [ $tier = long ]; then
  shift
  [ $# -gt 0 ] || set -- $(long_names)
  for part in "$@"; do
    [ -n "$(long_commands "$part")" ] || { echo "tests/run.sh: no part is named '$part'; --help lists them" >&2; exit 64; }
  done
elif [ -z "$tier" ] || [ $# -gt 1 ]; then
  usage >&2
  exit 64
fi

# One more test at once than there are cores: the station's tests wait more than they work.
jobs=$(($(nproc) + 1))
install_missing $FOILGAUGE_PACKAGES
# A version manager's python3 is a script that takes a tenth of a second, and the tests call Python a thousand times.
PATH=$(dirname "$(python3 -c 'import sys; print(sys.executable)' 2>/dev/null || command -v sh)"):$PATH
build_preset release build
if [ $tier = quick ]; then
  exec ctest --test-dir build -L quick --output-on-failure -j$jobs
fi
if [ $tier = long ]; then
  install_missing $FOILGAUGE_BENCH_PACKAGES $FOILGAUGE_R_PACKAGES $FOILGAUGE_BROWSER_PACKAGES $FOILGAUGE_SCHEMA_PACKAGES $FOILGAUGE_SHOP_PACKAGES
  install_missing $FOILGAUGE_CHROOT_PACKAGES
  # The numbers of Debian's python3, whatever stands before it in PATH.
  PATH=/usr/bin:$PATH
  case " $* " in *" sanitized "*) build_preset sanitize build-sanitize ;; esac
  run_long "$@"
  exit
fi
build_preset sanitize build-sanitize

# The sanitized tree looks at scans that the release tree draws; drawing has tests of its own in both.
export FOILGAUGE_RENDERER=$PWD/build/foilgauge
# Both trees are tested even when the first fails; ctest's own summary is the last thing said.
code=0
for tree in build build-sanitize; do
  echo "testing $tree/"
  ctest --test-dir "$tree" --output-on-failure -j$jobs || code=$?
done
exit $code
