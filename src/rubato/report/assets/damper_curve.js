// A damper curve: the largest amplitude over frequency against a parameter, and its optimum with the certificate.

function is_damper_curve(analysis) {
  const [table] = analysis.tables;
  return analysis.attributes.type === "damper_curve" && table && table.name === "" && Boolean(table.curves);
}

/** The largest amplitudes of both linear limits over the parameter: dashed without sliders, dotted with all stuck. */
function damper_limits(linear, abscissa_name) {
  const parameter = linear && variable_of(linear, abscissa_name);
  if (!parameter) return [];
  return ["free", "stuck"].flatMap((limit) => {
    const variable = variable_of(linear, `${limit}_objective`);
    return variable ? [{
      type: "scatter", mode: "lines", x: linear.overview[parameter.index][0], y: linear.overview[variable.index][0], name: `Linear, ${limit}`,
      showlegend: true, line: {color: "#59636d", width: 1.3, dash: limit === "free" ? "dash" : "dot"},
      hovertemplate: `Linear, ${limit}: %{y:.6~g} ${pretty_unit(variable.unit)}<extra></extra>`,
    }] : [];
  });
}

function damper_figure(table, optimum, linear) {
  const {abscissa} = table.curves;
  const objective = variable_of(table, "objective"), amplitude = variable_of(table, "amplitude"), frequency = variable_of(table, "angular_frequency");
  const curves = curves_of(table);
  const is_single = curves.length === 1;
  const quantities = [amplitude, objective].filter((variable) => variable);
  const parameter = table.overview[abscissa][0];
  const kind = optimum && variable_of(optimum, "kind");
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const quantity_at = add(quantities.length > 1 ? {label: "Quantity", options: quantities.map((variable) => phrase(variable.name))} : null);
  const label_at = add(is_single ? null : label_chooser(amplitude));
  const scale_at = add({label: "Scale", options: ["Linear", "Logarithmic"]});
  const named = optimum && optimum.rows === 1 && variable_of(optimum, table.variables[abscissa].name);
  return make_figure({
    caption: `Damper curve: the largest value over frequency against the parameter (top), and the frequency where it stands (bottom).` +
      (named ? " The star marks the optimum." : "") + (is_single && linear ? " Dashed and dotted: the linear limits, sliders free and sliders stuck." : "") +
      curves_text(table),
    choosers, height: 560,
    draw: (chosen) => {
      const variable = quantities[quantity_at < 0 ? 0 : chosen[quantity_at]];
      const label = label_at < 0 ? 0 : chosen[label_at];
      const slice = (index, which, curve) => table.overview[index][which].slice(curve.from, curve.to);
      const x_of = (curve) => slice(abscissa, 0, curve);
      const colors = color_places(table);
      const hover = `${plot_text(table.variables[abscissa].name)} %{x:.6~g}<br>%{y:.6~g} ${pretty_unit(variable.unit)}`;
      let traces;
      if (is_single) {
        traces = table.overview[variable.index].map((_, which) => {
          const name = variable.dimension ? variable.labels[which] : phrase(variable.name);
          return {type: "scatter", mode: "lines+markers", x: x_of(curves[0]), y: slice(variable.index, which, curves[0]), name: plot_text(name), showlegend: true,
                  line: {...line_style(which), dash: "solid"}, marker: {size: 4}, hovertemplate: `${plot_text(name)}<br>${hover}<extra></extra>`};
        });
      } else {
        const which = Math.min(label, Math.max(variable.labels.length - 1, 0));
        traces = family_traces(table, curves, (curve) => ({x: x_of(curve), y: slice(variable.index, which, curve)}), colors[0], hover);
      }
      if (is_single && (variable === objective || variable === amplitude)) traces.unshift(...damper_limits(linear, table.variables[abscissa].name));
      const flagged = (is_single ? table.overview[variable.index].map((_, which) => which) : [label]).flatMap((which) => flagged_traces(table, variable, which));
      traces.push(...flagged.map((trace, index) => ({...trace, showlegend: index === 0})));
      const layout = {
        xaxis: axis(`${table.variables[abscissa].name} [${parameter_unit(table.variables[abscissa])}]`,
                    {...(frequency ? {anchor: "y2"} : {}), mirror: "all", ...(is_spread_by_ratio(parameter) ? log_axis(parameter) : {})}),
        yaxis: axis(axis_label(variable), {...(frequency ? {domain: [0.4, 1]} : {}),
                                          ...(chosen[scale_at] === 1 ? log_axis(table.overview[variable.index].flat()) : {rangemode: "tozero"})}),
        annotations: [],
        ...beside(traces),
      };
      if (frequency) {
        layout.yaxis2 = axis(axis_label(frequency), {domain: [0, 0.32]});
        for (const curve of curves.slice(0, most_in_legend)) {
          traces.push({type: "scatter", mode: "lines+markers", x: x_of(curve), y: slice(frequency.index, 0, curve), yaxis: "y2", showlegend: false,
                       text: slice(frequency.index, 0, curve).map((at) => (at === null ? "" : frequency_text(table, at))),
                       line: {color: "#1c242c", width: 1.3}, marker: {size: 3}, hovertemplate: "%{x:.6~g}<br>%{text}<extra></extra>"});
        }
      }
      const best = named && variable_of(optimum, variable.name);
      if (best) {
        const values = optimum.overview[best.index].map((column) => column[0]);
        const x = optimum.overview[named.index][0][0];
        // With several coordinates the largest is what the optimum is about.
        const y = Math.max(...values.filter((value) => value !== null));
        const at = optimum.overview[variable_of(optimum, "angular_frequency")?.index ?? 0][0][0];
        const lines = [`<b>${plot_text(table.variables[abscissa].name)} = ${Number(x.toPrecision(6))}</b>`,
                       `${Number(y.toPrecision(7))} ${pretty_unit(variable.unit)}${frequency ? ` at ${frequency_text(table, at)}` : ""}`];
        if (kind) lines.push(`certificate: ${value_text(kind, optimum.overview[kind.index][0][0])}`);
        traces.push({type: "scatter", mode: "markers", x: [x], y: [y], name: "Optimum", showlegend: true, hovertemplate: `${lines.join("<br>")}<extra></extra>`,
                     marker: {symbol: "star", size: 15, color: "#d55e00", line: {color: "#ffffff", width: 1}}});
        const log_x = layout.xaxis.type === "log", log_y = layout.yaxis.type === "log";
        layout.annotations.push({x: log_x ? Math.log10(x) : x, y: log_y ? Math.log10(y) : y, text: lines.join("<br>"), align: "left", showarrow: true, arrowhead: 0,
                                 ax: 0, ay: -70, bgcolor: "rgba(255,255,255,0.92)", bordercolor: "#d55e00", borderpad: 5, font: {size: 12}});
        if (frequency) {
          traces.push({type: "scatter", mode: "markers", x: [x], y: [at], yaxis: "y2", showlegend: false, hoverinfo: "skip",
                       marker: {symbol: "star", size: 12, color: "#d55e00", line: {color: "#ffffff", width: 1}}});
        }
      }
      return {traces, layout};
    },
  });
}

const parameter_unit = (variable) => (variable.unit && variable.unit !== "1" ? pretty_unit(variable.unit) : "SI");

const certificates = {
  smooth: "the derivative along the parameter and the slope over frequency vanish",
  corner: "the curve has a corner there: it falls before and rises behind",
  flat: "the curve does not change there",
  uncertified: "the best that was found; neither vanishing derivatives nor a kink could be shown",
  bound: "the curve still falls at the end of the range of the parameter",
  kink: "two peaks or coordinates are equal there; the multipliers weigh their derivatives to zero",
};

/** Name and value of everything that the optimum tells. */
function optimum_table(table, optimum) {
  const kind = variable_of(optimum, "kind");
  const word = kind && value_text(kind, optimum.overview[kind.index][0][0]);
  if (optimum.rows > 1) {
    return optimum.rows <= 60 ? results_table(optimum, `The optimum of each case, ${count_text(optimum.rows)} rows.`, 7) : null;
  }
  const rows = optimum.variables.flatMap((variable, index) => optimum.overview[index].map((column, label) => {
    const is_parameter = variable.name === table.variables[table.curves.abscissa].name;
    const unit = is_parameter ? parameter_unit(variable) : pretty_unit(variable.unit);
    const name = is_parameter ? variable.name : phrase(variable.name);
    const cell = variable.categories.length ? value_text(variable, column[0]) : number_node(column[0], is_small_number(variable.name) ? 3 : 10);
    return [variable.dimension ? `${variable.labels[label]}: ${name}` : name, cell, variable.categories.length ? "" : unit];
  }));
  return make_table({
    caption: `The optimum and its certificate.${word && certificates[word] ? ` ${phrase(word)}: ${certificates[word]}.` : ""}`,
    columns: [{title: "Quantity", is_text: true}, {title: "Value"}, {title: "Unit", is_text: true}], rows,
  });
}

/** Rows of equal keys, wherever they stand: [{keys, rows: [index, ...]}]. For short tables that are shown whole. */
function rows_by(table, keys, rows = table.overview[0][0].map((_, row) => row)) {
  const groups = new Map();
  for (const row of rows) {
    const values = keys.map((key) => table.overview[key][0][row]);
    const name = values.join(" ");
    if (!groups.has(name)) groups.set(name, {keys: values, rows: []});
    groups.get(name).rows.push(row);
  }
  return [...groups.values()];
}

function peaks_tracked_figure(table, main) {
  const number = table.variables.findIndex((variable) => /^peak/.test(variable.name) && !variable.dimension);
  const parameter = variable_of(table, main.variables[main.curves.abscissa].name);
  const frequency = variable_of(table, "angular_frequency"), amplitude = variable_of(table, "amplitude") ?? variable_of(table, "objective");
  if (number < 0 || !parameter || !amplitude || table.is_envelope) return null;
  // A sweep has peaks of every combination of its values: those of one are shown at a time.
  const swept = main.curves.keys.map((key) => table.variables.findIndex((variable) => variable.name === main.variables[key].name));
  const combinations = rows_by(table, swept.filter((key) => key >= 0));
  const names = combinations.map((combination) => curve_name(main, combination, varying_keys(main)));
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const combination_at = add(combinations.length > 1 ? {label: "Combination", options: names} : null);
  const label_at = add(label_chooser(amplitude));
  return make_figure({
    caption: "All peaks that were tracked: their values (top) and frequencies (bottom). The damper curve is the highest of them.",
    choosers, height: 520,
    draw: (chosen) => {
      const label = label_at < 0 ? 0 : chosen[label_at];
      const {rows} = combinations[combination_at < 0 ? 0 : chosen[combination_at]];
      const traces = [];
      for (const group of rows_by(table, [number], rows)) {
        const pick = (variable, which) => group.rows.map((row) => table.overview[variable.index][which][row]);
        const style = {type: "scatter", mode: "lines+markers", x: pick(parameter, 0), name: `Peak ${value_text(table.variables[number], group.keys[0])}`,
                       legendgroup: String(group.keys[0]), line: {...line_style(traces.length / 2), dash: "solid"}, marker: {size: 4}};
        traces.push({...style, y: pick(amplitude, label), showlegend: true});
        if (frequency) traces.push({...style, y: pick(frequency, 0), yaxis: "y2", showlegend: false});
      }
      const values = table.overview[parameter.index][0];
      const subject = amplitude.dimension ? `${amplitude.labels[label]}: ` : "";
      return {traces, layout: {
        xaxis: axis(`${parameter.name} [${parameter_unit(parameter)}]`, {anchor: "y2", mirror: "all", ...(is_spread_by_ratio(values) ? log_axis(values) : {})}),
        yaxis: axis(`${subject}${axis_label(amplitude)}`, {domain: [0.4, 1], rangemode: "tozero"}),
        yaxis2: axis(frequency ? axis_label(frequency) : "[–]", {domain: [0, 0.32]}),
      }};
    },
  });
}

/** Where there is an optimum for each of many cases: how they are distributed. */
function optimum_distribution(table, optimum) {
  const at = optimum && variable_of(optimum, table.variables[table.curves.abscissa].name);
  if (!at || optimum.rows < 12) return null;
  const kind = variable_of(optimum, "kind");
  const is_flat = (row) => kind && kind.categories[optimum.overview[kind.index][0][row]] === "flat";
  const places = optimum.overview[at.index][0].filter((_, row) => !is_flat(row));
  const flat = optimum.overview[at.index][0].length - places.length;
  if (places.length < 12) return null;
  const without = flat ? ` ${count_text(flat)} of them do not depend on the parameter where they are best, and are left out.` : "";
  return make_figure({
    caption: `Distribution of the optimum over ${count_text(optimum.rows)} cases.${without}`, height: 340,
    draw: () => ({
      traces: [{type: "histogram", x: places, histnorm: "percent", nbinsx: 50, marker: {color: "#56a0d3", line: {color: "#ffffff", width: 0.5}},
                hovertemplate: "%{x}: %{y:.3~g} %<extra></extra>"}],
      layout: {xaxis: axis(`${at.name} [${parameter_unit(at)}]`), yaxis: axis("Share of the cases [%]"), bargap: 0},
    }),
  });
}

function write_damper_curve(chapter, analysis) {
  const of = (name) => analysis.tables.find((table) => table.name === name && table.rows > 0);
  const [table] = analysis.tables;
  const optimum = of("optimum"), peaks = of("peaks"), linear = of("linear"), bands = of("bands");
  if (table.rows === 0) {
    chapter.node.append(element("p", {class: "note"}, "It ended before its first point."));
    return;
  }
  const statuses = statuses_of(table);
  if (statuses.length) add_section(chapter, "Points", statuses);
  add_section(chapter, "Damper curve", damper_figure(table, optimum, linear));
  const spread = bands && bands_figure(bands, quantity_label(table, table.curves.abscissa));
  if (spread) add_section(chapter, "Percentile bands", spread);
  if (optimum) {
    add_section(chapter, "Optimum", [optimum_table(table, optimum), optimum_distribution(table, optimum)].filter((node) => node));
  }
  const tracked = peaks && peaks_tracked_figure(peaks, table);
  if (tracked) add_section(chapter, "Peaks", tracked);
  const sliders = variables_named(table, /^(dissipated|slip_share)$/).filter((variable) => variable.dimension);
  if (sliders.length) {
    add_section(chapter, "Stick and slip", family_figure(table, sliders, {caption: "Sliders at the peak: friction work and share of slip over a period."}));
  }
  write_tables(chapter, analysis.tables.filter((other) => ![table, optimum, linear, spread ? bands : undefined, tracked ? peaks : undefined].includes(other)));
}
