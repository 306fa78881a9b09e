#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Measures a lot on a Slurm cluster: an array of shards, then the merge when all of them are done.
#   lot.sh manifest.csv recipe.json OUTPUT [SCANS_PER_TASK]
# The folder of the manifest, of the recipe and of OUTPUT must be seen by every node.
set -euo pipefail
if [ $# -lt 3 ]; then
  echo "usage: lot.sh MANIFEST.csv RECIPE.json OUTPUT [SCANS_PER_TASK]" >&2
  exit 64
fi
manifest=$(realpath "$1") recipe=$(realpath "$2") output=$(realpath -m "$3") each=${4:-500}
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=${FOILGAUGE:-foilgauge}

scans=$("$program" lot "$manifest" --recipe "$recipe" -o "$output" --dry-run | cut -d ' ' -f 1)
tasks=$(((scans + each - 1) / each))
array=$(sbatch --parsable --array="1-$tasks" "$here/lot.sbatch" "$manifest" "$recipe" "$output.shards")
# Exit codes 1 (out of tolerance), 2 (a scan not measured) and 3 (cannot tell) are answers, not failures.
merge="$program merge $(seq -f "'$output.shards/%.0f'" -s ' ' "$tasks") -o '$output' || [ \$? -le 3 ]"
sbatch --parsable --dependency="afterok:$array" --job-name=foilgauge-merge --output="$output.merge.log" --wrap="$merge"
echo "$scans scans in $tasks tasks; the report will be $output/index.html" >&2
