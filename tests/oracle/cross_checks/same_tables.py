"""Two sets of results of the same equations: `differences(one, other, analysis, allowed)`."""

import math
import re

import numpy

from compare import Table

# Columns that count what was done on the way, and what the two write differently.
APART = ("error", "residual", "iterations", "transitions", "residue [J]", "mode", "status")
TOGETHER = {"strain [J]": ("strain [J]", "slider_stored [J]", "law_stored [J]"),
            "damper_dissipated [J]": ("damper_dissipated [J]", "slider_dissipated [J]", "law_dissipated [J]")}
SUMMANDS = sum(TOGETHER.values(), ())


def differences(one, other, name, kind, allowed, stiffness, unlike=()):
    """[(what, error, allowed)] over the tables of an analysis; errors are relative to the largest of the same quantity.

    @param stiffness  of the stiffest slider, whose force at the largest amplitude what is remembered of it is held to
    @param unlike     statuses that the other may have instead of `converged`
    """
    if unlike and Table(one / f"{name}.csv").text("status") != Table(other / f"{name}.csv").text("status"):
        paths = [one / f"{name}.csv"]  # the rows that both have found
    else:
        paths = sorted(one.glob(f"{name}.*csv"))
    found, least_work = [], _least_work(one / f"{name}.csv") if kind == "transient" else 0.0
    for path in paths:
        which = path.name[len(name) + 1:-4]
        # Extremes are those of columns that are compared row by row; of equal ones either time may be the first.
        if which in ("nodes", "lines", "joints", "shapes", "extremes"):
            continue
        twin = other / path.name
        if not twin.exists():
            found.append((f"{path.name} is missing", 1.0, 0.0))
            continue
        if which == "events" and _is_still(one / f"{name}.csv"):
            continue
        if which == "events" and len(Table(path).rows) != len(Table(twin).rows):
            # Of many that are passed or located some few lie within a tolerance of touching.
            events = [len(Table(p).rows) for p in (path, twin)]
            found.append((f"{events[0]} and {events[1]} events", abs(events[0] - events[1]) / max(events), 0.05))
            continue
        if which == "events" and allowed > 1e-6 and kind == "transient" and Table(path).text("joint") != Table(twin).text("joint"):
            continue  # of two that nearly coincide either may be the first
        if which == "steps":
            steps = [len(Table(p).rows) for p in (path, twin)]
            # Laws are not in what tells which errors die away.
            found.append((f"{steps[0]} and {steps[1]} steps", abs(math.log(steps[1] / steps[0])), math.log(5)))
            continue
        found += _table(Table(path), Table(twin), "" if which else kind, allowed, stiffness, least_work, unlike)
    return found


def _table(one, other, kind, allowed, stiffness, least_work, unlike):
    if len(one.rows) != len(other.rows):
        return [(f"{one.path.name}: {len(one.rows)} rows and {len(other.rows)}", 1.0, 0.0)]
    found, numbers, sizes = [], {}, {}
    # Sliders that stick for whole periods keep an offset of their history: where only one tells it, it may be another.
    has_offsets = bool(unlike) and any("offset [" in h and not other.has(h) for h in one.head)
    keep = [i for i, row in enumerate(zip(one.text("status"), other.text("status"))) if row == ("converged", "converged")] \
        if one.has("status") else range(len(one.rows))
    if one.has("status") and any(a != b for a, b in zip(one.text("status"), other.text("status")) if not {a, b} <= {
            "converged", *unlike}):
        found.append((f"{one.path.name} status", 1.0, 0.0))
    for head in one.head:
        if not other.has(head) or head in APART or ".law_" in head or (head in SUMMANDS and head not in TOGETHER):
            continue
        if has_offsets and (".mean [" in head or ".rms [" in head):
            continue
        a, b = one.text(head), other.text(head)
        try:
            a, b = (numpy.array([float(x) if x else numpy.nan for x in cells])[keep] for cells in (a, b))
        except ValueError:
            if a != b:
                found.append((f"{one.path.name} {head}", 1.0, 0.0))
            continue
        if head in TOGETHER:
            a, b = (sum(table.column(h)[keep] for h in TOGETHER[head] if table.has(h)) for table in (one, other))
        if head == "strain [J]":  # what is stored at the start is where the zero was laid
            a, b = a - a[0], b - b[0]
        if head == "viscous_work [J]":
            b = b + sum((other.column(h)[keep] for h in other.head if h.endswith(".dissipated [J]") and not one.has(h)), 0.0)
        numbers[head] = (a, b)
    for head in [h for h in numbers if "phase [rad]" in h]:
        _as_vectors(numbers, head)
    if kind == "modes":
        return found + _modes(numbers, allowed)
    for head, (a, b) in numbers.items():
        kind_of = _quantity(head, kind)
        size = numpy.nanmax(numpy.abs(a), initial=0.0)
        sizes[kind_of] = max(sizes.get(kind_of, 0.0), size if math.isfinite(size) else 0.0)
        numbers[head] = (kind_of, a, b)
    if kind == "frequency_response":
        sizes["offset [N]"] = stiffness * sizes.get("amplitude [m]", 0.0)
        sizes["moment_offset [N m]"] = stiffness * sizes.get("angle_amplitude [rad]", 0.0)
        # of what is not damped the works are round-off
        sizes["input_work [J]"] = sizes["dissipated [J]"] = sizes["viscous_work [J]"] = max(
            sizes.get(key, 0.0) for key in ("viscous_work [J]", "dissipated [J]"))
    for slip, place in (("slip [m]", "position [m]"), ("slip_angle [rad]", "angle [rad]")):  # of one that sticks
        sizes[slip] = max(sizes.get(slip, 0.0), sizes.get(place, 0.0))
    for key in [k for k in sizes if k.endswith("[N m]")]:
        sizes[key] = max(sizes[key], least_work)
    for key in [k for k in sizes if k.endswith("[N]")]:  # round-off of the others
        sizes[key] = max(sizes[key], 1e-9 * max(size for k, size in sizes.items() if k.endswith("[N]")))
    sizes["[J]"] = max(sizes.get("[J]", 0.0), least_work)
    _floors(numbers, sizes)
    for head, (kind_of, a, b) in numbers.items():
        if kind_of == "input_work [J]" and not sizes[kind_of]:
            continue
        same = (a == b) | (numpy.isnan(a) & numpy.isnan(b))
        error = numpy.max(numpy.where(same, 0.0, numpy.abs(a - b)), initial=0.0) / (sizes[kind_of] or 1.0)
        limit = allowed
        if "velocity [" in head and kind == "transient":
            limit = 30 * allowed  # also that of fast parts, which errors of displacements hardly see
        elif "acceleration [" in head and kind == "transient":
            limit = 30 * allowed if allowed < 1e-6 else max(100 * allowed, 0.1)
        elif ".friction_" in head and kind == "transient":
            limit = 10 * allowed  # what sticks carries is a multiplier of the step
        elif "dissipated" in head or head == "viscous_work [J]":
            limit = max(allowed, 1e-4)  # sums over steps, by two formulas
            if head in TOGETHER and other.has("law_dissipated [J]") and one.has("slider_dissipated [J]"):
                limit = max(limit, 1e-2)  # where a slip begins within a step, a slider books the mean of its forces
        if unlike and head.endswith("[J]"):
            limit = 0.1  # of marches with different numbers of steps: the damping of the method
        found.append((f"{one.path.name} {head}", error if math.isfinite(error) else math.inf, limit))
    return found


def _least_work(path):
    """Of a motion that is round-off: the largest force over a millionth of the largest place."""
    if not path.exists():
        return 0.0
    table = Table(path)

    def largest(word):
        return max((numpy.nanmax(numpy.abs(table.column(h)), initial=0.0) for h in table.head if h.endswith(word)), default=0.0)
    return 1e-6 * largest("[N]") * largest("position [m]")


def _is_still(path):
    """A mechanism of which nothing can move, and what sticks and slips there is round-off."""
    table = Table(path)
    far = max((numpy.max(numpy.abs(table.column(h)), initial=0.0) for h in table.head if h.endswith("position [m]")), default=0.0)
    fast = max((numpy.max(numpy.abs(table.column(h)), initial=0.0) for h in table.head if h.endswith("velocity [m/s]")), default=0.0)
    return fast * table.column("time [s]")[-1] < 1e-4 * far


def _floors(numbers, sizes):
    """Of a mechanism that hardly moves velocities are round-off: those of a thousandth of its size in the whole time are small."""
    if "time [s]" not in numbers or "position [m]" not in sizes:
        return
    length, time = sizes["position [m]"], max(numbers["time [s]"][1], default=1.0) or 1.0
    floors = {"velocity [m/s]": length / time, "acceleration [m/s2]": length / time**2, "angle [rad]": 1.0, "angular_velocity [rad/s]": 1 / time,
              "angular_acceleration [rad/s2]": 1 / time**2}
    for key, floor in floors.items():
        sizes[key] = max(sizes.get(key, 0.0), 1e-3 * floor)


def _quantity(head, kind):
    """What is measured by the same size: all energies; of a response means and harmonics by the largest amplitude."""
    word = head.rsplit(".", 1)[-1]
    if kind != "frequency_response":
        return "[J]" if word == head and head.endswith("[J]") else word
    if re.fullmatch(r"(harmonic\d+_)?(cosine |sine )?(angle_)?(amplitude|mean|rms) \[(m|rad)\]", word):
        return "angle_amplitude [rad]" if word.endswith("[rad]") else "amplitude [m]"
    return word


def _as_vectors(numbers, head):
    """A phase and its amplitude as the amplitude of a cosine and of a sine: the phase of almost nothing is anything."""
    stem = head[:-len("phase [rad]")]
    amplitude = next((h for h in numbers if h.startswith(stem) and "amplitude" in h and "velocity" not in h and "acceleration" not in h
                      and "harmonic" not in h[len(stem):]), None)
    a, b = numbers.pop(head)
    if amplitude is None:
        return
    for part, turn in (("cosine", numpy.cos), ("sine", numpy.sin)):
        numbers[f"{stem}{part} {amplitude[len(stem):]}"] = tuple(
            size * turn(phase) for size, phase in zip(numbers[amplitude], (a, b)))


def _modes(numbers, allowed):
    """Eigenvalues, and shapes where no other frequency is near, whatever their sign."""
    w = numbers["angular_frequency [rad/s]"][0]
    found, largest = [], numpy.max(numpy.abs(w), initial=1e-300)
    for head in ("angular_frequency [rad/s]", "eigenvalue_real [1/s]", "eigenvalue_imaginary [rad/s]"):
        a, b = numbers[head]
        # a frequency is the root of an eigenvalue, which is known to round-off of the largest
        size = numpy.maximum(numpy.abs(numpy.hypot(*(numbers[f"eigenvalue_{p}"][0] for p in ("real [1/s]", "imaginary [rad/s]")))), 1e-5 * largest)
        found.append((head, float(numpy.max(numpy.abs(a - b) / size, initial=0.0)), max(allowed, 1e-8)))
    shapes = [h for h in numbers if "shape" in h and "imaginary" not in h]
    if not shapes or any("shape_imaginary" in h for h in numbers):
        return found
    a, b = (numpy.array([numbers[h][i] for h in shapes]) for i in (0, 1))
    for k in range(len(w)):
        near = [abs(w[k] - w[j]) for j in range(len(w)) if j != k and numbers["_limit"][0][j] == numbers["_limit"][0][k]] \
            if "_limit" in numbers else [abs(w[k] - w[j]) for j in range(len(w)) if j != k]
        if near and min(near) < 1e-3 * w[k] or w[k] < 1e-3 * largest:
            continue
        size = numpy.max(numpy.abs(a[:, k]), initial=1e-300)
        error = min(numpy.max(numpy.abs(a[:, k] - s * b[:, k])) for s in (1, -1)) / size
        found.append((f"shape {k + 1}", float(error), 1e-6))
    return found
