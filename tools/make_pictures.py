"""Make the pictures of the README and of the tutorial: run the examples, open their reports, save their figures.

Usage: make_pictures.py RUBATO [EXAMPLE...]. Writes docs/pictures/*.png; needs chromium and chromedriver.
"""
import base64
import pathlib
import shutil
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(root / "tests" / "report"))
from browser_test import Browser  # noqa: E402: lies beside the tests of the report

# Of each example: the picture's name, and words of the caption of its figure (the first that has them is taken).
PICTURES = {
    "single-mass": {"motion": "Motion of the coordinates", "energy": "Energy ledger"},
    "single-mass-slider": {"motion": "Motion of the coordinates", "loop": "Hysteresis loop", "energy": "Energy ledger"},
    "underplatform-damper": {"motion": "Motion of the coordinates", "loop": "Hysteresis loop", "energy": "Energy ledger"},
    "method-study": {"error": "against step", "radius": "Spectral radius", "elongation": "Period elongation",
                     "runge-kutta": "Stability regions", "newmark": "Stability of Newmark"},
    "matrices": {"motion": "Motion of the coordinates"},
}
WIDTH = 900

SAVE = """
const figure = figures.find((one) => one.node.querySelector('figcaption').textContent.includes(arguments[0]));
if (!figure) return null;
const plot = figure.plot;
const height = plot.clientHeight;
const done = figure.is_drawn ? Promise.resolve() : figure.render();
return done.then(() => Plotly.toImage(plot, {format: 'png', width: arguments[1], height, scale: 1.5}));
"""

# Figures 2.4 to 2.17 of the thesis on one sheet: each method's response beside the exact one.
SHEET = """
const chosen = figures.filter((one) => one.node.querySelector('figcaption').textContent.includes('response beside'));
if (chosen.length === 0) return null;
const wait = Promise.all(chosen.map((one) => one.is_drawn ? null : one.render()));
return wait.then(() => Promise.all(chosen.map((one) =>
  Plotly.toImage(one.plot, {format: 'png', width: 450, height: 300, scale: 1.5})))).then(async (images) => {
  const sheet = document.createElement('canvas');
  sheet.width = 2 * 675;
  sheet.height = Math.ceil(images.length / 2) * 450;
  const pen = sheet.getContext('2d');
  pen.fillStyle = 'white';
  pen.fillRect(0, 0, sheet.width, sheet.height);
  for (const [i, source] of images.entries()) {
    const image = new Image();
    image.src = source;
    await image.decode();
    pen.drawImage(image, (i % 2) * 675, Math.floor(i / 2) * 450);
  }
  return sheet.toDataURL('image/png');
});
"""


def save(browser, name, script, *arguments):
    data = browser.script(script, *arguments)
    if not data:
        print(f"{name}: no such figure", file=sys.stderr)
        return False
    (root / "docs" / "pictures" / name).write_bytes(base64.b64decode(data.split(",")[1]))
    print(f"docs/pictures/{name}")
    return True


def main():
    rubato, *names = sys.argv[1:]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-pictures-"))
    browser = Browser(folder)
    complete = True
    try:
        for name in names or PICTURES:
            results = folder / name
            subprocess.run([rubato, "run", str(root / "examples" / name / "study.toml"), "-o", str(results), "--quiet"],
                           check=True)
            browser.call("POST", "/url", {"url": (results / "report.html").as_uri()})
            browser.wait("return document.querySelectorAll('figure').length > 0")
            for picture, words in PICTURES[name].items():
                complete &= save(browser, f"{name}-{picture}.png", SAVE, words, WIDTH)
            if name == "method-study":
                complete &= save(browser, f"{name}-responses.png", SHEET)
            if name == "underplatform-damper":  # the README shows the report as it opens
                browser.call("POST", "/window/rect", {"width": 1366, "height": 900})
                browser.script("window.scrollTo(0, 0)")
                browser.script("document.querySelector('#figure-1').scrollIntoView({behavior: 'instant'})")
                browser.wait("return document.querySelector('#figure-1 .main-svg') !== null")
                shot = browser.call("GET", "/screenshot")
                (root / "docs" / "pictures" / f"{name}.png").write_bytes(base64.b64decode(shot))
                print(f"docs/pictures/{name}.png")
    finally:
        browser.close()
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(not complete)


if __name__ == "__main__":
    main()
