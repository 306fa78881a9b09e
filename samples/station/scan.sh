#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Scans for measurement through SANE: gray, as many bits as there are, a straight tone curve, no
# sharpening, no loss. A driver's defaults are made for documents and photographs.
#
#   scan.sh FILE [DPI [OPTIONS OF SCANIMAGE, as -x 100 -y 60]]
#   scan.sh --show [DPI [OPTIONS]]     writes the scanimage command that it would run
#
# SCANNER=DEVICE in the environment, as `scanimage -L` names it; without, SANE's first scanner.
# In a recipe: "scan_command": "sh /etc/foilgauge/scan.sh {file} 4800"
set -eu

[ $# -ge 1 ] || { sed -n '3,10s/^# \{0,1\}//p' "$0" >&2; exit 64; }
file=$1
dpi=${2:-4800}
shift
[ $# -eq 0 ] || shift
case $file in
*.tif | *.tiff) format=tiff ;;
*.pnm) format=pnm ;;
*) format=png ;;
esac

refuse() {
  echo "scan.sh: $*" >&2
  exit 65
}

# scanimage with what is set so far: "set" holds an option and its value per line.
set_so_far=
newline='
'
run() {
  old_ifs=$IFS
  IFS=$newline
  # shellcheck disable=SC2086
  set -- "$@" $set_so_far
  IFS=$old_ifs
  scanimage ${SCANNER:+--device-name="$SCANNER"} "$@"
}

list() { run --all-options 2>/dev/null; }

# choices OPTION: what it can be, one a line; nothing where the scanner does not have it, or not now.
choices() {
  printf '%s\n' "$options" | awk -v option="--$1" '
    { sub(/^ +/, "") }
    index($0, option) != 1 { next }
    {
      rest = substr($0, length(option) + 1)
      if (rest !~ /^( |\[=)/ || rest ~ /\[(inactive|read-only)\]/) next
      sub(/^\[=\(/, "", rest) && sub(/\)\].*$/, "", rest)
      while (sub(/ \[[^][]*\]$/, "", rest)) continue
      sub(/^ +/, "", rest)
      gsub(/\|/, "\n", rest)
      print rest
    }'
}

# allows CHOICES VALUE: it is one of them, or lies in their range, as 1..1200dpi.
allows() {
  printf '%s\n' "$1" | awk -v value="$2" '
    { whole = $0; sub(/(dpi|bit|%)$/, "") }
    $0 == value || whole == value { found = 1 }
    split(whole, range, /\.\./) == 2 && value + 0 >= range[1] + 0 && value + 0 <= range[2] + 0 { found = 1 }
    END { exit !found }'
}

# put OPTION VALUE...: the first of the values that it can be.
put() {
  option=$1
  shift
  can=$(choices "$option")
  [ -n "$can" ] || return 0
  for value in "$@"; do
    allows "$can" "$value" || continue
    set_so_far="$set_so_far${set_so_far:+$newline}--$option=$value"
    options=$(list)
    return 0
  done
}

has() { printf '%s\n' "$set_so_far" | grep -q -- "^--$1="; }

# straight OPTION: a gamma table that is a straight line. Its last index is in what scanimage says of
# one that is too large.
straight() {
  top=$(choices "$1" | sed -n 's/^[^.]*\.\.\([0-9]*\).*/\1/p')
  [ -n "$top" ] || return 0
  last=$(run --dont-scan "--$1=[0]0-[999999]$top" 2>&1 | sed -n 's/.*out of range \[0\.\.\([0-9]*\)\].*/\1/p')
  [ -z "$last" ] || set_so_far="$set_so_far${set_so_far:+$newline}--$1=[0]0-[$last]$top"
}

options=$(list) || refuse "no scanner answers: $(run --all-options 2>&1 >/dev/null | tail -n 1)"
put source Flatbed
put mode "16 bits gray" "16bit Gray" Gray "True Gray" Grayscale
has mode || [ -z "$(choices mode)" ] || refuse "no gray among its modes: $(choices mode | tr '\n' ' ')"
# The tone curve: straight. A table of its own only where nothing else bends it.
put gamma-correction "User defined (Gamma=1.0)" "User defined"
put gamma 1
put gamma-value 1
put analog-gamma 1
if ! printf '%s\n' "$set_so_far" | grep -q gamma; then
  put custom-gamma yes
  straight gamma-table
fi
put color-correction None
put brightness 0
put contrast 0
put shadow 0
put highlight 100
# The edges: as the sensor saw them.
put sharpness 0
put sharpen 0
put swdeskew no
put swdespeck 0 no
put swcrop no
put preview no
put quality-scan yes
put high-quality yes
# The gray levels: all of them, and no loss on the way.
for depth in $(choices depth | sed 's/[^0-9]//g' | sort -rn); do
  put depth "$depth"
  break
done
put compression None
put jpeg no
put jpeg-quality 0
can=$(choices resolution)
put resolution "$dpi"
has resolution || [ -z "$can" ] || refuse "the scanner has no $dpi dpi: it has $(printf '%s' "$can" | tr '\n' ' ')"

if [ "$file" = --show ]; then
  printf 'scanimage'
  [ -z "${SCANNER-}" ] || printf ' --device-name="%s"' "$SCANNER"
  printf '%s\n' "$set_so_far" | sed "s/=\(.*[^-A-Za-z0-9.,_].*\)\$/='\1'/" | while read -r line; do printf ' %s' "$line"; done
  printf ' --format=png --output-file={file}'
  [ $# -eq 0 ] || printf ' %s' "$*"
  echo
  exit 0
fi
run "--format=$format" "$@" >"$file"
