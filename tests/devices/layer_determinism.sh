#!/bin/sh
# Two runs of layer_probe, the second beside a busy loop, print the same predicted times.
# usage: layer_determinism.sh PROBE FOLDER
set -eu
probe=$1
folder=$2
mkdir -p "$folder"
"$probe" "$folder/first.record" > "$folder/first.txt"
(while :; do :; done) &
busy=$!
trap 'kill $busy' EXIT
"$probe" "$folder/second.record" > "$folder/second.txt"
test "$(wc -l < "$folder/first.txt")" -ge 240
cmp "$folder/first.txt" "$folder/second.txt"
echo "the same times"
