// The sections that show a structure: in motion over time, in equilibrium, and swinging in its modes.

const counted = (count, one, several = `${one}s`) => `${count_text(count)} ${count === 1 ? one : several}`;

function scene_caption(scene, what) {
  const joints = scene.joints.names.length;
  const size = joints > 0 ? `${counted(own_nodes(scene).length, "body or node", "bodies and nodes")}, ${counted(joints, "joint")}`
                          : `${counted(scene.names.length, "node")}, ${counted(scene.lines[0].length, "line")}`;
  const where = scene.rotation[0].length > 0 ? "the configuration about which it swings" : "where it stands without load";
  const rest = scene.is_absolute ? "" : ` Grey: ${where}.`;
  return `${what} (${size}).${rest}${is_in_space(scene) ? " Drag to turn it." : ""}${symbols_text(scene)}`;
}

/** The place of a time between the frames, whose times rise. */
function place_of_time(times, time) {
  let low = 0, high = times.length - 1;
  if (time >= times[high]) return high;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return low + Math.max(0, time - times[low]) / (times[high] - times[low]);
}

/** A transient: the structure over time. events: of its locks, as events_of tells. */
function motion_player(scene, events) {
  const times = scene.coordinate, last = times.length - 1;
  const split = (at) => {
    const frame = Math.min(Math.floor(at), last);
    return [frame, Math.min(frame + 1, last), at - frame];
  };
  const time_of = (at) => {
    const [first, second, share] = split(at);
    return times[first] + share * (times[second] - times[first]);
  };
  const moments = {
    count: times.length,
    values: (at) => {
      const [first, second, share] = split(at);
      return between_frames(scene, scene.values[first], scene.values[second], share);
    },
    label: (at) => `t = ${Number(time_of(at).toPrecision(4))} s`,
    duration: times[last] - times[0],
    advanced: (at, seconds) => place_of_time(times, time_of(at) + seconds),
    held: (at) => held_joints(events, time_of(at)),
  };
  return make_player({scene, moments, seconds: 8, caption: scene_caption(scene, "The structure in motion")});
}

/** A state of equilibrium. held: names of joints whose lock holds in it. */
function shape_figure(scene, held) {
  const moments = {count: 1, values: () => scene.values[0], label: () => "", held: () => held};
  return make_player({scene, moments, seconds: 1, caption: scene_caption(scene, "The structure in equilibrium")});
}

/**
 * The largest displacement of a shape over a period, of any node [1/sqrt(kg)]. Where a body turns that carries little around
 * it, so much that at the usual share it turns by half a radian.
 */
function largest_motion(scene, size, frame) {
  const parts = [scene.values, ...(scene.imaginary ? [scene.imaginary] : [])].map((all) => node_motion(scene, all[frame]));
  const carriers = new Set(scene.carrier.filter((carrier, node) => carrier !== node));
  const length = (node, first) => Math.hypot(...parts.flatMap((motion) => [...motion.subarray(6 * node + first, 6 * node + first + 3)]));
  const reach = (node) => Math.max(length(node, 0), carriers.has(node) ? 2 * usual_share * size * length(node, 3) : 0);
  return scene.names.reduce((most, _, node) => Math.max(most, reach(node)), 0);
}

/** What a mode is called in a list: its frequency and damping, or how it leaves or comes back. */
function mode_text(table, row) {
  const cell = (name) => {
    const variable = variable_of(table, name);
    return variable ? table.overview[variable.index][0][row] : null;
  };
  const short = (number) => String(Number(number.toPrecision(4)));
  const [hertz, radians, ratio, growth] = ["frequency", "angular_frequency", "damping_ratio", "eigenvalue_real"].map(cell);
  const swings = Math.abs(ratio) < 1 && radians > 0;
  const at = `${short(hertz)} Hz (${short(radians)} rad/s)`;
  if (ratio < -1e-9) return swings ? `${at}, grows as exp(${short(growth)} t)` : `leaves as exp(${short(growth)} t)`;
  if (!(radians > 0)) return "0 Hz, nothing brings it back";
  return `${at}, ${swings ? "" : "overdamped, "}damping ratio ${Number(ratio.toPrecision(3))}`;
}

/** Modes: each swings through a period, both parts of a complex shape in their phase. */
function mode_player(scene, table) {
  const limit = variable_of(table, "limit"), mode = variable_of(table, "mode");
  const cell = (variable, row) => table.overview[variable.index][0][row];
  const several = new Set(scene.rows.map((row) => cell(limit, row))).size > 1;
  const options = scene.rows.map((row) => `${several ? `${phrase(limit.categories[cell(limit, row)])}, mode` : "Mode"} ${cell(mode, row)}: ` +
    mode_text(table, row));
  const size = scene_size(scene), box = scene_box(scene), largest = scene.rows.map((_, frame) => largest_motion(scene, size, frame));
  let chosen = 0;
  const turn = (at) => 2 * Math.PI * at / 60;
  const moments = {
    count: 61,
    values: (at) => {
      const [c, s] = [Math.cos(turn(at)), Math.sin(turn(at))];
      return scene.values[chosen].map((value, i) => c * (value ?? 0) - (scene.imaginary ? s * (scene.imaginary[chosen][i] ?? 0) : 0));
    },
    label: (at) => `phase ${Math.round(6 * at)}°`,
  };
  const more = usual_share * size, flat = is_in_space(scene) ? 3 : 2;
  const shape = {
    size, scale: () => (largest[chosen] > 0 ? size / largest[chosen] : 0),
    box: {low: box.low.map((x, i) => x - (i < flat ? more : 0)), high: box.high.map((x, i) => x + (i < flat ? more : 0)),
          radius: box.radius + more},
  };
  const choosers = [{label: "Mode", options, choose: (index) => { chosen = index; }}];
  const rest = table.rows > scene.rows.length ? ` The first ${scene.rows.length} of ${count_text(table.rows)} are drawn.` : "";
  const caption = scene_caption(scene, scene.rotation[0].length > 0 ? "A mode of the mechanism" : "A mode of the structure") +
    ` The size of a mode is free: it is drawn as a small motion.${rest}`;
  return make_player({scene, moments, seconds: 2, is_periodic: true, choosers, shape, caption});
}

/** The section that shows the structure, where the results tell of one. */
function write_scene(chapter, analysis) {
  const {scene} = analysis;
  if (!scene) return;
  const modes = modes_table_of(analysis);
  if (modes) {
    if (!modes.is_envelope) add_section(chapter, "Modes in motion", mode_player(scene, modes));
  } else if (scene.coordinate.length > 1) {
    add_section(chapter, "The structure in motion", motion_player(scene, events_of(analysis)));
  } else {
    const held = analysis.tables.flatMap((table) => (table.attributes.held_locks ?? "").split("\n"));
    add_section(chapter, "The structure", shape_figure(scene, new Set(held)));
  }
}
