// Natural modes: a table of frequencies and damping, and the shapes of each limit.

const most_shapes = 12;
const most_mode_rows = 60;

function is_modes(analysis) {
  const table = analysis.tables.find((candidate) => candidate.name === "");
  return analysis.attributes.type === "modes" && variable_of(table, "limit") !== null && table.rows > 0;
}

/** {name, modes: [row, ...]} of each limit that has rows. */
function limits_of(table) {
  const limit = variable_of(table, "limit");
  const column = table.overview[limit.index][0];
  return limit.categories
    .map((name, word) => ({name, modes: column.flatMap((value, row) => (value === word ? [row] : []))}))
    .filter((entry) => entry.modes.length > 0);
}

function modes_table(table) {
  const limits = limits_of(table);
  const shown = table.variables.map((variable, index) => ({index, ...variable}))
    .filter((variable) => !variable.dimension && variable.name !== "limit");
  const rows = limits.flatMap(({name, modes}) => modes.map((row) => [
    name, ...shown.map((variable) => number_node(table.overview[variable.index][0][row], 7))])).slice(0, most_mode_rows);
  const rest = table.rows > rows.length ? ` The first ${rows.length} of ${count_text(table.rows)}.` : "";
  return make_table({
    caption: "Natural frequencies and damping. Free: sliders removed; stuck: sliders as springs. A free motion is " +
      `Re(shape exp(eigenvalue t)).${rest}`,
    columns: [{title: "Limit", is_text: true}, ...shown.map((variable) => ({title: axis_label(variable), is_text: false}))],
    rows,
  });
}

function shapes_figure(table) {
  const shape = variable_of(table, "shape"), imaginary = variable_of(table, "shape_imaginary");
  const frequency = variable_of(table, "angular_frequency");
  const limits = limits_of(table);
  const parts = imaginary ? [shape, imaginary] : [shape];
  const choosers = [{label: "Limit", options: limits.map(({name}) => phrase(name))}];
  if (imaginary) choosers.push({label: "Part", options: ["Real part", "Imaginary part"]});
  return make_figure({
    caption: `Shapes of the lowest ${most_shapes} modes at most, with a modal mass of 1 kg; the largest entry is real and ` +
      `positive.${shortened(shape)}`,
    choosers,
    draw: (chosen) => {
      const part = parts[chosen[1] ?? 0];
      const traces = limits[chosen[0]].modes.slice(0, most_shapes).map((row, index) => ({
        type: "scatter", mode: "lines+markers", x: part.labels.map(plot_text),
        y: part.labels.map((_, label) => table.overview[part.index][label][row]),
        name: `${index + 1}: ${table.overview[frequency.index][0][row].toPrecision(5)} rad/s`,
        line: line_style(index), marker: {size: 5, symbol: index % 8}, showlegend: true,
      }));
      return {traces, layout: {xaxis: axis("", {type: "category"}), yaxis: axis(axis_label(part))}};
    },
  });
}

function write_modes(chapter, analysis) {
  const table = analysis.tables.find((candidate) => candidate.name === "");
  add_section(chapter, "Frequencies and damping", modes_table(table));
  if (variable_of(table, "shape")) add_section(chapter, "Shapes", shapes_figure(table));
}
