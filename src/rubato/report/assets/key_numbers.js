// Key numbers of a transient: of coordinates and sliders, of joints their reactions and what moves them.

// The places of the key numbers of a label.
const key_places = {largest: 0, rms: 1, late: 2, time: 3, last: 4};
function key_number(table, variable, row, name) {
  const value = table.key_numbers[variable.index][row][key_places[name]];
  return number_node(name !== "time" && value !== null && Math.abs(value) < round_off * largest_of(table, variable) ? 0 : value, 4);
}

// Beside the largest number of its quantity what is smaller is nothing.
const round_off = 1e-12;
function largest_of(table, {index}) {
  return table.key_numbers[index].reduce((most, row) => Math.max(most, row[key_places.largest] ?? 0), 0);
}

/** A row a label, three columns a quantity; nodes inside beams are left out. */
function key_numbers(table, variables, caption) {
  const columns = [{title: phrase(variables[0].dimension), is_text: true}];
  const groups = [{title: "", span: 1}];
  for (const variable of variables) {
    groups.push({title: axis_label(variable), span: 3});
    columns.push({title: "max"}, {title: "rms"}, {title: "late"});
  }
  const rows = shown_places(variables[0], false).map((row) => [
    variables[0].labels[row], ...variables.flatMap((variable) => ["largest", "rms", "late"].map((name) => key_number(table, variable, row, name))),
  ]);
  const inner = has_inner_labels(variables[0]) ? " Nodes inside beams are left out." : "";
  return make_table({caption: caption + shortened(variables[0]) + inner, columns, groups, rows});
}

/** The largest reactions of all joints. */
function reaction_numbers({count, joints}) {
  const has_moments = joints.some((joint) => joint.moment > 0);
  const all = count > joints.length ? ` The ${joints.length} largest of ${count_text(count)}; the others are in the results file.` : "";
  return make_table({
    caption: "Largest reactions of the joints: norms of the force and of the moment that a joint makes on its second part, and when. All " +
      `rows count.${all}`,
    columns: [{title: "Joint", is_text: true}, {title: "Force [N]"}, {title: "at [s]"},
              ...(has_moments ? [{title: "Moment [N m]"}, {title: "at [s]"}] : [])],
    rows: joints.map(({name, is_of_lock, force, force_time, moment, moment_time}) => [
      is_of_lock ? `${name}, its lock` : name, number_node(force, 4), number_node(force_time, 5),
      ...(has_moments ? [number_node(moment, 4), number_node(moment_time, 5)] : []),
    ]),
  });
}

/** What drives, laws and friction give: a row a joint and quantity. */
function effort_numbers(table, efforts) {
  return make_table({
    caption: "Drives, laws and friction of the joints: the largest absolute value, when, and the root mean square over time.",
    columns: [{title: "Joint", is_text: true}, {title: "Quantity", is_text: true}, {title: "max"}, {title: "at [s]"}, {title: "rms"}, {title: "at the end"}],
    rows: efforts.flatMap((variable) => variable.labels.map((label, row) => [
      label, axis_label(variable), ...["largest", "time", "rms", "last"].map((name) => key_number(table, variable, row, name)),
    ])),
  });
}

/** Where joints are at the end and at most: angles with their speeds, displacements. */
function joint_numbers(table, [first, ...rates], places, caption) {
  const columns = [{title: "Joint", is_text: true}], groups = [{title: "", span: 1}];
  for (const variable of [first, ...rates]) {
    groups.push({title: axis_label(variable), span: 3});
    columns.push({title: "at the end"}, {title: "max"}, {title: "at [s]"});
  }
  return make_table({
    caption, columns, groups,
    rows: places.map((row) => [first.labels[row], ...[first, ...rates].flatMap((variable) => ["last", "largest", "time"].map(
      (name) => key_number(table, variable, row, name)))]),
  });
}

/** Of a mechanism, the tables of its joints: the loads that they are designed for, and where they go. */
function joint_tables(table, {rotations, sliding, efforts}) {
  const tables = [];
  if (efforts.length) tables.push(effort_numbers(table, efforts));
  if (table.reactions) tables.push(reaction_numbers(table.reactions));
  const meaning = " at the end, and the largest absolute value with its time.";
  const [angle, speed] = rotations;
  if (angle && speed) {
    const places = angle.labels.flatMap((label, place) => (/\.(rx|ry|rz)$/.test(label) ? [] : [place]));
    if (places.length) tables.push(joint_numbers(table, [angle, speed], places, `Angles of the joints and their speeds${meaning}`));
  }
  for (const variable of sliding) {
    tables.push(joint_numbers(table, [variable], variable.labels.map((_, place) => place), `Travel of the joints that slide${meaning}`));
  }
  return tables;
}

function write_key_numbers(chapter, table, {motion, rotations, sliders, hinges, laws = [], joints = null}) {
  if (!table.key_numbers) return;
  const meaning = " max: largest absolute value; rms: root mean square over time; late: half of peak to peak over the " +
    "last tenth of the duration. Every step counts for max, every row for the others.";
  const numbers = joints ? joint_tables(table, joints) : [];
  if (motion.length) numbers.push(key_numbers(table, motion, `Motion of the coordinates.${meaning}`));
  if (rotations.length) numbers.push(key_numbers(table, rotations, `Rotations of the nodes${joints ? " and joints" : ""}.${meaning}`));
  if (sliders.length) numbers.push(key_numbers(table, sliders, `Motion and force of the sliders.${meaning}`));
  if (hinges.length) numbers.push(key_numbers(table, hinges, `Moment and slip of the sliders between rotations.${meaning}`));
  for (const dimension of ["law", "rotational_law"]) {
    const seen = laws.filter((variable) => variable.dimension === dimension);
    if (seen.length) numbers.push(key_numbers(table, seen, `Force, displacement and dissipation of the laws.${meaning}`));
  }
  if (numbers.length) add_section(chapter, "Key numbers", numbers);
}
