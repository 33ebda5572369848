// Numbered HTML tables.

let table_count = 0;

/**
 * A table.
 *
 * columns: [{title, is_text}], the first heads the rows; rows: [[node or string, ...], ...].
 * groups: [{title, span}] above the column heads, or nothing.
 */
function make_table({caption, columns, rows, groups = null}) {
  const number = ++table_count;
  const cell_class = (index) => (columns[index].is_text ? "text" : undefined);
  const heads = columns.map((column, index) => element("th", {scope: "col", class: cell_class(index)}, column.title));
  const group_row = groups && element("tr", {class: "groups"}, groups.map(
    (group) => element("th", {scope: "colgroup", colspan: String(group.span)}, group.title)));
  const body = rows.map((row) => element("tr", {}, row.map((cell, index) => element(
    index === 0 ? "th" : "td", {scope: index === 0 ? "row" : undefined, class: cell_class(index)}, cell))));
  const kind = columns.every((column) => column.is_text) ? "words" : undefined;
  return element("div", {class: rows.length > 25 ? "table" : "table short", id: `table-${number}`},
                 element("p", {class: "caption"}, element("b", {}, `Table ${number}. `), caption),
                 element("div", {class: "scroll"}, element("table", {class: kind}, element("thead", {}, group_row, element("tr", {}, heads)),
                                                           element("tbody", {}, body))));
}

/** The rows of a short table of the results, one column a label. */
function results_table(table, caption, digits = 6) {
  const columns = [];
  table.variables.forEach((variable, index) => {
    table.overview[index].forEach((values, label) => {
      const name = variable.dimension ? `${variable.labels[label]} ${axis_label(variable)}` : axis_label(variable);
      // netCDF keeps words without blanks; only names of methods have underscores of their own.
      const words = variable.categories.map((word) => (variable.name === "method" ? word : word.replaceAll("_", " ")));
      columns.push({title: words.length ? phrase(variable.name) : name, is_text: words.length > 0,
                    cells: values.map((value) => (words.length ? words[value] ?? "–" : number_node(value, digits)))});
    });
  });
  const rows = columns[0].cells.map((_, row) => columns.map((column) => column.cells[row]));
  return make_table({caption, columns, rows});
}
