// Amplitude over frequency and a parameter, as a map.

/** y over x at other abscissae, linear between, null outside. */
function resampled(x, y, at) {
  let right = 1;
  const turned = x.length > 1 && x[0] > x.at(-1);
  const xs = turned ? [...x].reverse() : x, ys = turned ? [...y].reverse() : y;
  return at.map((value) => {
    while (right < xs.length - 1 && xs[right] < value) ++right;
    const [x0, x1, y0, y1] = [xs[right - 1], xs[right], ys[right - 1], ys[right]];
    if (y0 === null || y1 === null || value < x0 - 1e-12 * Math.abs(x0) || value > x1 + 1e-12 * Math.abs(x1)) return null;
    return x1 === x0 ? y0 : y0 + (y1 - y0) * (value - x0) / (x1 - x0);
  });
}

/** Whether rising values have equal differences or ratios to within a factor of four: then cells may be drawn to scale. */
function is_evenly_spaced(values) {
  const by_ratio = is_spread_by_ratio(values);
  const steps = values.slice(1).map((value, i) => (by_ratio ? Math.log(value / values[i]) : value - values[i]));
  return Math.max(...steps) <= 4 * Math.min(...steps);
}

/** Amplitude over abscissa and parameter: where curves are few, nothing. */
function map_figure(table, variable) {
  const places = color_places(table).filter((place) => slices_of(table, place).some((slice) => slice.curves.length >= 5));
  if (!places.length || table.overview[table.curves.abscissa][0].length < 25) return null;
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const label_at = add(label_chooser(variable));
  const place_at = add(places.length > 1
    ? {label: "Parameter", options: places.map((place) => table.variables[table.curves.keys[place]].name)} : null);
  const [place] = places;
  const slices = slices_of(table, place);
  const slice_at = add(places.length === 1 && slices.length > 1 ? {label: "Slice", options: slices.map((slice) => slice.name)} : null);
  const scale_at = add({label: "Colours", options: ["Linear", "Logarithmic"]});
  return make_figure({
    caption: `Amplitude over frequency and parameter; the black line follows the largest one.${curves_text(table)}` +
      (places.length > 1 ? " The other parameters have their first values." : ""),
    choosers, height: 460,
    draw: (chosen) => {
      const along = places[place_at < 0 ? 0 : chosen[place_at]];
      const {curves} = slices_of(table, along)[slice_at < 0 ? 0 : chosen[slice_at]];
      const label = label_at < 0 ? 0 : chosen[label_at];
      const by_ratio = chosen[scale_at] === 1;
      const column = (index, which, curve) => table.overview[index][which].slice(curve.from, curve.to);
      const [low, high] = bounds(curves.flatMap((curve) => column(table.curves.abscissa, 0, curve)));
      const own = column(table.curves.abscissa, 0, curves[0]);
      const is_common = curves.every((curve) => curve.to - curve.from === own.length &&
        own.every((value, i) => value === table.overview[table.curves.abscissa][0][curve.from + i]) && own.every((value, i) => i === 0 || value > own[i - 1]));
      const x = is_common ? own : Array.from({length: 301}, (_, i) => low + (high - low) * i / 300);
      const values_of_parameter = curves.map((curve) => curve.keys[along]);
      const is_even = is_evenly_spaced(values_of_parameter);
      const y = is_even ? values_of_parameter : values_of_parameter.map((value) => value_text(table.variables[table.curves.keys[along]], value));
      const rows = curves.map((curve) => {
        const values = column(variable.index, label, curve);
        return is_common ? values : resampled(column(table.curves.abscissa, 0, curve), values, x);
      });
      const z = by_ratio ? rows.map((row) => row.map((value) => (value > 0 ? Math.log10(value) : null))) : rows;
      const ridge = rows.map((row) => row.reduce((best, value, i) => (value !== null && (best < 0 || value > row[best]) ? i : best), -1));
      const title = `${variable.labels[label] ?? ""} amplitude [${pretty_unit(variable.unit)}]`.trim();
      const [z_low, z_high] = bounds(z.flat());
      const decades = [];
      for (let decade = Math.floor(z_low); by_ratio && decade <= z_high; ++decade) {
        for (const digit of z_high - z_low < 2 ? [1, 2, 5] : [1]) decades.push(Math.log10(digit) + decade);
      }
      const ticks = decades.filter((tick) => tick >= z_low && tick <= z_high);
      return {
        traces: [{
          type: "heatmap", x, y, z, colorscale: map_colors, hoverongaps: false, customdata: rows,
          colorbar: {title: {text: plot_text(title), side: "right"}, thickness: 14, outlinewidth: 0,
                     ...(by_ratio ? {tickvals: ticks, ticktext: ticks.map((tick) => String(Number((10 ** tick).toPrecision(2))))} : {})},
          hovertemplate: `${variable_phrase(table.variables[table.curves.abscissa])} %{x:.6~g}<br>` +
            `${plot_text(table.variables[table.curves.keys[along]].name)} ${is_even ? "%{y:.5~g}" : "%{y}"}<br>Amplitude %{customdata:.5~g}<extra></extra>`,
        }, {
          type: "scatter", mode: "lines+markers", x: ridge.map((i) => (i < 0 ? null : x[i])), y, name: "Largest", hoverinfo: "skip", showlegend: false,
          line: {color: "#000000", width: 1.2, dash: "dot"}, marker: {color: "#000000", size: 3},
        }],
        layout: {
          xaxis: axis(quantity_label(table, table.curves.abscissa), {range: [x[0], x.at(-1)], showgrid: false}),
          yaxis: axis(quantity_label(table, table.curves.keys[along]), {
            ...(!is_even ? {type: "category"} : is_spread_by_ratio(y) ? log_axis(y) : {}), showgrid: false, zeroline: false}),
        },
      };
    },
  });
}

// Light to dark, so that the largest amplitude stands out on paper as well.
const map_colors = [[0, "#fbfaf2"], [0.2, "#fbdc8b"], [0.4, "#f2a65a"], [0.6, "#d9604f"], [0.8, "#9c2f6b"], [1, "#3b1a5a"]];
