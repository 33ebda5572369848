"""Builds the extension module of the Python package with CMake; pyproject.toml says the rest.

RUBATO_BUILD names a build folder to use, such as build/release of this tree; without it one is made in build/pip, which
takes some minutes the first time.
"""
import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = pathlib.Path(__file__).resolve().parent


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        given = os.environ.get("RUBATO_BUILD")
        folder = pathlib.Path(given).resolve() if given else root / "build" / "pip"
        configure = ["cmake", "-S", str(root), "-B", str(folder)]
        if not (folder / "CMakeCache.txt").exists():
            configure += ["-DCMAKE_BUILD_TYPE=Release", "-DRUBATO_BUILD_TESTS=OFF", "-DRUBATO_PYTHON=ON"]
            configure += ["-G", "Ninja"] if shutil.which("ninja") else []
            configure += [f"-DPython3_EXECUTABLE={sys.executable}"]
        if not given:
            subprocess.run(configure, check=True)
        subprocess.run(["cmake", "--build", str(folder), "--target", "rubato_python", "--parallel",
                        str(len(os.sched_getaffinity(0)))], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        built = folder / "python" / "rubato" / target.name
        if not built.exists():
            sys.exit(f"{built} is not there: {folder} was made for another Python; remove it")
        for file in (built, built.with_name("_parts.pyi")):
            shutil.copy(file, target.parent)


setup(ext_modules=[Extension("rubato._rubato", [])], cmdclass={"build_ext": BuildWithCMake})
