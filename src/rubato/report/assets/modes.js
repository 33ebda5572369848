// Modes of the linear limits: frequencies and damping ratios, and shapes over the coordinates.

function modes_table_of(analysis) {
  return analysis.tables.find((table) => variable_of(table, "damping_ratio") && variable_of(table, "angular_frequency") && table.rows > 0);
}

/** Shapes in bars over the coordinates; real and imaginary parts side by side where modes are complex. */
function shapes_figure(table, parts) {
  const limit = variable_of(table, "limit"), mode = variable_of(table, "mode");
  const frequency = variable_of(table, "angular_frequency");
  const words = limit ? limit.categories : [];
  const limits = limit ? [...new Set(table.overview[limit.index][0])] : [null];
  const rows_of = (value) => table.overview[0][0].map((_, row) => row).filter((row) => !limit || table.overview[limit.index][0][row] === value);
  const most = Math.max(...limits.map((value) => rows_of(value).length));
  const numbers = Array.from({length: most}, (_, i) => {
    const row = rows_of(limits[0])[i];
    return String(mode && row !== undefined ? value_text(mode, table.overview[mode.index][0][row]) : i + 1);
  });
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const limit_at = add(limits.length > 1 ? {label: "Limit", options: limits.map((value) => phrase(words[value]))} : null);
  const mode_at = add(numbers.length > 1 ? {label: "Mode", options: numbers.map((number) => `Mode ${number}`)} : null);
  const [first] = parts;
  const is_long = first.labels.length > 60;
  return make_figure({
    caption: `Shape of a mode over the coordinates.${shortened(first)}`, choosers, height: 380,
    draw: (chosen) => {
      const rows = rows_of(limits[limit_at < 0 ? 0 : chosen[limit_at]]);
      const row = rows[Math.min(mode_at < 0 ? 0 : chosen[mode_at], rows.length - 1)];
      const at = Number(table.overview[frequency.index][0][row].toPrecision(6));
      return {
        traces: parts.map((variable, index) => ({
          ...(is_long ? {type: "scatter", mode: "lines", line: line_style(index), x: variable.labels.map((_, i) => i + 1), text: variable.labels.map(plot_text)}
                      : {type: "bar", marker: {color: palette[index]}, x: variable.labels.map(plot_text)}),
          y: table.overview[variable.index].map((column) => column[row]), name: shape_name(variable), showlegend: parts.length > 1,
          hovertemplate: `${is_long ? "%{text}" : "%{x}"}: %{y:.5~g}<extra></extra>`,
        })),
        layout: {xaxis: axis("Coordinate [–]", is_long ? {} : {type: "category", showgrid: false}),
                 yaxis: axis(`Shape at ${at} rad/s [${pretty_unit(first.unit)}]`), bargap: 0.35},
      };
    },
  });
}

const shape_name = (variable) => (/imag/.test(variable.name) ? "Imaginary part" : /phase/.test(variable.name) ? "Phase" : "Real part");

function write_modes(chapter, table) {
  const shapes = variables_named(table, /shape/).filter((variable) => variable.dimension && variable.labels.length && !/phase/.test(variable.name));
  const columns = table.variables.map((variable, index) => ({index, ...variable})).filter((variable) => !variable.dimension);
  const most = 60;
  const kept = {...table, variables: columns, overview: columns.map((variable) => table.overview[variable.index].map((column) => column.slice(0, most)))};
  const rest = table.rows > most ? ` The first ${most} of ${count_text(table.rows)} rows; the others are in the results file.` : "";
  add_section(chapter, "Modes", results_table(kept, `Natural frequencies and damping ratios.${rest}`, 7));
  if (table.is_envelope) return;
  for (const [title, dimension] of [["Mode shapes", "coordinate"], ["Mode shapes: rotations", "rotation"]]) {
    const parts = shapes.filter((variable) => (variable.dimension === "rotation") === (dimension === "rotation"));
    if (parts.length) add_section(chapter, title, shapes_figure(table, parts));
  }
}
