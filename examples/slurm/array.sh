#!/bin/sh
# A grid on a Slurm cluster: an array job of its parts, and a job behind it that joins them.
#
#   examples/slurm/array.sh FILE.toml [PARTS] [DIR]
#
# Type it on a login node, in the folder of the project; DIR (default: reports) must lie on a file
# system that all nodes share. The program is built once, here; set EXPERIMENT=/path/to/experiment to
# use one that is there. SBATCH_OPTIONS is handed on, for example "--partition=short --time=1:00:00".
# A part that was ended (time limit, failed node) goes on where it stopped when the same line is
# typed again. The join runs in any case: where parts are missing it names them with their commands.
set -eu

file=${1:?"usage: array.sh FILE.toml [PARTS] [DIR]"}
parts=${2:-8}
out=${3:-reports}
cpus=${CPUS:-2}
export GRID_FILE="$file" GRID_OUT="$out" GRID_PARTS="$parts"

if [ -z "${EXPERIMENT:-}" ]; then
    cargo build --release --bin experiment
    EXPERIMENT=${CARGO_TARGET_DIR:-$PWD/target}/release/experiment
fi
export EXPERIMENT
mkdir -p "$out"

# shellcheck disable=SC2086  # SBATCH_OPTIONS are several words
array=$(sbatch --parsable --export=ALL ${SBATCH_OPTIONS:-} --job-name=grid-part --array="1-$parts" \
    --cpus-per-task="$cpus" --requeue --output="$out/slurm-%A-%a.log" <<'JOB'
#!/bin/sh
echo "part $SLURM_ARRAY_TASK_ID of $GRID_PARTS on $SLURMD_NODENAME"
exec "$EXPERIMENT" --shard "$SLURM_ARRAY_TASK_ID/$GRID_PARTS" --resume \
    --jobs "$SLURM_CPUS_PER_TASK" --out "$GRID_OUT" "$GRID_FILE"
JOB
)
# shellcheck disable=SC2086
join=$(sbatch --parsable --export=ALL ${SBATCH_OPTIONS:-} --job-name=grid-merge --dependency="afterany:$array" \
    --output="$out/slurm-$array-merge.log" <<'JOB'
#!/bin/sh
exec "$EXPERIMENT" merge --out "$GRID_OUT" "$GRID_FILE"
JOB
)
echo "parts: job $array (1-$parts), join: job $join; its words will be in $out/slurm-$array-merge.log"
