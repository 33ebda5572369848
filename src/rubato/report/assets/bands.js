// Percentile bands of random samples.

/** Percentile bands: the variables amplitude_p05, amplitude_p25, ...; pairs about the median are shaded. */
function bands_figure(table, abscissa_label) {
  const levels = variables_named(table, /_p\d+$/)
    .map((variable) => ({percent: Number(variable.name.match(/\d+$/)[0]), variable})).sort((a, b) => a.percent - b.percent);
  if (!levels.length || !table.curves) return null;
  const [{variable: first}] = levels;
  const quantity = phrase(first.name.replace(/_p\d+$/, ""));
  const curves = curves_of(table), places = varying_keys(table, curves);
  const choosers = [];
  const add = (chooser) => (chooser ? choosers.push(chooser) - 1 : -1);
  const label_at = add(label_chooser(first));
  const curve_at = add(curves.length > 1 ? {label: "Direction", options: curves.map((curve) => curve_name(table, curve, places))} : null);
  const scale_at = add({label: "Scale", options: ["Linear", "Logarithmic"]});
  const pairs = levels.slice(0, Math.floor(levels.length / 2)).map((low, index) => [low, levels[levels.length - 1 - index]]);
  const fills = ["rgba(0,114,178,0.16)", "rgba(0,114,178,0.26)", "rgba(0,114,178,0.34)"];
  const missing = variable_of(table, "missing");
  const lacking = missing ? table.maxima[missing.index][0] : 0;
  return make_figure({
    caption: "Percentile bands over the samples: everywhere the band holds the middle share of them; the line is the median." +
      (lacking > 0 ? ` Up to ${count_text(lacking)} samples have no value somewhere and do not count there.` : ""),
    choosers, height: 430,
    draw: (chosen) => {
      const label = label_at < 0 ? 0 : chosen[label_at], curve = curves[curve_at < 0 ? 0 : chosen[curve_at]];
      const slice = (index, which) => table.overview[index][which].slice(curve.from, curve.to);
      const line = ({percent, variable}) => ({
        type: "scatter", mode: "lines", x: slice(table.curves.abscissa, 0), y: slice(variable.index, label),
        hovertemplate: `${percent} %: %{y:.5~g} ${pretty_unit(variable.unit)} at %{x:.6~g}<extra></extra>`,
      });
      const edge = {line: {width: 0.6, color: "#0072b2"}};
      const traces = pairs.flatMap(([low, high], index) => [
        {...line(low), ...edge, showlegend: false, legendgroup: `band ${index}`},
        {...line(high), ...edge, fill: "tonexty", fillcolor: fills[index] ?? fills.at(-1), name: `${low.percent} to ${high.percent} %`,
         legendgroup: `band ${index}`, showlegend: true},
      ]);
      if (levels.length % 2 === 1) {
        const middle = levels[(levels.length - 1) / 2];
        traces.push({...line(middle), name: middle.percent === 50 ? "Median" : `${middle.percent} %`, showlegend: true, line: {color: "#1c242c", width: 2}});
      }
      return {traces, layout: {
        xaxis: axis(abscissa_label, is_spread_by_ratio(slice(table.curves.abscissa, 0)) ? log_axis(slice(table.curves.abscissa, 0)) : {}),
        yaxis: axis(`${first.dimension ? `${first.labels[label]}: ` : ""}${quantity} [${pretty_unit(first.unit)}]`,
                    chosen[scale_at] === 1 ? log_axis(levels.flatMap(({variable}) => slice(variable.index, label))) : {rangemode: "tozero"}),
      }};
    },
  });
}
