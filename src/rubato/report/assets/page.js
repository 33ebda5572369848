// Elements, numbers and units: what every part of the page is written with.

/** An element with attributes and children; strings become text, never markup. */
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "onclick") {
      node.addEventListener("click", value);
    } else if (value !== undefined && value !== false) {
      node.setAttribute(name, value === true ? "" : value);
    }
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

/** "m/s2" as people write it: "m/s²". Pure numbers have the unit "–". */
function pretty_unit(unit) {
  if (!unit || unit === "1") return "–";
  return unit.replace(/2\b/g, "²").replace(/3\b/g, "³").replace(/\s+/g, " ");
}

/** "slider_dissipated" as a phrase: "Slider dissipated". */
function phrase(name) {
  if (name === "omega_h") return "ωh";
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** What a variable is called where it is shown. */
const variable_phrase = (variable) => phrase(variable.shown_name ?? variable.name);

/** The label of an axis or a column: "Position [m]". */
function axis_label(variable) {
  return `${variable_phrase(variable)} [${pretty_unit(variable.unit)}]`;
}

/** A number with so many significant digits, as a node; a dash where there is none. */
function number_node(value, digits = 5) {
  if (value === null || value === undefined || Number.isNaN(value)) return document.createTextNode("–");
  if (value === 0) return document.createTextNode("0");
  const minus = (text) => text.replace("-", "−");
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e6) {
    // Round numbers are shown as they are written in a study.
    const short = String(value);
    const rounded = value.toPrecision(digits);
    return document.createTextNode(minus(short.length <= digits ? short : rounded.includes("e") ? String(Number(rounded)) : rounded));
  }
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return element("span", {class: "number"}, `${minus(mantissa)} × 10`, element("sup", {}, minus(exponent.replace("+", ""))));
}

/** An integer with thin spaces between thousands. */
function count_text(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}

// Okabe and Ito's colours without the yellow, which is too light on white; then the same with other dashes.
const palette = ["#0072b2", "#d55e00", "#009e73", "#8f3f71", "#56a0d3", "#b8860b", "#000000"];
const dashes = ["solid", "dash", "dot", "dashdot"];

function line_style(index) {
  return {
    color: palette[index % palette.length],
    dash: dashes[Math.floor(index / palette.length) % dashes.length],
    width: 1.6,
  };
}

/** The variable of a table by name: {index, ...variable}, or null. */
function variable_of(table, name) {
  const index = table ? table.variables.findIndex((variable) => variable.name === name) : -1;
  return index < 0 ? null : {index, ...table.variables[index]};
}

/** "; the first 24 of 100 coordinates are shown", where labels were left out. */
function shortened(variable) {
  if (variable.label_count <= variable.labels.length) return "";
  return ` ${variable.labels.length} of ${count_text(variable.label_count)} ${variable.dimension}s are shown; ` +
    "the others are in the results file.";
}

// Sections and the table of contents that lists them.

const contents = element("ol", {});
let chapter_count = 0;

/** A numbered chapter (h2) with its entry in the table of contents; `add_section` gives it sections. */
function add_chapter(parent, title, ...intro) {
  const number = ++chapter_count;
  const id = `chapter-${number}`;
  const node = element("section", {id, class: "chapter"},
                       element("h2", {}, element("span", {class: "ordinal"}, String(number)), title), ...intro);
  const entries = element("ol", {});
  contents.append(element("li", {}, element("a", {href: `#${id}`}, title), entries));
  parent.append(node);
  return {node, entries, number, sections: 0};
}

function add_section(chapter, title, ...body) {
  const id = `section-${chapter.number}-${++chapter.sections}`;
  const heading = element("h3", {id}, element("span", {class: "ordinal"}, `${chapter.number}.${chapter.sections}`), title);
  chapter.node.append(heading, ...body.flat());
  chapter.entries.append(element("li", {}, element("a", {href: `#${id}`}, title)));
}

/**
 * netCDF keeps words without blanks: names of joints and nodes in a scene and in a table of events become again those of the
 * labels of the main table.
 */
function restore_blanks(analysis) {
  const names = new Map();
  for (const label of (analysis.tables[0]?.variables ?? []).flatMap((variable) => variable.labels)) {
    for (const name of [label, label.replace(/\.[^.]*$/, "")]) if (name.includes(" ")) names.set(name.replaceAll(" ", "_"), name);
  }
  const restored = (words) => words.map((word) => names.get(word) ?? word);
  const {scene} = analysis;
  if (scene) {
    scene.names = restored(scene.names);
    scene.joints.names = restored(scene.joints.names);
  }
  for (const table of analysis.tables.filter((candidate) => candidate.attributes.type === "events")) {
    for (const variable of table.variables) if (variable.name === "joint") variable.categories = restored(variable.categories);
  }
}
