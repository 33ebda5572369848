"""A law with a linear formula is the spring and the damper: `laws_against_parts.py COMMAND 1-40 m1-m20 [--keep FOLDER] [--verbose]`.

Random structures and, with an `m`, mechanisms are written with springs and dampers, and the same with laws: formulas, hysteresis that
never yields, and laws without a force beside. Every analysis that takes laws gives the same tables, to what its method says; a march to a steady response is longer with laws, as nothing
extrapolates it, and may end before it repeats. Exit status 1
where they differ.
"""

import functools
import os
import pathlib
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from cross_checks import linear_laws, pressed_sliders, two_ways  # noqa: E402

WAYS = {"formulas": linear_laws.as_formulas, "hysteresis": linear_laws.as_hysteresis, "nothing": linear_laws.beside_nothing,
        "pressed by time": pressed_sliders.by_time, "pressed by a law": pressed_sliders.by_law}


def models(drawn, seed, folder):
    tables, parts = drawn(seed, folder)
    ways = {way: lambda plain, rewrite=rewrite: rewrite(plain, parts) for way, rewrite in WAYS.items()}
    return [(tables, ways, ())] if parts else []


if __name__ == "__main__":
    sys.exit(two_ways.main({"": functools.partial(models, linear_laws.structure), "m": functools.partial(models, linear_laws.mechanism)}))
