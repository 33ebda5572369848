// A transient: time histories, phase portrait, hysteresis loops, energy ledger.

/** What the figures of the last rows show, in words. */
function window_text(table) {
  if (!table.window) return `All ${count_text(table.rows)} rows are shown.`;
  return `The last ${count_text(table.window[0][0].length)} of ${count_text(table.rows)} rows are shown, ` +
    `from t = ${Number(table.window[0][0][0].toPrecision(6))} s.`;
}

function overview_text(table) {
  if (!table.is_envelope) return "Every row is drawn.";
  return `The whole run shows the extremes of ${count_text(table.overview[0][0].length / 2)} buckets of ` +
    `${count_text(table.rows)} rows, so no peak is lost; the last ${count_text(table.window[0][0].length)} rows are ` +
    "drawn as they are.";
}

const whole_or_window = {label: "Range", options: ["Whole run", "Last rows"]};

/** The columns that a range shows: 0 the whole run, 1 the last rows. */
function columns_of(table, range) {
  return range === 1 && table.window ? table.window : table.overview;
}

/** Places of the labels that a figure shows: those of nodes within beams ("BEAM:1.x") only where asked for. */
function shown_places(variable, with_inner) {
  const places = variable.labels.map((_, place) => place);
  const others = places.filter((place) => !is_inner_label(variable.labels[place]));
  return with_inner || others.length === 0 ? places : others;
}

const is_inner_label = (label) => /:\d+\.(x|y|z|rx|ry|rz)$/.test(label);
const has_inner_labels = (variable) => shown_places(variable, false).length < variable.labels.length;

function lines_over_rows(table, variable, range, places) {
  const columns = columns_of(table, range);
  return columns[variable.index].map((y, label) => ({
    type: "scatter", mode: "lines", x: columns[0][0], y, line: line_style(places.indexOf(label)), showlegend: true,
    name: plot_text(variable.dimension ? variable.labels[label] : phrase(variable.name)),
  })).filter((_, label) => places.includes(label));
}

/** A figure of some variables over the rows, one at a time. */
function history_figure(table, variables, subject) {
  const choosers = [{label: "Quantity", options: variables.map((variable) => phrase(variable.name))}];
  if (table.window) choosers.push(whole_or_window);
  const has_inner = variables.some(has_inner_labels);
  if (has_inner) choosers.push({label: "Nodes", options: ["Without nodes inside beams", "All nodes"]});
  return make_figure({
    caption: `${subject} over ${table.variables[0].name}. ${overview_text(table)}${shortened(variables[0])}`,
    choosers, height: 400,
    draw: (chosen) => {
      const variable = variables[chosen[0]], range = table.window ? chosen[1] : 0;
      const places = shown_places(variable, has_inner && chosen[choosers.length - 1] === 1);
      return {
        traces: lines_over_rows(table, variable, range, places),
        layout: {xaxis: axis(axis_label(table.variables[0])), yaxis: axis(axis_label(variable)),
                 hovermode: places.length > 8 ? "closest" : "x unified"},
      };
    },
  });
}

function phase_portrait(table, position, velocity) {
  const columns = columns_of(table, 1), places = shown_places(position, false);
  const [across, up] = [position, velocity].map((variable) => places.map((label) => columns[variable.index][label]));
  const rest = has_inner_labels(position) ? " Nodes inside beams are left out." : "";
  return make_figure({
    caption: `Phase portrait: velocity against position. ${window_text(table)}${shortened(position)}${rest}`, height: 440,
    draw: () => ({
      traces: places.map((label, line) => ({
        type: "scatter", mode: "lines", x: across[line], y: up[line], name: plot_text(position.labels[label]),
        line: {...line_style(line), width: 1.3}, showlegend: true,
      })),
      layout: {xaxis: axis(axis_label(position), {range: padded_range(across)}),
               yaxis: axis(axis_label(velocity), {range: padded_range(up)})},
    }),
  });
}

/** Where the attributes tell of a slider: those with forces come first, then those with moments. */
function place_of_slider(table, force, label) {
  return force.name === "moment" ? (variable_of(table, "force")?.label_count ?? 0) + label : label;
}

/** The relative displacement of a slider's ends: kept in the results, or slip + force / stiffness. */
function relative_displacement(table, force, label) {
  const columns = columns_of(table, 1);
  const kept = variable_of(table, "displacement");
  if (kept && kept.dimension === force.dimension) {
    return {title: "Relative displacement [m]", values: columns[kept.index][label]};
  }
  const turns = force.name === "moment";
  const slip = variable_of(table, turns ? "slip_angle" : "slip");
  const stiffness = (table.attributes.slider_stiffness ?? "").split(/[\s,]+/).map(Number)[place_of_slider(table, force, label)];
  if (stiffness > 0) {
    const forces = columns[force.index][label];
    return {title: turns ? "Relative rotation [rad]" : "Relative displacement [m]",
            values: columns[slip.index][label].map((value, row) => value + forces[row] / stiffness)};
  }
  return {title: turns ? "Slip [rad]" : "Slip [m]", values: columns[slip.index][label]};
}

/** The Coulomb limits of a slider, where the results tell them. */
function limit_lines(table, force, label, values) {
  const limit = (table.attributes.slider_limit ?? "").split(/[\s,]+/).map(Number)[place_of_slider(table, force, label)];
  const [low, high] = padded_range([values]) ?? [0, 0];
  if (!(limit > 0)) return [];
  return [{type: "scatter", mode: "lines", x: [low, high, null, low, high], y: [limit, limit, null, -limit, -limit], name: "±μN",
           line: {color: "#6c7680", width: 1, dash: "dash"}, hoverinfo: "name", showlegend: true}];
}

/** Whether a column is one of these quantities: where sliders or stops have it as well, it is `law_force` in results.nc. */
function is_quantity(variable, names) {
  return names.some((name) => [name, `${variable.dimension}_${name}`].includes(variable.name));
}

/** What a law sees, first less second. */
function law_displacement(table, force, label) {
  const seen = table.variables.map((variable, index) => ({...variable, index}))
    .find((variable) => variable.dimension === force.dimension && is_quantity(variable, ["displacement", "angle"]));
  return {title: axis_label(seen), values: columns_of(table, 1)[seen.index][label]};
}

function hysteresis_loops(table, force, displacement_of = relative_displacement, parts = "sliders") {
  const most = 12;
  const columns = columns_of(table, 1);
  const shown = Math.min(most, columns[force.index].length);
  return element("div", {class: "pair"}, columns[force.index].slice(0, shown).map((y, label) => {
    const displacement = displacement_of(table, force, label);
    const rest = label === 0 && force.label_count > shown
      ? ` The first ${shown} of ${count_text(force.label_count)} ${parts} have a figure.` : "";
    return make_figure({
      caption: `Hysteresis loop of ${force.labels[label]}. ${window_text(table)}${rest}`, height: 320, is_small: true,
      draw: () => ({
        traces: [...(parts === "sliders" ? limit_lines(table, force, label, displacement.values) : []), {type: "scatter", mode: "lines", x: displacement.values, y, name: plot_text(force.labels[label]),
                  line: {...line_style(label), dash: "solid"}, showlegend: true}],
        layout: {xaxis: axis(displacement.title, {range: padded_range([displacement.values])}),
                 yaxis: axis(axis_label(force), {range: padded_range([y])})},
      }),
    });
  }));
}

// Which panel each entry of the ledger stands in: what accumulates, what goes to and fro, what is left.
const ledger_panels = [
  {title: "Cumulative [J]", names: ["load_work", "damper_dissipated", "slider_dissipated", "stop_dissipated", "law_dissipated", "lock_dissipated",
    "friction_dissipated", "drive_work"], domain: [0.60, 1.0]},
  {title: "Stored [J]", names: ["kinetic", "strain", "slider_stored", "stop_stored", "law_stored"], domain: [0.24, 0.54]},
  {title: "Residue [J]", names: ["residue"], domain: [0.0, 0.18]},
];

function energy_ledger(table) {
  const named = ledger_panels.flatMap((panel) => panel.names);
  const others = table.variables.slice(1).map((variable) => variable.name).filter((name) => !named.includes(name));
  const choosers = table.window ? [whole_or_window] : [];
  return make_figure({
    caption: "Energy ledger: work of the loads and what dampers, sliders and locks dissipated since the start (top), energy stored " +
      "(middle), and the residue of the integration that closes the balance (bottom, on its own scale). What stays zero is " +
      `left out. ${overview_text(table)}`,
    height: 620, choosers,
    draw: ([range = 0]) => {
      const columns = columns_of(table, range);
      const layout = {xaxis: axis(axis_label(table.variables[0]), {anchor: "y3", mirror: "all"}), hovermode: "x"};
      const traces = [];
      ledger_panels.forEach((panel, index) => {
        const suffix = index === 0 ? "" : String(index + 1);
        layout[`yaxis${suffix}`] = axis(panel.title, {domain: panel.domain});
        const entries = (index === 1 ? [...panel.names, ...others] : panel.names).map((name) => variable_of(table, name)).filter(Boolean);
        const moving = entries.filter((variable) => columns[variable.index][0].some((value) => value !== 0));
        for (const variable of moving.length ? moving : entries) {
          traces.push({type: "scatter", mode: "lines", x: columns[0][0], y: columns[variable.index][0],
                       yaxis: `y${suffix}`, name: phrase(variable.name), line: line_style(traces.length)});
        }
      });
      return {traces, layout};
    },
  });
}

function is_transient(analysis) {
  const table = analysis.tables[0];
  return table && table.name === "" && table.row_dimension === "time" &&
    (variable_of(table, "position") !== null || analysis.attributes.type === "transient");
}

// The table of the extremes that columns took at the ends of steps.
const is_of_extremes = (table) => table.attributes.type === "extremes" && ["column", "least", "largest"].every((name) => variable_of(table, name));

/** Lets the key numbers of a table tell the largest values at all steps: rows may be fewer. */
function take_extremes(analysis, table) {
  const extremes = analysis.tables.find(is_of_extremes);
  if (!extremes || !table.key_numbers || extremes.is_envelope) return;
  const column = (name) => extremes.overview[variable_of(extremes, name).index][0];
  const names = variable_of(extremes, "column").categories;
  const places = new Map(column("column").map((category, row) => [names[category], row]));
  const [least, least_time, largest, largest_time] = ["least", "time_of_least", "largest", "time_of_largest"].map(column);
  table.variables.forEach((variable, index) => {
    if (!table.key_numbers[index]) return;
    variable.labels.forEach((label, row) => {
      const at = places.get(`${label}.${variable.name}`);
      if (at === undefined || least[at] === null) return;
      const is_least = -least[at] > largest[at] || (-least[at] === largest[at] && least_time[at] < largest_time[at]);
      table.key_numbers[index][row][key_places.largest] = is_least ? -least[at] : largest[at];
      table.key_numbers[index][row][key_places.time] = is_least ? least_time[at] : largest_time[at];
    });
  });
}

function write_transient(chapter, analysis) {
  const [table] = analysis.tables;
  take_extremes(analysis, table);
  const is_of_stops = (variable) => ["stop", "rotational_stop"].includes(variable.dimension);
  const is_of_laws = (variable) => ["law", "rotational_law"].includes(variable.dimension);
  const is_of_joints = (variable) => variable.dimension.endsWith("joint");
  const is_of_bushings = (variable) => variable.dimension === "bushing";
  const of = (names) => names.map((name) => variable_of(table, name))
    .filter((variable) => variable && variable.labels.length &&
      ![is_of_stops, is_of_laws, is_of_joints, is_of_bushings].some((belongs) => belongs(variable)));
  const those = (belongs) => table.variables.map((variable, index) => ({...variable, index}))
    .filter((variable) => variable.labels.length && belongs(variable));
  const stops = those(is_of_stops), laws = those(is_of_laws), joints = those(is_of_joints), bushings = those(is_of_bushings);
  const is_reaction = (variable) => variable.name.startsWith("reaction_");
  const sliding = joints.filter((variable) => variable.dimension === "sliding_joint");
  const reactions = joints.filter(is_reaction);
  const efforts = joints.filter((variable) => !is_reaction(variable) && !sliding.includes(variable));
  const motion = of(["position", "velocity", "acceleration"]);
  const rotations = of(["angle", "angular_velocity", "angular_acceleration"]);
  const sliders = of(["force", "slip", "displacement"]), hinges = of(["moment", "slip_angle"]);
  const ledger = analysis.tables.find((candidate) => candidate.name === "energy");
  if (table.rows === 0) {
    chapter.node.append(element("p", {class: "note"}, "It ended before its first row."));
    return;
  }
  const is_mechanism = joints.length > 0;
  if (is_mechanism) {
    write_key_numbers(chapter, table, {motion, rotations, sliders, hinges, laws, joints: {rotations, sliding, efforts}});
  }
  if (motion.length) {
    add_section(chapter, "Time histories", history_figure(table, motion, "Motion of the coordinates"));
    if (motion.length > 1) add_section(chapter, "Phase portrait", phase_portrait(table, motion[0], motion[1]));
  }
  if (rotations.length) {
    const subject = joints.length ? "Rotations of nodes and joints" : "Rotations of the nodes";
    add_section(chapter, "Rotations", history_figure(table, rotations, subject));
  }
  if (sliding.length) add_section(chapter, "Sliding joints", history_figure(table, sliding, "Travel of the joints that slide"));
  if (reactions.length) {
    add_section(chapter, "Joint reactions", history_figure(table, reactions, "What each joint does to its second part"));
  }
  if (efforts.length) {
    add_section(chapter, "Laws, friction and drives of joints", history_figure(table, efforts, "Forces and moments of laws, friction and drives"));
  }
  if (bushings.length) {
    add_section(chapter, "Bushings", history_figure(table, bushings, "What each bushing does to its second part, by its own axes"));
  }
  if (sliders.length) {
    add_section(chapter, "Sliders", history_figure(table, sliders, "Sliders: force and slip"));
    const [force] = of(["force"]);
    if (force && (variable_of(table, "slip") || variable_of(table, "displacement"))) {
      add_section(chapter, "Hysteresis loops", hysteresis_loops(table, force));
    }
  }
  const supports = of(["reaction", "reaction_moment"]);
  if (supports.length) add_section(chapter, "Moving supports", history_figure(table, supports, "Forces that move the supports"));
  if (stops.length) add_section(chapter, "Stops", history_figure(table, stops, "Stops: force and penetration"));
  if (laws.length) {
    add_section(chapter, "Laws", history_figure(table, laws, "Laws: force, displacement and what they dissipated"));
    for (const force of laws.filter((variable) => is_quantity(variable, ["force", "moment"]))) {
      add_section(chapter, is_quantity(force, ["force"]) ? "Forces over displacements" : "Moments over angles",
                  hysteresis_loops(table, force, law_displacement, "laws"));
    }
  }
  if (hinges.length === 2) {
    add_section(chapter, "Rotational sliders", history_figure(table, hinges, "Sliders between rotations: moment and slip"));
    add_section(chapter, "Moments over rotations", hysteresis_loops(table, hinges[0]));
  }
  if (ledger && ledger.rows) add_section(chapter, "Energy ledger", energy_ledger(ledger));
  if (!is_mechanism) write_key_numbers(chapter, table, {motion, rotations, sliders, hinges, laws});
}
