// A frequency response: which sections its chapter has.

function is_frequency_response(analysis) {
  const [table] = analysis.tables;
  return analysis.attributes.type === "frequency_response" && table && table.name === "" && Boolean(table.curves);
}

function write_frequency_response(chapter, analysis) {
  const of = (name) => analysis.tables.find((table) => table.name === name && table.rows > 0);
  const table = analysis.tables[0], linear = of("linear"), waveforms = of("waveforms"), bands = of("bands");
  if (table.rows === 0) {
    chapter.node.append(element("p", {class: "note"}, "It ended before its first point."));
    return;
  }
  const is_random = Boolean(bands) || /random|sample/.test(analysis.attributes.sweep ?? "");
  const statuses = statuses_of(table);
  if (statuses.length) add_section(chapter, "Points", statuses);
  const limits = has_limits(linear) ? " Dashed and dotted: the linear limits, sliders free and sliders stuck." : "";
  const sizes = variables_named(table, /^(amplitude|velocity_amplitude|acceleration_amplitude|rms|harmonic_?\d+_amplitude)$/);
  if (sizes.length) {
    const kinds = "Amplitude is half of peak to peak over a period.";
    add_section(chapter, "Responses", family_figure(table, sizes, {
      caption: `Responses in the steady state. ${kinds}${limits}`, linear, with_scale: true, height: 470}));
  }
  const turns = variables_named(table, /^(angle_amplitude|angular_velocity_amplitude|angular_acceleration_amplitude|angle_rms|angle_mean|harmonic_?\d+_angle_amplitude)$/);
  if (turns.length) {
    add_section(chapter, "Rotations", family_figure(table, turns, {
      caption: `Rotations in the steady state. Amplitude is half of peak to peak over a period.${limits}`, linear, with_scale: true, height: 470}));
  }
  if (bands) {
    const figure = bands_figure(bands, quantity_label(table, table.curves.abscissa));
    if (figure) add_section(chapter, "Percentile bands", figure);
  }
  const amplitude = variable_of(table, "amplitude");
  const map = amplitude && !is_random && map_figure(table, amplitude);
  if (map) add_section(chapter, "Map", map);
  const peaks = peaks_figures(table, is_random);
  if (peaks.length) add_section(chapter, "Largest amplitudes", peaks);
  const angles = variables_named(table, /^(phase|harmonic_?\d+_phase|mean)$/);
  if (angles.length) {
    add_section(chapter, "Phase and mean", family_figure(table, angles, {
      caption: `Phases of the harmonics, A cos(kΩt + phase), and the mean of the motion.${limits}`, linear}));
  }
  const sliders = variables_named(table, /^(slip_share|dissipated|offset|moment_offset)$/).filter((variable) => variable.dimension)
    .sort((a, b) => ["slip_share", "dissipated", "offset", "moment_offset"].indexOf(a.name) - ["slip_share", "dissipated", "offset", "moment_offset"].indexOf(b.name));
  if (sliders.length) {
    add_section(chapter, "Stick and slip", family_figure(table, sliders, {
      caption: "Sliders over a period: the share of it in which they slip, the work that friction dissipates, and the force that a slider " +
        "which never slips keeps."}));
  }
  const works = variables_named(table, /^(input_work|viscous_work|transitions|residual|error|iterations)$/).filter((variable) => !variable.dimension);
  if (works.length) {
    add_section(chapter, "Work and accuracy", family_figure(table, works, {
      caption: "Work of the loads and of viscous damping over a period, the number of transitions between stick and slip, and how well the points " +
        "were solved."}));
  }
  if (waveforms) write_waveforms(chapter, waveforms);
  write_tables(chapter, analysis.tables.filter((other) => other !== table && ![linear, waveforms, bands].includes(other)));
}
