"""Studies from files, texts and dictionaries, and what is said of those that cannot be used."""
import pathlib
import pickle

import numpy as np
import pytest

import rubato

OSCILLATOR = {
    "parameters": {"k": 4.0, "F": 1.0},
    "coordinate": [{"name": "mass", "mass": 1.0}],
    "spring": [{"between": ["mass", "ground"], "stiffness": "k"}],
    "damper": [{"between": ["mass", "ground"], "damping": 0.2}],
    "force": [{"on": "mass", "amplitude": "F", "angular_frequency": 1.5}],
    "analysis": [{"name": "response", "type": "transient", "step": 0.01, "duration": 1.0}],
}
TEXT = """[parameters]
k = 4.0
[[coordinate]]
name = "mass"
mass = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = "k"
[[analysis]]
name = "modes"
type = "modes"
"""


def edited(**tables):
    return {**OSCILLATOR, **tables}


def test_a_dictionary_and_its_text_give_the_same_numbers():
    study = rubato.Study(OSCILLATOR)
    again = rubato.Study.from_text(study.text)
    assert (study.run()["response"].position.values == again.run()["response"].position.values).all()


def test_numbers_and_arrays_of_numpy_serve():
    plain = {"angular_frequency": [0.5, 1.0, 1.5], "observe": ["mass"]}
    numpy = {"angular_frequency": np.linspace(0.5, 1.5, 3), "observe": np.array(["mass"])}
    responses = []
    for keys, mass in ((plain, 2.0), (numpy, np.float32(2.0))):
        study = edited(coordinate=[{"name": "mass", "mass": mass}],
                       force=[{"on": "mass", "amplitude": 1, "angular_frequency": "k"}],
                       spring=[{"between": ("mass", "ground"), "stiffness": np.int64(4)}],
                       analysis=[{"name": "frf", "type": "frequency_response", **keys}])
        responses.append(rubato.Study(study).run()["frf"].amplitude.values)
    assert (responses[0] == responses[1]).all()


def test_texts_survive_whatever_is_in_them():
    name = 'quote " backslash \\ line\nbreak é 漢 \x7f tab\t'
    assert rubato.Study(edited(title=name)).title == name


@pytest.mark.parametrize("tables, key, words", [
    ({"coordinate": [{"name": "mass", "mass": 1.0, "positon": 1}]}, "coordinate[0].positon", 'did you mean "position"'),
    ({"coordinate": [{"name": "mass", "mass": float("nan")}]}, "coordinate[0].mass", "finite"),
    ({"coordinate": [{"name": "mass", "mass": None}]}, "coordinate[0].mass", "NoneType"),
    ({"coordinate": [{"name": "mass", "mass": 1j}]}, "coordinate[0].mass", "complex"),
    ({"coordinate": [{"name": "mass", "mass": np.ones(3)}]}, "coordinate[0].mass", "mass"),
    ({"coordinate": [{"name": "mass", "mass": 2**70}]}, "coordinate[0].mass", "too large"),
    ({"coordinate": [{"name": "\ud800", "mass": 1.0}]}, "coordinate[0].name", "Unicode"),
    ({"spring": [{"between": ["mass", "grond"], "stiffness": 1.0}]}, "spring[0].between", "ground"),
    ({"analysis": [{"name": "r", "type": "transient", "step": {"tolerance": 1e-3, "frist": 1}, "duration": 1.0}]},
     "analysis[0].step.frist", "first"),
    ({"sping": []}, "sping", 'did you mean "spring"'),
])
def test_errors_of_a_dictionary_name_its_key(tables, key, words):
    with pytest.raises(rubato.StudyError) as caught:
        rubato.Study(edited(**tables)).check()
    assert caught.value.key is not None and caught.value.key.startswith(key)
    assert caught.value.file is None and caught.value.line is None
    assert words in str(caught.value)


def test_errors_of_a_text_name_file_line_and_column():
    with pytest.raises(rubato.StudyError) as caught:
        rubato.Study.from_text(TEXT.replace('stiffness = "k"', 'stifness = "k"'), name="mine.toml")
    assert (caught.value.file, caught.value.line) == ("mine.toml", 8)
    assert str(caught.value).startswith("mine.toml:8:")
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, rubato.Error)


def test_errors_of_a_file_name_it(tmp_path):
    with pytest.raises(rubato.StudyError, match="does not exist"):
        rubato.Study(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("title = \n")
    with pytest.raises(rubato.StudyError, match="bad.toml:1"):
        rubato.Study(tmp_path / "bad.toml")
    with pytest.raises(rubato.StudyError, match="from_text"):
        rubato.Study(TEXT)


def test_a_file_and_its_neighbours_are_read_from_its_folder(tmp_path):
    (tmp_path / "load.csv").write_text("time,force\n0,0\n1,1\n2,0\n")
    tables = edited(force=[{"on": "mass", "table": "load.csv"}])
    from_folder = rubato.Study(tables, folder=tmp_path)
    (tmp_path / "study.toml").write_text(from_folder.text)
    from_file = rubato.Study(tmp_path / "study.toml")
    first, second = (study.run()["response"].position.values for study in (from_folder, from_file))
    assert (first == second).all() and first.max() > 0.0
    with pytest.raises(rubato.StudyError, match="load.csv"):
        rubato.Study(tables, folder=tmp_path / "elsewhere")


def test_check_says_what_would_run():
    check = rubato.Study(OSCILLATOR).check(k=9)
    assert check.parameters == {"k": 9.0, "F": 1.0}
    assert "100 steps" in check.analyses["response"]
    assert "1 coordinate" in check.summary and "1 coordinate" in str(check)


def test_doubts_are_told_with_their_key():
    study = rubato.Study(edited(slider=[{"name": "pad", "between": ["mass", "ground"], "stiffness": 1.0,
                                         "friction_coefficient": 30.0, "normal_load": 1.0}]))
    assert any(text.startswith("slider[0].friction_coefficient: ") for text in study.check().warnings)
    with pytest.warns(rubato.StudyWarning, match="friction_coefficient"):
        study.run()


def test_a_study_survives_pickling():
    study = pickle.loads(pickle.dumps(rubato.Study(OSCILLATOR)))
    assert study.parameters == {"k": 4.0, "F": 1.0}
    with pytest.raises(rubato.StudyError) as caught:
        study.run(k="1/")
    fault = pickle.loads(pickle.dumps(caught.value))
    assert str(fault) == str(caught.value)


def test_a_study_shows_itself():
    study = rubato.Study(edited(title="<b>bold</b>"))
    assert "response" in repr(study) and "&lt;b&gt;" in study._repr_html_() and "k = 4" in study._repr_html_()
    assert pathlib.Path(rubato.__file__).with_name("py.typed").exists()
