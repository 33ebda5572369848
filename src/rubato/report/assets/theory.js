// Stability regions of the methods, which depend on no results.

/** |R(z)| of R(z) = sum r_k z^k, z = x + i y, by Horner's rule. */
function modulus_of_polynomial(coefficients, x, y) {
  let re = 0, im = 0;
  for (let k = coefficients.length - 1; k >= 0; --k) {
    [re, im] = [re * x - im * y + coefficients[k], re * y + im * x];
  }
  return Math.hypot(re, im);
}

function runge_kutta_regions(entries) {
  const side = (from, to, points) => Array.from({length: points}, (_, i) => from + (to - from) * i / (points - 1));
  const x = side(-5.2, 2.2, 223), y = side(-4, 4, 241);
  return make_figure({
    caption: "Stability regions of the explicit Runge-Kutta methods: inside its curve |R(hλ)| = 1 a method is stable, for an " +
      "eigenvalue λ of the equations in first-order form. An undamped mode lies on the imaginary axis.",
    height: 520,
    draw: () => ({
      traces: entries.map((entry, index) => ({
        type: "contour", x, y, z: y.map((im) => x.map((re) => modulus_of_polynomial(entry.coefficients, re, im))),
        contours: {type: "constraint", operation: "=", value: 1}, autocontour: false, showscale: false, hoverinfo: "name",
        line: line_style(index), fillcolor: "rgba(0,0,0,0)", showlegend: true, name: entry.names.join(", "),
      })),
      layout: {xaxis: axis("Re(hλ) [–]", {range: [-5.2, 2.2], constrain: "domain"}),
               yaxis: axis("Im(hλ) [–]", {scaleanchor: "x", range: [-4, 4], constrain: "domain"})},
    }),
  });
}

function newmark_region(entries) {
  const beta_end = 1.1, gamma_end = 1.65;
  const region = (name, beta, gamma, color) => ({
    type: "scatter", mode: "lines", fill: "toself", x: beta, y: gamma, name, fillcolor: color, line: {width: 0}, hoverinfo: "name",
  });
  const letter = (index) => String.fromCharCode(97 + index);
  const key = entries.map((entry, index) => `${letter(index)} ${entry.names.join(", ")}`).join("; ");
  const gammas = Array.from({length: 61}, (_, i) => 0.5 + (gamma_end - 0.5) * i / 60);
  return make_figure({
    caption: "Stability of Newmark's method over its parameters. Unconditional where 2β ≥ γ ≥ 1/2; for γ ≥ 1/2 and 2β < γ an " +
      "undamped mode needs ωh ≤ 1/√(γ/2 − β); for γ < 1/2 it grows at any step. To the right of the curve " +
      "β = (γ + 1/2)²/4 the roots stay complex at every step (no bifurcation). " +
      `Points: ${key}.`,
    height: 520,
    draw: () => ({
      traces: [
        region("Unconditional", [0.25, beta_end, beta_end, gamma_end / 2], [0.5, 0.5, gamma_end, gamma_end], "rgba(0,158,115,0.20)"),
        region("Conditional", [0, 0.25, gamma_end / 2, 0], [0.5, 0.5, gamma_end, gamma_end], "rgba(230,159,0,0.22)"),
        region("Unstable", [0, beta_end, beta_end, 0], [0, 0, 0.5, 0.5], "rgba(213,94,0,0.20)"),
        {type: "scatter", mode: "lines", x: gammas.map((gamma) => (gamma + 0.5) ** 2 / 4), y: gammas, name: "No bifurcation",
         line: {color: "#1c242c", dash: "dash", width: 1.5}},
        {type: "scatter", mode: "markers+text", x: entries.map((entry) => entry.beta), y: entries.map((entry) => entry.gamma),
         text: entries.map((entry, index) => letter(index)), textposition: "top center",
         customdata: entries.map((entry) => entry.names.join(", ")),
         hovertemplate: "%{customdata}<br>β = %{x:.5g}, γ = %{y:.5g}<extra></extra>", name: "Methods", cliponaxis: false,
         marker: {color: "#1c242c", size: 7}},
      ],
      layout: {xaxis: axis("β [–]", {range: [0, beta_end]}), yaxis: axis("γ [–]", {range: [0, gamma_end]})},
    }),
  });
}

function write_theory(chapter, theory) {
  add_section(chapter, "Stability regions", runge_kutta_regions(theory.runge_kutta), newmark_region(theory.newmark));
}
