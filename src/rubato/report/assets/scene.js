// The structure in motion: a canvas that plays, stops, and shows any moment; turned with the mouse where it is in space.

/** Displacements magnified to about a twelfth of the structure, by a round number; 1 where positions are absolute. */
function magnification(scene, size) {
  if (scene.is_absolute) return 1;
  const [, axes] = scene.places;
  let largest = 0;
  for (const values of [...scene.values, ...(scene.imaginary ?? [])]) {
    values.forEach((value, place) => { if (axes[place] < 3) largest = Math.max(largest, Math.abs(value ?? 0)); });
  }
  if (!(largest > 0) || !(size > 0)) return 1;
  const wanted = size / (12 * largest), power = 10 ** Math.floor(Math.log10(wanted));
  return [5, 2, 1].map((digit) => digit * power).find((candidate) => candidate <= wanted) ?? power;
}

const scene_box = (scene) => bounding_box(scene.names.map((_, node) => scene.position.map((axis) => axis[node])));
const scene_size = (scene) => scene_box(scene).diagonal;

/** The box of all that will be seen: every node at some of the moments. */
function seen_box(scene, scale) {
  const nodes = scene.names.map((_, node) => node);
  const step = Math.max(1, Math.floor(scene.values.length / 40));
  const moments = scene.values.filter((_, frame) => frame % step === 0).map((values) => node_motion(scene, values));
  const still = scene.is_absolute ? [] : [new Float64Array(6 * nodes.length)];
  return bounding_box([...still, ...moments].flatMap((motion) => nodes.map((node) => node_position(scene, motion, scale, node))));
}

const between = (first, second, share) => first.map((value, i) => (value ?? 0) + share * ((second[i] ?? 0) - (value ?? 0)));

/**
 * Values between two frames. A rotation vector jumps where it passes half a turn: between such frames a node stays in the
 * rotation of the nearer one, instead of spinning back.
 */
function between_frames(scene, first, second, share) {
  const values = between(first, second, share), [nodes, axes] = scene.places, jumps = new Map();
  axes.forEach((axis, place) => {
    if (axis >= 3) jumps.set(nodes[place], Math.hypot(jumps.get(nodes[place]) ?? 0, (second[place] ?? 0) - (first[place] ?? 0)));
  });
  if (!is_in_space(scene)) return values;
  return values.map((value, place) => (axes[place] >= 3 && jumps.get(nodes[place]) > Math.PI ? (share < 0.5 ? first : second)[place] : value));
}

const usual_share = 0.1;  // of a structure's size: the largest displacement of a shape

function amplitude_slider(choose) {
  const text = (share) => `${Math.round(100 * share)} % of the size`;
  const slider = element("input", {type: "range", class: "amplitude", min: "0.01", max: "0.4", step: "0.01",
                                   value: String(usual_share), "aria-label": "Amplitude"});
  const told = element("output", {}, text(usual_share));
  slider.addEventListener("input", () => {
    told.textContent = text(Number(slider.value));
    choose(Number(slider.value));
  });
  return element("label", {class: "choice"}, "Amplitude ", slider, " ", told);
}

/**
 * A player of a scene.
 *
 * moments: {count, label(at), values(at)}: what is seen at a place in [0, count - 1], which need not be whole
 * seconds: how long the whole takes at the speed that is chosen first
 * choosers: as in make_figure, besides those of the player
 * shape: of motions without a size of their own, {box, size, scale()}: how large to draw what is chosen so that its largest
 * displacement is the size of the structure; a slider says which part of that is seen
 */
function make_player({scene, moments, caption, seconds, is_periodic = false, choosers = [], shape = null}) {
  const usual = shape ? 1 : magnification(scene, scene_size(scene));
  const scales = scene.is_absolute || shape ? [1] : [...new Set([usual, 1, usual / 2, 2 * usual, 5 * usual])];
  const view = make_view(scene, shape ? shape.box : seen_box(scene, usual));
  const height = Math.round(Math.min(460, Math.max(200, 80 + 700 * view.aspect)));
  const canvas = element("canvas", {class: "scene", role: "img", "aria-label": caption, style: `height:${height}px`, tabindex: "0"});
  const state = {at: 0, scale: usual, speed: 1, is_playing: false, traced: new Set(), last: 0, share: usual_share};
  const scale = () => (shape ? state.share * shape.scale() : state.scale);

  const time = element("output", {class: "moment"});
  const scrub = element("input", {type: "range", min: "0", max: String(Math.max(1, moments.count - 1)), step: "any", value: "0", "aria-label": "Moment"});
  const play = element("button", {type: "button", class: "play", "aria-label": "Play", onclick: () => set_playing(!state.is_playing)}, "▶ Play");
  scrub.addEventListener("input", () => {
    set_playing(false);
    state.at = Number(scrub.value);
    paint();
  });
  const scale_text = (scale) => (scale === 1 ? "true to scale" : `× ${Number(scale.toPrecision(3))}`);
  const lists = [...choosers.map(({label, options, choose}) => choice_list({label, options}, (index) => {
    choose(index);
    paint();
  }))];
  if (scales.length > 1) lists.push(choice_list({label: "Displacements", options: scales.map(scale_text)}, (index) => {
    state.scale = scales[index];
    paint();
  }));
  const amplitude = shape ? amplitude_slider((share) => {
    state.share = share;
    paint();
  }) : null;
  const speeds = [1, 0.5, 0.2, 2, 5];
  lists.push(choice_list({label: "Speed", options: speeds.map((speed) => (speed === 1 ? "normal" : `× ${speed}`))}, (index) => {
    state.speed = speeds[index];
  }));
  const trace_list = is_periodic ? [] : [choice_list({label: "Trace", options: ["no node", ...scene.names.slice(0, 200)]}, (index) => {
    state.traced.clear();
    if (index > 0) state.traced.add(index - 1);
    paint();
  })];

  function trace_of(node) {
    const points = [];
    for (let frame = 0; frame <= state.at; ++frame) points.push(node_position(scene, node_motion(scene, moments.values(frame)), scale(), node));
    return points;
  }

  function paint() {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth || paper_width;
    canvas.width = Math.round(ratio * width);
    canvas.height = Math.round(ratio * height);
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    view.fit(width, height, shape ? Math.max(0, state.share - usual_share) * shape.size : 0);
    draw_scene(pen, scene, view, {motion: node_motion(scene, moments.values(state.at)), scale: scale(), width, height,
                                  traces: [...state.traced].map(trace_of)});
    scrub.value = String(state.at);
    time.textContent = moments.label(state.at);
  }

  function tick(now) {
    if (!state.is_playing) return;
    const last = moments.count - 1;
    state.at += (now - state.last) / 1000 * state.speed * last / seconds;
    state.last = now;
    if (state.at >= last) {
      if (is_periodic) {
        state.at %= last;
      } else {
        state.at = last;
        set_playing(false);
      }
    }
    paint();
    if (state.is_playing) requestAnimationFrame(tick);
  }

  function set_playing(is_playing) {
    if (is_playing && state.at >= moments.count - 1) state.at = 0;
    state.is_playing = is_playing;
    play.textContent = is_playing ? "❚❚ Pause" : "▶ Play";
    play.setAttribute("aria-label", is_playing ? "Pause" : "Play");
    state.last = performance.now();
    if (is_playing) requestAnimationFrame(tick);
  }

  canvas.addEventListener("pointerdown", (pressed) => {
    if (!view.in_space) return;
    canvas.setPointerCapture(pressed.pointerId);
    const start = {x: pressed.clientX, y: pressed.clientY, yaw: view.yaw, pitch: view.pitch};
    const turn = (moved) => {
      view.yaw = start.yaw - 0.01 * (moved.clientX - start.x);
      view.pitch = Math.max(-1.57, Math.min(1.57, start.pitch + 0.01 * (moved.clientY - start.y)));
      paint();
    };
    canvas.addEventListener("pointermove", turn);
    canvas.addEventListener("pointerup", () => canvas.removeEventListener("pointermove", turn), {once: true});
  });
  new ResizeObserver(() => { if (figure.is_drawn) paint(); }).observe(canvas);

  const moving = moments.count > 1 ? [play, scrub, time] : [];
  const tools = element("div", {class: "tools"}, ...moving, ...lists, amplitude, ...trace_list);
  const save = (name) => element("a", {href: canvas.toDataURL("image/png"), download: `${name}.png`}).click();
  const figure = frame_figure({drawing: canvas, caption, tools, file_kind: "PNG", save, render: paint, height});
  return figure.node;
}

function scene_caption(scene, what) {
  const many = scene.names.length;
  const size = `${count_text(many)} node${many === 1 ? "" : "s"}, ${count_text(scene.lines[0].length)} line${scene.lines[0].length === 1 ? "" : "s"}`;
  const where = scene.rotation[0].length > 0 ? "the configuration about which it swings" : "where it stands without load";
  const rest = scene.is_absolute ? "" : ` Grey: ${where}.`;
  return `${what} (${size}).${rest}${is_in_space(scene) ? " Drag to turn it." : ""}`;
}

/** A transient: the structure over time. */
function motion_player(scene) {
  const times = scene.coordinate, last = times.length - 1;
  const split = (at) => {
    const frame = Math.min(Math.floor(at), last);
    return [frame, Math.min(frame + 1, last), at - frame];
  };
  const moments = {
    count: times.length,
    values: (at) => {
      const [first, second, share] = split(at);
      return between_frames(scene, scene.values[first], scene.values[second], share);
    },
    label: (at) => {
      const [first, second, share] = split(at);
      return `t = ${Number((times[first] + share * (times[second] - times[first])).toPrecision(4))} s`;
    },
  };
  return make_player({scene, moments, seconds: 8, caption: scene_caption(scene, "The structure in motion")});
}

/** A state of equilibrium. */
function shape_figure(scene) {
  const moments = {count: 1, values: () => scene.values[0], label: () => ""};
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
    add_section(chapter, "The structure in motion", motion_player(scene));
  } else {
    add_section(chapter, "The structure", shape_figure(scene));
  }
}
