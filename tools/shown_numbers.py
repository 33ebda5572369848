"""Numbers that a page shows, and the results they are of. check_commands.py holds pages to them.

A comment that no reader sees stands behind the paragraph that shows a number:

    <!-- shown: 970 = rows("results/frame/low.steps.csv", reason="accepted") -->
    <!-- shown:
    0.8 = largest("results/x/motion.csv", "1.y.position [m]") * 1000
    5,779 +- 2 % = rows("results/frame/middle.steps.csv", reason="accepted")
    -->
    <!-- said: 400 steps -->

The number stands there as it stands in the text before; the results must give it to its last digit, or to the share that
is said. Folders are those of the commands of the page. `said` is for a number that is chosen, or that no command gives.
"""
import csv
import decimal
import math
import re

COMMENT = re.compile(r"<!-- (shown|said):(.*?)-->", re.S)
LINE = re.compile(r"^\s*(\S+?)(?: \+- ([\d.]+) %)? = (.+?)\s*$")
EVENT = re.compile(r'("[^"`]+" (?:locks|lets go|sticks|slips)) at t = [\d.]+ s(?:, taking [\d.e-]+ J)?')
STEPS = re.compile(r"(?<![\w.,])(\d[\d,]*) steps\b")


class Results:
    """What expressions may ask of the results in a folder."""

    def __init__(self, scratch, run_edited):
        self.scratch = scratch
        self.run_edited = run_edited
        self.tables = {}

    def names(self):
        own = ("rows", "column", "first", "last", "largest", "highest", "lowest", "mean", "quantile", "edited")
        return {"math": math, "abs": abs, "max": max, "min": min, "zip": zip, **{name: getattr(self, name) for name in own}}

    def table(self, path):
        if path not in self.tables:
            with open(self.scratch / path, newline="") as file:
                self.tables[path] = list(csv.DictReader(file))
        return self.tables[path]

    def rows(self, path, **where):
        """How many rows have these words in these columns."""
        return sum(all(row[name] == word for name, word in where.items()) for row in self.table(path))

    def column(self, path, name, begin=-math.inf, end=math.inf, **where):
        """Its numbers where the first column lies between two values, and other columns have these words."""
        rows = [row for row in self.table(path) if all(row[other] == word for other, word in where.items())]
        if begin > -math.inf or end < math.inf:
            place = next(iter(rows[0]))
            rows = [row for row in rows if begin <= float(row[place]) <= end]
        return [float(row[name]) for row in rows if row[name]]

    def first(self, path, name):
        return self.column(path, name)[0]

    def last(self, path, name):
        return self.column(path, name)[-1]

    def largest(self, path, name, *span, **where):
        return max(abs(value) for value in self.column(path, name, *span, **where))

    def highest(self, path, name, *span, **where):
        return max(self.column(path, name, *span, **where))

    def lowest(self, path, name, *span, **where):
        return min(self.column(path, name, *span, **where))

    def mean(self, path, name, *span, **where):
        values = self.column(path, name, *span, **where)
        return sum(values) / len(values)

    def quantile(self, path, name, share, *span, **where):
        """What this share of its numbers does not exceed."""
        values = sorted(self.column(path, name, *span, **where))
        return values[int(share * len(values))]

    def edited(self, study, *pieces):
        """The folder of the results of a study in which pieces of text are replaced: old, new, old, new, ..."""
        return self.run_edited(study, pieces)


def as_number(text):
    return decimal.Decimal(text.replace(",", ""))


def like(value, text):
    """A value in the form of another number: as many digits behind the point, the exponent, commas."""
    mantissa, _, exponent = text.partition("e")
    scale = decimal.Decimal(1).scaleb(int(exponent)) if exponent else decimal.Decimal(1)
    digits = len(mantissa.partition(".")[2])
    comma = "," if "," in mantissa or len(mantissa) > 4 and digits == 0 else ""
    return f"{decimal.Decimal(repr(value)) / scale:{comma}.{digits}f}" + ("e" + exponent if exponent else "")


def is_shown(value, text, share):
    number = as_number(text)
    unit = decimal.Decimal(1).scaleb(number.as_tuple().exponent)
    slack = max(decimal.Decimal("0.500001") * unit, abs(number) * decimal.Decimal(share or 0) / 100)
    return math.isfinite(value) and abs(decimal.Decimal(repr(value)) - number) <= slack


def last_place(text, token):
    """Where a number stands last in a text, or -1."""
    found = [match.start() for match in re.finditer(r"(?<![\w.,])" + re.escape(token) + r"(?![\d]|[.,]\d|e[-\d])", text)]
    return found[-1] if found else -1


def check_events(text, printed, fail):
    """What a page quotes of events, `"B" locks at t = 1.3715 s`, must be in what its commands print."""
    for event in EVENT.finditer(text):
        if any(event[0] in line for line in printed):
            continue
        alike = [line for line in printed if event[1] in line]
        fail(text[: event.start()].count("\n") + 1,
             f"`{event[0]}` is not what the commands print" + (f", but: {'; '.join(alike[:6])}" if alike else ""))


def check(text, results, fail, update=False):
    """Compares what a page shows with its results; calls fail(line, complaint). Returns the page, updated if asked for."""
    edits = []
    known = set()
    for comment in COMMENT.finditer(text):
        begin, line_number = comment.start(), text[: comment.start()].count("\n") + 1
        if comment[1] == "said":
            known.update(STEPS.findall(comment[2]))
            continue
        for line in filter(str.strip, comment[2].splitlines()):
            parts = LINE.match(line)
            if not parts:
                fail(line_number, f"`{line.strip()}` is not of the form NUMBER = EXPRESSION")
                continue
            token, share, expression = parts.groups()
            known.add(token)
            place = last_place(COMMENT.sub(lambda c: " " * len(c[0]), text[:begin]), token)
            if place < 0:
                fail(line_number, f"{token} is compared, and does not stand in the text before")
                continue
            try:
                value = float(eval(expression, {"__builtins__": {}, **results.names()}))
            except Exception as fault:  # whatever the expression of a page does
                fail(line_number, f"`{expression}`: {type(fault).__name__}: {fault}")
                continue
            if is_shown(value, token, share):
                continue
            if update:
                inside = begin + comment[0].index(line) + line.index(token)
                edits += [(place, token, like(value, token)), (inside, token, like(value, token))]
            else:
                fail(text[:place].count("\n") + 1, f"the page shows {token}, the results give {value:.6g}: `{expression}`")
    prose = re.sub(r"^```.*?^```$|<!--.*?-->|`[^`]*`", lambda part: re.sub(r"\S", " ", part[0]), text, flags=re.S | re.M)
    for match in STEPS.finditer(prose):
        if match[1] not in known:
            fail(text[: match.start()].count("\n") + 1,
                 f'"{match[0]}" is compared with no results: say <!-- shown: {match[1]} = rows(...) --> behind it, or said')
    for place, old, new in sorted(edits, reverse=True):
        text = text[:place] + new + text[place + len(old):]
    return text
