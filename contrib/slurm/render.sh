#!/bin/bash
#SBATCH --job-name=etendue
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@120
# One task of the array. It renders some of the samples of every pixel.
#
# The task may be killed, preempted and requeued at any time; it resumes from its checkpoint. Two
# minutes before its time limit, it saves its samples and requeues itself.
set -u

scene=$1 output=$2 samples=$3 parts=$4
shift 4
part=$SLURM_ARRAY_TASK_ID

"${ETENDUE:-etendue}" render "$scene" --output "$output.parts/$part.part" \
    --spp "$samples" --samples "$part/$parts" --resume=auto --skip-existing \
    --threads "${SLURM_CPUS_PER_TASK:-1}" "$@" &
child=$!
trap 'kill -TERM "$child"' TERM
wait "$child"
code=$?
# A signal interrupts `wait` while the render still writes its checkpoint.
while kill -0 "$child" 2>/dev/null; do
    wait "$child"
    code=$?
done
# If Slurm has already requeued the task itself, this fails.
if [ "$code" -eq 143 ]; then
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$part" || true
fi
exit "$code"
