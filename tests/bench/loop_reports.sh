#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# reports/thesis/loop_* and reports/blind/: the loop on the thesis's measured tables and on the tables
# whose truth is not published. Needs the data folder ($FOILGAUGE_SHARED, or ../shared).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
shared=$(cd "${FOILGAUGE_SHARED:-$root/../shared}" && pwd)
loop() { "$root/build/foilgauge" loop "$@"; }

thesis=$root/reports/thesis
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$root"/tests/data/thesis/table_5_[14].csv "$work"
# Table 5.4 with the responses that table 5.1 gives for its corner runs 1, 3, 5 and 7.
awk -F, -v OFS=, 'NR == FNR { y[$1] = $5; next } FNR > 1 && $1 <= 8 { $4 = y[$1] } { print }' \
  "$work/table_5_1.csv" "$work/table_5_4.csv" >"$work/table_5_4_corners_of_5_1.csv"
# All thirteen runs in one table.
awk -F, -v OFS=, 'NR == FNR { print; next } FNR > 1 && $1 > 8 { print $1, 300, $2, $3, $4 }' \
  "$work/table_5_1.csv" "$work/table_5_4.csv" >"$work/thirteen_runs.csv"
cd "$work"
eq53="1 + temperature_C + duration_h + temperature_C:duration_h"
eq54="$eq53 + temperature_C^2 + duration_h^2"
run() { # NAME TABLE MODEL
  loop --table "$2" --response springback_error_pct --model "$3" \
    -o "$thesis/loop_$1.json" --html "$thesis/loop_$1.html"
}
run table_5_1_eq_5_3 table_5_1.csv "$eq53"
run table_5_4_eq_5_4 table_5_4.csv "$eq54"
run table_5_4_corners_of_5_1 table_5_4_corners_of_5_1.csv "$eq54"
run thirteen_runs thirteen_runs.csv "$eq54"

cd "$shared/blind"
for declared in [tl]*.declared.json; do
  name=${declared%.declared.json}
  loop --table "$name.csv" --declared "$declared" -o "$root/reports/blind/$name.json" \
    --html "$root/reports/blind/$name.html"
done
/usr/bin/python3 "$root/tests/bench/loop_blind_tables.py" "$root/reports/blind"
