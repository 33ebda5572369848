// Numbered figures: drawn when they come into view, and all of them before printing.

const figures = [];
let figure_count = 0;

// The width that A4 with the margins of style.css leaves, in CSS pixels.
const paper_width = 672;
const paper_gap = 16;

const axis_style = {
  showline: true, mirror: true, linecolor: "#3c4650", linewidth: 1, ticks: "inside", tickcolor: "#3c4650", ticklen: 5,
  gridcolor: "#e4e8ec", zeroline: true, zerolinecolor: "#b4bcc4", zerolinewidth: 1, exponentformat: "power",
  hoverformat: ".5~g", automargin: true,
};

/** Text as plotly.js shows it: it takes tags in names for markup. */
function plot_text(text) {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
}

function axis(title, more = {}) {
  return {...axis_style, title: {text: plot_text(title), standoff: 8, font: {size: 14}}, ...more};
}

/** A range with a margin around columns of numbers, so that closed curves do not touch the frame. */
function padded_range(columns) {
  let low = Infinity, high = -Infinity;
  for (const column of columns) {
    for (const value of column) {
      if (value === null) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  const margin = 0.06 * (high - low) || 1;
  return low <= high ? [low - margin, high + margin] : undefined;
}

const logarithmic = {type: "log", dtick: 1, zeroline: false, minor: {ticks: "inside", ticklen: 3}};

function complete_layout(layout, height, is_small) {
  return {
    height, autosize: true, paper_bgcolor: "#ffffff", plot_bgcolor: "#ffffff", hovermode: "closest",
    font: {family: "inherit", size: is_small ? 12 : 13, color: "#1c242c"},
    margin: {l: 64, r: 16, t: is_small ? 54 : 36, b: 48},
    legend: is_small ? {orientation: "h", x: 0, y: 1.02, yanchor: "bottom"}
                     : {x: 1.01, xanchor: "left", y: 1, bordercolor: "#d4dae0", borderwidth: 0, font: {size: 12}},
    hoverlabel: {bgcolor: "#ffffff", bordercolor: "#6c7680", font: {color: "#1c242c"}},
    modebar: {bgcolor: "rgba(0,0,0,0)", color: "#8c96a0", activecolor: "#1c242c"},
    ...layout,
  };
}

/** Whether options are too many, or too long, for a row of buttons. */
function is_long_choice({options}) {
  return options.length > 7 || options.reduce((length, option) => length + option.length, 0) > 90;
}

function choice_buttons(chooser, choose) {
  return element("div", {class: "chooser", role: "group", "aria-label": chooser.label}, chooser.options.map((option, index) => element(
    "button", {type: "button", "aria-pressed": String(index === 0), onclick: (event) => {
      for (const button of event.target.parentNode.children) {
        button.setAttribute("aria-pressed", String(button === event.target));
      }
      choose(index);
    }}, option)));
}

function choice_list(chooser, choose) {
  const list = element("select", {"aria-label": chooser.label}, chooser.options.map((option, index) => element(
    "option", {value: String(index)}, option)));
  list.addEventListener("change", () => choose(list.selectedIndex));
  return element("label", {class: "choice"}, `${chooser.label} `, list);
}

/**
 * The frame of a numbered figure: tools, the drawing, its caption and a button that saves it.
 *
 * render: draws; it is given {width, height, autosize} before printing and nothing otherwise.
 */
function frame_figure({drawing, caption, tools, file_kind, save, render, height, is_small = false}) {
  const number = ++figure_count;
  const title = `Download figure ${number} as ${file_kind}`;
  const button = element("button", {type: "button", class: "save", title, "aria-label": title,
                                    onclick: () => save(`figure-${number}`)}, `Download ${file_kind}`);
  const figure = {height, is_small, is_drawn: false};
  figure.node = element("figure", {id: `figure-${number}`}, tools, drawing, element(
    "figcaption", {}, element("span", {}, element("b", {}, `Figure ${number}. `), caption), button));
  figure.render = (size = {}) => {
    figure.is_drawn = true;
    return render(size);
  };
  figures.push(figure);
  return figure;
}

/** Lines through all of their points: Plotly would leave out those on nearly straight ways, and smooth curves show corners. */
function with_every_point(traces) {
  return traces.map((trace) => (trace.type === "scatter" ? {...trace, line: {...trace.line, simplify: false}} : trace));
}

/**
 * A figure with axes.
 *
 * choosers: [{label, options: [text, ...]}]: rows of buttons, or a list to choose from where there are many; draw(chosen)
 * is given the index chosen in each.
 * draw: returns {traces, layout}.
 * is_small: half the width of the page.
 */
function make_figure({caption, draw, choosers = [], height = 380, is_small = false}) {
  const chosen = choosers.map(() => 0);
  const drawing = element("div", {class: "plot", role: "img", "aria-label": caption, style: `height:${height}px`});
  const tools = choosers.length === 0 ? null : element("div", {class: "tools"}, choosers.map((chooser, which) => {
    const choose = (index) => {
      chosen[which] = index;
      figure.render();
    };
    return is_long_choice(chooser) ? choice_list(chooser, choose) : choice_buttons(chooser, choose);
  }));

  function render(size) {
    const {traces, layout} = draw(chosen);
    drawing.style.height = `${size.height ?? height}px`;
    const config = {
      responsive: true, displaylogo: false, displayModeBar: "hover", doubleClick: "reset",
      modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d", "toImage", "sendChartToCloud"],
    };
    return Plotly.react(drawing, with_every_point(traces), {...complete_layout(layout, height, is_small), ...size}, config);
  }
  const save = (filename) => Plotly.downloadImage(drawing, {format: "svg", filename, width: drawing.clientWidth, height});
  const figure = frame_figure({drawing, caption, tools, file_kind: "SVG", save, render, height, is_small});
  return figure.node;
}

function draw_all() {
  return Promise.all(figures.filter((figure) => !figure.is_drawn).map((figure) => figure.render()));
}

/** Draws what comes within a screen of the view, and everything at the width of the paper before printing. */
function watch_figures() {
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries.filter((seen) => seen.isIntersecting)) {
      observer.unobserve(entry.target);
      const figure = figures.find((candidate) => candidate.node === entry.target);
      if (!figure.is_drawn) figure.render();
    }
  }, {rootMargin: "100% 0px"});
  for (const figure of figures) observer.observe(figure.node);

  const folded = [...document.querySelectorAll("details:not([open])")];
  window.addEventListener("beforeprint", () => {
    for (const details of folded) details.open = true;
    for (const figure of figures) {
      const width = figure.is_small ? (paper_width - paper_gap) / 2 : paper_width;
      // Two full figures with their captions fit a page so.
      figure.render({width, height: figure.is_small ? figure.height : 0.84 * figure.height, autosize: false});
    }
  });
  window.addEventListener("afterprint", () => {
    for (const details of folded) details.open = false;
    for (const figure of figures) figure.render();
  });
}
