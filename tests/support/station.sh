# SPDX-License-Identifier: GPL-3.0-or-later
# Shared functions of the tests of a running station; sourced from the checkout with the program's path and `name`, the
# test's. Files go to $work, which is removed at the end, when the station is ended too.
set -euo pipefail
. "${BASH_SOURCE[0]%/*}/checks.sh"
program=$(realpath "$1")
renderer=${FOILGAUGE_RENDERER-}
[ -x "$renderer" ] || renderer=$program
work=$(mktemp -d)
station=
at_end() { :; } # of a test that has more to take back
# A child that is killed before it runs its program comes here, too: the folder is its parent's.
end() {
  [ "$BASHPID" = $$ ] || return 0
  [ -z "$station" ] || kill -9 "$station" 2>/dev/null || true
  at_end
  rm -rf "$work"
}
trap end EXIT

fail() {
  echo "$name: $*" >&2
  [ ! -s "$work/said" ] || tail -n 20 "$work/said" | sed 's/^/  said: /' >&2
  exit 1
}
# draw SEED FILE: a scan of a foil with two bumps. recipe: for all of them.
draw() {
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200},
    "foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]}' "$1" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$2"
}
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1", "design": {"schema": "foilgauge/design/1", "bump_count": 2}}
R
recipe="--recipe $work/recipe.json"
# start FOLDER [OPTION...]: a station in the background; its number in $station, its words in $work/said.
start() {
  local folder=$1
  shift
  : >"$work/address"
  env --default-signal=INT,HUP "$program" station "$folder" --port 0 "$@" >"$work/address" 2>>"$work/said" &
  station=$!
  for ((i = 0; i < 1500; i++)); do
    [ ! -s "$work/address" ] || return 0
    kill -0 "$station" 2>/dev/null || fail "the station has ended"
    sleep 0.02
  done
  fail "no address"
}
# stop [SIGNAL]: ends the station; its exit code in $code.
stop() {
  code=0
  kill -"${1:-9}" "$station"
  wait "$station" 2>/dev/null || code=$?
  station=
}
# wait_for SECONDS COMMAND...
wait_for() {
  local end=$((SECONDS + $1))
  shift
  while ! "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || fail "waited in vain: $*"
    sleep 0.05
  done
}
measured() { # FOLDER COUNT
  [ "$(python3 -c 'import sqlite3, sys
print(sqlite3.connect(f"file:{sys.argv[1]}/foilgauge.sqlite?mode=ro", uri=True)
      .execute("SELECT count(*) FROM scans").fetchone()[0])' "$1")" -eq "$2" ]
}
