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
  return bounding_box([...still, ...moments].flatMap((motion) => [
    ...nodes.map((node) => node_position(scene, motion, scale, node)), ...shape_corners(scene, motion, scale)]));
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

/** The number of 1, 2, 5, 10, ... and their tenths that is nearest by ratio. */
function round_ratio(ratio) {
  const power = 10 ** Math.floor(Math.log10(ratio)), gap = (candidate) => Math.abs(Math.log(candidate / ratio));
  return Number([1, 2, 5, 10].map((digit) => digit * power).reduce((a, b) => (gap(b) < gap(a) ? b : a)).toPrecision(1));
}

/** Speeds to choose from, {text, rate}: of a motion over time its seconds in one of the reader's, else a part of the whole. */
function speeds_of(moments, seconds) {
  if (!moments.duration) {
    return [1, 0.5, 0.2, 2, 5].map((speed) => ({text: speed === 1 ? "normal" : `× ${speed}`, rate: speed / seconds}));
  }
  const usual = round_ratio(moments.duration / seconds);
  const rates = [usual, ...[0.5, 0.2, 0.1, 2, 5, 10].map((factor) => round_ratio(factor * usual)), 1];
  return [...new Set(rates)].map((rate) => ({text: rate === 1 ? "real time" : `${rate} × real time`, rate}));
}

/**
 * A player of a scene.
 *
 * moments: {count, label(at), values(at)}: what is seen at a place in [0, count - 1], which need not be whole; of a motion
 * over time also {duration [s], advanced(at, seconds), held(at)}: the place so much later, and the joints whose lock holds
 * seconds: about how long the whole takes at the speed that is chosen first
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
  const state = {at: 0, scale: usual, speed: 0, is_playing: false, traced: null, last: 0, share: usual_share,
                 named: 0, pointer: null};
  const ways = ways_of(scene), places = named_places(scene), speeds = speeds_of(moments, seconds), nobody = new Set();
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
  if (moments.count > 1) {
    lists.push(choice_list({label: "Speed", options: speeds.map(({text}) => text)}, (index) => { state.speed = index; }));
  }
  const traceable = is_periodic || moments.count === 1 ? [] : traceable_places(scene).slice(0, 200);
  const trace_list = traceable.length === 0 ? null : choice_list({label: "Trace", options: ["no node", ...traceable.map(({text}) => text)]}, (index) => {
    state.traced = index > 0 ? traceable[index - 1].node : null;
    paint();
  });
  const names_list = names_chooser(scene, (index) => {
    state.named = index;
    paint();
  });

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
    const motion = node_motion(scene, moments.values(state.at));
    draw_scene(pen, scene, view, {motion, scale: scale(), width, height, ways, held: moments.held?.(state.at) ?? nobody,
                                  traces: state.traced === null ? [] : [trace_of(state.traced)]});
    draw_names(pen, scene, view, {motion, scale: scale(), places, choice: state.named, pointer: state.pointer, width});
    scrub.value = String(state.at);
    time.textContent = moments.label(state.at);
  }

  function tick(now) {
    if (!state.is_playing) return;
    const last = moments.count - 1, passed = (now - state.last) / 1000 * speeds[state.speed].rate;
    state.at = moments.advanced ? moments.advanced(state.at, passed) : state.at + passed * last;
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

  const point = (pointer) => {
    state.pointer = pointer;
    if (!state.is_playing) paint();
  };
  canvas.addEventListener("pointermove", (moved) => { if (moved.buttons === 0) point([moved.offsetX, moved.offsetY]); });
  canvas.addEventListener("pointerleave", () => point(null));
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
  const tools = element("div", {class: "tools"}, ...moving, ...lists, amplitude, trace_list, names_list);
  const save = (name) => element("a", {href: canvas.toDataURL("image/png"), download: `${name}.png`}).click();
  const figure = frame_figure({drawing: canvas, caption, tools, file_kind: "PNG", save, render: paint, height});
  return figure.node;
}
