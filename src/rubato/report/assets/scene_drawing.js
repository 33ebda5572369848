// How a structure looks on a canvas.

const scene_colors = {reference: "#b4bcc4", line: "#0b4f7c", node: "#1c242c", support: "#6c7680", trace: "#d55e00",
                      shape: "rgba(11, 79, 124, 0.09)", paper: "#ffffff"};

function draw_polyline(pen, points) {
  pen.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  pen.stroke();
}

/** Ground under a mark: a line with strokes below, across a direction down to it. */
function draw_hatching(pen, [x, y], half) {
  draw_polyline(pen, [[x - half, y], [x + half, y]]);
  for (let at = x - half + 3; at <= x + half + 0.1; at += 4) draw_polyline(pen, [[at, y], [at - 4, y + 5]]);
}

/** A mark under a supported node: a triangle over the ground; a block where it is clamped; open where it is held in part. */
function draw_support(pen, [x, y], kind) {
  const size = 9;
  pen.beginPath();
  if (kind === "clamped") {
    pen.rect(x - 0.7 * size, y + 2, 1.4 * size, size - 2);
  } else {
    pen.moveTo(x, y);
    pen.lineTo(x - 0.7 * size, y + size);
    pen.lineTo(x + 0.7 * size, y + size);
    pen.closePath();
  }
  if (kind === "held") pen.stroke(); else pen.fill();
  pen.lineWidth = 1;
  draw_hatching(pen, [x, y + size], size);
}

/** A length that a person would choose for a scale bar of about so many pixels. */
function round_length(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return [5, 2, 1].map((digit) => digit * power).find((candidate) => candidate <= length) ?? power;
}

function draw_scale_bar(pen, view, height) {
  const length = round_length(110 / view.pixels), pixels = length * view.pixels;
  pen.strokeStyle = pen.fillStyle = scene_colors.node;
  pen.lineWidth = 1;
  draw_polyline(pen, [[14, height - 18], [14, height - 13], [14 + pixels, height - 13], [14 + pixels, height - 18]]);
  pen.fillText(`${Number(length.toPrecision(2))} m`, 14 + pixels + 6, height - 11);
}

/** The axes x, y, z of the world in a corner. */
function draw_axes(pen, view, width, height) {
  const [x, y] = [width - 46, height - 40], length = 26;
  pen.strokeStyle = pen.fillStyle = scene_colors.support;
  pen.lineWidth = 1.2;
  ["x", "y", "z"].forEach((name, i) => {
    const [dx, dy] = view.direct([0, 1, 2].map((axis) => (axis === i ? 1 : 0)));
    draw_polyline(pen, [[x, y], [x + length * dx, y + length * dy]]);
    pen.fillText(name, x + (length + 9) * dx - 3, y + (length + 9) * dy + 4);
  });
}

/** Lines of bodies that have a shape are thin: the shape tells how large the body is. */
function line_width(scene, line, shaped) {
  if (scene.kinds[line] !== "body") return 2.2;
  return shaped.has(carrier_of(scene, scene.lines[0][line])) ? 0.8 : 4.5;
}

function draw_lines(pen, scene, view, motion, scale) {
  const shaped = new Set(scene.shapes.nodes), has_joints = scene.joints.names.length > 0;
  pen.strokeStyle = scene_colors.line;
  scene.lines[0].forEach((_, line) => {
    if (has_joints && scene.kinds[line] === "strut") return;  // their symbols stand there
    pen.lineWidth = line_width(scene, line, shaped);
    draw_polyline(pen, line_points(scene, motion, scale, line).map(view.project));
  });
}

/** Dots at nodes; of a mechanism not at the points of joints, which have symbols. */
function draw_nodes(pen, scene, view, motion, scale) {
  if (scene.names.length > 200) return;
  pen.fillStyle = scene_colors.node;
  scene.names.forEach((_, node) => {
    if (scene.joints.names.length > 0 && carrier_of(scene, node) !== node) return;
    const [x, y] = view.project(node_position(scene, motion, scale, node));
    pen.beginPath();
    pen.arc(x, y, 2.4, 0, 2 * Math.PI);
    pen.fill();
  });
}

/**
 * Draws the structure: where it was, thin and grey, where it is, supports, joints, and the way that some nodes have gone.
 * ways: of joints that slide, as ways_of tells; held: names of joints whose lock holds.
 */
function draw_scene(pen, scene, view, {motion, scale, traces, ways, held, width, height}) {
  pen.clearRect(0, 0, width, height);
  pen.fillStyle = scene_colors.paper;
  pen.fillRect(0, 0, width, height);
  pen.lineJoin = "round";
  pen.font = "12px sans-serif";
  if (!scene.is_absolute) {
    pen.strokeStyle = scene_colors.reference;
    pen.lineWidth = 1;
    const rest = new Float64Array(motion.length);
    scene.lines[0].forEach((_, line) => draw_polyline(pen, line_points(scene, rest, 0, line).map(view.project)));
  }
  pen.strokeStyle = scene_colors.trace;
  pen.lineWidth = 1.2;
  for (const trace of traces) draw_polyline(pen, trace.map(view.project));
  draw_shapes(pen, scene, view, motion, scale);
  draw_lines(pen, scene, view, motion, scale);
  const guided = guides_on_ground(scene);
  (scene.support ?? []).forEach((kind, node) => {
    if (kind === "free" || guided.has(node)) return;
    pen.fillStyle = pen.strokeStyle = scene_colors.support;
    pen.lineWidth = 1.2;
    draw_support(pen, view.project(node_position(scene, motion, scale, node)), kind);
  });
  draw_nodes(pen, scene, view, motion, scale);
  draw_joints(pen, scene, view, {motion, scale, ways, held});
  draw_scale_bar(pen, view, height);
  if (view.in_space) draw_axes(pen, view, width, height);
}
