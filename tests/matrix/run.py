"""Runs the matrix: each combination of method, controller, estimator, model and output is refused with a message or right.

Usage: run.py RUBATO [--sample N] [--only TEXT] [--jobs N] [--keep DIR] [--table FILE]

Right means:
- equal steps on a smooth motion: the ratio of the errors at h and h/2 lies within 0.7 and 1.4 times 2^order, or the error
  has reached that of the reference;
- equal steps across sliders, stops, friction and impacts, where theory gives first order: the error falls at least in
  proportion to the step over the ladder, within a factor of 3;
- steps that choose themselves: the error is within ten tolerances. The tolerance of `inertia_jump` is one of its source,
  proportional to the cube of the step, and not of the result: there the number of steps grows with three quarters of the
  power -1/3 of the tolerance that theory gives, and with it the error falls with three quarters of the method's order
  from the last but one tolerance to the last (at loose ones a method with damping of its own loses fast parts of the motion
  whole, and no more can be lost). This goes for the tolerances that choose the steps; of a loose one the longest may do,
  a fiftieth of the run or what the stability of an explicit method allows.
A run that ends with a message is wrong too, unless `known_ends.txt` names it.
Errors are those of positions, in each unit relative to the largest value of the reference, over all rows; of mechanisms
to no less than a hundredth of a metre and a radian, by which their tolerance is measured while they have come less far.
The reference of a model is another route: the exact flow, or a march at a tolerance far below. Rows at times of their
own (`output.every` of steps that choose themselves) are compared with cubics through the rows of the reference: the last
and ten others, since at one time alone an error may vanish by chance. Across transitions, where cubics err, the last is
compared alone.
"""
import argparse
import bisect
import collections
import concurrent.futures
import csv
import math
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(__file__))
from combinations import Combination, all_combinations  # noqa: E402

SLACK = {"smooth": (0.7, 1.4), "floor": 30.0}
ROWS = 1000  # of a reference, so close that cubics through them err less than a march
BATCH = 8   # combinations a run: a study with hundreds of analyses takes longer than its parts
POSITION = re.compile(r"\.(position|angle|displacement) (\[[^]]*\])$")


def names_in(file):
    return set((pathlib.Path(__file__).parent / file).read_text().splitlines())


def write(folder, model, analyses):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in model.files.items():
        (folder / name).write_text(text)
    study = folder / "study.toml"
    study.write_text(model.text + "\n" + "".join(analyses))
    return study


def call(rubato, *arguments):
    """A run that would fill the disk or the day ends instead."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2**31, 2**31))
        resource.setrlimit(resource.RLIMIT_CPU, (900, 900))
        os.setpriority(os.PRIO_PROCESS, 0, max(10, os.getpriority(os.PRIO_PROCESS, 0)))
    return subprocess.run([rubato, *map(str, arguments)], capture_output=True, text=True, preexec_fn=limit)


def positions(path):
    """{time: {column: value}} of the columns of positions, angles and displacements."""
    with open(path) as file:
        rows = csv.reader(file)
        header = next(rows)
        taken = [(k, name) for k, name in enumerate(header) if POSITION.search(name)]
        return {round(float(row[0]), 9): {name: float(row[k]) for k, name in taken} for row in rows}


def cubic(reference, times, time):
    """The reference at a time between its rows: {column: value}."""
    first = min(max(bisect.bisect(times, time) - 2, 0), len(times) - 4)
    nodes = times[first:first + 4]
    shares = [math.prod((time - b) / (a - b) for b in nodes if b != a) for a in nodes]
    return {name: sum(s * reference[t][name] for s, t in zip(shares, nodes)) for name in reference[nodes[0]]}


def compared(reference, found, has_own_times, is_smooth):
    """The rows of the reference at those times of a table that are compared."""
    times = sorted(reference)
    tenths = times[::ROWS // 10]
    if not has_own_times:
        return {time: reference[time] for time in tenths}
    rows = {times[-1]: reference[times[-1]]}
    own = sorted(found)
    if is_smooth and own:
        for tenth in tenths[:-1]:   # not at tenths, where tables have corners, over which cubics err
            wanted = tenth + 0.4 * (tenths[1] - tenths[0])
            time = own[min(bisect.bisect(own, wanted), len(own) - 1)]
            rows[time] = cubic(reference, times, time)
    return rows


def unit_of(column):
    return POSITION.search(column).group(2)


def sizes_of(reference, least_size):
    """{unit: the largest value of the reference}."""
    sizes = collections.defaultdict(lambda: least_size)
    for name in next(iter(reference.values())):
        sizes[unit_of(name)] = max(sizes[unit_of(name)], *(abs(row[name]) for row in reference.values()))
    return {unit: size or 1.0 for unit, size in sizes.items()}


def largest_error(found, expected, sizes):
    """Of all units the largest error relative to their size; None without an expected row."""
    if any(time not in found for time in expected):
        return None
    errors = collections.defaultdict(float)
    for name in next(iter(expected.values())):
        differences = [abs(found[time][name] - row[name]) for time, row in expected.items()]
        error = max(differences) if all(map(math.isfinite, differences)) else math.inf
        errors[unit_of(name)] = max(errors[unit_of(name)], error)
    return max(error / sizes[unit] for unit, error in errors.items())


def steps_taken(path):
    with open(path) as file:
        rows = csv.reader(file)
        header = next(rows)
        step, reason = header.index("step [s]"), header.index("reason")
        return [float(row[step]) for row in rows if row[reason] in ("accepted", "event")]


def steps_chosen(rungs, longest, has_stability_limit):
    """How many steps each tolerance chose; None where a tenth of the run is passed with the longest that there may be."""
    if has_stability_limit and rungs:
        longest = min(longest, max(rungs[0]))
    return [len(steps) if sum(h for h in steps if h > 0.99 * longest) < 0.1 * sum(steps) else None for steps in rungs]


def follows(errors, tolerances, numbers, order):
    """Whether the steps follow the tolerance of `inertia_jump` as its source does, and the errors the steps."""
    share = 0.75
    more_steps = numbers[-1] / numbers[0] > (tolerances[0] / tolerances[-1]) ** (share / 3)
    return more_steps and errors[-1] < errors[-2] * (numbers[-2] / numbers[-1]) ** (share * order)


def judge(combination, errors, floor, numbers):
    """None where it is right, else a line.
    numbers: of steps of each rung, None where its tolerance does not choose them."""
    if any(e is None for e in errors):
        return "rows are missing"
    shown = " ".join(f"{e:.2e}" for e in errors)
    if len(errors) == 1:
        return None if errors[0] < SLACK["floor"] * floor else f"error {shown}"
    model = combination.model
    if not combination.has_equal_steps:
        if combination.has_inertia_jump:
            tolerances = combination.rungs()
            if not model.smooth:
                return None if errors[-1] < max(errors[0] / 1.5, 1e-3) else f"errors {shown} at tolerances {tolerances}"
            ruled = [rung for rung in zip(errors, tolerances, numbers) if rung[-1]]
            good = (errors[-1] < max(SLACK["floor"] * floor, 10 * tolerances[-1]) or len(ruled) < 2
                    or follows(*zip(*ruled), combination.order or 2))
        else:
            good = all(e < 10 * t + SLACK["floor"] * floor for e, t in zip(errors, combination.rungs()))
        return None if good else f"errors {shown} at tolerances {combination.rungs()}"
    if errors[-1] < SLACK["floor"] * floor:
        return None
    if not model.smooth:
        expected = errors[0] / 2 ** (len(errors) - 1)
        return None if errors[-1] < max(3.0 * expected, 2e-4) else f"errors {shown} across transitions"
    order = combination.order or 2
    pairs = [(a, b) for a, b in zip(errors, errors[1:]) if b > SLACK["floor"] * floor]
    if not pairs:
        return None
    ratio = pairs[-1][0] / pairs[-1][1] / 2**order
    if combination.method == '"fox_goodwin"' and ratio > 1.0:   # of order 4 in displacement where little is damped
        return None
    low, high = SLACK["smooth"]
    return None if low <= ratio <= high else f"errors {shown}: {ratio:.2f} times 2^{order}"


class Matrix:
    def __init__(self, rubato, folder, keep):
        self.rubato, self.folder, self.keep = rubato, pathlib.Path(folder), keep
        self.refused, self.wrong, self.right, self.ended = [], [], [], []
        self.known_ends = names_in("known_ends.txt")

    def reference(self, model):
        folder = self.folder / model.name / "reference"
        plain = Combination(model, '"generalized_alpha"', None, "interval").analysis("reference", None)
        text = plain.replace('method = "generalized_alpha"', model.reference)
        tenth, row = repr(model.duration / 10), repr(model.duration / ROWS)
        text = text.replace(f"interval = {tenth}", f"interval = {row}")
        finest = text.replace("1e-7", "1e-8").replace("1e-10", "1e-11")
        study = write(folder, model, [text.replace('"reference"', '"coarser"'), finest])
        told = call(self.rubato, "run", study, "-q", "-o", folder / "results")
        if told.returncode:
            raise SystemExit(f"the reference of {model.name} fails:\n{told.stderr}")
        fine = positions(folder / "results" / "reference.csv")
        sizes = sizes_of(fine, model.least_size)
        spread = largest_error(positions(folder / "results" / "coarser.csv"), fine, sizes)
        return fine, sizes, max(spread, 1e-10)

    def run_model(self, model, combinations):
        reference, sizes, floor = self.reference(model)
        accepted = []
        for index, combination in enumerate(combinations):
            folder = self.folder / model.name / "check"
            told = call(self.rubato, "check", write(folder, model, [combination.analysis("a", combination.rungs()[0])]))
            if told.returncode == 0:
                accepted.append((index, combination))
            elif told.returncode == 2 and "error:" in told.stderr:
                self.refused.append((combination, told.stderr.strip().splitlines()[0]))
            else:
                self.wrong.append((combination, f"check ends with {told.returncode}: {told.stderr.strip()[:200]}"))
        for start in range(0, len(accepted), BATCH):
            self.run_batch(model, accepted[start:start + BATCH], reference, sizes, floor)

    def run_batch(self, model, accepted, reference, sizes, floor):
        analyses = [combination.analysis(f"c{index}-{k}", rung)
                    for index, combination in accepted for k, rung in enumerate(combination.rungs())]
        folder = self.folder / model.name / f"run{accepted[0][0]}"
        told = call(self.rubato, "run", write(folder, model, analyses), "-q", "-o", folder / "results")
        failures = {match.group(1): line for line in told.stderr.splitlines()
                    if (match := re.search(r'"(c\d+-\d+)"', line))}
        for index, combination in accepted:
            self.judge(combination, index, folder / "results", failures, reference, sizes, floor)
        if not self.keep:
            shutil.rmtree(folder)

    def judge(self, combination, index, results, failures, reference, sizes, floor):
        errors, rungs = [], []
        for k in range(len(combination.rungs())):
            name = f"c{index}-{k}"
            path = results / f"{name}.csv"
            found = positions(path) if path.exists() else {}
            smooth = combination.model.smooth
            has_own_times = combination.output == "every" and not (
                combination.has_equal_steps and smooth and combination.method != '"exact"')
            expected = compared(reference, found, has_own_times, smooth)
            error = largest_error(found, expected, sizes)
            if error is None and name in failures:
                may_end = combination.name in self.known_ends
                (self.ended if may_end else self.wrong).append((combination, f"ends: {failures[name]}"))
                return
            errors.append(error)
            steps = results / f"{name}.steps.csv"
            if combination.has_inertia_jump and steps.exists():
                rungs.append(steps_taken(steps))
        numbers = steps_chosen(rungs, combination.model.duration / 50, combination.has_stability_limit)
        line = judge(combination, errors, floor, numbers)
        (self.wrong if line else self.right).append((combination, line or "right"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rubato")
    parser.add_argument("--sample", type=int, help="only so many, drawn with a fixed seed, and those of failed.txt")
    parser.add_argument("--only", default="", help="only combinations whose name contains this")
    parser.add_argument("--jobs", type=int, default=1, help="so many models at a time")
    parser.add_argument("--keep", help="folder of the studies and results (default: a temporary one)")
    parser.add_argument("--table", help="write a line for each combination")
    options = parser.parse_args()
    chosen = [c for c in all_combinations() if options.only in c.name]
    if options.sample and options.sample < len(chosen):
        failed = names_in("failed.txt") | names_in("known_ends.txt")
        drawn = set(random.Random(1).sample([c.name for c in chosen], options.sample)) | failed
        chosen = [c for c in chosen if c.name in drawn]
    with tempfile.TemporaryDirectory() as temporary:
        matrix = Matrix(os.path.abspath(options.rubato), options.keep or temporary, options.keep)
        groups = collections.defaultdict(list)
        for combination in chosen:
            groups[combination.model.name].append(combination)

        def run(combinations):
            matrix.run_model(combinations[0].model, combinations)
            print(f"{combinations[0].model.name}: {len(combinations)} combinations; so far {len(matrix.right)} right, "
                  f"{len(matrix.refused)} refused, {len(matrix.ended)} ended with a message, {len(matrix.wrong)} wrong",
                  flush=True)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(run, groups.values()))
    for combination, line in matrix.wrong:
        print(f"WRONG {combination.name}: {line}")
    if options.table:
        with open(options.table, "w") as file:
            for kind in ("right", "refused", "ended", "wrong"):
                for combination, line in getattr(matrix, kind):
                    file.write(f"{kind}\t{combination.name}\t{line}\n")
    print(f"{len(chosen)} combinations: {len(matrix.right)} right, {len(matrix.refused)} refused, "
          f"{len(matrix.ended)} ended with a message, {len(matrix.wrong)} wrong")
    return 1 if matrix.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
