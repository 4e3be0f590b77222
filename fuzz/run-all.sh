#!/bin/sh
# Runs every target for some seconds, several at a time, and summarises each.
#
#     run-all.sh [SECONDS [TARGETS AT A TIME]]
#
# Needs beside it: `any` (cargo fuzz build any; see README.md) and the folders `seeds` and
# `dictionaries`. Writes `work/TARGET` (the corpus), `found/TARGET` (inputs that failed), `logs`, and
# `summary.txt`.
set -u
cd "$(dirname "$0")" || exit 1
seconds=${1:-600}
at_a_time=${2:-16}
targets='xml obj ply serialized vol checkpoint exr png jpeg hdr bmp tga tiff pfm scene'

mkdir -p logs
run() {
    mkdir -p "work/$1" "found/$1" "seeds/$1"
    dictionary=
    [ -f "dictionaries/$1.dict" ] && dictionary="-dict=dictionaries/$1.dict"
    # shellcheck disable=SC2086 # nothing or one word
    ETENDUE_TARGET=$1 ./any "work/$1" "seeds/$1" -max_total_time="$2" -max_len=16384 -timeout=20 \
        -rss_limit_mb=2500 -artifact_prefix="found/$1/" -print_final_stats=1 $dictionary \
        >"logs/$1.log" 2>&1
    echo "$1 ended with $?" >>"logs/$1.log"
}

running=0
for target in $targets; do
    run "$target" "$seconds" &
    running=$((running + 1))
    if [ "$running" -ge "$at_a_time" ]; then
        wait
        running=0
    fi
done
wait

for target in $targets; do
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "logs/$target.log")
    coverage=$(grep -o 'cov: [0-9]*' "logs/$target.log" | tail -1)
    found=$(find "found/$target" -type f | wc -l)
    echo "$target: ${executions:-?} executions, ${coverage:-cov: ?}, $found findings"
done | tee summary.txt
