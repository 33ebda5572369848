"""Results as labelled arrays: grids of sweeps, ownership, files."""
import gc
import os
import pathlib
import re
import subprocess
import warnings

import numpy as np
import pytest
import xarray

import rubato

EXAMPLES = pathlib.Path(os.environ["RUBATO_ROOT"]) / "examples"
OMEGA = np.array([0.5, 1.0, 1.5, 3.0])


def response(sweep, folder=".", **keys):
    return rubato.Study({
        "parameters": {"Omega": 1.0, "k": 4.0, "m": 1.0},
        "coordinate": [{"name": "a", "mass": "m"}, {"name": "b", "mass": 1.0}],
        "spring": [{"between": ["a", "ground"], "stiffness": "k"}, {"between": ["b", "ground"], "stiffness": 9.0}],
        "damper": [{"between": ["a", "ground"], "damping": 0.2}, {"between": ["b", "ground"], "damping": 0.2}],
        "force": [{"on": "a", "amplitude": 1.0, "angular_frequency": "Omega"}],
        "analysis": [{"name": "frf", "type": "frequency_response", "angular_frequency": OMEGA, "sweep": sweep, **keys}],
    }, folder=folder)


def amplitude(k, m, omega=OMEGA):
    return 1.0 / np.abs(k - m * omega**2 + 0.2j * omega)


def test_a_sweep_lies_on_its_grid():
    frf = response({"k": [4.0, 2.0, 8.0], "m": [1.0, 3.0]}).run()["frf"]
    assert frf.amplitude.dims == ("k", "m", "angular_frequency", "coordinate")
    assert list(frf.k) == [4.0, 2.0, 8.0] and list(frf.m) == [1.0, 3.0]
    for k in (4.0, 2.0, 8.0):
        for m in (1.0, 3.0):
            np.testing.assert_allclose(frf.amplitude.sel(k=k, m=m, coordinate="a"), amplitude(k, m), rtol=1e-9)
    assert float(frf.amplitude.sel(coordinate="b").max()) < 1e-12
    assert frf.status.dims == ("k", "m", "angular_frequency")


def test_a_sweep_of_cases_lies_in_lines(tmp_path):
    (tmp_path / "cases.csv").write_text("k,m\n4,1\n2,3\n8,1\n")
    frf = response({"file": "cases.csv"}, tmp_path).run()["frf"]
    assert frf.amplitude.dims == ("line", "angular_frequency", "coordinate")
    assert frf.k.dims == ("line",) and list(frf.m) == [1.0, 3.0, 1.0]
    for line in range(3):
        expected = amplitude(float(frf.k[line]), float(frf.m[line]))
        np.testing.assert_allclose(frf.amplitude.isel(line=line).sel(coordinate="a"), expected, rtol=1e-9)


def test_random_samples_lie_over_their_number():
    study = response({"samples": 20, "parameters": {"k": {"distribution": "uniform", "from": 3.0, "to": 5.0}}})
    frf = study.run()["frf"]
    assert frf.sizes["line"] == 20 and frf.k.dims == ("line",)
    assert ((3.0 <= frf.k) & (frf.k <= 5.0)).all()
    np.testing.assert_allclose(frf.amplitude.isel(line=7).sel(coordinate="a"), amplitude(float(frf.k[7]), 1.0), rtol=1e-9)


def test_a_swept_static_state_lies_on_its_grid():
    study = rubato.Study({
        "parameters": {"k": 4.0, "F": 1.0},
        "coordinate": [{"name": "a", "mass": 1.0}],
        "spring": [{"between": ["a", "ground"], "stiffness": "k"}],
        "force": [{"on": "a", "expression": "F"}],
        "analysis": [{"name": "rest", "type": "static", "sweep": {"k": [1.0, 2.0, 4.0], "F": [1.0, 3.0]}}]})
    rest = study.run()["rest"]
    assert dict(rest.sizes)["k"] == 3 and rest.sizes["F"] == 2
    position = rest[next(name for name in rest.data_vars if "position" in str(name))]
    position = position.isel({d: 0 for d in position.dims if d not in ("k", "F")})
    np.testing.assert_allclose(position, rest.F / rest.k if position.dims == ("F", "k") else (rest.F / rest.k).T, rtol=1e-12)


def test_histories_of_a_swept_transient_are_those_of_single_runs():
    tables = {
        "parameters": {"k": 4.0, "c": 0.1},
        "coordinate": [{"name": "a", "mass": 1.0, "position": 0.1}, {"name": "b", "mass": 1.0}],
        "spring": [{"between": ["a", "ground"], "stiffness": "k"}, {"between": ["a", "b"], "stiffness": 3.0}],
        "damper": [{"between": ["b", "ground"], "damping": "c"}]}
    single = {"name": "t", "type": "transient", "step": 0.01, "duration": 1.0}
    sweep = {"sweep": {"k": [1.0, 2.0, 4.0], "c": [0.1, 0.2]}, "histories": True}
    results = rubato.Study({**tables, "analysis": [{**single, **sweep}]}).run()
    histories, study = results["t.histories"], rubato.Study({**tables, "analysis": [single]})
    assert histories.position.dims == ("k", "c", "time", "coordinate") and histories.sizes["time"] == 101
    for k in (1.0, 2.0, 4.0):
        for c in (0.1, 0.2):
            alone = study.run(k=k, c=c)["t"]
            assert (histories.position.sel(k=k, c=c).values == alone.position.values).all()
            assert results["t"].position_max.sel(k=k, c=c, coordinate="b") == alone.position.sel(coordinate="b").max()


def test_a_response_there_and_back_keeps_its_directions_apart():
    frf = response({"k": [4.0, 2.0]}, direction="both", start="previous").run()["frf"]
    assert frf.sizes["k"] == 2 and list(frf.direction) == ["up", "down"]
    np.testing.assert_allclose(frf.amplitude.sel(k=2.0, direction="down", coordinate="a"),
                               amplitude(2.0, 1.0, frf.angular_frequency.sel(k=2.0, direction="down").values), rtol=1e-9)


def test_modes_lie_over_limit_and_number():
    modes = rubato.Study(EXAMPLES / "underplatform-damper" / "study.toml").run(only="modes")["modes"]
    assert modes.sizes["limit"] == 2 and modes.sizes["mode"] == 5
    omega = modes.angular_frequency.sel(limit="stuck")
    assert (np.diff(omega) >= 0).all() and (omega > modes.angular_frequency.sel(limit="free") - 1e-12).all()
    assert modes["shape"].sel(limit="free", mode=1).dims == ("coordinate",)


def test_a_damper_curve_lies_over_its_parameter():
    results = rubato.Study(EXAMPLES / "underplatform-damper" / "study.toml").run(only="damper")
    curve, optimum = results["damper"], results["damper.optimum"]
    assert curve.objective.dims == ("N0",) and curve.sizes["N0"] == 40
    assert float(curve.objective.min()) >= optimum.objective.item() * (1 - 1e-9)
    assert optimum.N0.item() == pytest.approx(34.78, abs=0.01)
    assert "damper.peaks" in results.tables("damper")


def test_numbers_are_views_that_outlive_the_results():
    study = response({"k": [4.0, 2.0]})
    results = study.run()
    values = results["frf"].amplitude.values
    assert not values.flags.owndata and not values.flags.writeable
    kept, copy = values, values.copy()
    del study, results, values
    gc.collect()
    np.random.default_rng(0).random(10**6)  # memory that would take the place
    assert (kept == copy).all()
    with pytest.raises(ValueError):
        kept[...] = 0.0


def test_names_that_are_not_there_are_told():
    results = response({"k": [4.0]}).run()
    with pytest.raises(KeyError, match='did you mean \\\\?"frf'):
        results["frg"]
    with pytest.raises(KeyError, match="linear"):
        results["frf.linaer"]
    assert "frf" in results and "frf.linear" in results and "frf.x" not in results and "x" not in results
    assert len(results) == 1 and "frf (" in repr(results) and "<table>" in results._repr_html_()


def test_every_example_gives_datasets():
    for name in ("slider-crank", "method-study", "two-supports", "campbell", "single-mass-slider", "stick-slip"):
        study = rubato.Study(EXAMPLES / name / "study.toml")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results = study.run()
        for analysis in results:
            for table in (analysis, *results.tables(analysis)):
                data = results[table]
                assert data.attrs["status"] == "done"
                assert all("units" in data[variable].attrs for variable in data.data_vars), table


def test_files_are_those_of_the_command(tmp_path):
    study = EXAMPLES / "single-mass-slider" / "study.toml"
    subprocess.run([os.environ["RUBATO_COMMAND"], "run", study, "-o", tmp_path / "command", "-q"], check=True)
    results = rubato.Study(study).run()
    results.write(tmp_path / "python")
    results.report(tmp_path / "page.html")
    written = sorted(file.name for file in (tmp_path / "python").iterdir() if not file.name.startswith("."))
    assert written == sorted(file.name for file in (tmp_path / "command").iterdir() if not file.name.startswith("."))

    def without_history(file):
        return re.sub(r'\["history","[^"]*"\]|"history":"[^"]*"', "", file.read_text())
    for file in (tmp_path / "command").glob("*.csv"):
        assert file.read_text() == (tmp_path / "python" / file.name).read_text()
    pages = [without_history(page) for page in (tmp_path / "command" / "report.html", tmp_path / "python" / "report.html",
                                                tmp_path / "page.html")]
    assert pages[0] == pages[1] == pages[2]
    assert "rubato.Study" in (tmp_path / "page.html").read_text()


def test_results_are_those_of_the_netcdf_file(tmp_path):
    pytest.importorskip("netCDF4")
    results = rubato.Study(EXAMPLES / "single-mass-slider" / "study.toml").run()
    results.write(tmp_path)
    for name in results:
        read = xarray.open_dataset(tmp_path / "results.nc", group=name)
        assert set(read.variables) == set(results[name].variables)


def test_files_that_cannot_be_written_are_told(tmp_path):
    results = response({"k": [4.0]}).run()
    with pytest.raises(rubato.OutputError):
        results.report(tmp_path / "none" / "page.html")
    (tmp_path / "file").write_text("")
    with pytest.raises(rubato.Error):
        results.write(tmp_path / "file")
    results.write(tmp_path / "again")
    results.write(tmp_path / "again")
