// Analyses repeated over samples: key numbers over the swept parameters, their distributions, a Campbell diagram.

function is_swept(analysis) {
  const [table] = analysis.tables;
  return /^swept_/.test(analysis.attributes.type ?? "") && Boolean(table) && table.name === "";
}

/** The swept parameters of the main table: [{index, name, values}]. */
function swept_parameters(analysis, table) {
  return (analysis.attributes.swept_parameters ?? "").split(", ").map((name) => variable_of(table, name)).filter((variable) => variable)
    .map((variable) => ({...variable, values: table.overview[variable.index][0]}));
}

/** Every column of key numbers: [{name, unit, values}]. */
function key_columns(analysis, table) {
  const heads = ["sample", "warnings", "status", ...(analysis.attributes.swept_parameters ?? "").split(", ")];
  return table.variables.flatMap((variable, index) => (heads.includes(variable.name) || variable.categories.length ? [] : table.overview[index].map(
    (values, label) => ({name: variable.dimension ? `${variable.labels[label]}, ${phrase(variable.name).toLowerCase()}` : phrase(variable.name),
                         unit: variable.unit, values}))));
}

/** Rows in groups that are equal in some parameters: [{name, rows}]. */
function rows_by_values_of(parameters, count) {
  const groups = new Map();
  for (let row = 0; row < count; ++row) {
    const name = parameters.map((parameter) => `${parameter.name} = ${value_text(parameter, parameter.values[row])}`).join(", ");
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(row);
  }
  return [...groups].map(([name, rows]) => ({name, rows}));
}

/** Natural frequencies over the speed, with engine orders across and their crossings marked. */
function campbell_figure(analysis, table, crossings) {
  const {speed, speed_unit, speed_factor, engine_orders} = analysis.attributes;
  const parameters = swept_parameters(analysis, table);
  const x = parameters.find((parameter) => parameter.name === speed) ?? parameters[0];
  const others = parameters.filter((parameter) => parameter !== x);
  const frequency = variable_of(table, "frequency");
  const groups = rows_by_values_of(others, table.rows);
  const orders = (engine_orders ?? "").split(", ").filter((text) => text).map(Number);
  const title = speed ? `${phrase(x.name)} [${speed_unit}]` : `${x.name} [SI]`;
  const most = bounds(table.overview[frequency.index].flat())[1];
  return make_figure({
    caption: orders.length
      ? "Campbell diagram: natural frequencies over the speed, engine orders across (grey), and where they meet (crosses)."
      : `Natural frequencies over ${x.name}.${shortened(frequency)}`,
    choosers: groups.length > 1 ? [{label: "Slice", options: groups.map((group) => group.name)}] : [], height: 460,
    draw: (chosen) => {
      const group = groups[groups.length > 1 ? chosen[0] : 0];
      const rows = [...group.rows].sort((a, b) => x.values[a] - x.values[b]);
      const traces = frequency.labels.map((label, index) => ({
        type: "scatter", mode: rows.length > 60 ? "lines" : "lines+markers", x: rows.map((row) => x.values[row]),
        y: rows.map((row) => table.overview[frequency.index][index][row]), name: plot_text(label), showlegend: true,
        line: {...line_style(index), dash: label.startsWith("stuck") ? "dot" : "solid"}, marker: {size: 4},
        hovertemplate: `${plot_text(label)}<br>${plot_text(x.name)} %{x:.6~g}<br>%{y:.6~g} Hz<extra></extra>`,
      }));
      const [low, high] = bounds(rows.map((row) => x.values[row]));
      for (const order of orders) {
        const at = (value) => order * Number(speed_factor) * value / (2 * Math.PI);
        traces.unshift({type: "scatter", mode: "lines", x: [low, high], y: [at(low), at(high)], showlegend: false, hoverinfo: "skip",
                        line: {color: "#8c96a0", width: 1.1, dash: "dash"}});
        const end = Math.min(high, 1.05 * most / at(1));
        traces.push({type: "scatter", mode: "text", x: [end], y: [at(end)], text: [`EO ${order}`], textposition: "top left", showlegend: false,
                     hoverinfo: "skip", textfont: {size: 11, color: "#59636d"}});
      }
      if (crossings) {
        const column = (name) => crossings.overview[variable_of(crossings, name).index][0];
        const is_here = (row) => others.every((other) => column(other.name)[row] === other.values[group.rows[0]]);
        const shown = column(x.name).map((_, row) => row).filter(is_here);
        const mode = variable_of(crossings, "mode");
        traces.push({type: "scatter", mode: "markers", x: shown.map((row) => column(x.name)[row]), y: shown.map((row) => column("frequency")[row]),
                     text: shown.map((row) => `EO ${column("engine_order")[row]}, ${mode.categories[column("mode")[row]]}`),
                     name: "Crossing", showlegend: shown.length > 0, marker: {symbol: "x", size: 8, color: "#000000"},
                     hovertemplate: "%{text}<br>%{x:.6~g}<br>%{y:.6~g} Hz<extra></extra>"});
      }
      return {traces, layout: {xaxis: axis(title), yaxis: axis("Frequency [Hz]", {range: [0, 1.08 * most]})}};
    },
  });
}

/** A key number over a parameter: lines over a grid, points of cases and random samples. */
function swept_figure(analysis, table) {
  const parameters = swept_parameters(analysis, table);
  const columns = key_columns(analysis, table).filter((column) => column.values.some((value) => value !== null));
  if (!columns.length || !parameters.length) return null;
  const is_grid = analysis.attributes.sweep === "grid";
  const choosers = [{label: "Quantity", options: columns.map((column) => column.name)}];
  if (parameters.length > 1) choosers.push({label: "Over", options: parameters.map((parameter) => parameter.name)});
  return make_figure({
    caption: "Key numbers of the samples over a swept parameter; samples without a result have no point.", choosers,
    draw: (chosen) => {
      const column = columns[chosen[0]], x = parameters[parameters.length > 1 ? chosen[1] : 0];
      const groups = is_grid ? rows_by_values_of(parameters.filter((parameter) => parameter !== x), table.rows) : [{name: "", rows: x.values.map((_, row) => row)}];
      const shown = groups.slice(0, most_in_legend);
      return {
        traces: shown.map(({name, rows}, index) => {
          const order = [...rows].sort((a, b) => x.values[a] - x.values[b]);
          return {type: "scatter", mode: is_grid ? "lines+markers" : "markers", x: order.map((row) => x.values[row]), y: order.map((row) => column.values[row]),
                  name: plot_text(name || column.name), showlegend: shown.length > 1, line: line_style(index), marker: {size: is_grid ? 4 : 5, color: palette[index % palette.length]},
                  hovertemplate: `${plot_text(x.name)} %{x:.6~g}<br>%{y:.6~g}<extra></extra>`};
        }),
        layout: {xaxis: axis(`${x.name} [SI]`, is_spread_by_ratio(x.values) ? log_axis(x.values) : {}), yaxis: axis(`${column.name} [${pretty_unit(column.unit)}]`)},
      };
    },
  });
}

/** How a key number is distributed over random samples. */
function swept_distribution(analysis, table) {
  const columns = key_columns(analysis, table).filter((column) => new Set(column.values.filter((value) => value !== null)).size > 2);
  if (!columns.length) return null;
  return make_figure({
    caption: "How a key number is distributed over the samples that have it.", choosers: [{label: "Quantity", options: columns.map((column) => column.name)}],
    draw: ([chosen]) => ({
      traces: [{type: "histogram", x: columns[chosen].values.filter((value) => value !== null), marker: {color: palette[0]}, showlegend: false,
                hovertemplate: "%{x}: %{y} samples<extra></extra>"}],
      layout: {xaxis: axis(`${columns[chosen].name} [${pretty_unit(columns[chosen].unit)}]`), yaxis: axis("Samples [–]"), bargap: 0.05},
    }),
  });
}

/** The table `statistics`, a row a key number. */
function statistics_numbers(table) {
  const words = variable_of(table, "statistic");
  const most = 80;
  const rows = table.variables.flatMap((variable, index) => (index === words.index ? [] : table.overview[index].map((values, label) => [
    `${variable.dimension ? `${variable.labels[label]} ` : ""}${axis_label(variable)}`, ...values.map((value) => number_node(value, 5))])));
  const some = rows.length > most ? ` The first ${most} of ${count_text(rows.length)}; the others are in the results file.` : "";
  return make_table({
    caption: `Key numbers over the samples: mean, standard deviation, extremes, and what 5, 25, 50, 75 and 95 % of the samples lie below.${some}`,
    columns: [{title: "Key number", is_text: true}, ...table.overview[words.index][0].map((place) => ({title: words.categories[place]}))],
    rows: rows.slice(0, most),
  });
}

function write_swept(chapter, analysis) {
  const [table] = analysis.tables;
  const of_name = (name) => analysis.tables.find((other) => other.name === name);
  const [crossings, statistics, failures, histories] = ["crossings", "statistics", "failures", "histories"].map(of_name);
  const is_random = analysis.attributes.sweep === "random";
  if (table.is_envelope) {
    add_section(chapter, "Samples", element("p", {class: "note"}, `${count_text(table.rows)} samples are in the results file.`));
  } else {
    if (variable_of(table, "frequency") && !is_random) {
      add_section(chapter, "Natural frequencies", campbell_figure(analysis, table, crossings?.rows ? crossings : null));
    }
    const figures = [swept_figure(analysis, table), is_random ? swept_distribution(analysis, table) : null].filter((figure) => figure);
    if (figures.length) add_section(chapter, "Key numbers", figures);
  }
  if (statistics?.rows) add_section(chapter, "Statistics", statistics_numbers(statistics));
  const is_short = (other) => other?.rows > 0 && other.rows <= 500;
  if (is_short(crossings)) add_section(chapter, "Crossings", results_table(crossings, "Where engine orders meet natural frequencies.", 6));
  if (histories?.curves) {
    const variables = histories.variables.map((variable, index) => ({index, ...variable})).filter((variable) => variable.dimension && variable.labels.length);
    if (variables.length) add_section(chapter, "Histories", family_figure(histories, variables, {caption: "Motions of the samples."}));
  }
  if (is_short(failures)) add_section(chapter, "Samples without a result", results_table(failures, "Why samples have no result."));
  const shown = [table, crossings, statistics, failures, histories];
  for (const other of analysis.tables.filter((one) => !shown.includes(one) && one.name !== "modes")) write_tables(chapter, [other]);
}
