"""The JSON schema that `rubato schema` prints says what the reader says.

usage: schema_test.py RUBATO ROOT

Every example is valid to both; every mutation of one (a key unknown, missing or of the wrong type) to neither; and the
keys of the schema are those that the reader asks for.
"""
import copy
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

try:
    import jsonschema
except ImportError:  # the distribution's package serves the distribution's interpreter
    if os.path.realpath(sys.executable) == os.path.realpath("/usr/bin/python3"):
        raise
    os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])

rubato, root = sys.argv[1], pathlib.Path(sys.argv[2])
schema = json.loads(subprocess.run([rubato, "schema"], check=True, capture_output=True, text=True).stdout)
validator = jsonschema.Draft202012Validator(schema)
examples = sorted((root / "examples").glob("*/study.toml"))


def is_valid(study):
    return validator.is_valid(study)


def check(path):
    """Exit status of `rubato check`, and its message without warnings, which are of the mechanism and not of the file."""
    result = subprocess.run([rubato, "check", str(path)], capture_output=True, text=True)
    return result.returncode, "".join(line for line in result.stderr.splitlines(True) if ": warning: " not in line)


def to_toml(value):
    """A value on one line; tables are inline below the top."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(to_toml, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {to_toml(v)}" for k, v in value.items()) + "}"
    return repr(value)


def dump(study):
    lines = [f"{key} = {to_toml(value)}" for key, value in study.items() if not isinstance(value, (dict, list))]
    for key, value in study.items():
        if isinstance(value, dict):
            lines += [f"[{key}]"] + [f"{json.dumps(k)} = {to_toml(v)}" for k, v in value.items()]
        if isinstance(value, list):
            for entry in value:
                lines += [f"[[{key}]]"] + [f"{k} = {to_toml(v)}" for k, v in entry.items()]
    return "\n".join(lines) + "\n"


def tables(study):
    """(name, table) of every table of a study whose keys are fixed."""
    yield "study", study
    for key, value in study.items():
        if isinstance(value, list):
            yield from ((key, entry) for entry in value)
        elif isinstance(value, dict) and key != "parameters":
            yield key, value


# Without these a table means nothing; the rest is optional.
REQUIRED = {"coordinate": ("name", "mass"), "spring": ("between", "stiffness"), "damper": ("between", "damping"),
            "damping": ("modal_ratio",), "slider": ("between", "stiffness", "friction_coefficient", "normal_load"),
            "force": ("on", "amplitude"), "matrices": ("mass", "stiffness"), "analysis": ("name", "type", "duration"), "node": ("name", "position"),
            "material": ("name", "young", "density"), "section": ("name", "area"),
            "beam": ("nodes", "section", "material"), "truss": ("nodes", "section", "material"),
            "mass": ("node",), "support": ("node", "fix"), "displacement": ("on", "value"),
            "gravity": ("acceleration",), "body": ("name", "mass", "inertia", "position"),
            "joint": ("type", "between")}


def mutations(study):
    for index, (name, table) in enumerate(tables(study)):
        def changed(change):
            mutant = copy.deepcopy(study)
            change(list(tables(mutant))[index][1])
            return mutant

        yield f"{name}: unknown key", changed(lambda t: t.update(no_such_key=1))
        for key in table:
            if key not in ("parameters",) or name != "study":
                yield f"{name}: {key} = false", changed(lambda t: t.update({key: False if key not in FLAGS else 1}))
        for key in REQUIRED.get(name, ()):
            if key in table:
                yield f"{name}: no {key}", changed(lambda t: t.pop(key))


FLAGS = ("energy", "allow_unstable", "as_printed", "following", "project_velocities")


def keys_of(node):
    """Names of the properties of a schema, at every depth."""
    found = set()
    if isinstance(node, dict):
        found |= set(node.get("properties", {})) if isinstance(node.get("properties"), dict) else set()
        for value in node.values():
            found |= keys_of(value)
    if isinstance(node, list):
        for value in node:
            found |= keys_of(value)
    return found


class Schema(unittest.TestCase):
    def test_is_a_schema(self):
        jsonschema.Draft202012Validator.check_schema(schema)

    def test_there_are_examples(self):
        self.assertGreaterEqual(len(examples), 5)

    def test_accepts_the_examples(self):
        for path in examples:
            with self.subTest(path.parent.name):
                validator.validate(tomllib.loads(path.read_text()))
                status, message = check(path)
                self.assertEqual((status, message), (0, ""))

    def test_and_the_reader_refuse_every_mutation(self):
        for path in examples:
            study = tomllib.loads(path.read_text())
            with tempfile.TemporaryDirectory() as folder:
                for file in set(path.parent.iterdir()) - {path}:
                    os.symlink(file, pathlib.Path(folder) / file.name)
                target = pathlib.Path(folder) / "study.toml"
                target.write_text(dump(study))
                self.assertEqual(check(target), (0, ""), "the study written back")
                count = 0
                for label, mutant in mutations(study):
                    with self.subTest(f"{path.parent.name}: {label}"):
                        target.write_text(dump(mutant))
                        self.assertFalse(is_valid(mutant), "the schema accepts it")
                        status, message = check(target)
                        self.assertEqual(status, 2, "the reader accepts it")
                        self.assertIn("error: ", message)
                        count += 1
                self.assertGreater(count, 20)

    def test_and_the_reader_agree_on_keys_that_exclude_each_other(self):
        damper = tomllib.loads((root / "examples" / "underplatform-damper" / "study.toml").read_text())
        damper["analysis"] = damper["analysis"][:1]  # the exact flow takes no formulas of t
        harmonic = {"on": "blade1", "amplitude": 1.0}
        analysis = {"name": "run", "type": "transient", "duration": 1.0}
        motion = {"amplitude": 1.0, "frequency": 2.0, "of": "displacement"}
        cases = [
            ("force", [harmonic | {"frequency": 2.0}], True),
            ("force", [harmonic], False),
            ("force", [harmonic | {"frequency": 2.0, "angular_frequency": 2.0}], False),
            ("force", [harmonic | {"frequency": 2.0, "beyond": "zero"}], False),
            ("force", [{"on": "blade1", "expression": "sin(t)"}], True),
            ("force", [{"on": "blade1", "expression": "sin(t)", "phase": 1.0}], False),
            ("damping", {"modal_ratio": [0.01, 0.02], "modes": 2}, True),
            ("damping", {"rayleigh": {"stiffness": 0.01}}, True),
            ("damping", {"rayleigh": {}}, False),
            ("damping", {"rayleigh": {"mass": 0.01}, "modes": 2}, False),
            ("base_motion", motion, True),
            ("base_motion", motion | {"expression": "t"}, False),
            ("analysis", [analysis | {"step": 0.01}], True),
            ("analysis", [analysis], False),
            ("analysis", [analysis | {"method": "exact"}], True),
            ("analysis", [analysis | {"method": "exact", "step": 0.01}], False),
            ("analysis", [analysis | {"step": 0.01, "method": {"name": "hht", "alpha": -0.1}}], True),
            ("analysis", [analysis | {"step": {"tolerance": 1e-3}}], True),
            ("analysis", [analysis | {"step": {"first": 1e-3}}], False),
            ("analysis", [analysis | {"step": {"tolerance": 1e-3, "events": "locate", "controller": "pi"}}], True),
            ("analysis", [analysis | {"step": {"tolerance": 1e-3, "controller": "pid"}}], False),
            ("analysis", [analysis | {"method": "exact", "step": {"tolerance": 1e-3}}], False),
            ("analysis", [analysis | {"step": 0.01, "output": {"every": 2, "interval": 0.1}}], False),
            ("analysis", [analysis | {"step": 0.01, "name": "results"}], False),
            ("analysis", [analysis | {"step": 0.01, "name": "a/b"}], False),
            ("analysis", [analysis | {"step": 0.01, "observe": ["disk1", "disk1"]}], False),
            ("analysis", [analysis | {"step": 0.01, "initial": "static"}], True),
            ("analysis", [analysis | {"step": 0.01, "initial": "static", "displacements": []}], True),
            ("analysis", [analysis | {"step": 0.01, "displacements": []}], False),
            ("analysis", [{"name": "rest", "type": "static", "observe": ["blade1"]}], True),
            ("analysis", [{"name": "rest", "type": "static", "duration": 1.0}], False),
            ("force", [{"on": "blade1", "held": 5.0}], True),
            ("force", [harmonic | {"frequency": 2.0, "held": 5.0}], False),
            ("analysis", [], False),
        ]
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder) / "study.toml"
            for key, value, expected in cases:
                with self.subTest(f"{key} = {value}"):
                    study = damper | {key: value}
                    target.write_text(dump(study))
                    self.assertEqual(is_valid(study), expected, "the schema")
                    self.assertEqual(check(target)[0], 0 if expected else 2, "the reader")

    def test_and_the_reader_want_an_analysis(self):
        study = tomllib.loads(examples[0].read_text())
        del study["analysis"]
        self.assertFalse(is_valid(study))
        with tempfile.TemporaryDirectory() as folder:
            for file in set(examples[0].parent.iterdir()) - {examples[0]}:
                os.symlink(file, pathlib.Path(folder) / file.name)
            target = pathlib.Path(folder) / "study.toml"
            target.write_text(dump(study))
            message = 'error: the study has no [[analysis]]; add one, such as type = "transient"\n'
            self.assertEqual(check(target), (2, f"{target}: {message}"))

    def test_has_the_keys_that_the_reader_asks_for(self):
        calls = (r'(?:\.|->|\b)(?:text|quantity|node|has|optional_\w+)\("(\w+)"')
        fields = r'\b(?:visit|inner)\.(?:template )?(\w+)(?:<\w+>)?\(\s*(?:is_force \? )?("\w+"(?: : "\w+")?)'
        either = r'either_quantity\(\s*\{"(\w+)", "(\w+)"\}'
        asked = set()
        for source in (root / "src" / "rubato" / "io").glob("read*.cpp"):
            asked |= set(re.findall(calls, source.read_text()))
        for source in (root / "src" / "rubato" / "model" / "fields").glob("*_fields.hpp"):
            text = source.read_text()
            for operation, words in re.findall(fields, text):
                asked |= set(re.findall(r"\w+", words)) if operation != "title" else set()
            asked |= {word for pair in re.findall(either, text) for word in pair}
        # Laws name their table, and their keys with a type.
        law = r'LawKind \w+\(\) \{.*?return \{\s*"(\w+)"|\{"([\w.]+)", (?:LawKey::)?Type::'
        for source in (root / "src" / "rubato" / "model" / "laws").glob("*.cpp"):
            for pair in re.findall(law, source.read_text(), re.DOTALL):
                asked |= {word for key in pair if key for word in key.split(".")}
        known = keys_of(schema)
        # A method's own parameters are read by whatever name they have and judged by the catalogue.
        methods = set(subprocess.run([rubato, "methods", "newmark"], check=True, capture_output=True,
                                     text=True).stdout.split())
        self.assertLessEqual({"beta", "gamma"}, methods)
        by_name = {"alpha", "beta", "gamma", "rho_inf", "theta"}
        self.assertEqual(asked - by_name, known - by_name)

    def test_lists_the_methods_of_the_catalogue(self):
        lines = subprocess.run([rubato, "methods"], check=True, capture_output=True, text=True).stdout.split("\n\n")[0]
        catalogue = [line.split()[0] for line in lines.splitlines()[1:]]
        self.assertEqual(schema["$defs"]["method_name"]["enum"], catalogue)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
