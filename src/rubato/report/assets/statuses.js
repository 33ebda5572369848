// What became of the points of a sweep: statuses in words, in a table, and as crosses in figures.

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
