// The page from the data beside it.

const data = JSON.parse(document.getElementById("data").textContent);

function badge(status) {
  const known = {done: "done", failed: "failed", interrupted: "interrupted"};
  return element("span", {class: `badge ${known[status] ?? "unknown"}`}, status || "incomplete");
}

/** Name and value in two columns. */
function definitions(pairs) {
  return element("dl", {}, pairs.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

/** The values of the attributes `word1`, `word2`, ... in their order. */
function numbered(attributes, word) {
  const number = (name) => Number(name.slice(word.length));
  return Object.keys(attributes).filter((name) => name.startsWith(word) && number(name) > 0)
    .sort((a, b) => number(a) - number(b)).map((name) => attributes[name]);
}

function what_became(analysis) {
  const {status, message} = analysis.attributes;
  if (status === "done") return null;
  return element("div", {class: "alarm", role: "alert"}, element("b", {}, `${analysis.name}: ${status || "incomplete"}. `),
                 message || "The results file does not say how this analysis ended; what it wrote is shown.");
}

/** Warnings, each once with the analyses that it is of, so that what holds for the model is not repeated. */
function warnings_of(analyses) {
  const names = new Map();
  for (const {name, attributes} of analyses) {
    for (const text of numbered(attributes, "warning")) names.set(text, [...(names.get(text) ?? []), name]);
  }
  const where = (list) => (list.length === 1 || list.length < analyses.length ? list.join(", ") : "all analyses");
  const most = 400;
  return [...names].map(([text, list]) => element("div", {class: "alarm warning", role: "note"}, element("b", {}, `Warning, ${where(list)}: `),
    ...(text.length > most ? [`${text.slice(0, most)} …`, element("details", {}, element("summary", {}, "The whole warning"), element("pre", {}, text))]
                           : [text])));
}

function write_summary(parent) {
  const chapter = add_chapter(parent, "Summary");
  chapter.node.append(...data.analyses.map(what_became).filter((node) => node), ...warnings_of(data.analyses));
  const findings = data.analyses.map((analysis) => numbered(analysis.attributes, "finding"));
  const has_findings = findings.some((texts) => texts.length);
  add_section(chapter, "Analyses", make_table({
    caption: "What was run and what became of it.",
    columns: ["Analysis", "Type", "Method", "Step", "Status", ...(has_findings ? ["Findings"] : [])].map((title) => ({title, is_text: true})),
    rows: data.analyses.map((analysis, index) => {
      const {type, solver, method = solver, step, status} = analysis.attributes;
      return [element("a", {href: `#analysis-${index}`}, analysis.name), type ? phrase(type) : "–", method ?? "–", step ?? "–", badge(status),
              ...(has_findings ? [findings_cell(findings[index])] : [])];
    }),
  }));
  const facts = Object.entries(data.attributes).filter(([name]) => !["title", "study", "Conventions", "source"].includes(name))
    .map(([name, value]) => [phrase(name), value]);
  add_section(chapter, "Provenance", definitions([...facts, ["Results file", data.results_file]]));
  if (data.attributes.study) {
    chapter.node.append(element("details", {}, element("summary", {}, "The study, as it was run"),
                                element("pre", {}, data.attributes.study)));
  }
}

/** A line a finding; of many the first ones, the others folded. */
function findings_cell(texts) {
  if (texts.length === 0) return "–";
  const lines = (some) => some.map((text) => element("div", {}, text));
  const shown = 6;
  if (texts.length <= shown + 2) return element("div", {}, lines(texts));
  return element("div", {}, lines(texts.slice(0, shown)),
                 element("details", {class: "more"}, element("summary", {}, `${texts.length - shown} more`), lines(texts.slice(shown))));
}

// Attributes that are told elsewhere, or are there for figures.
const not_statistics = ["type", "method", "solver", "step", "status", "message", "slider_stiffness", "slider_limit"];

/** What the solver counted. */
function statistics_of(analysis) {
  const pairs = Object.entries(analysis.attributes)
    .filter(([name, value]) => value !== "" && !not_statistics.includes(name) && !/^(finding|warning)\d+$/.test(name))
    .map(([name, value]) => [phrase(name), value]);
  if (pairs.length === 0) return null;
  return element("details", {class: "statistics"}, element("summary", {}, "Statistics of the run"), definitions(pairs));
}

function write_analysis(parent, analysis, index) {
  const {type, solver, method, step, status} = analysis.attributes;
  const facts = [type && phrase(type), solver && `solver ${solver.replaceAll("_", " ")}`, method && `method ${method}`, step && `step ${step}`].filter((fact) => fact);
  const chapter = add_chapter(parent, analysis.name, element("p", {class: "facts", id: `analysis-${index}`}, facts.join(" · "),
                                                             facts.length ? " " : "", badge(status)),
                              what_became(analysis), statistics_of(analysis));
  show_in_hertz(analysis);
  write_scene(chapter, analysis);
  if (is_swept(analysis)) {
    write_swept(chapter, analysis);
  } else if (is_transient(analysis)) {
    write_transient(chapter, analysis);
    const others = analysis.tables.filter((table) => table.name !== "" && table.name !== "energy");
    others.filter(is_of_events).forEach((table) => write_events(chapter, analysis, table));
    others.filter(is_of_steps).forEach((table) => write_steps(chapter, table, events_of(analysis)));
    write_tables(chapter, others.filter((table) => !is_of_steps(table) && !is_of_events(table)));
  } else if (is_frequency_response(analysis)) {
    write_frequency_response(chapter, analysis);
  } else if (is_damper_curve(analysis)) {
    write_damper_curve(chapter, analysis);
  } else if (modes_table_of(analysis)) {
    const modes = modes_table_of(analysis);
    write_modes(chapter, modes);
    write_tables(chapter, analysis.tables.filter((table) => table !== modes));
  } else if (is_method_study(analysis)) {
    write_method_study(chapter, analysis, data.theory);
  } else {
    write_tables(chapter, analysis.tables);
  }
  if (analysis.tables.length === 0) chapter.node.append(element("p", {class: "note"}, "It left no results."));
}

function write_page() {
  const main = element("main", {});
  const title = data.attributes.title || data.results_file;
  const version = data.attributes.version ? ` ${data.attributes.version}` : "";
  const header = element("header", {}, element("p", {class: "overline"}, `Rubato${version} · report of a study`),
                         element("h1", {}, title));
  const navigation = element("nav", {class: "contents", "aria-label": "Contents"}, element("h2", {}, "Contents"), contents);
  data.analyses.forEach(restore_blanks);
  write_summary(main);
  data.analyses.forEach((analysis, index) => write_analysis(main, analysis, index));
  document.getElementById("page").append(header, navigation, main);
  watch_figures();
}

write_page();
