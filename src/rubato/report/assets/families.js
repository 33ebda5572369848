// Families of curves over frequency, with the linear limits and the points that did not converge.

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
    return curves.map((curve, index) => {
      const rest = curve_name(linear, curve, places);
      const name_of_limit = `Linear, ${limit}${color === null ? "" : `: ${variable.labels[label]}`}`;
      const shown = rest ? `${name_of_limit} (${rest})` : name_of_limit;
      const x = linear.overview[linear.curves.abscissa][0].slice(curve.from, curve.to);
      const y = linear.overview[variable.index][label].slice(curve.from, curve.to);
      return {
        type: "scatter", mode: "lines", ...(is_angle(name) ? broken_at_turns(x, y) : {x, y}), name: plot_text(name_of_limit), legendgroup: plot_text(name_of_limit),
        showlegend: index === 0,
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
      const hover = `${variable_phrase(table.variables[abscissa])} %{x:.6~g} ${pretty_unit(table.variables[abscissa].unit)}<br>` +
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
