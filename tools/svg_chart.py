"""Line charts in SVG, several panels on one sheet, with linear or logarithmic axes. No libraries.

    panel = Panel("title", "x", "y", log_x=True)
    panel.line("name", [(x, y), ...])
    write("file.svg", [panel, ...], columns=2)
"""
import html
import math

COLOURS = ["#1f5fa8", "#c8552b", "#2f8f5b", "#7a4fa3", "#8a6d1f", "#5a5a5a"]
WIDTH, HEIGHT = 430, 316
LEFT, RIGHT, TOP, BOTTOM = 66, 12, 48, 44


class Axis:
    """A range of values, padded, with its ticks and the way from a value to 0 ... 1."""

    def __init__(self, values, is_log):
        self.is_log = is_log
        low, high = min(values), max(values)
        if is_log:
            self.low, self.high = math.log10(low) - 0.08, math.log10(high) + 0.08
        else:
            pad = 0.04 * (high - low) or 1.0
            self.low, self.high = low - pad, high + pad

    def place(self, value):
        return ((math.log10(value) if self.is_log else value) - self.low) / (self.high - self.low)

    def ticks(self):
        if self.is_log:
            first, last = math.ceil(self.low), math.floor(self.high)
            stride = max(1, math.ceil((last - first) / 6))
            if last > first:
                return [(10.0**e, f"1e{e}" if not -2 <= e <= 3 else f"{10.0**e:g}") for e in range(first, last + 1, stride)]
            values = [m * 10.0**e for e in range(first - 1, last + 2) for m in (1, 2, 5)]
            return [(v, f"{v:g}") for v in values if self.low <= math.log10(v) <= self.high]
        raw = (self.high - self.low) / 5
        power = 10.0 ** math.floor(math.log10(raw))
        step = next(m * power for m in (1, 2, 5, 10) if m * power >= raw)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [(i * step, f"{i * step:.10g}") for i in range(first, last + 1)]


class Panel:
    """One chart: lines, points and bars, each with a name for the legend (none: not in it)."""

    def __init__(self, title, x, y, log_x=False, log_y=False, x_range=None, y_range=None):
        self.title, self.x, self.y = title, x, y
        self.log_x, self.log_y = log_x, log_y
        self.x_range, self.y_range = x_range, y_range
        self.series = []

    def line(self, name, points, colour=None, dash="", width=1.6, marks=False):
        self.series.append(("line", name, points, colour, dash, width, marks))

    def bars(self, name, points, colour=None):
        self.series.append(("bars", name, points, colour, "", 3.0, False))

    def draw(self, x0, y0):
        colours = {}
        for _, name, _, colour, *_ in self.series:
            if colour is None and name not in colours:
                colours[name] = COLOURS[len(colours) % len(COLOURS)]
        points = [p for _, _, series, *_ in self.series for p in series]
        horizontal = Axis(self.x_range or [x for x, _ in points], self.log_x)
        vertical = Axis(self.y_range or [y for _, y in points], self.log_y)
        inner_width, inner_height = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

        def at(x, y):
            return (x0 + LEFT + inner_width * horizontal.place(x), y0 + TOP + inner_height * (1 - vertical.place(y)))

        out = [f'<text x="{x0 + LEFT}" y="{y0 + 19}" font-weight="bold">{html.escape(self.title)}</text>']
        for value, text in horizontal.ticks():
            x = at(value, points[0][1])[0]
            out.append(f'<path d="M{x:.1f} {y0 + TOP}v{inner_height}" stroke="#e2e2e2"/>'
                       f'<text x="{x:.1f}" y="{y0 + HEIGHT - BOTTOM + 15}" text-anchor="middle">{text}</text>')
        for value, text in vertical.ticks():
            y = at(points[0][0], value)[1]
            out.append(f'<path d="M{x0 + LEFT} {y:.1f}h{inner_width}" stroke="#e2e2e2"/>'
                       f'<text x="{x0 + LEFT - 5}" y="{y + 4:.1f}" text-anchor="end">{text}</text>')
        out.append(f'<rect x="{x0 + LEFT}" y="{y0 + TOP}" width="{inner_width}" height="{inner_height}" fill="none" '
                   'stroke="#777"/>'
                   f'<text x="{x0 + LEFT + inner_width / 2}" y="{y0 + HEIGHT - 10}" text-anchor="middle">'
                   f'{html.escape(self.x)}</text>'
                   f'<text transform="translate({x0 + 13} {y0 + TOP + inner_height / 2}) rotate(-90)" '
                   f'text-anchor="middle">{html.escape(self.y)}</text>')
        clip = f"clip{x0}-{y0}"
        out.append(f'<clipPath id="{clip}"><rect x="{x0 + LEFT}" y="{y0 + TOP}" width="{inner_width}" '
                   f'height="{inner_height}"/></clipPath><g clip-path="url(#{clip})">')
        for kind, name, series, colour, dash, width, marks in self.series:
            colour = colour or colours[name]
            places = [at(x, y) for x, y in series]
            if kind == "bars":
                floor = y0 + TOP + inner_height
                out += [f'<path d="M{x:.1f} {floor}V{y:.1f}" stroke="{colour}" stroke-width="{width}"/>' for x, y in places]
                continue
            path = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
            style = f' stroke-dasharray="{dash}"' if dash else ""
            out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="{width}"{style}/>')
            if marks:
                out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{colour}"/>' for x, y in places]
        out.append("</g>")
        return out + self.legend(x0, y0, colours)

    def legend(self, x0, y0, colours):
        named = {name: (colour or colours[name], dash) for _, name, _, colour, dash, *_ in self.series if name}
        if len(named) < 2:
            return []
        out, left, y = [], x0 + LEFT + (8 if len(named) > 4 else 0), y0 + 37
        if len(named) > 4:  # beside the lines, one below the other
            y = y0 + TOP + 16
        for name, (colour, dash) in named.items():
            style = f' stroke-dasharray="{dash}"' if dash else ""
            out.append(f'<path d="M{left} {y - 4}h18" stroke="{colour}" stroke-width="2"{style}/>'
                       f'<text x="{left + 23}" y="{y}">{html.escape(name)}</text>')
            if len(named) > 4:
                y += 16
                continue
            left += 38 + 6.6 * len(name)
        return out


def write(path, panels, columns=2):
    """Draws the panels row by row."""
    rows = math.ceil(len(panels) / columns)
    width, height = columns * WIDTH, rows * HEIGHT
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
           'font-family="Helvetica, Arial, sans-serif" font-size="11.5" fill="#222">',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    for i, panel in enumerate(panels):
        out += panel.draw(i % columns * WIDTH, i // columns * HEIGHT)
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n</svg>\n")
    print(path)
