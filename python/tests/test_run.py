"""Runs: their numbers against closed forms and the command's, parameters, Ctrl-C, failures, threads."""
import csv
import os
import pathlib
import signal
import subprocess
import threading
import time

import numpy as np
import pytest
import xarray

import rubato

COMMAND = os.environ["RUBATO_COMMAND"]
DAMPER = pathlib.Path(os.environ["RUBATO_ROOT"]) / "examples" / "underplatform-damper" / "study.toml"
MASS, DAMPING, STIFFNESS = 2.0, 0.3, 8.0


def oscillator(*analyses, **tables):
    return rubato.Study({
        "parameters": {"Omega": 1.0, "F": 3.0, "k": STIFFNESS, "c": DAMPING},
        "coordinate": [{"name": "mass", "mass": MASS, "position": 0.1}],
        "spring": [{"between": ["mass", "ground"], "stiffness": "k"}],
        "damper": [{"between": ["mass", "ground"], "damping": "c"}],
        "force": [{"on": "mass", "amplitude": "F", "angular_frequency": "Omega"}],
        "analysis": list(analyses), **tables})


LONG = {"name": "long", "type": "transient", "step": 1e-4, "duration": 1e5, "output": {"every": 1000}}
SHORT = {"name": "short", "type": "transient", "step": 0.01, "duration": 0.1}


def test_frequency_response_is_that_of_the_oscillator():
    omega = np.linspace(0.1, 5.0, 50)
    frf = oscillator({"name": "frf", "type": "frequency_response", "angular_frequency": omega}).run()["frf"]
    receptance = 3.0 / (STIFFNESS - MASS * omega**2 + 1j * DAMPING * omega)
    np.testing.assert_allclose(frf.amplitude.sel(coordinate="mass"), np.abs(receptance), rtol=1e-10)
    np.testing.assert_allclose(frf.phase.sel(coordinate="mass"), np.angle(receptance), atol=1e-10)
    assert (frf.angular_frequency.values == omega).all()
    assert frf.amplitude.attrs["units"] == "m" and frf.attrs["status"] == "done"
    assert (frf.status == "converged").all()


def test_free_vibration_decays_as_it_should():
    history = oscillator({"name": "free", "type": "transient", "method": "exact", "duration": 10.0}).run(F=0)["free"]
    decay, natural = DAMPING / (2 * MASS), np.sqrt(STIFFNESS / MASS)
    damped = np.sqrt(natural**2 - decay**2)
    t = history.time.values
    exact = 0.1 * np.exp(-decay * t) * (np.cos(damped * t) + decay / damped * np.sin(damped * t))
    np.testing.assert_allclose(history.position.sel(coordinate="mass"), exact, atol=1e-12)


def rows_of(table, head):
    """The values of a column of a CSV file, `coordinate.variable`, in the order of its rows."""
    *label, variable = head.rsplit(".", 1)
    labels = [d for d in table.dims if table[d].dtype.kind == "U" and d not in ("limit", "direction", "column")]
    rows = max((tuple(d for d in table[v].dims if d not in labels) for v in table.data_vars), key=len)
    values = table[variable]
    if label:
        (dimension,) = set(values.dims) & set(labels)
        values = values.sel({dimension: label[0]})
    shape = [table.sizes[d] for d in rows]
    return values.broadcast_like(xarray.DataArray(np.zeros(shape), dims=rows)).transpose(*rows).values.ravel()


def test_numbers_are_those_of_the_command_to_the_last_digit(tmp_path):
    subprocess.run([COMMAND, "run", DAMPER, "-o", tmp_path, "-q", "--set", "Omega=7.8"], check=True, capture_output=True)
    with pytest.warns(rubato.StudyWarning):  # the responses give Omega its values
        results = rubato.Study(DAMPER).run(Omega=7.8)
    compared = 0
    for file in tmp_path.glob("*.csv"):
        heads, *rows = csv.reader(file.open())
        for place, head in enumerate(heads):
            values = rows_of(results[file.stem], head.split(" [")[0])
            given = [row[place] for row in rows]
            if values.dtype.kind == "f":
                values, given = np.nan_to_num(values, nan=-1e300), [float(text or -1e300) for text in given]
            assert given == list(values), (file.name, head)
            compared += len(given)
    assert compared > 300_000


def test_jobs_change_nothing():
    study = rubato.Study(DAMPER)
    one, two = study.run(jobs=1), study.run(jobs=2)
    for name in one:
        assert one[name].equals(two[name]), name


def test_parameters_replace_those_of_the_study():
    study = oscillator({"name": "static", "type": "static"})
    for value in (5, 5.0, np.float64(5), np.array(5.0), "2 + 3"):
        at = study.run(k=value, parameters={"F": 2.0})["static"]
        assert at.position.values.ravel()[0] == pytest.approx(2.0 / 5.0, rel=1e-12)
    assert study.parameters["k"] == STIFFNESS


@pytest.mark.parametrize("values, words", [
    ({"Omga": 1.0}, 'no such parameter: "Omga"; did you mean "Omega"?'), ({"k": float("nan")}, "finite"), ({"k": 1 / 1e-320}, "finite"),
    ({"k": [1.0, 2.0]}, "one number"), ({"k": np.ones((1, 1))}, "one number"), ({"k": None}, "one number"),
    ({"k": True}, "one number"), ({"k": 1j}, "one number"), ({"k": "1 +"}, '"k"'), ({"k": "F"}, '"k"'),
    ({"k": -1e400}, "finite"), ({"jobs": 1.5}, "whole number"), ({"jobs": -1}, "whole number"),
    ({"only": "shrot"}, 'did you mean "short"'), ({"only": ["short", "x"]}, "no such analysis"),
])
def test_what_cannot_be_run_with_is_refused(values, words):
    study = oscillator(SHORT)
    with pytest.raises(rubato.StudyError) as caught:
        study.run(**values)
    assert words in str(caught.value) and study.results is None


def test_only_some_analyses_run():
    assert list(oscillator(SHORT, LONG).run(only="short")) == ["short"]


def interrupt_after(seconds):
    threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT)).start()


def test_ctrl_c_keeps_what_there_is():
    study = oscillator(LONG, SHORT)
    interrupt_after(0.4)
    begin = time.monotonic()
    with pytest.raises(rubato.Interrupted) as caught:
        study.run()
    assert time.monotonic() - begin < 5.0
    assert isinstance(caught.value, KeyboardInterrupt)
    results = caught.value.results
    assert results is study.results
    assert results.status("long") == "interrupted" and results["long"].attrs["status"] == "interrupted"
    t = results["long"].time.values
    assert len(t) > 1 and (np.diff(t) > 0).all() and t[-1] < 1e5
    assert np.isfinite(results["long"].position.values).all()
    assert results.message("short") == "not begun" and len(results["short"].data_vars) == 0
    assert study.run(only="short").status("short") == "done"


def test_a_handler_of_a_signal_may_raise_what_it_likes():
    def alarm(*_):
        raise TimeoutError("too long")
    before = signal.signal(signal.SIGALRM, alarm)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(TimeoutError):
            oscillator(LONG).run()
    finally:
        signal.signal(signal.SIGALRM, before)


def test_other_threads_of_python_go_on_meanwhile():
    study, stop, beats = oscillator({**LONG, "duration": 500.0}), threading.Event(), []
    pulse = threading.Thread(target=lambda: [beats.append(1) for _ in iter(lambda: stop.wait(0.002), True)])
    pulse.start()
    begin = time.monotonic()
    study.run()
    seconds = time.monotonic() - begin
    stop.set()
    pulse.join()
    assert len(beats) > 0.2 * seconds / 0.002


def test_studies_run_in_several_threads_at_once():
    study = oscillator({"name": "static", "type": "static"})
    found = {}

    def work(k):
        found[k] = [study.run(k=k)["static"].position.item() for _ in range(20)]
    threads = [threading.Thread(target=work, args=(k,)) for k in (1.0, 2.0, 4.0, 8.0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, positions in found.items():
        assert positions == [pytest.approx(3.0 / k)] * 20


def test_progress_is_told():
    told = []
    oscillator({**LONG, "duration": 500.0}).run(progress=lambda *stage: told.append(stage))
    assert told and all(name == "long" and unit == "steps" and 0 <= done <= total for name, done, total, unit in told)
    assert [done for _, done, _, _ in told] == sorted(done for _, done, _, _ in told)


def test_a_progress_function_that_raises_ends_the_run():
    def fail(*_):
        raise RuntimeError("mine")
    begin = time.monotonic()
    with pytest.raises(RuntimeError, match="mine"):
        oscillator(LONG).run(progress=fail)
    assert time.monotonic() - begin < 5.0


UNSTABLE = {"name": "wild", "type": "transient", "method": "central_difference", "step": 1.5, "duration": 3000.0,
            "allow_unstable": True}


def test_failures_of_the_mathematics_raise_and_keep_what_there_is():
    study = oscillator(UNSTABLE, SHORT)
    with pytest.raises(rubato.AnalysisError, match='analysis "wild" failed') as caught:
        study.run()
    results = caught.value.results
    assert results.status("wild") == "failed" and results.status("short") == "done"
    assert results["wild"].sizes["time"] > 1 and np.isfinite(results["wild"].position.values).all()
    with pytest.warns(rubato.StudyWarning, match="wild"):
        assert study.run(strict=False).status("wild") == "failed"
