// Names in the drawing of a structure: of bodies, nodes and joints, beside them or where the pointer is.

const is_inner_node = (name) => /:\d+$/.test(name);

/** Nodes that move by themselves, not points that they carry. */
function own_nodes(scene) {
  return scene.names.map((_, node) => node).filter((node) => carrier_of(scene, node) === node);
}

/** What can be named: {text, more, nodes, kind}, in the middle of its nodes; the joints first. Struts and links have two ends. */
function named_places(scene) {
  const {names, types, first, second} = scene.joints;
  const ends = (joint) => (["strut", "distance"].includes(types[joint]) ? [first[joint], second[joint]] : [second[joint]]);
  return [...names.map((name, joint) => ({text: name, more: ` (${types[joint]})`, nodes: ends(joint), kind: "joint"})),
          ...own_nodes(scene).map((node) => ({text: scene.names[node], more: "", nodes: [node], kind: is_inner_node(scene.names[node]) ? "inner" : "part"}))];
}

/** What the list of nodes to trace offers: {text, node}. */
function traceable_places(scene) {
  if (scene.joints.names.length === 0) return scene.names.map((text, node) => ({text, node}));
  const {names, first, second} = scene.joints;
  const joints = names.map((name, joint) => ({text: `joint ${name}`, node: carrier_of(scene, second[joint]) >= 0 ? second[joint] : first[joint]}));
  const own = own_nodes(scene).map((node) => ({text: scene.names[node], node}));
  return [...own.filter(({text}) => !is_inner_node(text)), ...joints, ...own.filter(({text}) => is_inner_node(text))];
}

// What is named: what the pointer is at, bodies and nodes, joints, all.
const name_choices = ["where the pointer is", "of bodies and nodes", "of joints", "all"];

/** A list of what is named; without joints there are nodes alone. */
function names_chooser(scene, choose) {
  const options = scene.joints.names.length > 0 ? name_choices : [name_choices[0], "of nodes"];
  return choice_list({label: "Names", options}, choose);
}

/** Whether a place is named by a choice. */
function is_named({kind}, choice) {
  return kind !== "inner" && (choice === 3 || (choice === 1 && kind === "part") || (choice === 2 && kind === "joint"));
}

/** Places whose marks lie over each other, with their names in one text: [{text, at, kind}]. */
function grouped_places(places) {
  const groups = [];
  for (const {text, at, kind} of places) {
    const group = groups.find((other) => Math.hypot(other.at[0] - at[0], other.at[1] - at[1]) < 8);
    if (group) group.text += `, ${text}`; else groups.push({text, at, kind});
  }
  return groups;
}

/**
 * Writes names beside their places.
 * choice: of name_choices; pointer: [x, y] on the canvas, or null
 */
function draw_names(pen, scene, view, {motion, scale, places, choice, pointer, width}) {
  const at = ({nodes}) => {
    const ends = nodes.map((node) => view.project(node_position(scene, motion, scale, node)));
    return between(ends[0], ends.at(-1), 0.5);
  };
  const write = ({text, at: [x, y], kind}) => {
    const wide = pen.measureText(text).width, left = Math.max(4, Math.min(x + 9, width - wide - 4));
    pen.fillStyle = "rgba(255, 255, 255, 0.8)";
    pen.fillRect(left - 2, y - 20, wide + 4, 15);
    pen.fillStyle = kind === "part" ? scene_colors.line : scene_colors.node;
    pen.fillText(text, left, y - 8);
  };
  pen.font = "12px sans-serif";
  const named = places.filter((place) => is_named(place, choice)).slice(0, 300);
  grouped_places(named.map((place) => ({...place, at: at(place)}))).forEach(write);
  if (!pointer) return;
  let nearest = null, least = 14;
  for (const place of places) {
    const [x, y] = at(place), distance = Math.hypot(x - pointer[0], y - pointer[1]);
    if (distance < least) [nearest, least] = [place, distance];
  }
  if (nearest) write({text: nearest.text + nearest.more, at: at(nearest), kind: nearest.kind});
}
