#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scanning: samples/station/scan.sh sets every option that a scanner has, by its driver's own list,
# and no other; the station names options of its scan_command that spoil a scan, and none else.
# Usage: test_scan_command.sh PROGRAM
name=test_scan_command
. "$(dirname "$0")/../support/station.sh"
scan=$(dirname "$(realpath "$0")")/../../samples/station/scan.sh
real=$(command -v scanimage || true)

# Drivers as they list their options; some have them only in gray. The arguments of each scan are noted.
mkdir "$work/bin"
cat >"$work/bin/scanimage" <<'S'
#!/bin/bash
mode=Lineart
for word in "$@"; do
  case $word in
  --mode=*) mode=${word#--mode=} ;;
  --gamma-table=*99999*) echo "scanimage: option --gamma-table: index 999999 out of range [0..4095]" >&2; exit 1 ;;
  --all-options) list=1 ;;
  esac
done
if [ -z "${list-}" ]; then
  printf '%s\n' "$@" >"$ASKED"
  printf scan
  exit
fi
gray=inactive
[ "$mode" = Lineart ] || gray=8
case $DRIVER in
epson2) cat <<O
    --mode Lineart|Gray|Color [$mode]
    --depth 8|12|16bit [$gray]
    --brightness -4..3 [0]
    --sharpness -2..2 [0]
    --gamma-correction User defined (Gamma=1.0)|User defined (Gamma=1.8) [User defined (Gamma=1.8)]
    --color-correction None|Built in CCT profile|User defined CCT profile [Built in CCT profile] [advanced]
    --resolution 300|1200|2400|4800dpi [300]
    --preview[=(yes|no)] [no]
    --eject
O
;;
pixma) cat <<O
    --resolution auto||75|150|2400|4800dpi [75]
    --mode auto|Color|Gray|48 bits color|16 bits gray [Color]
    --source Flatbed|Transparency Unit [Flatbed]
    --custom-gamma[=(auto|yes|no)] [no]
    --gamma-table auto|0..255,... [inactive]
    --gamma auto|0.299988..5 [2.2]
    --calibrate auto|Once|Always|Never [Once]
O
;;
genesys) cat <<O
    --mode Color|Gray [$mode]
    --depth 8|16bit [8]
    --resolution 4800|2400|1200dpi [300]
    --custom-gamma[=(yes|no)] [no] [advanced]
    --gamma-table 0..65535,... [advanced]
    --brightness -100..100 (in steps of 1) [0]
    --contrast -100..100 (in steps of 1) [0]
    --swdeskew[=(yes|no)] [no]
    --lamp-off-scan[=(yes|no)] [no]
O
;;
hpaio) cat <<O
    --mode Lineart|Gray|Color [Color]
    --resolution 75|1200|2400|4800dpi [75]
    --contrast -127..127 [0] [advanced]
    --compression JPEG [JPEG] [advanced]
    --jpeg-quality 0..100 [10] [advanced]
O
;;
esac
S
chmod +x "$work/bin/scanimage"
export ASKED=$work/asked
path=$PATH
PATH=$work/bin:$PATH
# shown DRIVER: the command that scan.sh would run, for a driver's list of options.
shown() { DRIVER=$1 sh "$scan" --show 4800 || fail "scan.sh --show of $1"; }
expect() { # DRIVER WORDS: the options that are set, besides format and file
  local is
  is=$(shown "$1")
  [ "$is" = "scanimage $2 --resolution=4800 --format=png --output-file={file}" ] || fail "$1: $is"
}
expect epson2 "--mode=Gray --gamma-correction='User defined (Gamma=1.0)' --color-correction=None --brightness=0 --sharpness=0 --preview=no --depth=16"
expect pixma "--source=Flatbed --mode='16 bits gray' --gamma=1"
expect genesys "--mode=Gray --custom-gamma=yes --gamma-table='[0]0-[4095]65535' --brightness=0 --contrast=0 --swdeskew=no --depth=16"
expect hpaio "--mode=Gray --contrast=0 --jpeg-quality=0"
(cd "$work" && DRIVER=epson2 sh "$scan" .hidden.tif 2400 -x 60) || fail "scan.sh does not scan"
[ "$(cat "$work/.hidden.tif")" = scan ] || fail "the scan is not in its file"
for word in --gamma-correction='User defined (Gamma=1.0)' --resolution=2400 --depth=16 --format=tiff -x 60; do
  grep -qxF -- "$word" "$ASKED" || fail "scan.sh does not ask for $word: $(cat "$ASKED")"
done
DRIVER=epson2 sh "$scan" "$work/x.png" 3000 2>"$work/said" && fail "3000 dpi, which it does not have"
grep -q 'no 3000 dpi: it has 300 1200 2400 4800' "$work/said" || fail "$(cat "$work/said")"
sh "$scan" 2>"$work/said" && fail "no file is no usage"
grep -q 'scan.sh FILE' "$work/said" || fail "no usage: $(cat "$work/said")"

# SANE's own scanimage, with the backend that draws test pictures.
PATH=$path
if [ -n "$real" ] && "$real" -d test --test-picture Grid -n 2>/dev/null; then
  SCANNER="test" sh "$scan" "$work/grid.png" 300 -x 60 -y 40 --test-picture Grid || fail "the test backend"
  [ "$(od -An -tu1 -j24 -N2 "$work/grid.png" | tr -d ' ')" = 160 ] || fail "the test backend: not gray of 16 bits"
fi

# start COMMAND: a station with this scan_command; its messages are in $work/err, its page in $work/page.
start() {
  rm -rf "$work/in" "$work/address"
  mkdir "$work/in"
  python3 - "$1" >"$work/recipe.json" <<'P'
import json, sys
print(json.dumps({"schema": "foilgauge/recipe/1", "station": {"scan_command": sys.argv[1]}}))
P
  "$program" station "$work/in" --recipe "$work/recipe.json" --port 0 >"$work/address" 2>"$work/err" &
  station=$!
  for _ in $(seq 100); do
    [ ! -s "$work/address" ] || break
    sleep 0.05
  done
  python3 -c 'import sys, urllib.request as u; print(u.urlopen(sys.argv[1]).read().decode())' \
    "$(head -n 1 "$work/address")" >"$work/page" || fail "no page: $(cat "$work/err")"
  kill "$station"
  wait "$station" 2>/dev/null || true
  station=
}
PATH=$work/bin:$PATH
for driver in epson2 pixma genesys hpaio; do
  start "$(shown $driver)"
  ! grep -q scan_command "$work/err" || fail "what scan.sh sets of $driver is said to spoil a scan: $(cat "$work/err")"
  grep -q 'spoils scans' "$work/page" && fail "the page warns of $driver"
done
start 'scanimage --mode Lineart --sharpness 2 --format=jpeg >{file}'
for words in '--mode Lineart: There are so few' 'Write --mode Gray.' '--sharpness 2: The picture is sharpened' \
  'Write --sharpness 0.' '--format jpeg: ' 'Write --format png.'; do
  grep -qF -- "$words" "$work/err" || fail "not said at the start: $words: $(cat "$work/err")"
  grep -qF -- "$words" "$work/page" || fail "not on the page: $words"
done
[ "$(grep -c scan_command "$work/err")" = 1 ] || fail "said more than once: $(cat "$work/err")"
