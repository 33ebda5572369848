// The largest amplitude of each curve: over parameters, or its distribution over samples.

/** The largest amplitude of each curve over one parameter (with its frequency), over two (a map), or its distribution. */
function peaks_figures(table, is_random) {
  const {peaks} = table;
  if (!peaks || table.curves.count < 3) return [];
  const variable = {index: peaks.variable, ...table.variables[peaks.variable]};
  const count = peaks.keys[0]?.length ?? 0;
  const places = table.curves.keys.map((_, place) => place).filter((place) => new Set(peaks.keys[place]).size > 1);
  const numeric = places.filter((place) => table.variables[table.curves.keys[place]].categories.length === 0);
  if (!numeric.length || table.variables[table.curves.abscissa].name !== "angular_frequency") return [];
  const some = count < table.curves.count ? ` ${count_text(count)} of ${count_text(table.curves.count)} curves.` : "";
  if (is_random) return [distribution_figure(table, variable, some), sensitivity_figure(table, variable, numeric, some)];
  const values = (place) => new Set(peaks.keys[place]).size;
  const [place] = numeric.sort((a, b) => values(b) - values(a));
  const others = places.filter((other) => other !== place);
  const series = new Map();
  for (let curve = 0; curve < count; ++curve) {
    const name = curve_name(table, {keys: peaks.keys.map((column) => column[curve])}, others);
    if (!series.has(name)) series.set(name, []);
    series.get(name).push(curve);
  }
  const parameter = peaks.keys[place];
  if (series.size > 2 * most_in_legend) return [];
  return [make_figure({
    caption: `Largest amplitude of each curve (top) and the frequency where it stands (bottom), of the points that were computed.${some}${shortened(variable)}`,
    height: 520,
    draw: () => {
      const traces = [];
      variable.labels.forEach((label, which) => {
        for (const [name, members] of series) {
          const rows = [...members].sort((a, b) => parameter[a] - parameter[b]);
          const text = plot_text(name ? `${label}, ${name}` : label);
          const style = {x: rows.map((row) => parameter[row]), type: "scatter", mode: "lines+markers", name: text, legendgroup: text,
                         line: line_style(traces.length / 2), marker: {size: 4}};
          traces.push({...style, y: rows.map((row) => peaks.value[which][row])},
                      {...style, y: rows.map((row) => peaks.abscissa[which][row]), yaxis: "y2", showlegend: false});
        }
      });
      return {traces, layout: {
        xaxis: axis(quantity_label(table, table.curves.keys[place]), {anchor: "y2", mirror: "all", ...(is_spread_by_ratio(parameter) ? log_axis(parameter) : {})}),
        yaxis: axis(`Largest amplitude [${pretty_unit(variable.unit)}]`, {domain: [0.42, 1], rangemode: "tozero"}),
        yaxis2: axis(quantity_label(table, table.curves.abscissa), {domain: [0, 0.34]}),
      }};
    },
  })];
}

/** A sorted copy of what is a number. */
function sorted(values) {
  return values.filter((value) => value !== null).sort((a, b) => a - b);
}

function quantile(ordered, share) {
  const place = share * (ordered.length - 1), low = Math.floor(place);
  return ordered[low] + (place - low) * ((ordered[low + 1] ?? ordered[low]) - ordered[low]);
}

function distribution_figure(table, variable, some) {
  const labels = label_chooser(variable);
  return make_figure({
    caption: `Distribution of the largest amplitude over the samples; lines: 5th, 50th and 95th percentile.${some}`,
    choosers: labels ? [labels] : [], height: 360,
    draw: ([label = 0]) => {
      const values = table.peaks.value[label];
      const ordered = sorted(values);
      return {
        traces: [{type: "histogram", x: values, nbinsx: 60, histnorm: "percent", name: plot_text(variable.labels[label]), marker: {color: "#56a0d3", line: {color: "#ffffff", width: 0.5}},
                  hovertemplate: "%{x} m: %{y:.3~g} %<extra></extra>".replace(" m", ` ${pretty_unit(variable.unit)}`)}],
        layout: {
          xaxis: axis(`${variable.labels[label]}: Largest amplitude [${pretty_unit(variable.unit)}]`), yaxis: axis("Share of the samples [%]"), bargap: 0,
          shapes: [0.05, 0.5, 0.95].map((share) => ({type: "line", x0: quantile(ordered, share), x1: quantile(ordered, share), yref: "paper", y0: 0, y1: 1,
                                                     line: {color: "#1c242c", width: 1.4, dash: share === 0.5 ? "solid" : "dash"}})),
          annotations: [0.05, 0.5, 0.95].map((share) => ({x: quantile(ordered, share), yref: "paper", y: 1, yanchor: "bottom", showarrow: false, font: {size: 12},
                                                          text: `${100 * share} %: ${Number(quantile(ordered, share).toPrecision(4))}`})),
        },
      };
    },
  });
}

function sensitivity_figure(table, variable, numeric, some) {
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const parameter_at = add(numeric.length > 1
    ? {label: "Parameter", options: numeric.map((place) => table.variables[table.curves.keys[place]].name)} : null);
  const label_at = add(label_chooser(variable));
  return make_figure({
    caption: `Largest amplitude of each sample against one of its parameters; the colour is the frequency of the peak.${some}`, choosers, height: 400,
    draw: (chosen) => {
      const place = numeric[parameter_at < 0 ? 0 : chosen[parameter_at]], label = label_at < 0 ? 0 : chosen[label_at];
      return {
        traces: [{type: "scatter", mode: "markers", x: table.peaks.keys[place], y: table.peaks.value[label], showlegend: false,
                  marker: {size: 5, opacity: 0.75, color: table.peaks.abscissa[label], colorscale: color_scale, showscale: true,
                           colorbar: {title: {text: quantity_label(table, table.curves.abscissa), side: "right"}, thickness: 12, outlinewidth: 0}},
                  hovertemplate: `%{x:.5~g}<br>%{y:.5~g}<br>at %{marker.color:.5~g} ${pretty_unit(table.variables[table.curves.abscissa].unit)}<extra></extra>`}],
        layout: {xaxis: axis(quantity_label(table, table.curves.keys[place])),
                 yaxis: axis(`${variable.labels[label]}: Largest amplitude [${pretty_unit(variable.unit)}]`)},
      };
    },
  });
}
