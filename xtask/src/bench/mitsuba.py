"""Times Mitsuba's path tracer on one scene: prints the seconds that loading takes, those for each number
of samples, and the most memory that the process had, in millions of bytes.

Arguments: scene file, variant, threads, width, height, numbers of samples. The first render of each
number compiles and is not counted. Dr.Jit takes the LLVM that DRJIT_LIBLLVM_PATH names; version 15
fails on some processors with AVX-512, version 19 does not.
"""

import re
import resource
import sys
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

scene_path, variant, threads, width, height, *counts = sys.argv[1:]
mi.set_variant(variant)
if variant.startswith("llvm"):
    import drjit as dr

    dr.set_thread_count(int(threads))

# The film's size stands in the file, and the files it names are relative to it.
folder = Path(scene_path).resolve().parent
text = Path(scene_path).read_text()
text = re.sub(r'(name="width" value=")\d+', rf"\g<1>{width}", text)
text = re.sub(r'(name="height" value=")\d+', rf"\g<1>{height}", text)
text = re.sub(r'(name="filename" value=")(?!/)', rf"\g<1>{folder}/", text)
with tempfile.NamedTemporaryFile("w", suffix=".xml") as copy:
    copy.write(text)
    copy.flush()
    start = time.perf_counter()
    scene = mi.load_file(copy.name)
    print(time.perf_counter() - start, flush=True)


def render(count, seed):
    start = time.perf_counter()
    np.array(mi.render(scene, spp=count, seed=seed))
    return time.perf_counter() - start


for count in map(int, counts):
    render(count, 0)
    print(min(render(count, 1), render(count, 2)), flush=True)

print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1.024e-3)
