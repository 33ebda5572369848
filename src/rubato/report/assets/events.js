// Events of a march: when joints lock and let go, stick and slip, and sliders and stops of a structure likewise.

const is_of_events = (table) => table.attributes.type === "events" && ["joint", "event"].every((name) => variable_of(table, name));

// How each kind of event is marked, and what it is called.
const event_kinds = {
  stops: {text: "Stop holds", symbol: "square", color: palette[1]},
  latches: {text: "Latch locks", symbol: "diamond", color: palette[3]},
  locks: {text: "Lock holds", symbol: "square", color: palette[1]},
  lets_go: {text: "Stop lets go", symbol: "square-open", color: palette[1]},
  sticks: {text: "Sticks", symbol: "triangle-down", color: palette[2]},
  slips: {text: "Slips", symbol: "triangle-up-open", color: palette[2]},
  closes: {text: "Closes", symbol: "square", color: palette[1]},
  opens: {text: "Opens", symbol: "square-open", color: palette[1]},
};
const most_marks = 1000;  // of a kind

// What a table of events calls the parts that change.
const joints_of_events = {one: "Joint", all: "joints", nothing: "no joint locked or let go, stuck or slipped",
                          lost: " Energy lost: what the impact of a rigid lock took, or the spring of a damped stop still held as it let go."};
const contacts_of_events = {one: "Contact", all: "contacts", nothing: "no slider slipped and no stop closed",
                            lost: " Energy lost: what the spring of a damped stop still held as it let go."};
const parts_of_events = (table) => table.attributes.of === "contacts" ? contacts_of_events : joints_of_events;

/** The events of an analysis in the order of time: {time, joint, part, event, kind, energy}; the part of a joint with several locks is one of them. */
function events_of(analysis) {
  const table = analysis.tables.find(is_of_events);
  if (!table || table.rows === 0) return [];
  const columns = columns_of(table, 1), [joint, event, energy, lock] = ["joint", "event", "energy_lost", "lock"].map((name) => variable_of(table, name));
  const cell = (variable, row) => columns[variable.index][0][row];
  const limits = new Map((analysis.scene?.joints.names ?? []).map((name, place) => [name, analysis.scene.joints.limits[place]]));
  return columns[0][0].map((time, row) => {
    const [name, word] = [joint, event].map((variable) => variable.categories[cell(variable, row)]);
    const kind = word === "locks" ? {stop: "stops", latch: "latches"}[limits.get(name)] ?? "locks" : word;
    const part = lock && cell(lock, row) > 0 ? `${name}, lock(${cell(lock, row)})` : name;
    return {time, joint: name, part, event: word, kind, energy: energy ? cell(energy, row) : null};
  });
}

/** The joints whose lock holds at a time. */
function held_joints(events, time) {
  const held = new Map();
  for (const {time: when, joint, part, event} of events) {
    if (when > time) break;
    if (event === "locks") held.set(part, joint);
    if (event === "lets_go") held.delete(part);
  }
  return new Set(held.values());
}

/** Marks of events, a trace a kind, at most so many of it; where(event): {x, y}. From the height `low`, if given, lines lead up. */
function event_traces(events, where, low = null) {
  return Object.entries(event_kinds).flatMap(([kind, {text, symbol, color}]) => {
    const all = events.filter((event) => event.kind === kind);
    if (all.length === 0) return [];
    const step = Math.max(1, all.length / most_marks);
    const shown = all.filter((_, place) => Math.floor(place / step) !== Math.floor((place - 1) / step));
    const some = shown.length < all.length ? ` (${count_text(shown.length)} of ${count_text(all.length)})` : "";
    const places = shown.map(where), [x, y] = [places.map((place) => place.x), places.map((place) => place.y)];
    const lines = low === null ? [] : [{
      type: "scatter", mode: "lines", x: x.flatMap((at) => [at, at, null]), y: y.flatMap((high) => [low, high, null]), legendgroup: kind,
      line: {color, width: 1, dash: "dot"}, hoverinfo: "skip", showlegend: false,
    }];
    return [...lines, {type: "scatter", mode: "markers", x, y, name: `${text}${some}`, text: shown.map((event) => plot_text(event.part)), legendgroup: kind,
                       marker: {symbol, color, size: 9, line: {color, width: 1.4}}, showlegend: true,
                       hovertemplate: `%{text}: ${text.toLowerCase()} at %{x:.9~g} s<extra></extra>`}];
  });
}

/** When which part did what, over the time of the run. */
function events_figure(events, range, parts) {
  const names = [...new Set(events.map(({part}) => part))];
  return make_figure({
    caption: `Events of the ${parts.all} over time: ${count_text(events.length)} in all.`, height: Math.min(600, 150 + 28 * names.length),
    draw: () => ({
      traces: event_traces(events, ({time, part}) => ({x: time, y: plot_text(part)})),
      layout: {xaxis: axis("Time [s]", {range}), yaxis: axis(`${parts.one} [–]`, {
        type: "category", categoryarray: names.map(plot_text).reverse(), range: [-0.6, names.length - 0.4], dtick: 1, tick0: 0,
      })},
    }),
  });
}

/** A row an event where there are few, else a row a joint and kind. */
function events_table(events, parts) {
  const joule = (energy) => number_node(energy, 4);
  if (events.length <= 60) {
    return make_table({
      caption: `Events of the ${parts.all}.${parts.lost}`,
      columns: [{title: "Time [s]"}, {title: parts.one, is_text: true}, {title: "Event", is_text: true}, {title: "Energy lost [J]"}],
      rows: events.map(({time, part, kind, energy}) => [number_node(time, 9), part, event_kinds[kind]?.text ?? kind, joule(energy)]),
    });
  }
  const groups = new Map();
  for (const event of events) {
    const key = JSON.stringify([event.part, event.kind]);
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(event);
  }
  return make_table({
    caption: `Events of the ${parts.all} by kind. Each is in the results file.`,
    columns: [{title: parts.one, is_text: true}, {title: "Event", is_text: true}, {title: "Number"}, {title: "First [s]"}, {title: "Last [s]"},
              {title: "Energy lost [J]"}],
    rows: [...groups.values()].map((group) => [
      group[0].part, event_kinds[group[0].kind]?.text ?? group[0].kind, count_text(group.length), number_node(group[0].time, 7),
      number_node(group.at(-1).time, 7), joule(group.reduce((sum, {energy}) => sum + (energy ?? 0), 0)),
    ]),
  });
}

function write_events(chapter, analysis, table) {
  const events = events_of(analysis), parts = parts_of_events(table);
  if (events.length === 0) {
    add_section(chapter, "Events", element("p", {class: "note"}, `Nothing happened: ${parts.nothing}.`));
    return;
  }
  const last = table.is_envelope ? element("p", {class: "note"}, `The last ${count_text(events.length)} of ${count_text(table.rows)} events.`) : null;
  add_section(chapter, "Events", [last, events_figure(events, padded_range([analysis.tables[0].overview[0][0]]), parts), events_table(events, parts)].filter((node) => node));
}
