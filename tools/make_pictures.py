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

# Of each example: the picture's name, and words of the caption of its figure. Where they are not enough: which of the
# figures with these words, from 1, and what is chosen above it ("Lines": the names of the only ones to be shown). A list of
# times: the structure at these moments, drawn over each other.
RESPONSES, SLIDERS = "Responses in the steady state", "Sliders over a period"
MOTION, ROTATIONS, STEPS = "Motion of the coordinates", "Rotations of nodes and joints", "Length of the steps"
PICTURES = {
    "single-mass": {"motion": MOTION, "energy": "Energy ledger"},
    "single-mass-slider": {"motion": MOTION, "loop": "Hysteresis loop", "energy": "Energy ledger",
                           "frf": RESPONSES, "phase": "Phases of the harmonics", "slip": SLIDERS,
                           "loops": "Hysteresis loops at chosen points", "marched": (RESPONSES, 2, {}),
                           "damper": "Damper curve:"},
    "underplatform-damper": {"motion": MOTION, "loop": "Hysteresis loop", "energy": "Energy ledger",
                             "modes": ("Shape of a mode", 1, {"Mode": "Mode 4"}),
                             "frf": (RESPONSES, 1, {"Scale": "Logarithmic"}), "map": "Amplitude over frequency and parameter",
                             "loops": "Hysteresis loops at chosen points", "damper": "Damper curve:"},
    "rotor-speed": {"responses": RESPONSES, "mass": "Damper curve:"},
    "unbalance": {"run-up": RESPONSES, "slip": SLIDERS, "map": ("Amplitude over frequency and parameter", 2, {})},
    "mistuned-sectors": {"bands": "Percentile bands over the samples", "distribution": "Distribution of the largest amplitude",
                         "sensitivity": "Largest amplitude of each sample"},
    "method-study": {"error": "against step", "radius": "Spectral radius", "elongation": "Period elongation",
                     "runge-kutta": "Stability regions", "newmark": "Stability of Newmark",
                     "responses": "response beside"},
    "building": {"motion": MOTION},
    "isolated-building": {"loop": "Hysteresis loop of bearings"},
    "machine-mounts": {"motion": MOTION, "loop": "Hysteresis loop of mounts"},
    "machine-mounts-running": {"frf": (RESPONSES, 1, {"Scale": "Logarithmic"})},
    "two-supports": {"motion": MOTION},
    "late-stop": {"motion": MOTION},
    "frame": {"motion": MOTION},
    "double-pendulum": {"positions": [0.0, 0.8, 1.1, 1.8, 2.2, 3.8], "motion": MOTION, "steps": STEPS},
    "locking-bars": {"positions": [0.0, 0.9, 1.2, 1.39], "angle": (ROTATIONS, 1, {"Lines": ["B"]}), "steps": STEPS,
                     "energy": "Energy ledger"},
    "slider-crank": {"positions": [0.0, 0.2, 0.27, 0.33, 0.37, 0.42], "speed": (ROTATIONS, 1, {"Quantity": "Angular velocity", "Lines": ["shaft"]}),
                     "reactions": ("What each joint does", 1, {"Quantity": "Reaction normal"})},
    "slider-crank-flexible": {"drive": ("Forces and moments of laws, friction and drives", 1, {"Quantity": "Drive moment"})},
    "shaking-sieve": {"motion": "Travel of the joints that slide",
                      "drive": ("Forces and moments of laws, friction and drives", 1, {"Quantity": "Drive moment"})},
    "wheel-suspension": {"ride": RESPONSES},
    "geared-pair": {"angle": (ROTATIONS, 1, {"Lines": ["azimuth"]})},
    "deployable-panel": {"positions": [0.0, 0.6, 1.07, 1.5, 1.84, 4.5], "angles": (ROTATIONS, 1, {"Lines": ["wall", "first", "second"]}),
                         "energy": "Energy ledger"},
    "cam-follower": {"lift": ("Travel of the joints that slide", 1, {})},
    "hatch": {"positions": [0.0, 0.2, 0.4, 0.6], "angle": (ROTATIONS, 1, {"Lines": ["hinge"]}), "energy": "Energy ledger",
              "mode": "A mode of the mechanism"},
    "door-on-two-hinges": {"angle": (ROTATIONS, 1, {"Lines": ["upper hinge"]}),
                           "reactions": ("What each joint does", 1, {"Quantity": "Reaction x"})},
    "heavy-top": {"motion": MOTION},
    "bricard": {"energy": "Energy ledger"},
    "matrices": {"motion": MOTION},
}
WIDTH = 900

# Numbers of the figures whose caption has these words.
FIND = """
return [...document.querySelectorAll('figure')].map((figure, i) => [figure.querySelector('figcaption').textContent, i + 1])
  .filter(([caption]) => caption.includes(arguments[0])).map(([, number]) => number)
"""

DRAW = "document.getElementById('figure-' + arguments[0]).scrollIntoView({behavior: 'instant'})"

# Presses the button, or takes the entry of the list, that is called so.
CHOOSE = """
const figure = document.querySelector(`#figure-${arguments[0]}`);
const [label, option] = [arguments[1], arguments[2]];
const buttons = figure.querySelector(`.chooser[aria-label="${label}"]`);
if (buttons) {
  const button = [...buttons.querySelectorAll('button')].find((entry) => entry.textContent === option);
  button?.click();
  return Boolean(button);
}
const list = figure.querySelector(`select[aria-label="${label}"]`);
const index = list ? [...list.options].findIndex((entry) => entry.text === option) : -1;
if (index < 0) return false;
list.selectedIndex = index;
list.dispatchEvent(new Event('change'));
return true;
"""

SAVE = """
const plot = document.querySelector(`#figure-${arguments[0]} .plot`);
if (!plot) return document.querySelector(`#figure-${arguments[0]} canvas`).toDataURL('image/png');
return Plotly.toImage(plot, {format: 'png', width: arguments[1], height: plot.clientHeight, scale: 1});
"""

# Hides all lines but those of these names, and draws them solid.
HIDE = """
const plot = document.querySelector(`#figure-${arguments[0]} .plot`);
const shown = plot.data.map((trace) => arguments[1].includes(trace.name));
return Plotly.restyle(plot, {visible: shown, 'line.dash': 'solid'}).then(() => arguments[1].every((name) => plot.data.some((trace) => trace.name === name)));
"""

# The structure at some times, the last of them in full colour.
OVERLAY = """
const figure = document.querySelector(`#figure-${arguments[0]}`);
const [canvas, scrub, label] = ['canvas', 'input[type=range]', '.moment'].map((part) => figure.querySelector(part));
const sheet = document.createElement('canvas');
[sheet.width, sheet.height] = [canvas.width, canvas.height];
const pen = sheet.getContext('2d');
pen.fillStyle = 'white';
pen.fillRect(0, 0, sheet.width, sheet.height);
pen.globalCompositeOperation = 'multiply';
const place = (at) => {
  scrub.value = String(at);
  scrub.dispatchEvent(new Event('input'));
  return Number(label.textContent.match(/t = (.*) s/)[1]);
};
for (const [index, time] of arguments[1].entries()) {
  let low = 0, high = Number(scrub.max);
  while (high - low > 1e-3) [low, high] = place((low + high) / 2) < time ? [(low + high) / 2, high] : [low, (low + high) / 2];
  place(high);
  pen.globalAlpha = 0.3 + 0.7 * (index + 1) / arguments[1].length;
  pen.drawImage(canvas, 0, 0);
}
return sheet.toDataURL('image/png');
"""

# Several figures on one sheet, in two columns.
SHEET = """
return Promise.all(arguments[0].map((number) => Plotly.toImage(document.querySelector(`#figure-${number} .plot`),
  {format: 'png', width: 600, height: 360, scale: 1}))).then(async (images) => {
  const sheet = document.createElement('canvas');
  sheet.width = 2 * 600;
  sheet.height = Math.ceil(images.length / 2) * 360;
  const pen = sheet.getContext('2d');
  pen.fillStyle = 'white';
  pen.fillRect(0, 0, sheet.width, sheet.height);
  for (const [i, source] of images.entries()) {
    const image = new Image();
    image.src = source;
    await image.decode();
    pen.drawImage(image, (i % 2) * 600, Math.floor(i / 2) * 360);
  }
  return sheet.toDataURL('image/png');
});
"""


def find(browser, words):
    """Numbers of the figures whose caption has these words, drawn."""
    numbers = browser.script(FIND, words)
    for number in numbers:
        browser.script(DRAW, number)
        browser.wait(f"return document.querySelector('#figure-{number} .main-svg') !== null || "
                     f"document.querySelector('#figure-{number} canvas')?.width > 300")  # that of one which is not drawn
    return numbers


def write(name, data):
    (root / "docs" / "pictures" / name).write_bytes(base64.b64decode(data.split(",")[-1]))
    print(f"docs/pictures/{name}")


def save(browser, example, picture, figure):
    if isinstance(figure, list):
        write(f"{example}-{picture}.png", browser.script(OVERLAY, find(browser, "The structure in motion")[0], figure))
        return True
    words, which, choices = (figure, 1, {}) if isinstance(figure, str) else figure
    numbers = find(browser, words)
    if len(numbers) < which:
        print(f"{example}: no figure {which} says \"{words}\"", file=sys.stderr)
        return False
    for label, option in choices.items():
        if not (browser.script(HIDE, numbers[which - 1], option) if label == "Lines"
                else browser.script(CHOOSE, numbers[which - 1], label, option)):
            print(f"{example}: the figure {picture} has no {label} \"{option}\"", file=sys.stderr)
            return False
    is_sheet = example == "method-study" and picture == "responses"
    write(f"{example}-{picture}.png",
          browser.script(SHEET, numbers) if is_sheet else browser.script(SAVE, numbers[which - 1], WIDTH))
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
            for picture, figure in PICTURES[name].items():
                complete &= save(browser, name, picture, figure)
            if name == "underplatform-damper":  # for the README: the report as it is read
                browser.call("POST", "/window/rect", {"width": 1366, "height": 900})
                browser.script(DRAW, find(browser, PICTURES[name]["motion"])[0])
                write(f"{name}.png", browser.call("GET", "/screenshot"))
    finally:
        browser.close()
        shutil.rmtree(folder, ignore_errors=True)
    sys.exit(not complete)


if __name__ == "__main__":
    main()
