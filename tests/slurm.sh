#!/bin/sh
# Runs examples/slurm/array.sh on a Slurm cluster that lives in a temporary folder of this machine,
# and compares what it gives with one run.
#
#   sh tests/slurm.sh /path/to/experiment
#
# Needs root and the Debian packages slurm-wlm and munge. Slurm and munge that already run here are
# not touched: keys, sockets, ports and states are the script's own, and its servers end with it.
set -eu

program=$(realpath "${1:?usage: slurm.sh PROGRAM}")
project=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
servers=""
end() {
    code=$?
    for server in $servers; do
        kill "$server" 2>/dev/null || true
    done
    wait
    if [ "$code" -ne 0 ]; then
        tail -n 20 "$work"/*.log "$work"/out/*.log 2>/dev/null || true
    fi
    rm -rf "$work"
    exit "$code"
}
trap end EXIT
trap 'exit 1' INT TERM

mkdir "$work/munge" "$work/spool1" "$work/spool2" "$work/state" "$work/out"
chmod 755 "$work" "$work/munge"
head -c 1024 /dev/urandom > "$work/munge/key"
chmod 600 "$work/munge/key"
socket=$work/munge/socket
munged --foreground --force --key-file="$work/munge/key" --socket="$socket" \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" \
    > "$work/munged.log" 2>&1 &
servers="$!"

host=$(hostname -s)
port=$((20000 + $$ % 20000))
cat > "$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=2
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 State=UNKNOWN
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 State=UNKNOWN
PartitionName=test Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$work/slurm.conf"
slurmctld -D > "$work/slurmctld.log" 2>&1 &
servers="$servers $!"
for node in node1 node2; do
    slurmd -D -N "$node" > "$work/slurmd-$node.log" 2>&1 &
    servers="$servers $!"
done

# waits up to a minute until a command says a word
until_says() {
    word=$1
    shift
    for _ in $(seq 60); do
        if "$@" 2>/dev/null | grep -q "$word"; then
            return 0
        fi
        sleep 1
    done
    echo "waited a minute for '$word' of: $*" >&2
    "$@" >&2 || true
    return 1
}
until_says "^2 idle" sinfo --noheader --format="%D %t"
sinfo

cat > "$work/grid.toml" <<'TOML'
[simulation]
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
train      = 1
validation = 0
duration_s = 4.0

[[method]]
name = "torque_regression"

[grid]
noise_scale = [0.5, 1.0, 2.0]
seed        = { count = 20 }
TOML
cd "$work"
"$program" --quiet --out one grid.toml 2> one.log

# runs the array job and compares its folder with that of one run
run_and_compare() {
    EXPERIMENT=$program CPUS=1 sh "$project/examples/slurm/array.sh" grid.toml 4 out
    until_says "^0$" sh -c 'squeue --noheader | wc -l'
    cat out/slurm-*.log
    for file in summary.csv results.json report.html experiment.toml; do
        cmp "out/grid/$file" "one/grid/$file"
    done
    grep -q "on node1" out/slurm-*.log
    grep -q "on node2" out/slurm-*.log
    rm out/slurm-*.log out/grid/results.json
}
run_and_compare
echo "== four parts on two nodes, joined: the same summary, results and report as of one run"

rm out/grid/part-3-of-4.jsonl
truncate --size=-100 out/grid/part-2-of-4.jsonl
run_and_compare
echo "== the same after a part was lost and another torn, and the same line was typed again"
