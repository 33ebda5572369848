// A method study: errors of each method, order, stability, and its response beside the exact one.

function is_method_study(analysis) {
  return analysis.attributes.type === "method_study" || analysis.tables.some((table) => table.name === "ladder");
}

/** The series that a table holds of a variable: by label, or by the words of a column that names the method of each row. */
function series_of(table, variable) {
  const x_variable = table.variables[0];
  const word_index = table.variables.findIndex((candidate) => candidate.categories.length > 0);
  if (variable.dimension || word_index < 0) {
    return table.overview[variable.index].map((y, label) => ({
      name: variable.dimension ? variable.labels[label] : phrase(variable.name), x: table.overview[0][0], y, x_variable,
    }));
  }
  // One row a method and a step: the first other column without words is the abscissa.
  const words = table.variables[word_index].categories;
  const x_index = table.variables.findIndex((candidate) => candidate.categories.length === 0);
  return words.map((name, word) => {
    const rows = table.overview[word_index][0].flatMap((value, row) => (value === word ? [row] : []));
    const pick = (index) => rows.map((row) => table.overview[index][0][row]);
    return {name, x: pick(x_index), y: pick(variable.index), x_variable: table.variables[x_index]};
  });
}

function abscissa_indices(table) {
  const has_words = table.variables.some((variable) => variable.categories.length > 0);
  return has_words ? [table.variables.findIndex((variable) => variable.categories.length === 0)] : [0];
}

function plotted_variables(table) {
  const skipped = abscissa_indices(table);
  return table.variables.map((variable, index) => ({index, ...variable}))
    .filter((variable) => variable.categories.length === 0 && !skipped.includes(variable.index));
}

/** Error against step on logarithmic axes, with the slopes of the orders. */
function ladder_figure(table, variable) {
  const series = series_of(table, variable);
  const steps = series.flatMap((line) => line.x), errors = series.flatMap((line) => line.y).filter((error) => error > 0);
  const longest = Math.max(...steps), shortest = Math.min(...steps), least = Math.min(...errors);
  const anchor = Math.max(...errors.filter((error) => error < 1));
  const slopes = [1, 2, 3, 4].map((order) => {
    const lowest = Math.max(shortest, longest * (least / anchor) ** (1 / order));
    return {type: "scatter", mode: "lines", x: [lowest, longest], y: [anchor * (lowest / longest) ** order, anchor],
            name: `Slope ${order}`, line: {color: "#9aa4ae", width: 1, dash: "dot"}, hoverinfo: "name"};
  });
  return make_figure({
    caption: `${phrase(variable.name)} against step, down to where round-off takes over. Dotted: the slopes of orders 1 to 4.`,
    height: 560,
    draw: () => ({
      traces: [...slopes, ...series.map((line, index) => ({
        type: "scatter", mode: "lines+markers", x: line.x, y: line.y, name: plot_text(line.name), line: line_style(index),
        marker: {size: 5, symbol: index % 8}}))],
      layout: {xaxis: axis(axis_label(series[0].x_variable), logarithmic), yaxis: axis(axis_label(variable), logarithmic)},
    }),
  });
}

function stability_figure(table, variable) {
  const series = series_of(table, variable);
  // Beyond its limit an explicit method's radius grows without bound, and beyond pi a sampled period is that of an alias:
  // either would flatten the others. Zooming out shows them.
  const ranges = {spectral_radius: [0, 1.6], period_elongation: [-0.4, 1.6], numerical_damping: [-0.1, 0.6]};
  return make_figure({
    caption: `${phrase(variable.name)} of each method over the step times the angular frequency of a mode.`,
    height: Math.max(460, 110 + 19 * series.length),
    draw: () => ({
      traces: series.map((line, index) => ({type: "scatter", mode: "lines", x: line.x, y: line.y, name: plot_text(line.name),
                                            line: line_style(index)})),
      layout: {xaxis: axis(axis_label(series[0].x_variable)), yaxis: axis(axis_label(variable), {range: ranges[variable.name]})},
    }),
  });
}

/**
 * For each method: its response beside the exact one, and their difference below. Where the table is too long to be
 * shown whole its last rows are: the extremes of buckets fall on other rows for each method and cannot be subtracted.
 */
function response_figures(whole) {
  const table = {...whole, overview: whole.window ?? whole.overview};
  const variable = variable_of(table, "position") ?? plotted_variables(table)[0];
  const named = variable_of(table, "exact");
  const series = series_of(table, variable);
  // The numbers of a page have seven digits: a small difference is not left of two of them, and has a column of its own.
  const differences = variable_of(table, "difference");
  const difference_of = (name) => differences && series_of(table, differences).find((line) => line.name === name)?.y;
  const exact = named ? table.overview[named.index][0] : series.find((line) => line.name === "exact")?.y;
  return series.filter((line) => line.name !== "exact").map((line) => make_figure({
    caption: `${line.name}: response beside the exact one, and their difference below. ${window_text(whole)}`,
    height: 360, is_small: true,
    draw: () => {
      const traces = [];
      if (exact) {
        traces.push({type: "scatter", mode: "lines", x: line.x, y: exact, name: "Exact", line: {color: "#1c242c", width: 2.4}});
      }
      traces.push({type: "scatter", mode: "lines", x: line.x, y: line.y, name: plot_text(line.name),
                   line: {color: "#e69f00", width: 1.4, dash: "dash"}});
      const layout = {xaxis: axis(axis_label(line.x_variable), exact ? {anchor: "y2", mirror: "all"} : {}), yaxis: axis(axis_label(variable))};
      if (exact) {
        const difference = difference_of(line.name) ?? line.y.map((value, row) => (value === null || exact[row] === null ? null : value - exact[row]));
        traces.push({type: "scatter", mode: "lines", x: line.x, y: difference, yaxis: "y2", name: "Difference",
                     line: {color: "#0072b2", width: 1.3}});
        layout.yaxis.domain = [0.46, 1];
        layout.yaxis2 = axis(`Difference [${pretty_unit(variable.unit)}]`, {domain: [0, 0.36]});
      }
      return {traces, layout};
    },
  }));
}

function write_method_study(chapter, analysis, theory) {
  const of = (name) => analysis.tables.find((table) => table.name === name && table.rows > 0);
  const main = of(""), ladder = of("ladder"), stability = of("stability"), response = of("response");
  if (main) {
    add_section(chapter, "Errors", results_table(main, "Errors of each method against the closed-form response.", 7));
  }
  if (ladder) {
    add_section(chapter, "Error against step", plotted_variables(ladder).map((variable) => ladder_figure(ladder, variable)));
  }
  const unstable = of("unstable");
  if (response) add_section(chapter, "Responses", element("div", {class: "pair"}, response_figures(response)));
  if (stability) {
    add_section(chapter, "Spectral properties", plotted_variables(stability).map((variable) => stability_figure(stability, variable)));
  }
  if (unstable) {
    const [step, limit] = ["step", "stability_limit"].map((name) => Number(parseFloat(unstable.attributes[name]).toPrecision(6)));
    add_section(chapter, "Beyond the stability limit", element(
      "p", {}, `A step of ${step} s, beyond the limit of ${limit} s.`), element("div", {class: "pair"}, response_figures(unstable)));
  }
  write_theory(chapter, theory);
  const known = [main, ladder, stability, response, unstable];
  write_tables(chapter, analysis.tables.filter((table) => !known.includes(table)), 10);
}
