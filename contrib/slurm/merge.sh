#!/bin/bash
#SBATCH --job-name=etendue-merge
#SBATCH --cpus-per-task=1
# Puts the parts together. They stay: remove OUTPUT.parts when the picture is as you want it.
set -eu

output=$1
exec "${ETENDUE:-etendue}" merge "$output".parts/*.part --output "$output"
