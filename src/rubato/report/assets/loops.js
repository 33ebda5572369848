// Waveforms over a period, and the hysteresis loops of sliders, at chosen points of a response.

/** So many cases stand in one figure; of more, evenly spread ones. */
const most_cases = 40;

function chosen_cases(table) {
  const curves = curves_of(table);
  if (curves.length <= most_cases) return curves;
  return Array.from({length: most_cases}, (_, i) => curves[Math.round(i * (curves.length - 1) / (most_cases - 1))]);
}

function case_colors(table) {
  return varying_keys(table).find((place) => table.variables[table.curves.keys[place]].categories.length === 0);
}

/** Force over displacement of a slider, a loop a case; a period's samples are joined at their ends. */
function loops_figure(table, force, displacement) {
  const cases = chosen_cases(table);
  const choosers = [label_chooser(force)].filter((chooser) => chooser);
  const closed = (index, label, curve) => {
    const values = table.overview[index][label].slice(curve.from, curve.to);
    return [...values, values[0]];
  };
  return make_figure({
    caption: `Hysteresis loops at chosen points: the area of a loop is the friction work over a period.${shortened(force)}`, choosers, height: 440,
    draw: ([label = 0]) => {
      const traces = family_traces(table, cases, (curve) => ({x: closed(displacement.index, label, curve), y: closed(force.index, label, curve)}),
                                   case_colors(table), `%{x:.5~g} ${pretty_unit(displacement.unit)}, %{y:.5~g} ${pretty_unit(force.unit)}`);
      return {traces, layout: {
        xaxis: axis(`${displacement.labels[label]}: Relative displacement [${pretty_unit(displacement.unit)}]`,
                    {range: padded_range([table.overview[displacement.index][label]])}),
        yaxis: axis(axis_label(force), {range: padded_range([table.overview[force.index][label]])}),
        ...beside(traces),
      }};
    },
  });
}

/** Quantities over the time of a period, a line a case. */
function waveforms_figure(table, variables) {
  const cases = chosen_cases(table);
  const names = [...new Set(variables.flatMap((variable) => variable.labels.map((label) => `${variable.index} ${label}`)))];
  const options = names.map((name) => {
    const [index, ...label] = name.split(" ");
    return `${label.join(" ")}: ${phrase(table.variables[index].name)}`;
  });
  return make_figure({
    caption: `Waveforms over a period at chosen points.${shortened(variables[0])}`,
    choosers: options.length > 1 ? [{label: "Quantity", options}] : [], height: 400,
    draw: ([which = 0]) => {
      const [index, ...words] = names[which].split(" ");
      const variable = {index: Number(index), ...table.variables[index]};
      const label = variable.labels.indexOf(words.join(" "));
      const slice = (column, at, curve) => table.overview[column][at].slice(curve.from, curve.to);
      const traces = family_traces(table, cases, (curve) => ({x: slice(table.curves.abscissa, 0, curve), y: slice(variable.index, label, curve)}),
                                   case_colors(table), `%{x:.5~g} s, %{y:.5~g} ${pretty_unit(variable.unit)}`);
      return {traces, layout: {
        xaxis: axis(axis_label(table.variables[table.curves.abscissa])),
        yaxis: axis(`${variable.labels[label]}: ${phrase(variable.name)} [${pretty_unit(variable.unit)}]`), ...beside(traces),
      }};
    },
  });
}

function write_waveforms(chapter, table) {
  if (!table.curves) return;
  const body = [];
  const force = variable_of(table, "force"), displacement = variable_of(table, "displacement");
  if (force && displacement && force.labels.length) body.push(loops_figure(table, force, displacement));
  const moment = variable_of(table, "moment"), angle = variable_of(table, "relative_angle");
  if (moment && angle && moment.labels.length) body.push(loops_figure(table, moment, angle));
  const motion = ["position", "angle", "velocity", "force", "displacement", "moment", "relative_angle"].map((name) => variable_of(table, name))
    .filter((variable) => variable && variable.labels.length);
  if (motion.length) body.push(waveforms_figure(table, motion));
  if (body.length) add_section(chapter, "Loops and waveforms", body);
}
