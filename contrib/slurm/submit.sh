#!/bin/sh
# Renders a scene as an array of Slurm jobs and merges their parts.
#
#     submit.sh SCENE OUTPUT SAMPLES PARTS [OPTION OF etendue render]...
#
# Prints the id of the merge job. The environment variable SBATCH_OPTIONS holds sbatch options for
# the array, such as SBATCH_OPTIONS="--cpus-per-task=16 --time=4:00:00".
set -eu

if [ "$#" -lt 4 ]; then
    echo "usage: $0 SCENE OUTPUT SAMPLES PARTS [OPTION]..." >&2
    exit 2
fi
scene=$1 output=$2 samples=$3 parts=$4
shift 4
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$output.parts"

# shellcheck disable=SC2086 # SBATCH_OPTIONS is split into words
array=$(sbatch --parsable --array="1-$parts" --output="$output.parts/%a.log" \
    ${SBATCH_OPTIONS:-} "$here/render.sh" "$scene" "$output" "$samples" "$parts" "$@")
# If a part fails, cancel the merge; otherwise it would wait forever.
exec sbatch --parsable --dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes \
    --output="$output.parts/merge.log" "$here/merge.sh" "$output"
