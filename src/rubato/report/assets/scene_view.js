// A structure at a moment: where its nodes and lines are, and where a view shows them.

/** A vector turned by a rotation vector, about its direction by its length. */
function turned_by(turn, vector) {
  const angle = Math.hypot(...turn);
  if (angle === 0) return vector;
  const [x, y, z] = turn.map((component) => component / angle), [a, b, c] = vector;
  const along = (1 - Math.cos(angle)) * (x * a + y * b + z * c), [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [cos * a + sin * (y * c - z * b) + along * x, cos * b + sin * (z * a - x * c) + along * y,
          cos * c + sin * (x * b - y * a) + along * z];
}

const crossed = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];

/**
 * Motion of every node, six numbers each: displacements (or positions) along x, y, z and rotations about them. Shapes are
 * small motions: rotations are vectors, told in the axes of the nodes where those are turned, and what a node carries moves
 * by their cross product with its arm, so that joints stay closed however large a shape is drawn.
 */
function node_motion(scene, values) {
  const motion = new Float64Array(6 * scene.names.length);
  if (scene.is_absolute) {
    scene.names.forEach((_, node) => scene.position.forEach((axis, i) => { motion[6 * node + i] = axis[node]; }));
  }
  const [nodes, axes] = scene.places;
  values.forEach((value, place) => { motion[6 * nodes[place] + axes[place]] = value ?? 0; });
  if (scene.rotation[0].length > 0) {
    scene.names.forEach((_, node) => {
      const turn = turned_by(scene.rotation.map((axis) => axis[node] ?? 0), motion.subarray(6 * node + 3, 6 * node + 6));
      motion.set(turn, 6 * node + 3);
    });
  }
  scene.carrier.forEach((carrier, node) => {  // points that move with a node
    if (carrier === node || carrier < 0) return;
    const turn = [3, 4, 5].map((i) => motion[6 * carrier + i]);
    const moved = scene.is_absolute ? turned_by(turn, scene.offset.map((axis) => axis[node] ?? 0))
                                    : crossed(turn, scene.position.map((axis) => axis[node] - axis[carrier]));
    moved.forEach((x, i) => { motion[6 * node + i] = motion[6 * carrier + i] + x; });
  });
  return motion;
}

/** The node that carries a point; -1: the ground. */
const carrier_of = (scene, node) => scene.carrier[node] ?? node;

/** A direction in the axes of a node or of what carries it, by the axes of the world. */
function carried_direction(scene, motion, scale, node, direction) {
  const carrier = carrier_of(scene, node);
  if (carrier < 0) return direction;
  const turn = [3, 4, 5].map((i) => motion[6 * carrier + i]);
  if (scene.is_absolute) return turned_by(turn, direction);
  const rest = turned_by(scene.rotation.map((axis) => axis[carrier] ?? 0), direction), more = crossed(turn, rest);
  return rest.map((x, i) => x + scale * more[i]);
}

/** Where a node is: its reference position and `scale` times its displacement. */
function node_position(scene, motion, scale, node) {
  const moved = [0, 1, 2].map((i) => motion[6 * node + i]);
  return scene.is_absolute ? moved : moved.map((u, i) => scene.position[i][node] + scale * u);
}

/**
 * Points along a line in the deformed structure. Displacements go along it with the rotations of its ends as slopes, as
 * in a beam; without rotations, where positions are absolute, and of bodies and links it is straight.
 */
function line_points(scene, motion, scale, line) {
  const [a, b] = [scene.lines[0][line], scene.lines[1][line]];
  const ends = [node_position(scene, motion, scale, a), node_position(scene, motion, scale, b)];
  const turns = (node) => [3, 4, 5].map((i) => motion[6 * node + i]);
  const [ta, tb] = [turns(a), turns(b)];
  const is_straight = scene.is_absolute || (scene.kinds.length > 0 && scene.kinds[line] !== "beam");
  if (is_straight || ![...ta, ...tb].some((turn) => turn !== 0)) return ends;
  const axis = [0, 1, 2].map((i) => scene.position[i][b] - scene.position[i][a]);
  const squared = axis.reduce((sum, x) => sum + x * x, 0);
  const stretch = [0, 1, 2].reduce((sum, i) => sum + (motion[6 * b + i] - motion[6 * a + i]) * axis[i], 0) / squared;
  const [sa, sb] = [crossed(ta, axis), crossed(tb, axis)].map((slope) => slope.map((s, i) => s + stretch * axis[i]));
  const pieces = 8, points = [];
  for (let piece = 0; piece <= pieces; ++piece) {
    const x = piece / pieces, x2 = x * x, x3 = x2 * x;
    points.push([0, 1, 2].map((i) => scene.position[i][a] + x * axis[i] + scale * (
      (1 - 3 * x2 + 2 * x3) * motion[6 * a + i] + (x - 2 * x2 + x3) * sa[i] +
      (3 * x2 - 2 * x3) * motion[6 * b + i] + (x3 - x2) * sb[i])));
  }
  return points;
}

/** Smallest and largest of each coordinate over points, and how far from the middle they reach. */
function bounding_box(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    for (let i = 0; i < 3; ++i) {
      low[i] = Math.min(low[i], point[i]);
      high[i] = Math.max(high[i], point[i]);
    }
  }
  const centre = low.map((x, i) => 0.5 * (x + high[i]));
  const radius = points.reduce((most, point) => Math.max(most, Math.hypot(...point.map((x, i) => x - centre[i]))), 0);
  return {low, high, radius, diagonal: Math.hypot(...high.map((x, i) => x - low[i]))};
}

const is_in_space = (scene) => scene.position[2].some((z) => z !== 0) || scene.places[1].includes(2);

/** A view of points: x to the right and y up in the plane; in space z up, from a direction that may be turned. */
function make_view(scene, box) {
  const centre = box.low.map((x, i) => 0.5 * (x + box.high[i]));
  const view = {in_space: is_in_space(scene), yaw: 0.6, pitch: 0.35, pixels: 1, origin: [0, 0]};
  const turned = (point) => {
    const [x, y, z] = point.map((value, i) => value - centre[i]);
    if (!view.in_space) return [x, y];
    const [c, s] = [Math.cos(view.yaw), Math.sin(view.yaw)], depth = c * y - s * x;
    return [c * x + s * y, Math.cos(view.pitch) * z + Math.sin(view.pitch) * depth];
  };
  const half = view.in_space ? [box.radius, box.radius] : [0, 1].map((i) => 0.5 * (box.high[i] - box.low[i]));
  view.aspect = Math.max(half[1], 0.15 * half[0]) / Math.max(half[0], 0.15 * half[1], 1e-300);
  /** Fits the box, with so much more to each side [m], into a canvas of so many pixels. */
  view.fit = (width, height, more = 0) => {
    const margin = 34, [wide, high] = half.map((length) => Math.max(2 * (length + more), 1e-300));
    view.pixels = Math.min((width - 2 * margin) / wide, (height - 2 * margin) / high);
    view.origin = [0.5 * width, 0.5 * height];
  };
  view.project = (point) => {
    const [x, y] = turned(point);
    return [view.origin[0] + view.pixels * x, view.origin[1] - view.pixels * y];
  };
  /** A direction of the world on the canvas, in pixels: of length 1 where it lies in the plane of the picture. */
  view.direct = (direction) => {
    const [x, y] = turned(direction.map((x, i) => x + centre[i]));
    return [x, -y];
  };
  return view;
}
