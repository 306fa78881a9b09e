#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# samples/slurm on a one-machine Slurm that this script starts for itself (Debian: slurm-wlm, munge; needs root): a lot as
# a job array, one task requeued while it runs, the merge, and the report compared with one run's to the byte.
# Exit 77 (skipped) without Slurm or root.
#   tests/bench/slurm_lot.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
for tool in slurmctld slurmd munged sbatch scontrol; do
  if ! PATH=$PATH:/usr/sbin command -v $tool >/dev/null || [ "$(id -u)" != 0 ]; then
    echo "skipped: no $tool, or not root"
    exit 77
  fi
done
export PATH=$PATH:/usr/sbin
export FOILGAUGE=$PWD/build/foilgauge
samples=$PWD/samples
folder=$(mktemp -d)
daemons=()
finish() {
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$folder"
}
trap finish EXIT
chmod 755 "$folder"
host=$(hostname -s)

# start NAME COMMAND...: a daemon in the foreground of a job of ours, ended by its own number.
start() {
  local name=$1
  shift
  "$@" >"$folder/$name.out" 2>&1 &
  daemons+=($!)
}

dd if=/dev/urandom of="$folder/key" bs=128 count=1 status=none
chmod 600 "$folder/key"
mkdir "$folder/state" "$folder/spool"
cat >"$folder/slurm.conf" <<C
ClusterName=foilgauge
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
ReturnToService=2
JobRequeue=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=1500 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
C
export SLURM_CONF=$folder/slurm.conf
start munged munged --force --foreground --key-file="$folder/key" --socket="$folder/munge.socket" \
  --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" --seed-file="$folder/seed"
sleep 1
start slurmctld slurmctld -D
start slurmd slurmd -D -N "$host"
for _ in $(seq 30); do
  sinfo -h -o %t 2>/dev/null | grep -qE 'idle|mix' && break
  sleep 1
done
sinfo

mkdir "$folder/scans"
sed 's/"seed": 1/"seed": 7/' "$samples/render/clean.json" >"$folder/spec.json"
"$FOILGAUGE" render "$folder/spec.json" -o "$folder/foil.png"
echo scan >"$folder/manifest.csv"
for i in $(seq 60); do
  ln "$folder/foil.png" "$folder/scans/foil$i.png"
  echo "$folder/scans/foil$i.png" >>"$folder/manifest.csv"
done
cd "$folder"
"$FOILGAUGE" lot --print-recipe >recipe.json
"$samples/slurm/lot.sh" manifest.csv recipe.json lot 20
for _ in $(seq 60); do
  task=$(squeue -h -t R -o '%F_%K %j' | awk '$2 == "foilgauge-lot" { print $1; exit }')
  [ -n "$task" ] && break
  sleep 0.2
done
sleep 1
echo "killing and requeueing $task"
scontrol requeue "$task"
sleep 1
scontrol update jobid="$task" starttime=now 2>/dev/null || true
for _ in $(seq 300); do
  [ -s lot/lot.json ] && break
  sleep 1
done
squeue
"$FOILGAUGE" lot manifest.csv --recipe recipe.json -o alone 2>/dev/null || [ $? -le 3 ]
diff -r lot alone
grep -l 'kept' lot-*.log | head -n 1 | xargs grep -h kept
echo "the merged report is the report of one run, to the byte"
