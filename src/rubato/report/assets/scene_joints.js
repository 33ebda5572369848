// Symbols of joints: pins as circles, guides as lines along their axes, struts as springs or cylinders.

const joint_colors = {ink: "#1c242c", paper: "#ffffff", held: "#d55e00"};
const sliding_types = ["prismatic", "cylindrical", "screw"];

const joint_axis = (scene, joint) => scene.joints.axis.map((axis) => axis[joint]);

/** Where the points of a joint are. */
function joint_ends(scene, motion, scale, joint) {
  return [scene.joints.first[joint], scene.joints.second[joint]].map((node) => node_position(scene, motion, scale, node));
}

/** Ground points from which a guide starts: the guide is hatched instead. */
function guides_on_ground(scene) {
  const {types, first} = scene.joints;
  return new Set(first.filter((node, joint) => sliding_types.includes(types[joint]) && carrier_of(scene, node) < 0));
}

/** How far each joint that slides goes along its axis, from its first point [m]: [least, most], over some of the frames. */
function ways_of(scene) {
  const {types} = scene.joints, step = Math.max(1, Math.floor(scene.values.length / 40)), ways = new Map();
  types.forEach((type, joint) => { if (sliding_types.includes(type)) ways.set(joint, [0, 0]); });
  if (ways.size === 0 || !scene.is_absolute) return ways;
  scene.values.filter((_, frame) => frame % step === 0).forEach((values) => {
    const motion = node_motion(scene, values);
    ways.forEach((way, joint) => {
      const [from, to] = joint_ends(scene, motion, 1, joint);
      const axis = carried_direction(scene, motion, 1, scene.joints.first[joint], joint_axis(scene, joint));
      const along = axis.reduce((sum, x, i) => sum + x * (to[i] - from[i]), 0);
      way[0] = Math.min(way[0], along);
      way[1] = Math.max(way[1], along);
    });
  });
  return ways;
}

/** Symbols shrink where there are many. */
const symbol_size = (count) => (count > 400 ? 1.8 : count > 120 ? 2.6 : count > 40 ? 3.5 : 5);

function draw_circle(pen, [x, y], radius, fill) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.stroke();
}

/** A box about a point, along a direction of the canvas. */
function draw_box(pen, [x, y], [dx, dy], length, width, fill) {
  const [ax, ay, bx, by] = [0.5 * length * dx, 0.5 * length * dy, -0.5 * width * dy, 0.5 * width * dx];
  pen.beginPath();
  pen.moveTo(x + ax + bx, y + ay + by);
  pen.lineTo(x - ax + bx, y - ay + by);
  pen.lineTo(x - ax - bx, y - ay - by);
  pen.lineTo(x + ax - bx, y + ay - by);
  pen.closePath();
  pen.fillStyle = fill;
  pen.fill();
  pen.stroke();
}

/** Points between two points at shares of the way and distances across it [pixels]. */
function points_along([x1, y1], [x2, y2], places) {
  const [dx, dy] = [x2 - x1, y2 - y1], length = Math.hypot(dx, dy) || 1;
  return places.map(([share, across]) => [x1 + share * dx - across * dy / length, y1 + share * dy + across * dx / length]);
}

function draw_strut(pen, ends, law, size) {
  const half = 1.2 * size;
  pen.lineWidth = 1.3;
  if (law === "none") {
    pen.setLineDash([5, 4]);
    draw_polyline(pen, ends);
    pen.setLineDash([]);
  } else if (law === "spring") {
    const length = Math.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]), count = length < 60 ? 6 : length < 150 ? 10 : 16;
    const teeth = Array.from({length: count}, (_, i) => [0.2 + 0.6 * (i + 0.5) / count, i % 2 ? half : -half]);
    draw_polyline(pen, points_along(...ends, [[0, 0], [0.2, 0], ...teeth, [0.8, 0], [1, 0]]));
  } else {  // a cylinder with its rod; open where it only damps
    const body = points_along(...ends, [[0.15, -half], [0.6, -half], [0.6, half], [0.15, half], [0.15, -half]]);
    if (law === "damper") body.splice(0, body.length, ...points_along(...ends, [[0.65, -half], [0.25, -half], [0.25, half], [0.65, half]]));
    draw_polyline(pen, points_along(...ends, [[0, 0], [law === "damper" ? 0.25 : 0.15, 0]]));
    draw_polyline(pen, body);
    draw_polyline(pen, points_along(...ends, [[0.45, -half], [0.45, half]]));
    draw_polyline(pen, points_along(...ends, [[0.45, 0], [1, 0]]));
  }
  for (const end of ends) draw_circle(pen, end, 0.5 * size, joint_colors.paper);
}

/** The line along which a joint slides, hatched where the ground carries it, and the box on it. */
function draw_slider(pen, view, {from, at, axis, way, type, size, on_ground}) {
  const more = 10 / view.pixels;
  const ends = [way[0] - more, way[1] + more].map((along) => view.project(from.map((x, i) => x + along * axis[i])));
  const direction = view.direct(axis), length = Math.hypot(...direction);
  pen.lineWidth = 1.6;
  draw_polyline(pen, ends);
  if (on_ground) {
    const count = Math.max(3, Math.round(Math.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]) / 6));
    pen.lineWidth = 0.8;
    for (let i = 0; i <= count; ++i) draw_polyline(pen, points_along(...ends, [[i / count, 2], [i / count - 0.5 / count, 8]]));
  }
  pen.lineWidth = 1.4;
  const along = length > 1e-6 ? direction.map((x) => x / length) : [1, 0];
  draw_box(pen, view.project(at), along, (1 + 1.6 * length) * size, 1.8 * size, joint_colors.paper);
  if (type !== "prismatic") draw_circle(pen, view.project(at), 0.45 * size, type === "screw" ? joint_colors.ink : joint_colors.paper);
}

/** The plane across an axis, as a square about a point. */
function draw_plane(pen, view, at, axis, size) {
  const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
  const first = crossed(axis, [0, 1, 2].map((i) => (i === least ? 1 : 0))), second = crossed(axis, first);
  const half = 2 * size / view.pixels;
  const corner = ([a, b]) => view.project(at.map((x, i) => x + half * (a * first[i] + b * second[i])));
  draw_polyline(pen, [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(corner));
}

/** Round the symbol: an arrow where a drive or a force acts, a coil for a spring. */
function draw_law(pen, [x, y], law, size) {
  if (law === "none" || law === "damper" || size < 3) return;
  pen.lineWidth = 1.1;
  const reach = 2 * size;
  if (law === "spring") {
    const turns = Array.from({length: 25}, (_, i) => [1.1 * size + 0.9 * size * i / 24, i * Math.PI / 8]);
    draw_polyline(pen, turns.map(([radius, angle]) => [x + radius * Math.cos(angle), y - radius * Math.sin(angle)]));
    return;
  }
  pen.beginPath();
  pen.arc(x, y, reach, -0.2 * Math.PI, -1.1 * Math.PI, true);
  pen.stroke();
  const [tip_x, tip_y] = [x + reach * Math.cos(1.1 * Math.PI), y - reach * Math.sin(1.1 * Math.PI)];
  draw_polyline(pen, [[tip_x - 3.5, tip_y - 3.5], [tip_x, tip_y], [tip_x + 4, tip_y - 3.5]]);
}

/** Beside the symbol: a square for a stop, a diamond for a latch, filled while it holds. */
function draw_limit(pen, [x, y], limit, is_held, size) {
  if (limit === "none") return;
  const [cx, cy] = [x + 1.9 * size, y + 1.9 * size], diagonal = Math.SQRT1_2;
  pen.lineWidth = 1.3;
  pen.strokeStyle = joint_colors.held;
  draw_box(pen, [cx, cy], limit === "latch" ? [diagonal, diagonal] : [1, 0], 1.4 * size, 1.4 * size,
           is_held ? joint_colors.held : joint_colors.paper);
  pen.strokeStyle = joint_colors.ink;
}

function draw_joint(pen, scene, view, {motion, scale, ways, held}, joint, size) {
  const {names, types, laws, limits, first} = scene.joints, type = types[joint];
  const [from, at] = joint_ends(scene, motion, scale, joint), point = view.project(at);
  const axis = carried_direction(scene, motion, scale, first[joint], joint_axis(scene, joint));
  pen.strokeStyle = joint_colors.ink;
  pen.lineWidth = 1.4;
  if (type === "strut") {
    draw_strut(pen, [view.project(from), point], laws[joint], size);
  } else if (type === "distance") {
    for (const end of [view.project(from), point]) draw_circle(pen, end, 0.6 * size, joint_colors.paper);
  } else if (sliding_types.includes(type)) {
    draw_slider(pen, view, {from, at, axis, way: ways.get(joint) ?? [0, 0], type, size, on_ground: carrier_of(scene, first[joint]) < 0});
  } else if (type === "rigid") {
    draw_box(pen, point, [1, 0], 1.5 * size, 1.5 * size, joint_colors.ink);
  } else {
    if (type === "planar") draw_plane(pen, view, at, axis, size);
    const reach = 2.2 * size / view.pixels;
    if (type === "revolute" && view.in_space) {
      draw_polyline(pen, [-reach, reach].map((along) => view.project(at.map((x, i) => x + along * axis[i]))));
    }
    draw_circle(pen, point, type === "planar" ? 0.5 * size : size, joint_colors.paper);
    if (type === "spherical") draw_circle(pen, point, 0.45 * size, joint_colors.ink);
    if (type === "universal") {
      const [x, y] = point;
      draw_polyline(pen, [[x - size, y], [x + size, y]]);
      draw_polyline(pen, [[x, y - size], [x, y + size]]);
    }
  }
  if (type !== "strut") draw_law(pen, point, laws[joint], size);
  draw_limit(pen, type === "strut" ? view.project(between(from, at, 0.5)) : point, limits[joint], held.has(names[joint]), size);
}

function draw_joints(pen, scene, view, moment) {
  const {names} = scene.joints, size = symbol_size(names.length);
  names.forEach((_, joint) => draw_joint(pen, scene, view, moment, joint, size));
}

/** What the symbols that occur mean, in words. */
function symbols_text(scene) {
  const {types, laws, limits} = scene.joints;
  const has = (list, ...words) => words.some((word) => list.includes(word));
  const struts = laws.filter((_, joint) => types[joint] === "strut");
  const words = [
    has(types, "revolute") && "circles are pins", has(types, "spherical") && "circles with a dot are ball joints",
    has(types, "universal") && "circles with a cross are universal joints",
    has(types, ...sliding_types) && "boxes slide on the lines through them", has(types, "planar") && "dots slide on squares",
    has(types, "rigid") && "filled squares are rigid joints", has(types, "distance") && "lines with small circles at their ends are rigid links",
    has(struts, "spring") && "zigzags are springs", has(struts, "drive", "force", "damper") && "cylinders are struts",
    laws.some((law, joint) => ["drive", "force"].includes(law) && types[joint] !== "strut") && "an arrow around a joint is a drive or a law",
    laws.some((law, joint) => law === "spring" && types[joint] !== "strut") && "a coil around a joint is its spring",
    has(limits, "stop") && "an orange square beside a joint is its stop", has(limits, "latch") && (has(limits, "stop") ? "an orange diamond its latch" : "an orange diamond beside a joint is its latch"),
  ].filter((text) => text);
  if (words.length === 0) return "";
  const filled = has(limits, "stop", "latch") ? ", filled while it holds" : "";
  return ` ${phrase(words.join(", "))}${filled}.`;
}
