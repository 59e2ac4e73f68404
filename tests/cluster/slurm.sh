#!/usr/bin/env bash
# Slurm on one node, end to end: the script that `study --emit slurm` writes is submitted as it is, and its merge must give the
# answer of an undivided study. Needs root and, on Debian, `apt-get install slurmd slurmctld slurm-client munge python3`.
#   tests/cluster/slurm.sh [PROGRAM]        PROGRAM: target/release/proofmass
# A cluster of its own is started in a scratch folder and stopped at the end; one that runs on this machine is left alone.
set -euo pipefail
cd "$(dirname "$0")/../.."
export PROOFMASS=${1:-$PWD/target/release/proofmass}
for tool in sbatch slurmd slurmctld munged python3; do
  PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed here"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo "SKIPPED: a cluster is started by root"; exit 0; }
PATH=$PATH:/usr/sbin
home=$(mktemp -d /tmp/proofmass-slurm.XXXXXX)
pids=()
finish() {
  status=$?
  [ "$status" = 0 ] || tail -n 20 "$home"/*.log "$home"/out/*.log 2>/dev/null || true
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$home"
}
trap finish EXIT

# munge: a key and a socket of its own.
chmod 755 "$home"
install -d -o munge -g munge -m 700 "$home/munge"
install -d -o munge -g munge -m 755 "$home/socket"
dd if=/dev/urandom of="$home/munge/key" bs=1024 count=1 status=none
chown munge:munge "$home/munge/key"
chmod 400 "$home/munge/key"
socket=$home/socket/munge.socket
setpriv --reuid=munge --regid=munge --clear-groups munged --foreground --key-file="$home/munge/key" --socket="$socket" \
  --pid-file="$home/munge/pid" --seed-file="$home/munge/seed" --log-file="$home/munge/log" >"$home/munged.log" 2>&1 &
pids+=($!)

node=$(hostname -s)
cores=$(nproc)
cat >"$home/slurm.conf" <<CONF
ClusterName=proofmass
SlurmctldHost=$node
AuthType=auth/munge
AuthInfo=socket=$socket
CredType=cred/munge
SlurmUser=root
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$home/state
SlurmdSpoolDir=$home/spool
SlurmctldPidFile=$home/slurmctld.pid
SlurmdPidFile=$home/slurmd.pid
SlurmctldLogFile=$home/slurmctld.log
SlurmdLogFile=$home/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SchedulerParameters=sched_interval=2,bf_interval=2
MailProg=/bin/true
NodeName=$node CPUs=$cores State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$home/state" "$home/spool"
export SLURM_CONF=$home/slurm.conf
for _ in $(seq 50); do [ -S "$socket" ] && break; sleep 0.1; done
slurmctld -D >"$home/controller.log" 2>&1 &
pids+=($!)
slurmd -D >"$home/daemon.log" 2>&1 &
pids+=($!)
for _ in $(seq 60); do sinfo -h -o %t 2>/dev/null | grep -q idle && break; sleep 1; done
sinfo

cat >"$home/study.toml" <<STUDY
name = "On a cluster"
members = 5000
duration_s = 5.0
[accelerometer]
noise_density_ug_rthz = 100.0
bias_mg = { mean = 0.0, sd = 1.0 }
[gyro]
angle_random_walk_deg_rth = 0.3
[report]
times_s = [1.0, 5.0]
STUDY
"$PROOFMASS" study "$home/study.toml" --seed 7 --backend cpu --emit slurm --shards 5 --out "$home/out"
bash "$home"/out/*.slurm.sh
for _ in $(seq 300); do [ -z "$(squeue -h)" ] && break; sleep 1; done
[ -z "$(squeue -h)" ] || { squeue; echo "the jobs do not end"; exit 1; }
[ -s "$home/out/report.html" ] || { echo "the dependent merge has written no report"; exit 1; }
"$PROOFMASS" --json merge "$home/out" >"$home/merged.json"
"$PROOFMASS" --json study "$home/study.toml" --seed 7 --backend cpu --out "$home/whole" >"$home/whole.json"
python3 - "$home/merged.json" "$home/whole.json" <<'PYTHON'
import json, sys
documents = [json.load(open(path)) for path in sys.argv[1:]]
for document in documents:
    for field in ("seconds", "backend", "out", "shards"):
        document.pop(field, None)
assert documents[0] == documents[1], "another answer than that of one run"
PYTHON
echo "OK: 5 tasks of a job array and their dependent merge give the answer of one run"
