#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Random bearings of `foilgauge film` on a Slurm cluster: an array of parts, then the report when all of them are done.
#   film.sh OUTPUT TASKS ARGUMENTS...
#   film.sh shims 50 design.json --load 20 --speed 60000 --clearance 40 --shims=-7:7 --draws 100000
# The folder of OUTPUT and the files of the arguments must be seen by every node; relative paths count from where this is called.
set -euo pipefail
if [ $# -lt 3 ]; then
  echo "usage: film.sh OUTPUT TASKS ARGUMENTS..." >&2
  exit 64
fi
output=$(realpath -m "$1") tasks=$2
shift 2
program=${FOILGAUGE:-foilgauge}
mkdir -p "$output"
arguments=$(printf '%q ' "$@")

# A task that is killed and requeued goes on where it stopped: its draws are kept. Exit code 2 (no film under these foils) is an answer.
task="'$program' film $arguments --jobs \${SLURM_CPUS_PER_TASK:-1} --keep '$output'/draws.\$SLURM_ARRAY_TASK_ID \
  --shard \$SLURM_ARRAY_TASK_ID/$tasks -o '$output'/part.\$SLURM_ARRAY_TASK_ID.json || [ \$? -eq 2 ]"
array=$(sbatch --parsable --array="1-$tasks" --cpus-per-task=2 --mem=1G --requeue --job-name=foilgauge-film --output="$output/%a.log" --wrap="$task")
join="cat '$output'/draws.[0-9]* >'$output'/draws && '$program' film $arguments --keep '$output'/draws -o '$output'/film.json \
  --html '$output'/film.html --draws-out '$output'/draws.csv || [ \$? -eq 2 ]"
sbatch --parsable --dependency="afterok:$array" --job-name=foilgauge-film-report --output="$output/report.log" --wrap="$join"
echo "$tasks tasks; the report will be $output/film.html" >&2
