// A frequency response: families of curves over frequency with the linear limits, maps, peaks, percentile bands.

function is_frequency_response(analysis) {
  const [table] = analysis.tables;
  return analysis.attributes.type === "frequency_response" && table && table.name === "" && Boolean(table.curves);
}

/** Names of statuses other than converged with their counts: "3 not converged, 1 unbounded". */
function unconverged_text(table) {
  if (!table.statuses) return "";
  const words = table.variables[table.statuses.variable].categories;
  return table.statuses.counts.map((count, index) => (index > 0 && count > 0 ? `${count_text(count)} ${words[index].replaceAll("_", " ")}` : null))
    .filter((text) => text).join(", ");
}

/** What became of the points: in words, with an alarm where some did not converge, and a table of statuses. */
function statuses_of(table) {
  if (!table.statuses) return [];
  const {counts, variable} = table.statuses;
  const words = table.variables[variable].categories.map((word) => word.replaceAll("_", " "));
  const body = [];
  const failed = unconverged_text(table);
  const total = counts.reduce((sum, count) => sum + count, 0);
  if (failed) {
    body.push(element("div", {class: "alarm", role: "alert"}, element("b", {}, `Not all of the ${count_text(total)} points converged: `),
                      `${failed}. Where they have numbers these are the best that was found; crosses mark them in the figures.`));
  }
  const worst = (name) => {
    const found = variable_of(table, name);
    return found ? number_node(table.maxima[found.index][0], 3) : "–";
  };
  body.push(make_table({
    caption: "What became of the points. The residual is that of the equations which the solver solves, the error its estimate of the relative " +
      "error of the amplitudes; both are the largest of all points.",
    columns: [{title: "Points", is_text: true}, {title: "Number"}],
    rows: [...words.map((word, index) => [phrase(word), count_text(counts[index])]).filter((_, index) => counts[index] > 0),
           ["Largest residual [–]", worst("residual")], ["Largest error [–]", worst("error")]],
  }));
  return body;
}

/** Crosses where points did not converge, a trace a status. */
function flagged_traces(table, variable, label) {
  if (!table.statuses) return [];
  const {columns, variable: status, counts} = table.statuses;
  const words = table.variables[status].categories;
  const places = varying_keys(table);
  return words.flatMap((word, index) => {
    if (index === 0 || !counts[index]) return [];
    const rows = columns[status][0].flatMap((value, row) => (value === index && columns[variable.index][label][row] !== null ? [row] : []));
    if (!rows.length) return [];
    const name = word.replaceAll("_", " ");
    return [{
      type: "scatter", mode: "markers", x: rows.map((row) => columns[table.curves.abscissa][0][row]),
      y: rows.map((row) => columns[variable.index][label][row]), name: `${phrase(name)} (${count_text(counts[index])})`, showlegend: true,
      marker: {symbol: "x-thin", size: 9, line: {color: "#c8102e", width: 2}},
      text: rows.map((row) => plot_text(curve_name(table, {keys: table.curves.keys.map((key) => columns[key][0][row])}, places))),
      hovertemplate: `${phrase(name)}<br>%{text}<br>%{x:.6~g}, %{y:.5~g}<extra></extra>`,
    }];
  });
}

// So many pairs of limits are drawn: where the structure differs from curve to curve they would hide the responses.
const most_limits = 3;

const has_limits = (linear) => Boolean(linear && linear.curves && linear.curves.count <= most_limits);

/**
 * Both linear limits of a quantity, where the table `linear` has it: without sliders (dashed), with all of them stuck
 * (dotted). In grey, or in the colour of the curve that they belong to.
 */
function limit_traces(linear, name, label, color = null) {
  if (!has_limits(linear)) return [];
  const curves = curves_of(linear);
  const places = varying_keys(linear, curves);
  return ["free", "stuck"].flatMap((limit) => {
    const variable = variable_of(linear, `${limit}_${name}`);
    if (!variable || label >= variable.labels.length) return [];
    return curves.map((curve) => {
      const rest = curve_name(linear, curve, places);
      const shown = `Linear, ${limit}${rest ? ` (${rest})` : ""}${color === null ? "" : `: ${variable.labels[label]}`}`;
      const x = linear.overview[linear.curves.abscissa][0].slice(curve.from, curve.to);
      const y = linear.overview[variable.index][label].slice(curve.from, curve.to);
      return {
        type: "scatter", mode: "lines", ...(is_angle(name) ? broken_at_turns(x, y) : {x, y}), name: plot_text(shown), showlegend: true,
        line: {color: color ?? "#59636d", width: 1.3, dash: limit === "free" ? "dash" : "dot"},
        hovertemplate: `${plot_text(shown)}<br>%{x:.6~g}, %{y:.5~g}<extra></extra>`,
      };
    });
  });
}

const is_angle = (name) => /phase$/.test(name);
const is_small_number = (name) => name === "residual" || name === "error";

/**
 * Quantities over the abscissa, a curve a value of the swept parameters. One curve alone: a line a label.
 *
 * with_scale: a button for logarithmic axes of the ordinate.
 */
function family_figure(table, variables, {caption, linear = null, with_scale = false, height = 430}) {
  const all_curves = curves_of(table), slices = grid_slices(table);
  const {abscissa} = table.curves;
  const x_of = (curve) => table.overview[abscissa][0].slice(curve.from, curve.to);
  const colors = color_places(table);
  const is_single = all_curves.length === 1;
  const choosers = [{label: "Quantity", options: variables.map((variable) => quantity_phrase(variable.name))}];
  const labels = is_single ? null : label_chooser(variables.find((variable) => variable.labels.length > 1));
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const label_at = add(labels);
  const slice_at = add(slices ? {label: "Slice", options: slices.map((slice) => slice.name)} : null);
  const color_at = add(!slices && all_curves.length > most_in_legend && colors.length > 1
    ? {label: "Colour by", options: colors.map((place) => table.variables[table.curves.keys[place]].name)} : null);
  const scale_at = add(with_scale ? {label: "Scale", options: ["Linear", "Logarithmic"]} : null);
  const drops_chooser = choosers[0].options.length === 1;
  if (drops_chooser) choosers.shift();
  return make_figure({
    caption: caption + curves_text(table) + (variables[0].dimension ? shortened(variables[0]) : ""), choosers, height,
    draw: (given) => {
      const chosen = drops_chooser ? [0, ...given] : given;
      const variable = variables[chosen[0]];
      const curves = slices ? slices[chosen[slice_at]].curves : all_curves;
      const label = Math.min(label_at < 0 ? 0 : chosen[label_at], Math.max(variable.labels.length - 1, 0));
      const values = (curve, which) => {
        const x = x_of(curve), y = table.overview[variable.index][which].slice(curve.from, curve.to);
        return is_angle(variable.name) ? broken_at_turns(x, y) : {x, y};
      };
      const hover = `${phrase(table.variables[abscissa].name)} %{x:.6~g} ${pretty_unit(table.variables[abscissa].unit)}<br>` +
        `${quantity_phrase(variable.name)} %{y:.5~g} ${pretty_unit(variable.unit)}`;
      const shown = is_single ? table.overview[variable.index].map((_, which) => which) : [label];
      const traces = is_single
        ? shown.map((which) => {
          const name = variable.dimension ? variable.labels[which] : quantity_phrase(variable.name);
          return {type: "scatter", mode: "lines", ...values(curves[0], which), name: plot_text(name), line: {...line_style(which), dash: "solid"},
                  showlegend: true, hovertemplate: `${plot_text(name)}<br>${hover}<extra></extra>`};
        })
        : family_traces(table, curves, (curve) => values(curve, label), colors[color_at < 0 ? 0 : chosen[color_at]], hover);
      // The limits lie under the curves.
      const limits = shown.flatMap((which) => limit_traces(linear, variable.name, which, is_single && shown.length > 1 ? line_style(which).color : null));
      const flags = shown.flatMap((which) => flagged_traces(table, variable, which)).map((trace, index, all) => (
        {...trace, showlegend: all.findIndex((other) => other.name === trace.name) === index}));
      traces.unshift(...limits);
      traces.push(...flags);
      const is_log = is_small_number(variable.name) || (scale_at >= 0 && chosen[scale_at] === 1);
      const subject = !is_single && variable.dimension ? `${variable.labels[label]}: ` : "";
      const many = is_single ? {} : beside(traces);
      const layout = {
        xaxis: axis(quantity_label(table, abscissa), is_spread_by_ratio(table.overview[abscissa][0]) ? log_axis(table.overview[abscissa][0]) : {}),
        yaxis: axis(`${subject}${quantity_phrase(variable.name)} [${pretty_unit(variable.unit)}]`,
                    is_log ? log_axis(table.overview[variable.index].flat()) : positive_axis(variable.name)),
        ...many,
      };
      return {traces, layout};
    },
  });
}

/** "harmonic3_phase" as "Phase of harmonic 3". */
function quantity_phrase(name) {
  const harmonic = /^harmonic_?(\d+)_(.+)$/.exec(name);
  return harmonic ? `${phrase(harmonic[2])} of harmonic ${harmonic[1]}` : phrase(name);
}

const positive_axis = (name) => (/amplitude|rms|dissipated|slip_share|transitions/.test(name) ? {rangemode: "tozero"} : {});

function variables_named(table, pattern) {
  return table.variables.map((variable, index) => ({index, ...variable}))
    .filter((variable) => pattern.test(variable.name) && (!variable.dimension || variable.labels.length > 0));
}

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
          hovertemplate: `${phrase(table.variables[table.curves.abscissa].name)} %{x:.6~g}<br>` +
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
                  hovertemplate: "%{x:.5~g}<br>%{y:.5~g}<br>at %{marker.color:.5~g} rad/s<extra></extra>"}],
        layout: {xaxis: axis(quantity_label(table, table.curves.keys[place])),
                 yaxis: axis(`${variable.labels[label]}: Largest amplitude [${pretty_unit(variable.unit)}]`)},
      };
    },
  });
}

/** Percentile bands: the variables amplitude_p05, amplitude_p25, ...; pairs about the median are shaded. */
function bands_figure(table, abscissa_label) {
  const levels = variables_named(table, /_p\d+$/)
    .map((variable) => ({percent: Number(variable.name.match(/\d+$/)[0]), variable})).sort((a, b) => a.percent - b.percent);
  if (!levels.length || !table.curves) return null;
  const [{variable: first}] = levels;
  const quantity = phrase(first.name.replace(/_p\d+$/, ""));
  const curves = curves_of(table), places = varying_keys(table, curves);
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const label_at = add(label_chooser(first));
  const curve_at = add(curves.length > 1 ? {label: "Direction", options: curves.map((curve) => curve_name(table, curve, places))} : null);
  const scale_at = add({label: "Scale", options: ["Linear", "Logarithmic"]});
  const pairs = levels.slice(0, Math.floor(levels.length / 2)).map((low, index) => [low, levels[levels.length - 1 - index]]);
  const fills = ["rgba(0,114,178,0.16)", "rgba(0,114,178,0.26)", "rgba(0,114,178,0.34)"];
  const missing = variable_of(table, "missing");
  const lacking = missing ? table.maxima[missing.index][0] : 0;
  return make_figure({
    caption: "Percentile bands over the samples: everywhere the band holds the middle share of them; the line is the median." +
      (lacking > 0 ? ` Up to ${count_text(lacking)} samples have no value somewhere and do not count there.` : ""),
    choosers, height: 430,
    draw: (chosen) => {
      const label = label_at < 0 ? 0 : chosen[label_at], curve = curves[curve_at < 0 ? 0 : chosen[curve_at]];
      const slice = (index, which) => table.overview[index][which].slice(curve.from, curve.to);
      const line = ({percent, variable}) => ({
        type: "scatter", mode: "lines", x: slice(table.curves.abscissa, 0), y: slice(variable.index, label),
        hovertemplate: `${percent} %: %{y:.5~g} ${pretty_unit(variable.unit)} at %{x:.6~g}<extra></extra>`,
      });
      const edge = {line: {width: 0.6, color: "#0072b2"}};
      const traces = pairs.flatMap(([low, high], index) => [
        {...line(low), ...edge, showlegend: false, legendgroup: `band ${index}`},
        {...line(high), ...edge, fill: "tonexty", fillcolor: fills[index] ?? fills.at(-1), name: `${low.percent} to ${high.percent} %`,
         legendgroup: `band ${index}`, showlegend: true},
      ]);
      if (levels.length % 2 === 1) {
        const middle = levels[(levels.length - 1) / 2];
        traces.push({...line(middle), name: middle.percent === 50 ? "Median" : `${middle.percent} %`, showlegend: true, line: {color: "#1c242c", width: 2}});
      }
      return {traces, layout: {
        xaxis: axis(abscissa_label, is_spread_by_ratio(slice(table.curves.abscissa, 0)) ? log_axis(slice(table.curves.abscissa, 0)) : {}),
        yaxis: axis(`${first.dimension ? `${first.labels[label]}: ` : ""}${quantity} [${pretty_unit(first.unit)}]`,
                    chosen[scale_at] === 1 ? log_axis(levels.flatMap(({variable}) => slice(variable.index, label))) : {rangemode: "tozero"}),
      }};
    },
  });
}

function write_frequency_response(chapter, analysis) {
  const of = (name) => analysis.tables.find((table) => table.name === name && table.rows > 0);
  const table = analysis.tables[0], linear = of("linear"), waveforms = of("waveforms"), bands = of("bands");
  if (table.rows === 0) {
    chapter.node.append(element("p", {class: "note"}, "It ended before its first point."));
    return;
  }
  const is_random = Boolean(bands) || /random|sample/.test(analysis.attributes.sweep ?? "");
  const statuses = statuses_of(table);
  if (statuses.length) add_section(chapter, "Points", statuses);
  const limits = has_limits(linear) ? " Dashed and dotted: the linear limits, sliders free and sliders stuck." : "";
  const sizes = variables_named(table, /^(amplitude|velocity_amplitude|acceleration_amplitude|rms|harmonic_?\d+_amplitude)$/);
  if (sizes.length) {
    const kinds = "Amplitude is half of peak to peak over a period.";
    add_section(chapter, "Responses", family_figure(table, sizes, {
      caption: `Responses in the steady state. ${kinds}${limits}`, linear, with_scale: true, height: 470}));
  }
  const turns = variables_named(table, /^(angle_amplitude|angular_velocity_amplitude|angular_acceleration_amplitude|angle_rms|angle_mean|harmonic_?\d+_angle_amplitude)$/);
  if (turns.length) {
    add_section(chapter, "Rotations", family_figure(table, turns, {
      caption: `Rotations in the steady state. Amplitude is half of peak to peak over a period.${limits}`, linear, with_scale: true, height: 470}));
  }
  if (bands) {
    const figure = bands_figure(bands, quantity_label(table, table.curves.abscissa));
    if (figure) add_section(chapter, "Percentile bands", figure);
  }
  const amplitude = variable_of(table, "amplitude");
  const map = amplitude && !is_random && map_figure(table, amplitude);
  if (map) add_section(chapter, "Map", map);
  const peaks = peaks_figures(table, is_random);
  if (peaks.length) add_section(chapter, "Largest amplitudes", peaks);
  const angles = variables_named(table, /^(phase|harmonic_?\d+_phase|mean)$/);
  if (angles.length) {
    add_section(chapter, "Phase and mean", family_figure(table, angles, {
      caption: `Phases of the harmonics, A cos(kΩt + phase), and the mean of the motion.${limits}`, linear}));
  }
  const sliders = variables_named(table, /^(slip_share|dissipated|offset|moment_offset)$/).filter((variable) => variable.dimension)
    .sort((a, b) => ["slip_share", "dissipated", "offset", "moment_offset"].indexOf(a.name) - ["slip_share", "dissipated", "offset", "moment_offset"].indexOf(b.name));
  if (sliders.length) {
    add_section(chapter, "Stick and slip", family_figure(table, sliders, {
      caption: "Sliders over a period: the share of it in which they slip, the work that friction dissipates, and the force that a slider " +
        "which never slips keeps."}));
  }
  const works = variables_named(table, /^(input_work|viscous_work|transitions|residual|error|iterations)$/).filter((variable) => !variable.dimension);
  if (works.length) {
    add_section(chapter, "Work and accuracy", family_figure(table, works, {
      caption: "Work of the loads and of viscous damping over a period, the number of transitions between stick and slip, and how well the points " +
        "were solved."}));
  }
  if (waveforms) write_waveforms(chapter, waveforms);
  write_tables(chapter, analysis.tables.filter((other) => other !== table && ![linear, waveforms, bands].includes(other)));
}
