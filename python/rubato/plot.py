"""Figures of results, with matplotlib: each function draws into axes, its own unless given, and returns them."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator, List, Optional, Sequence, Tuple, Union

from .errors import StudyError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["damper_curve", "frequency_response", "plot", "time_history"]

_most_in_legend = 12


def _axes_of(axes: Optional["Axes"]) -> "Axes":
    if axes is not None:
        return axes
    from matplotlib import pyplot
    return pyplot.subplots(layout="constrained")[1]


def _label(values: "xarray.DataArray", name: Optional[str] = None) -> str:
    unit = values.attrs.get("units", "1")
    return (name or str(values.name)).replace("_", " ") + ("" if unit == "1" else f" [{unit}]")


def _variable(data: "xarray.Dataset", name: str) -> "xarray.DataArray":
    if name not in data:
        raise StudyError(f"no variable \"{name}\" to draw (there are: {', '.join(map(str, data.data_vars))})")
    return data[name]


def _chosen(values: "xarray.DataArray", labels: Union[str, Sequence[str], None]) -> List[Tuple[str, "xarray.DataArray"]]:
    """One array a label of the dimension that is no axis of rows: coordinates, sliders."""
    dimension = next((d for d in values.dims if values[d].dtype.kind == "U" and d not in ("limit", "direction")), None)
    if dimension is None:
        return [("", values)]
    known = [str(label) for label in values[dimension].values]
    wanted = known if labels is None else [labels] if isinstance(labels, str) else list(labels)
    for label in wanted:
        if label not in known:
            raise StudyError(f"no {dimension} \"{label}\" to draw (there are: {', '.join(known)})")
    return [(label, values.sel({dimension: label})) for label in wanted]


def _lines(values: "xarray.DataArray", along: str) -> Iterator[Tuple[str, "xarray.DataArray"]]:
    """The curves over one dimension, with what tells them apart."""
    others = [dimension for dimension in values.dims if dimension != along]
    if not others:
        yield "", values
        return
    stacked = values.stack(curve=others)
    for place in range(stacked.sizes["curve"]):
        curve = stacked.isel(curve=place)
        told = []
        for name in [str(c) for c in curve.coords if c not in ("curve", along) and "curve" in stacked[c].dims]:
            at = curve[name].item()
            told.append(f"{name} = {at:g}" if isinstance(at, (int, float)) else str(at))
        yield ", ".join(told), curve


def _draw(axes: "Axes", values: "xarray.DataArray", along: str, labels: Union[str, Sequence[str], None],
          options: dict) -> None:
    from matplotlib import colormaps

    if along not in values.dims:
        raise StudyError(f"the rows are not over \"{along}\" alone; select some, or draw with xarray")
    chosen = _chosen(values, labels)
    curves = [(", ".join(filter(None, (label if len(chosen) > 1 else "", told))), curve)
              for label, of_label in chosen for told, curve in _lines(of_label, along)]
    for place, (told, curve) in enumerate(curves):
        colour = {} if len(curves) <= 10 or "color" in options else {
            "color": colormaps["viridis"](place / (len(curves) - 1))}
        axes.plot(curve[along].values, curve.values, label=told, **{**colour, **options})
    if any(told for told, _ in curves):
        step = -(-len(curves) // _most_in_legend)
        handles, names = axes.get_legend_handles_labels()
        axes.legend(handles[::step], names[::step], fontsize="small")
    if len(chosen) == 1:
        axes.set_title(chosen[0][0])
    axes.set_xlabel(_label(values[along]))
    axes.grid(True, alpha=0.3)


def frequency_response(data: "xarray.Dataset", labels: Union[str, Sequence[str], None] = None,
                       variable: str = "amplitude", ax: Optional["Axes"] = None, **options: Any) -> "Axes":
    """A variable over the angular frequency, a line for each of `labels` (coordinates; all unless given) and each
    combination of swept parameters. Crosses mark points that are not ``converged``."""
    axes = _axes_of(ax)
    values = _variable(data, variable)
    _draw(axes, values, "angular_frequency", labels, options)
    if "status" in data and bool((data.status != "converged").any()):
        for _, at in _chosen(values.where(data.status != "converged"), labels):
            for _, curve in _lines(at, "angular_frequency"):
                axes.plot(curve.angular_frequency.values, curve.values, "x", color="crimson")
    axes.set_ylabel(_label(values))
    return axes


def damper_curve(data: "xarray.Dataset", labels: Union[str, Sequence[str], None] = None, variable: str = "objective",
                 optimum: Optional["xarray.Dataset"] = None, ax: Optional["Axes"] = None, **options: Any) -> "Axes":
    """The largest response over the parameter of the damper; a ring marks the optimum, where its table is given."""
    axes = _axes_of(ax)
    parameter = data.attrs["parameter"]
    values = _variable(data, variable)
    _draw(axes, values, parameter, labels, options)
    if optimum is not None and parameter in optimum and "objective" in optimum and variable == "objective":
        axes.plot(optimum[parameter].values.ravel(), optimum.objective.values.ravel(), "o", fillstyle="none",
                  color="black", label="optimum")
        axes.legend(fontsize="small")
    spread = data[parameter].values
    if len(spread) > 2 and spread.min() > 0 and spread.max() > 30 * spread.min():
        axes.set_xscale("log")
    axes.set_ylabel(_label(values, data.attrs.get("objective") if variable == "objective" else None))
    return axes


def time_history(data: "xarray.Dataset", labels: Union[str, Sequence[str], None] = None, variable: str = "position",
                 ax: Optional["Axes"] = None, **options: Any) -> "Axes":
    """A variable over time, a line for each of `labels` (coordinates, sliders; all unless given)."""
    axes = _axes_of(ax)
    values = _variable(data, variable)
    _draw(axes, values, "time", labels, options)
    axes.set_ylabel(_label(values))
    return axes


def plot(data: "xarray.Dataset", *arguments: Any, **options: Any) -> "Axes":
    """Draws a dataset as what it is: a frequency response, a damper curve or a time history."""
    if data.attrs.get("type") == "damper_curve" and data.attrs.get("parameter") in data.dims:
        return damper_curve(data, *arguments, **options)
    if "angular_frequency" in data.dims and "amplitude" in data:
        return frequency_response(data, *arguments, **options)
    if "time" in data.dims:
        return time_history(data, *arguments, **options)
    raise StudyError(f"there is no figure for \"{data.attrs.get('type', 'this')}\"; draw its variables with xarray, such "
                     "as data.frequency.plot()")
