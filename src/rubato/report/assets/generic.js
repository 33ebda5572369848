// Tables of no kind that the report knows: as they are where they are short, else as lines over their rows.

function write_tables(chapter, tables, digits = 6) {
  for (const table of tables) {
    const title = table.name ? phrase(table.name) : "Results";
    if (table.rows === 0) {
      add_section(chapter, title, element("p", {class: "note"}, "No row was written."));
      continue;
    }
    const width = table.overview.reduce((sum, columns) => sum + columns.length, 0);
    if (table.rows === 1 && table.variables.some((variable) => variable.dimension)) {
      add_section(chapter, title, one_row_tables(table, digits));
      continue;
    }
    const body = [];
    const is_short = table.rows <= 60 && width <= 14;
    if (is_short) body.push(results_table(table, `${title}, ${count_text(table.rows)} rows.`, digits));
    if (table.variables[0].categories.length === 0 && table.rows > 2) {
      for (const variable of plotted_variables(table)) body.push(generic_figure(table, variable));
    } else if (!is_short) {
      body.push(element("p", {class: "note"}, `${count_text(table.rows)} rows are in the results file.`));
    }
    add_section(chapter, title, body);
  }
}

/** A table of one row, such as a state of equilibrium: the quantities of each kind of thing beside its names. */
function one_row_tables(table, digits) {
  const variables = table.variables.map((variable, index) => ({index, ...variable}));
  const dimensions = [...new Set(variables.map((variable) => variable.dimension).filter((dimension) => dimension))];
  return dimensions.map((dimension) => {
    const shown = variables.filter((variable) => variable.dimension === dimension && variable.labels.length);
    if (shown.length === 0) return null;
    const what = shown.map((variable) => variable.description).filter((text) => text).join("; ");
    const [first] = shown;
    return make_table({
      caption: `${phrase(what || dimension)}.${shortened(first)}`,
      columns: [{title: phrase(dimension), is_text: true}, ...shown.map((variable) => ({title: axis_label(variable)}))],
      rows: first.labels.map((label, row) => [label, ...shown.map((variable) => number_node(table.overview[variable.index][row][0], digits))]),
    });
  }).filter((node) => node);
}

function generic_figure(table, variable) {
  const series = series_of(table, variable);
  const is_sparse = table.rows <= 60;  // a line of one value would not be seen
  const what = variable.description ? `${phrase(variable.name)}: ${variable.description}.` : `${phrase(variable.name)}.`;
  const how = table.is_envelope
    ? ` The extremes of ${count_text(table.overview[0][0].length / 2)} buckets of ${count_text(table.rows)} rows.` : "";
  return make_figure({
    caption: `${what}${how}${variable.dimension ? shortened(variable) : ""}`,
    draw: () => ({
      traces: series.map((line, index) => ({type: "scatter", mode: is_sparse ? "lines+markers" : "lines", x: line.x, y: line.y,
                                            name: plot_text(line.name), line: line_style(index), showlegend: true})),
      layout: {xaxis: axis(axis_label(series[0].x_variable)), yaxis: axis(axis_label(variable))},
    }),
  });
}
