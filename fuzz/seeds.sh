#!/bin/sh
# Gathers seeds for every target below fuzz/seeds from the repository: test corpora, scenes, pictures.
# Needs the built `etendue` command for pictures and checkpoints.
set -eu
cd "$(dirname "$0")/.."
etendue=${ETENDUE:-target/release/etendue}
seeds=fuzz/seeds
small='-size -20k'

gather() { # TARGET PATTERN...: files of these names, wherever tests and scenes keep them
    target=$1
    shift
    mkdir -p "$seeds/$target"
    for pattern in "$@"; do
        # shellcheck disable=SC2086 # several words
        find crates scenes gallery fuzz/findings -path '*/target' -prune -o -type f $small -name "$pattern" -print |
            while read -r file; do
                cp "$file" "$seeds/$target/$(echo "$file" | tr / _)"
            done
    done
}

gather xml '*.xml'
gather scene '*.xml'
gather obj '*.obj'
gather ply '*.ply'
gather serialized '*.serialized'
gather vol '*.vol'
gather exr '*.exr'
gather png '*.png'
gather jpeg '*.jpg'
gather hdr '*.hdr'
gather bmp '*.bmp'
gather tga '*.tga'
gather tiff '*.tif' '*.tiff'
gather pfm '*.pfm'

# Every plugin's sample is a scene's part.
awk '/^```xml/ { n++; inside = 1; next } /^```/ { inside = 0 } inside { print > "'$seeds'/scene/sample_" n ".body" }' \
    docs/plugins.md
for body in "$seeds"/scene/*.body; do
    { echo '<scene version="3.0.0">'; cat "$body"; echo '</scene>'; } >"${body%.body}.xml"
    rm "$body"
done
cp "$seeds"/scene/sample_*.xml "$seeds/xml"

# A whole file of every kind, and checkpoints.
scene=crates/cli/tests/scenes/small.xml
mkdir -p "$seeds/checkpoint"
for format in exr png jpg hdr bmp tiff pfm; do
    target=$(echo $format | sed 's/jpg/jpeg/')
    "$etendue" render $scene --quiet --resume=never --size 9x5 -o "$seeds/$target/picture.$format"
done
"$etendue" render $scene --quiet --resume=never --size 9x5 --variance -o "$seeds/checkpoint/whole.part"
"$etendue" render $scene --quiet --resume=never --size 3x2 --samples 1..3 -o "$seeds/checkpoint/some.part"

# The smallest valid volume and Targa files.
# shellcheck disable=SC1003 # a backslash
printf 'VOL\003\001\0\0\0\002\0\0\0\001\0\0\0\001\0\0\0\001\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\200?\0\0\200?\0\0\0?\0\0\200?' \
    >"$seeds/vol/two_cells.vol"
printf '\0\0\002\0\0\0\0\0\0\0\0\0\002\0\001\0\030\040abcdef' >"$seeds/tga/two_pixels.tga"
printf '\0\0\012\0\0\0\0\0\0\0\0\0\004\0\002\0\040\050\207abcd' >"$seeds/tga/run.tga"
