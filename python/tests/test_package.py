"""The package as pip installs it: from the repository, without a network."""
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(os.environ["RUBATO_ROOT"])


def test_pip_installs_a_package_that_runs(tmp_path):
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", venv], check=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    # setuptools leaves its own files beside pyproject.toml: it gets a tree of links.
    tree = tmp_path / "tree"
    tree.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "python"):
        (tree / name).symlink_to(ROOT / name)
    done = subprocess.run([venv / "bin" / "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--quiet",
                           "--disable-pip-version-check", "."], cwd=tree, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    program = ("import rubato; print(rubato.__file__); "
               "r = rubato.Study({'coordinate': [{'name': 'a', 'mass': 1.0, 'position': 0.5}], "
               "'spring': [{'between': ['a', 'ground'], 'stiffness': 1.0}], "
               "'analysis': [{'name': 'free', 'type': 'transient', 'step': 0.1, 'duration': 1.0}]}).run(); "
               "print(r['free'].sizes['time'])")
    told = subprocess.run([venv / "bin" / "python", "-c", program], cwd=tmp_path, env=environment, check=True,
                          capture_output=True, text=True).stdout.split()
    assert str(venv) in told[0] and told[1] == "11"
    package = pathlib.Path(told[0]).parent
    assert (package / "py.typed").exists() and (package / "_rubato.pyi").exists() and (package / "_parts.pyi").exists()
