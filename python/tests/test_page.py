"""What the reference page of the package shows runs, in the order in which it stands there."""
import os
import pathlib
import re
import shutil
import warnings

from matplotlib import pyplot

ROOT = pathlib.Path(os.environ["RUBATO_ROOT"])
PAGE = ROOT / "docs" / "reference" / "python.md"


def test_what_the_page_shows_runs(tmp_path, monkeypatch):
    shutil.copytree(ROOT / "examples" / "underplatform-damper", tmp_path / "underplatform-damper")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) > 5
    names = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for number, block in enumerate(blocks, 1):
            exec(compile(block, f"block {number} of {PAGE.name}", "exec"), names)
    pyplot.close("all")
    assert (tmp_path / "report.html").exists() and (tmp_path / "results" / "results.nc").exists()
