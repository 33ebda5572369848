// Tables of curves: the responses of a sweep, told apart by the values of the swept parameters.

/** A parameter of the study or another variable, as the title of an axis. Studies are in SI; parameters tell no unit. */
function quantity_label(table, index) {
  const variable = table.variables[index];
  const {excitation} = table.attributes;
  if (variable.name === "angular_frequency" && table.hertz !== undefined) return `Frequency${table.hertz === "f" ? "" : `, ${table.hertz}`} [Hz]`;
  if (variable.name === "angular_frequency" && excitation) return `Angular frequency, ${excitation} [rad/s]`;
  const tells_curves = table.curves && [table.curves.abscissa, ...table.curves.keys].includes(index);
  return tells_curves && (!variable.unit || variable.unit === "1") ? `${variable.name} [SI]` : axis_label(variable);
}

/** 0.30000000000000004 as "0.3"; a word where the variable has words. */
function value_text(variable, value) {
  if (value === null || value === undefined) return "–";
  if (variable.categories.length) return (variable.categories[value] ?? "–").replaceAll("_", " ");
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

/** The curves of a table: [{keys: [value, ...], from, to}], the points [from, to) of its columns. */
function curves_of(table) {
  const {keys, starts} = table.curves;
  return starts.slice(0, -1).map((from, index) => ({
    from, to: starts[index + 1], keys: keys.map((key) => table.overview[key][0][from]),
  }));
}

/** Places (in `table.curves.keys`) of the keys that take more than one value among the curves. */
function varying_keys(table, curves = curves_of(table)) {
  return table.curves.keys.map((_, place) => place)
    .filter((place) => new Set(curves.map((curve) => curve.keys[place])).size > 1);
}

/** "N0 = 10, direction = up", of the keys that vary. */
function curve_name(table, curve, places) {
  return places.map((place) => {
    const variable = table.variables[table.curves.keys[place]];
    return `${variable.name === "angular_frequency" ? table.hertz ?? "Ω" : variable.name.replaceAll("_", " ")} = ${value_text(variable, curve.keys[place])}` +
      (variable.unit && variable.unit !== "1" ? ` ${pretty_unit(variable.unit)}` : "");
  }).join(", ");
}

/** What the figures of a table of curves leave out, in words. */
function curves_text(table) {
  const shown = table.curves.starts.length - 1;
  const some = shown < table.curves.count ? ` ${count_text(shown)} of ${count_text(table.curves.count)} curves are drawn.` : "";
  return some + (table.is_envelope
    ? " Long curves are drawn by the extremes of buckets of points, so that no peak is lost." : "");
}

// Dark to light, and not so light that it is lost on white.
const scale_stops = [[0, [43, 26, 103]], [0.35, [24, 106, 176]], [0.7, [38, 158, 104]], [1, [235, 163, 0]]];
const color_scale = scale_stops.map(([at, rgb]) => [at, `rgb(${rgb.join(",")})`]);

function scale_color(fraction) {
  const next = Math.max(1, scale_stops.findIndex(([at]) => at >= fraction));
  const [[low, first], [high, second]] = [scale_stops[next - 1], scale_stops[next]];
  const part = (fraction - low) / (high - low);
  return `rgb(${first.map((value, i) => Math.round(value + part * (second[i] - value))).join(",")})`;
}

/** The largest and the least of what is a number. */
function bounds(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (value === null || value === undefined) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return [low, high];
}

/** Whether values are better spread on a logarithmic scale: all positive and over more than a decade and a half. */
function is_spread_by_ratio(values) {
  const [low, high] = bounds(values);
  return low > 0 && high / low > 30;
}

/** Colours of numbers, and the invisible trace that brings their colour bar. */
function color_map(values, title) {
  const by_ratio = is_spread_by_ratio(values);
  const place = (value) => (by_ratio ? Math.log10(value) : value);
  const [low, high] = bounds(values).map(place);
  const colorbar = {title: {text: plot_text(title), side: "right"}, thickness: 12, outlinewidth: 0, len: 1, x: 1.02, xanchor: "left"};
  if (by_ratio) {
    const [first, last] = bounds(values);
    const ticks = [];
    for (let decade = Math.floor(low); decade <= high; ++decade) {
      for (const digit of high - low < 3 ? [1, 2, 5] : [1]) ticks.push(digit * 10 ** decade);
    }
    colorbar.tickvals = ticks.filter((tick) => tick >= 0.999 * first && tick <= 1.001 * last).map(place);
    colorbar.ticktext = colorbar.tickvals.map((tick) => String(Number((10 ** tick).toPrecision(3))));
  }
  return {
    color: (value) => scale_color(high > low ? Math.min(1, Math.max(0, (place(value) - low) / (high - low))) : 0.5),
    bar: {type: "scatter", mode: "markers", x: [null], y: [null], hoverinfo: "skip", showlegend: false,
          marker: {color: [low, high], cmin: low, cmax: high, colorscale: color_scale, showscale: true, colorbar}},
  };
}

/** A logarithmic axis with plain numbers at its ticks where it spans few decades. */
function log_axis(values) {
  const [low, high] = bounds(values.filter((value) => value > 0));
  const decades = Math.log10(high / low);
  if (!(decades <= 3.5)) return logarithmic;
  const digits = decades < 0.8 ? [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9] : decades < 1.6 ? [1, 2, 3, 5, 7] : [1, 2, 5];
  const tickvals = [];
  for (let decade = Math.floor(Math.log10(low)) - 1; decade <= Math.log10(high) + 1; ++decade) {
    for (const digit of digits) tickvals.push(Number((digit * 10 ** decade).toPrecision(2)));
  }
  return {type: "log", zeroline: false, tickvals, ticktext: tickvals.map(String)};
}

// So many curves have a line of the legend each; more are told apart by a scale of colours.
const most_in_legend = 12;
const most_colors = 32;

/** `y` with gaps where it leaps by more than half a turn, so that a phase is not drawn across the figure. */
function broken_at_turns(x, y) {
  const out = {x: [], y: []};
  y.forEach((value, index) => {
    const before = y[index - 1];
    if (index > 0 && value !== null && before !== null && Math.abs(value - before) > Math.PI) {
      out.x.push(null);
      out.y.push(null);
    }
    out.x.push(x[index]);
    out.y.push(value);
  });
  return out;
}

/**
 * Lines of curves. `points(curve)` gives {x, y}. Up to a dozen curves have a line of the legend each; of more the colour
 * tells the value of the key at `color_place`.
 */
function family_traces(table, curves, points, color_place, hover_units) {
  const places = varying_keys(table, curves);
  const hover = (name) => `${plot_text(name)}<br>${hover_units}<extra></extra>`;
  if (curves.length <= most_in_legend || color_place === undefined) {
    return curves.map((curve, index) => {
      const name = curve_name(table, curve, places) || phrase(table.name || "response");
      return {type: "scatter", mode: "lines", ...points(curve), name: plot_text(name), line: line_style(index), showlegend: true,
              hovertemplate: hover(name)};
    });
  }
  const key = table.curves.keys[color_place];
  const colors = color_map(curves.map((curve) => curve.keys[color_place]), quantity_label(table, key));
  // Curves of like colour share a line with gaps: a page of hundreds of lines would be slow.
  const order = [...curves].sort((a, b) => a.keys[color_place] - b.keys[color_place]);
  const count = Math.min(order.length, most_colors);
  const traces = Array.from({length: count}, (_, bucket) => {
    const members = order.slice(Math.floor(bucket * order.length / count), Math.floor((bucket + 1) * order.length / count));
    const line = {x: [], y: [], text: []};
    for (const curve of members) {
      const {x, y} = points(curve);
      const name = plot_text(curve_name(table, curve, places));
      line.x = line.x.concat(x, [null]);
      line.y = line.y.concat(y, [null]);
      line.text = line.text.concat(Array(x.length + 1).fill(name));
    }
    const middle = members[Math.floor(members.length / 2)].keys[color_place];
    return {type: "scatter", mode: "lines", ...line, showlegend: false, line: {color: colors.color(middle), width: count < 20 ? 1.5 : 1},
            opacity: order.length > 60 ? 0.7 : 1, hovertemplate: `%{text}<br>${hover_units}<extra></extra>`};
  });
  return [...traces, colors.bar];
}

/** The keys by which curves can be coloured: those with numbers that vary, the one of most values first. */
function color_places(table) {
  const curves = curves_of(table);
  const count = (place) => new Set(curves.map((curve) => curve.keys[place])).size;
  return varying_keys(table, curves).filter((place) => table.variables[table.curves.keys[place]].categories.length === 0)
    .sort((a, b) => count(b) - count(a));
}

/** Curves that are equal in all varying keys but one, in the order of that one: [{name, curves}]. */
function slices_of(table, place) {
  const others = varying_keys(table).filter((other) => other !== place);
  const slices = new Map();
  for (const curve of curves_of(table)) {
    const name = curve_name(table, curve, others);
    if (!slices.has(name)) slices.set(name, []);
    slices.get(name).push(curve);
  }
  return [...slices].map(([name, curves]) => ({name, curves: curves.sort((a, b) => a.keys[place] - b.keys[place])}));
}

/**
 * The slices of a grid by its parameter of most values, where they are worth a choice of their own: more than one, of
 * more than one curve each, and too many curves for one legend. Null otherwise, as for random samples.
 */
function grid_slices(table) {
  const [place] = color_places(table);
  if (place === undefined || table.curves.starts.length - 1 <= most_in_legend) return null;
  const slices = slices_of(table, place);
  return slices.length > 1 && slices.length <= 200 && slices.every((slice) => slice.curves.length > 1) ? slices : null;
}

/** A chooser of labels of a variable, or nothing where there is only one. */
function label_chooser(variable) {
  return variable && variable.labels.length > 1 ? {label: phrase(variable.dimension), options: variable.labels} : null;
}

/** Layout of a legend or a colour bar beside a figure, both where both are there. */
function beside(traces) {
  const has_bar = traces.some((trace) => trace.marker && trace.marker.showscale);
  // The colour bar stands at the right; lines of the legend go above.
  return has_bar ? {legend: {orientation: "h", x: 0, y: 1.02, yanchor: "bottom"}, margin: {l: 64, r: 90, t: 54, b: 48}} : {};
}
