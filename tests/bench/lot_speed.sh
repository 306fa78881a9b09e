#!/bin/bash
# Scans per second of a lot on one and on two jobs, against one scan after another with `measure --threads 1`,
# and the memory of each. 1,000 scans by default: copies of 20 rendered foils of nine bumps at 4800 dpi (hard links,
# so that the disk is not what is measured; every link is hashed, read and measured on its own). Writes
# reports/lot_speed.csv and .md.
#   tests/bench/lot_speed.sh [SCANS]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
scans=${1:-1000}
program=$PWD/build/foilgauge
run_timed=$PWD/build/bench/run_timed
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

load=$(cut -d ' ' -f 1 /proc/loadavg)

mkdir "$folder/foils" "$folder/scans"
for i in $(seq 20); do
  sed "s/\"seed\": 1/\"seed\": $i/" samples/render/clean.json >"$folder/spec.json"
  "$program" render "$folder/spec.json" -o "$folder/foils/$i.png"
done
for i in $(seq "$scans"); do
  ln "$folder/foils/$(((i - 1) % 20 + 1)).png" "$folder/scans/foil$(printf '%06d' "$i").png"
done

# seconds COMMAND...: wall time; the peak memory in KiB goes to the file `peak`.
seconds() {
  "$run_timed" "$folder/cost" "$@" >/dev/null 2>&1 || [ $? -le 3 ]
  cut -d ' ' -f 4 "$folder/cost" >"$folder/peak"
  cut -d ' ' -f 1 "$folder/cost"
}

single=$(seconds "$program" measure "$folder"/foils/*.png --threads 1 -o "$folder/all.json" | awk '{ printf "%.4f", 20 / $1 }')
printf 'how,scans,seconds,scans_per_second,against_single,peak_mib\n' >"$folder/table.csv"
printf 'measure --threads 1,20,,%s,1,%.0f\n' "$single" "$(awk '{ print $1 / 1024 }' "$folder/peak")" >>"$folder/table.csv"
for part in $((scans / 4)) "$scans"; do
  find "$folder/scans" -name '*.png' | sort | head -n "$part" >"$folder/list.txt"
  for jobs in 1 2; do
    rm -rf "$folder/lot"
    wall=$(seconds "$program" lot "$folder/list.txt" -o "$folder/lot" --jobs $jobs)
    awk -v j=$jobs -v n="$part" -v s="$wall" -v one="$single" -v peak="$(cat "$folder/peak")" \
      'BEGIN { printf "lot --jobs %d,%d,%.1f,%.2f,%.2f,%.0f\n", j, n, s, n / s, n / s / one, peak / 1024 }' >>"$folder/table.csv"
  done
done
cp "$folder/table.csv" reports/lot_speed.csv
{
  echo "# Speed of a lot"
  echo
  echo "$(nproc) cores, load before the run $load. Scans are hard links to 20 rendered foils (nine bumps, 4800 dpi); wall time holds everything:"
  echo "hashing, measuring, keeping every record, the report. \`tests/bench/lot_speed.sh\` makes this page."
  echo
  echo "| how | scans | seconds | scans a second | against one at a time | peak memory, MiB |"
  echo "|---|---|---|---|---|---|"
  tail -n +2 "$folder/table.csv" | sed 's/^/| /; s/,/ | /g; s/$/ |/'
} >reports/lot_speed.md
cat reports/lot_speed.md
