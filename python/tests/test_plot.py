"""Figures: what is drawn, with which labels."""
import os
import pathlib

import pytest

import rubato
from matplotlib import pyplot

STUDY = pathlib.Path(os.environ["RUBATO_ROOT"]) / "examples" / "underplatform-damper" / "study.toml"


@pytest.fixture(scope="module")
def results():
    return rubato.Study(STUDY).run()


@pytest.fixture(autouse=True)
def close():
    yield
    pyplot.close("all")


def test_a_frequency_response_has_a_line_for_each_swept_value(results):
    axes = results.plot("frf", labels="blade2")
    assert len(axes.lines) == 10
    assert axes.get_xlabel() == "angular frequency [rad/s]" and axes.get_ylabel() == "amplitude [m]"
    first = axes.lines[0]
    assert (first.get_ydata() == results["frf"].amplitude.sel(N0=0, coordinate="blade2").values).all()
    assert first.get_label() == "N0 = 0" and axes.get_title() == "blade2"


def test_points_that_are_not_converged_are_marked(results):
    frf = results["frf"].sel(N0=[0, 35]).copy()
    status = frf.status.values.copy()
    status[1, 7] = "not_converged"
    axes = rubato.plot.frequency_response(frf.assign(status=(frf.status.dims, status)), labels=["blade1", "blade2"])
    marked = [line for line in axes.lines if line.get_marker() == "x"]
    assert sum(int((line.get_ydata() == line.get_ydata()).sum()) for line in marked) == 2


def test_a_damper_curve_marks_its_optimum(results):
    axes = results.plot("damper")
    assert axes.get_xscale() == "log" and axes.get_ylabel() == "amplitude [m]"
    assert axes.lines[-1].get_xdata()[0] == results["damper.optimum"].N0.item()


def test_a_time_history_has_its_units(results):
    axes = results.plot("response", labels=["blade1", "blade2"], variable="velocity")
    assert len(axes.lines) == 2
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "velocity [m/s]")
    mine = pyplot.subplots()[1]
    assert rubato.plot.time_history(results["response"], variable="force", ax=mine, color="k") is mine


def test_what_cannot_be_drawn_is_told(results):
    with pytest.raises(rubato.StudyError, match="blade9"):
        results.plot("frf", labels="blade9")
    with pytest.raises(rubato.StudyError, match="no variable"):
        results.plot("response", variable="colour")
    with pytest.raises(rubato.StudyError, match="no figure"):
        results.plot("modes")


def test_one_line_of_a_sweep_is_drawn_alone(results):
    axes = rubato.plot.plot(results["frf"].sel(N0=35), labels="blade2")
    assert len(axes.lines) == 1
