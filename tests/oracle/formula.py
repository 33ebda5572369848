"""Formulas of study files: a parser of its own, written from the page of the study language.

`Formula(text, names)` parses once; `formula(t=1.0, k=2.0)` evaluates. Values are floats, or `Jet`s, which carry two
derivatives along. `decisions` tells which side of each comparison, `abs`, `min`, ... was taken, so that the times at
which a formula switches can be bracketed; `along` takes them as they are told.

Operators, from the loosest to the tightest: `? :` (right), `||`, `&&`, the six comparisons, `+ -`, `* /`, unary
`- +`, `^` (right; `-2^2` is -4, `2^-1` is 0.5). Truth is any number but 0; comparisons give 0 or 1.
"""

import math
import re

CONSTANTS = {"pi": math.pi}


class FormulaError(Exception):
    pass


class Jet:
    """A value with its first and second derivative."""

    __slots__ = ("v", "d", "dd")

    def __init__(self, v, d=0.0, dd=0.0):
        self.v, self.d, self.dd = v, d, dd


def _value(x):
    return x.v if isinstance(x, Jet) else x


def _lift(x):
    return x if isinstance(x, Jet) else Jet(x)


def _add(a, b):
    if isinstance(a, Jet) or isinstance(b, Jet):
        a, b = _lift(a), _lift(b)
        return Jet(a.v + b.v, a.d + b.d, a.dd + b.dd)
    return a + b


def _neg(a):
    return Jet(-a.v, -a.d, -a.dd) if isinstance(a, Jet) else -a


def _mul(a, b):
    if isinstance(a, Jet) or isinstance(b, Jet):
        a, b = _lift(a), _lift(b)
        return Jet(a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + 2 * a.d * b.d + a.v * b.dd)
    return a * b


def _chain(a, f, df, ddf):
    return Jet(f, df * a.d, ddf * a.d * a.d + df * a.dd)


def _divide(a, b):
    if isinstance(b, Jet):
        return _mul(a, _chain(b, 1 / b.v, -1 / b.v**2, 2 / b.v**3))
    if b == 0:
        return math.nan if _value(a) == 0 else math.copysign(math.inf, _value(a)) * math.copysign(1.0, b)
    return _mul(a, 1 / b) if isinstance(a, Jet) else a / b


def _power(a, b):
    if not isinstance(a, Jet) and not isinstance(b, Jet):
        try:
            result = a**b
        except ZeroDivisionError:
            return math.inf
        except OverflowError:
            return math.inf
        return math.nan if isinstance(result, complex) else result
    if not isinstance(b, Jet):
        if b == 0:
            return 1.0
        slope = b * _power(a.v, b - 1)
        bend = b * (b - 1) * _power(a.v, b - 2) if b != 1 else 0.0
        return _chain(a, _power(a.v, b), slope, bend)
    return _call("exp", [_mul(b, _call("ln", [a]))])


# name: (f, f', f'')
_SMOOTH = {
    "sin": (math.sin, math.cos, lambda x: -math.sin(x)),
    "cos": (math.cos, lambda x: -math.sin(x), lambda x: -math.cos(x)),
    "tan": (math.tan, lambda x: 1 + math.tan(x)**2, lambda x: 2 * math.tan(x) * (1 + math.tan(x)**2)),
    "asin": (math.asin, lambda x: (1 - x * x)**-0.5, lambda x: x * (1 - x * x)**-1.5),
    "acos": (math.acos, lambda x: -(1 - x * x)**-0.5, lambda x: -x * (1 - x * x)**-1.5),
    "atan": (math.atan, lambda x: 1 / (1 + x * x), lambda x: -2 * x / (1 + x * x)**2),
    "sinh": (math.sinh, math.cosh, math.sinh),
    "cosh": (math.cosh, math.sinh, math.cosh),
    "tanh": (math.tanh, lambda x: 1 - math.tanh(x)**2, lambda x: -2 * math.tanh(x) * (1 - math.tanh(x)**2)),
    "asinh": (math.asinh, lambda x: (1 + x * x)**-0.5, lambda x: -x * (1 + x * x)**-1.5),
    "acosh": (math.acosh, lambda x: (x * x - 1)**-0.5, lambda x: -x * (x * x - 1)**-1.5),
    "atanh": (math.atanh, lambda x: 1 / (1 - x * x), lambda x: 2 * x / (1 - x * x)**2),
    "exp": (math.exp, math.exp, math.exp),
    "ln": (math.log, lambda x: 1 / x, lambda x: -1 / x**2),
    "log": (math.log, lambda x: 1 / x, lambda x: -1 / x**2),
    "log2": (math.log2, lambda x: 1 / (x * math.log(2)), lambda x: -1 / (x * x * math.log(2))),
    "log10": (math.log10, lambda x: 1 / (x * math.log(10)), lambda x: -1 / (x * x * math.log(10))),
    "sqrt": (math.sqrt, lambda x: 0.5 * x**-0.5, lambda x: -0.25 * x**-1.5),
}
_CHOOSING = {"abs": 1, "sign": 1, "rint": 1, "min": None, "max": None, "sum": None, "avg": None, "atan2": 2}

_decisions = None
_chosen = None


def _decide(what):
    if _chosen is not None:
        return next(_chosen)
    if _decisions is not None:
        _decisions.append(what)
    return what


def _call(name, arguments):
    if name in _SMOOTH:
        f, df, ddf = _SMOOTH[name]
        a = arguments[0]
        try:
            if isinstance(a, Jet):
                return _chain(a, f(a.v), df(a.v) if a.d or a.dd else 0.0, ddf(a.v) if a.d else 0.0)
            return f(a)
        except (ValueError, ZeroDivisionError):
            if name in ("ln", "log", "log2", "log10") and _value(a) == 0:
                return -math.inf
            return math.nan
        except OverflowError:
            return math.inf
    values = [_value(a) for a in arguments]
    if name == "abs":
        return arguments[0] if _decide(values[0] >= 0) else _neg(arguments[0])
    if name == "sign":
        return float(_decide((values[0] > 0) - (values[0] < 0)))
    if name == "rint":
        return float(_decide(math.floor(values[0] + 0.5)))
    if name == "min":
        return arguments[_decide(values.index(min(values)))]
    if name == "max":
        return arguments[_decide(values.index(max(values)))]
    if name == "atan2":
        if any(isinstance(a, Jet) for a in arguments):
            y, x = (_lift(a) for a in arguments)
            slope = _divide(_add(_mul(x, Jet(y.d, y.dd)), _neg(_mul(y, Jet(x.d, x.dd)))), _add(_mul(x, x), _mul(y, y)))
            return Jet(math.atan2(y.v, x.v), slope.v, slope.d)
        return math.atan2(*values)
    if name in ("sum", "avg"):
        total = 0.0
        for a in arguments:
            total = _add(total, a)
        return total if name == "sum" else _mul(total, 1 / len(arguments))
    raise FormulaError(f"unknown function {name}")


_COMPARE = {"<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
            "==": lambda a, b: a == b, "!=": lambda a, b: a != b}
_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_][A-Za-z0-9_]*)"
                    r"|(&&|\|\||<=|>=|==|!=|[-+*/^<>?:(),]))")


class Formula:
    """`Formula("t < 1 ? a : 0", {"t", "a"})(t=0.5, a=2.0)`"""

    def __init__(self, text, names):
        self.text = str(text)
        self._tokens = self._split(self.text)
        self._at = 0
        self.used = set()
        self._names = set(names)
        self._tree = self._ternary()
        if self._at != len(self._tokens):
            raise FormulaError(f"cannot read {self.text!r} from {self._tokens[self._at:]}")

    def __call__(self, **values):
        return self._tree({**CONSTANTS, **values})

    def decisions(self, **values):
        """The choices made at these values, as a tuple to be compared."""
        global _decisions
        _decisions = []
        try:
            self._tree({**CONSTANTS, **values})
            return tuple(_decisions)
        finally:
            _decisions = None

    def along(self, chosen, **values):
        """The value with the choices of `decisions`, whatever they would be here: one smooth branch, continued."""
        global _chosen
        _chosen = iter(chosen)
        try:
            return self._tree({**CONSTANTS, **values})
        finally:
            _chosen = None

    @staticmethod
    def _split(text):
        tokens, at, text = [], 0, text.rstrip()
        while at < len(text):
            match = _TOKEN.match(text, at)
            if not match:
                raise FormulaError(f"cannot read {text!r} at {at}")
            tokens.append(match.group(match.lastindex))
            at = match.end()
        return tokens

    def _peek(self):
        return self._tokens[self._at] if self._at < len(self._tokens) else None

    def _take(self, expected=None):
        token = self._peek()
        if token is None or (expected is not None and token != expected):
            raise FormulaError(f"{self.text!r}: expected {expected}, found {token}")
        self._at += 1
        return token

    def _ternary(self):
        condition = self._or()
        if self._peek() != "?":
            return condition
        self._take("?")
        yes = self._ternary()
        self._take(":")
        no = self._ternary()
        return lambda env: yes(env) if _value(condition(env)) != 0 else no(env)

    def _left(self, operators, below):
        left = below()
        while self._peek() in operators:
            operator, a, b = self._take(), left, below()
            left = operators[operator](a, b)
        return left

    def _or(self):
        return self._left({"||": lambda a, b: lambda e: float((_value(a(e)) != 0) | (_value(b(e)) != 0))}, self._and)

    def _and(self):
        return self._left({"&&": lambda a, b: lambda e: float((_value(a(e)) != 0) & (_value(b(e)) != 0))},
                          self._comparison)

    def _comparison(self):
        def operator(compare):
            return lambda a, b: lambda e: float(_decide(compare(_value(a(e)), _value(b(e)))))
        return self._left({sign: operator(compare) for sign, compare in _COMPARE.items()}, self._sum)

    def _sum(self):
        return self._left({"+": lambda a, b: lambda e: _add(a(e), b(e)),
                           "-": lambda a, b: lambda e: _add(a(e), _neg(b(e)))}, self._product)

    def _product(self):
        return self._left({"*": lambda a, b: lambda e: _mul(a(e), b(e)),
                           "/": lambda a, b: lambda e: _divide(a(e), b(e))}, self._unary)

    def _unary(self):
        if self._peek() in ("-", "+"):
            sign, operand = self._take(), self._unary()
            return (lambda e: _neg(operand(e))) if sign == "-" else operand
        return self._powers()

    def _powers(self):
        base = self._atom()
        if self._peek() != "^":
            return base
        self._take("^")
        exponent = self._unary()
        return lambda e: _power(base(e), exponent(e))

    def _atom(self):
        token = self._take()
        if token == "(":
            inside = self._ternary()
            self._take(")")
            return inside
        if token[0].isdigit() or token[0] == ".":
            number = float(token)
            return lambda e: number
        if self._peek() == "(":
            if token not in _SMOOTH and token not in _CHOOSING:
                raise FormulaError(f"{self.text!r}: unknown function {token}")
            self._take("(")
            arguments = [self._ternary()]
            while self._peek() == ",":
                self._take(",")
                arguments.append(self._ternary())
            self._take(")")
            takes = 1 if token in _SMOOTH else _CHOOSING[token]
            if takes not in (None, len(arguments)):
                raise FormulaError(f"{self.text!r}: {token} takes {takes} arguments")
            return lambda e: _call(token, [a(e) for a in arguments])
        if token not in self._names and token not in CONSTANTS:
            raise FormulaError(f"{self.text!r}: unknown name {token}")
        self.used.add(token)
        return lambda e: e[token]
