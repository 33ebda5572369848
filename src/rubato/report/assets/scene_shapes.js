// Bodies of simple shapes: their outlines, in the plane and in space.

const circle_pieces = 64;

/** A circle about the origin in the plane of two axes: points. */
function circle_points(radius, [first, second], height = 0) {
  return Array.from({length: circle_pieces + 1}, (_, piece) => {
    const angle = 2 * Math.PI * piece / circle_pieces, point = [height, height, height];
    point[first] = radius * Math.cos(angle);
    point[second] = radius * Math.sin(angle);
    return point;
  });
}

/**
 * Polylines in the axes of the body. In the plane the first is the outline, and a radius shows how round ones turn; in
 * space they are wires.
 */
function outlines_of(kind, [a, b, c], in_space) {
  if (kind === "box") {
    const level = (z) => [[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]].map(([x, y]) => [0.5 * x, 0.5 * y, z]);
    if (!in_space) return [level(0)];
    const [low, high] = [level(-0.5 * c), level(0.5 * c)];
    return [low, high, ...[0, 1, 2, 3].map((corner) => [low[corner], high[corner]])];
  }
  const radius = 0.5 * a;
  if (!in_space) return [circle_points(radius, [0, 1]), [[0, 0, 0], [radius, 0, 0]]];
  if (kind === "sphere") return [[0, 1], [1, 2], [2, 0]].map((axes) => circle_points(radius, axes));
  const [low, high] = [-0.5 * c, 0.5 * c].map((z) => circle_points(radius, [0, 1], z));
  return [low, high, ...[0, 1, 2, 3].map((quarter) => quarter * circle_pieces / 4).map((piece) => [low[piece], high[piece]])];
}

function draw_shapes(pen, scene, view, motion, scale) {
  const {nodes, kinds, size} = scene.shapes;
  pen.strokeStyle = scene_colors.line;
  pen.fillStyle = scene_colors.shape;
  pen.lineWidth = 1.4;
  nodes.forEach((node, shape) => {
    const at = node_position(scene, motion, scale, node);
    const axes = [0, 1, 2].map((i) => carried_direction(scene, motion, scale, node, [0, 1, 2].map((j) => (i === j ? 1 : 0))));
    const place = (point) => at.map((x, i) => x + axes[0][i] * point[0] + axes[1][i] * point[1] + axes[2][i] * point[2]);
    outlines_of(kinds[shape], size.map((along) => along[shape]), view.in_space).forEach((points, which) => {
      draw_polyline(pen, points.map((point) => view.project(place(point))));
      if (!view.in_space && which === 0) pen.fill();
    });
  });
}

/** The corners of the boxes around all shapes, for the box of all that will be seen. */
function shape_corners(scene, motion, scale) {
  const {nodes, size} = scene.shapes;
  return nodes.flatMap((node, shape) => {
    const at = node_position(scene, motion, scale, node), half = size.map((along) => 0.5 * along[shape]);
    return [[1, 1], [1, -1], [-1, 1], [-1, -1]].flatMap(([x, y]) => [1, -1].map((z) => {
      const arm = carried_direction(scene, motion, scale, node, [x * half[0], y * half[1], z * half[2]]);
      return at.map((value, i) => value + arm[i]);
    }));
  });
}
