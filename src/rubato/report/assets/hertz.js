// Studies that give frequencies in hertz, or excite by a parameter in hertz, are shown in hertz; results files tell rad/s.

const in_hertz = (values) => values.map((value) => (value === null ? null : value / (2 * Math.PI)));

function show_in_hertz(analysis) {
  const {excitation = "", frequency_unit} = analysis.tables[0]?.attributes ?? {};
  const is_by_hertz = excitation.startsWith("2 pi ");
  if (!is_by_hertz && frequency_unit !== "Hz") return;
  for (const table of analysis.tables) {
    table.hertz = is_by_hertz ? excitation.slice("2 pi ".length) : "f";
    table.variables.forEach((variable, index) => {
      if (!/(^|_)angular_frequency$/.test(variable.name) || variable.unit !== "rad/s") return;
      variable.unit = "Hz";
      variable.shown_name = variable.name.replace("angular_frequency", "frequency");
      table.overview[index] = table.overview[index].map(in_hertz);
      if (table.window) table.window[index] = table.window[index].map(in_hertz);
      if (table.statuses) table.statuses.columns[index] = table.statuses.columns[index].map(in_hertz);
      if (!table.peaks) return;
      if (table.curves.abscissa === index) table.peaks.abscissa = table.peaks.abscissa.map(in_hertz);
      const key = table.curves.keys.indexOf(index);
      if (key >= 0) table.peaks.keys[key] = in_hertz(table.peaks.keys[key]);
    });
  }
}

/** "7.5 rad/s"; where the study speaks of hertz, "1.1937 Hz (7.5 rad/s)". */
function frequency_text(table, frequency) {
  const text = (value) => Number(value.toPrecision(6));
  return table.hertz === undefined ? `${text(frequency)} rad/s` : `${text(frequency)} Hz (${text(2 * Math.PI * frequency)} rad/s)`;
}
