// The steps of a march that chose them itself: lengths and errors over time, and how often which length was taken.

function is_of_steps(table) {
  return table.attributes.type === "steps" && table.rows > 0 && ["step", "error", "reason"].every((name) => variable_of(table, name));
}

/** The tries in a range: {time, step, error, reason}, columns; the reason is an index into words. */
function tries_of(table, range) {
  const columns = columns_of(table, range);
  const of = (name) => columns[variable_of(table, name).index][0];
  return {time: columns[0][0], step: of("step"), error: of("error"), reason: of("reason")};
}

/** Extremes of buckets of many rows do not tell which step they are of. */
function tells_tries(table, range) {
  return !table.is_envelope || range === 1;
}

/** Rows whose step ended at a transition that was looked for: accepted right after tries beyond it. */
function located_rows(tries, words) {
  const [accepted, event] = ["accepted", "event"].map((word) => words.indexOf(word));
  return tries.reason.flatMap((reason, row) => (row > 0 && reason === accepted && tries.reason[row - 1] === event ? [row] : []));
}

const marks_of_tries = {
  accepted: {color: palette[0], size: 4, symbol: "circle"},
  error_too_large: {color: palette[1], size: 7, symbol: "x-thin-open"},
  event: {color: "#6c7680", size: 5, symbol: "circle-open"},
};

/** The times at which steps ended at an event, where nothing tells which: lines. */
function located_lines(tries, words, low, high) {
  const times = located_rows(tries, words).map((row) => tries.time[row] + tries.step[row]);
  if (times.length === 0) return [];
  return [{type: "scatter", mode: "lines", name: "Event", showlegend: true, hoverinfo: "x+name",
           line: {color: palette[2], width: 1, dash: "dot"},
           x: times.flatMap((time) => [time, time, null]), y: times.flatMap(() => [low, high, null])}];
}

/** Lengths or errors of all tries, told apart by what became of them; the times of events as lines. */
function tries_traces(table, range, name, unit, events) {
  const tries = tries_of(table, range);
  const y = tries[name].map((value) => (value > 0 ? value : null));
  const heights = y.filter((value) => value !== null);
  const [low, high] = heights.length ? bounds(heights) : [1, 1];
  const [first, last] = [tries.time[0], tries.time.at(-1) + (tries.step.at(-1) ?? 0)];
  const marks = event_traces(events.filter(({time}) => first <= time && time <= last), ({time}) => ({x: time, y: high}), low);
  if (!tells_tries(table, range)) {
    return [...marks, {type: "scatter", mode: "lines", x: tries.time, y, name: phrase(name), line: line_style(0), showlegend: false}];
  }
  const words = variable_of(table, "reason").categories;
  const traces = words.flatMap((word, index) => {
    const is_accepted = word === "accepted";  // their line has gaps where there is nothing to show
    const rows = tries.reason.flatMap((reason, row) => (reason === index && (is_accepted || y[row] !== null) ? [row] : []));
    if (!rows.some((row) => y[row] !== null)) return [];
    const mark = marks_of_tries[word] ?? {color: palette[3], size: 7, symbol: "cross-thin-open"};
    const title = word === "event" ? "tried for an event" : word.replaceAll("_", " ");
    return [{type: "scatter", mode: is_accepted ? "lines+markers" : "markers", x: rows.map((row) => tries.time[row]),
             y: rows.map((row) => y[row]), name: phrase(title), marker: {...mark, line: {width: 1.4, color: mark.color}},
             line: {color: mark.color, width: 1.2}, showlegend: true,
             hovertemplate: `%{y:.4~g} ${unit} at %{x:.6~g} s<extra>${title}</extra>`}];
  });
  if (heights.length) traces.unshift(...(events.length ? marks : located_lines(tries, words, low, high)));
  return traces;
}

/** A logarithmic axis whose labels do not crowd. */
function decades_axis(values) {
  const [low, high] = bounds(values.filter((value) => value > 0));
  return {...logarithmic, dtick: Math.max(1, Math.ceil(Math.log10(high / low) / 8)) || 1};
}

function tries_figure(table, name, caption, events, more) {
  const variable = variable_of(table, name), unit = variable.unit === "1" ? "" : pretty_unit(variable.unit);
  return make_figure({
    caption: `${caption} ${overview_text(table)}`, choosers: table.window ? [whole_or_window] : [],
    draw: ([range = 0]) => {
      const traces = tries_traces(table, range, name, unit, events);
      const {time} = tries_of(table, range);
      return {traces: [...traces, ...more(time)],
              layout: {xaxis: axis(axis_label(table.variables[0])), yaxis: axis(axis_label(variable), decades_axis(tries_of(table, range)[name]))}};
    },
  });
}

/** The tolerance beside the errors. */
function tolerance_line(table, time) {
  const tolerance = Number(table.attributes.tolerance);
  if (!(tolerance > 0)) return [];
  return [{type: "scatter", mode: "lines", x: [time[0], time[time.length - 1]], y: [tolerance, tolerance], name: "Tolerance",
           line: {color: "#1c242c", width: 1, dash: "dash"}, hoverinfo: "y+name", showlegend: true}];
}

function step_distribution_figure(table) {
  const {edges, counts} = table.distribution;
  const steps = counts.reduce((sum, count) => sum + count, 0);
  return make_figure({
    caption: `How often a step of which length was taken: ${count_text(steps)} accepted steps, in bins of equal ratio.`, height: 300,
    draw: () => ({
      // A bin reaches from its edge to the next; the last edge closes the last.
      traces: [{type: "scatter", mode: "lines", x: [edges[0], ...edges], y: [0, ...counts, 0], fill: "tozeroy", showlegend: false,
                line: {color: palette[0], width: 1.2, shape: "hv"}, hovertemplate: "%{y} steps from %{x:.3~g} s<extra></extra>"}],
      layout: {xaxis: axis(axis_label(variable_of(table, "step")), log_axis(edges)),
               yaxis: axis("Steps [–]", {rangemode: "tozero"})},
    }),
  });
}

/** events: as events_of tells, or none. */
function write_steps(chapter, table, events) {
  const has_error = tries_of(table, 0).error.some((error) => error > 0);
  const body = [tries_figure(table, "step", "Length of the steps over the time at which they start, and what became of each try.", events, () => [])];
  if (has_error) {
    body.push(tries_figure(table, "error", "Error of the steps, as it was estimated; a larger one than the tolerance is tried again with a shorter step, and one of zero leaves a gap.",
                           events, (time) => tolerance_line(table, time)));
  }
  if (table.distribution) body.push(step_distribution_figure(table));
  add_section(chapter, "Steps", body);
}
