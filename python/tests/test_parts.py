"""Studies that are built part by part."""
import ast
import inspect
import os
import pathlib
import pickle

import numpy as np
import pytest

import rubato

EXAMPLE = pathlib.Path(os.environ["RUBATO_ROOT"]) / "examples" / "single-mass" / "study.toml"


def chain(count):
    study = rubato.Study()
    study.set_parameters(k=100.0)
    for i in range(count):
        study.add_coordinate(name=f"m{i}", mass=np.float64(2.0))
        study.add_spring(between=("ground" if i == 0 else f"m{i - 1}", f"m{i}"), stiffness="k")
    study.add_analysis(name="modes", type="modes", count=count)
    return study


def test_a_chain_has_the_frequencies_of_a_chain():
    n = 8
    omega = chain(n).run(k=50.0)["modes"].angular_frequency.values.ravel()[:n]
    exact = 2 * np.sqrt(50.0 / 2.0) * np.sin((2 * np.arange(1, n + 1) - 1) * np.pi / (2 * (2 * n + 1)))
    np.testing.assert_allclose(omega, exact, rtol=1e-10)


def test_parts_are_what_a_dictionary_would_give():
    built, given = chain(2), rubato.Study({
        "parameters": {"k": 100.0},
        "coordinate": [{"name": "m0", "mass": 2.0}, {"name": "m1", "mass": 2.0}],
        "spring": [{"between": ["ground", "m0"], "stiffness": "k"}, {"between": ["m0", "m1"], "stiffness": "k"}],
        "analysis": [{"name": "modes", "type": "modes", "count": 2}]})
    assert built.run()["modes"].equals(given.run()["modes"])
    assert rubato.Study.from_text(built.text).run()["modes"].equals(given.run()["modes"])


@pytest.mark.parametrize("call, words", [
    (lambda s: s.add_slider(name="pad", betwen=["m0", "ground"]), 'did you mean "between"'),
    (lambda s: s.add_analysis(name="t", type="transient", durration=1.0), 'did you mean "duration"'),
    (lambda s: s.set_damping(modal_ration=0.1), 'did you mean "modal_ratio"'),
    (lambda s: s.add_coordinate({"name": "x", "weight": 1.0}), "mass"),
    (lambda s: s.add_coordinate(name="x", mass=1j), "coordinate[2].mass"),
    (lambda s: s.set_parameters(m=1.0), "[parameters] already"),
])
def test_a_wrong_key_is_refused_at_once_and_changes_nothing(call, words):
    study = chain(2)
    before = study.text
    with pytest.raises(rubato.StudyError) as caught:
        call(study)
    assert words in str(caught.value) and study.text == before
    assert study.run().status("modes") == "done"


def test_what_only_the_whole_study_shows_names_the_part():
    study = chain(3)
    study.add_spring(between=["m2", "m9"], stiffness=1.0)
    for _ in range(2):
        with pytest.raises(rubato.StudyError) as caught:
            study.run()
        assert caught.value.key.startswith("spring[3]")


def test_parts_join_a_study_file():
    study = rubato.Study(EXAMPLE)
    names = study.analyses
    study.add_coordinate(name="rider", mass=0.1)
    study.add_spring(between=["rider", "ground"], stiffness=0.4)
    study.add_analysis(name="extra", type="modes")
    assert study.analyses == [*names, "extra"]
    omega = study.run(only="extra")["extra"].angular_frequency.values
    assert np.isclose(omega, 2.0, rtol=1e-12).any()
    study.add_spring(between=["rider", "grond"], stiffness=0.4)
    with pytest.raises(rubato.StudyError) as caught:
        study.check()
    assert caught.value.key is not None and caught.value.key.startswith("spring[")
    again = pickle.loads(pickle.dumps(study))
    with pytest.raises(rubato.StudyError, match="spring"):
        again.check()


def test_parts_join_no_list_that_is_closed():
    study = rubato.Study.from_text('coordinate = [{ name = "a", mass = 1.0 }]\n')
    with pytest.raises(rubato.StudyError, match=r"\[\[coordinate\]\]"):
        study.add_coordinate(name="b", mass=1.0)


def test_an_empty_study_says_so():
    with pytest.raises(rubato.StudyError, match="add_coordinate"):
        rubato.Study().run()
    assert "cannot run yet" in repr(rubato.Study()) and "cannot run yet" in rubato.Study()._repr_html_()


def test_parts_tell_their_keys():
    signature = inspect.signature(rubato.Study.add_slider)
    assert {"name", "between", "stiffness", "friction_coefficient", "normal_load"} <= set(signature.parameters)
    assert "[N/m]" in rubato.Study.add_slider.__doc__ and "(required)" in rubato.Study.add_slider.__doc__
    assert "transient" in rubato.Study.add_analysis.__doc__


def test_type_stubs_have_every_part():
    stubs = ast.parse(pathlib.Path(rubato.__file__).with_name("_parts.pyi").read_text())
    (parts,) = (node for node in stubs.body if isinstance(node, ast.ClassDef))
    told = {method.name: [key.arg for key in method.args.kwonlyargs] for method in parts.body}
    for name in dir(rubato.Study):
        if name.startswith(("add_", "set_")):
            keys = inspect.signature(getattr(rubato.Study, name)).parameters.values()
            assert sorted(told[name]) == sorted(key.name for key in keys if key.kind == key.KEYWORD_ONLY), name
