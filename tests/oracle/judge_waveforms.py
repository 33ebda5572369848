"""Judges waveforms: positions over a period at the points of a response that lie nearest to what was asked for."""

import numpy

import steady
from structure.model import read_model
from verdicts import Table


def checks(study, analysis, response, parameter, allowed):
    """(what, error, allowed) of the table beside a response; `allowed` of its amplitudes."""
    path = response.path.with_suffix(".waveforms.csv")
    if "waveforms" not in analysis or not path.exists():
        return
    table = Table(path)
    hertz = 2 * numpy.pi if "frequency" in analysis else 1.0
    w = table.column("angular_frequency [rad/s]")
    yield "waveforms at other points", float(set(w) != _nearest(study, analysis, response, hertz)), 0.5
    points = int(study.number(analysis["waveforms"].get("points", 128)))
    swept = [p for p in study.parameters if table.has(p)]
    for begin in range(0, len(w), points):
        rows = slice(begin, begin + points)
        settings = {p: table.column(p)[begin] for p in swept}
        now = read_model(study.with_parameters({**settings, parameter: w[begin] / hertz}))
        if now.stops or now.laws or now.sliders and not steady.sticks(now):
            continue  # a march of the oracle for each would take too long
        fundamental, answers, _ = steady.linear(now, now.stuck_stiffness())
        times = table.column("time [s]")[rows]
        period = 2 * numpy.pi / fundamental
        yield "times of a waveform", numpy.max(numpy.abs(times - period * numpy.arange(points) / points)) / period, 1e-9
        for turns in (False, True):
            found = []
            for name in now.names:
                header = f"{name}.angle [rad]" if turns else f"{name}.position [m]"
                if table.has(header):
                    row = now.row(name)
                    x = sum(numpy.real((row @ z) * numpy.exp(1j * k * fundamental * times)) for k, z in answers.items())
                    found.append((header, numpy.abs(table.column(header)[rows] - x), numpy.max(numpy.abs(x))))
            size = max((whole for _, _, whole in found), default=0.0)
            for header, errors, _ in found if size > 0 else []:
                yield f"waveform {header} at {w[begin]:.6g}", numpy.max(errors) / size, allowed


def _nearest(study, analysis, response, hertz):
    at = analysis["waveforms"]["at"]
    if isinstance(at, dict):
        ends = [study.number(at[k]) for k in ("from", "to")]
        spread = numpy.geomspace if at.get("spacing") == "log" else numpy.linspace
        at = spread(*ends, int(study.number(at["points"])))
    else:
        at = [study.number(w) for w in (at if isinstance(at, list) else [at])]
    there = numpy.unique(response.column("angular_frequency [rad/s]"))
    return {there[numpy.argmin(numpy.abs(there - w * hertz))] for w in at}
