#!/bin/bash
#SBATCH --job-name=etendue-merge
#SBATCH --cpus-per-task=1
# Merges the parts and keeps them. Remove OUTPUT.parts when you no longer need them.
set -eu

output=$1
exec "${ETENDUE:-etendue}" merge "$output".parts/*.part --output "$output"
