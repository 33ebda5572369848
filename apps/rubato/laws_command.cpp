#include "commands.hpp"

#include <rubato/analysis/law_routes.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace rubato::app {
namespace {

using analysis::Element;
using analysis::Route;

struct Row {
  std::string name, meaning;
  Element element;
};

std::vector<Row> rows() {
  std::vector<Row> rows{
      {"slider", "dry friction: a spring that slips at its limit", Element::slider},
      {"stop", "a one-sided spring with a damper; in mechanisms modes have it closed or open as it is", Element::stop}};
  for (const model::LawKind& kind : model::law_kinds()) rows.push_back({kind.table, kind.meaning, Element::law});
  rows.push_back(
      {"contact", "friction in one or two directions under a spring across them that only pushes", Element::contact});
  rows.push_back({"slider under a load",
                  "a slider whose normal_load is a formula of t, the force of another part or the reaction of a joint; "
                  "in mechanisms "
                  "every slider, and its modes are those of its branch",
                  Element::pressed_slider});
  rows.push_back({"joint friction", "of the joints of a mechanism", Element::joint_friction});
  rows.push_back({"joint lock", "of the joints of a mechanism", Element::lock});
  return rows;
}

std::string how(Element element, Route route) {
  const std::string text = analysis::handling(element, route).how;
  return text.empty() ? "-" : text;
}

}  // namespace

int list_laws() {
  const std::vector<Row> all = rows();
  std::size_t first = 0;
  for (const Row& row : all) first = std::max(first, row.name.size() + 2);
  fmt::print("{:<{}}", "element", first);
  std::vector<std::size_t> widths;
  for (int r = 0; r < analysis::route_count; ++r) {
    const auto route = static_cast<Route>(r);
    std::size_t width = std::strlen(analysis::name_of(route));
    for (const Row& row : all) width = std::max(width, how(row.element, route).size());
    widths.push_back(width + 2);
    fmt::print("{:<{}}", analysis::name_of(route), r + 1 < analysis::route_count ? widths.back() : 0);
  }
  fmt::print("\n");
  for (const Row& row : all) {
    fmt::print("{:<{}}", row.name, first);
    for (int r = 0; r < analysis::route_count; ++r)
      fmt::print("{:<{}}", how(row.element, static_cast<Route>(r)),
                 r + 1 < analysis::route_count ? widths[static_cast<std::size_t>(r)] : 0);
    fmt::print("\n");
  }
  fmt::print(
      "\nsteps, exact: transients; periodic, harmonic_balance, time_marching: solvers of frequency_response\n\n");
  for (const Row& row : all) fmt::print("{:<{}}{}\n", row.name, first, row.meaning);
  fmt::print("\nWhere there is a \"-\":\n");
  std::vector<std::string> told;
  for (const Row& row : all)
    for (int r = 0; r < analysis::route_count; ++r) {
      const auto& one = analysis::handling(row.element, static_cast<Route>(r));
      if (*one.how != '\0' || *one.instead == '\0') continue;
      std::string line = fmt::format("  {} under {}: {}", row.element == Element::law ? "laws" : row.name,
                                     analysis::name_of(static_cast<Route>(r)), one.instead);
      if (std::find(told.begin(), told.end(), line) != told.end()) continue;
      fmt::print("{}\n", line);
      told.push_back(std::move(line));
    }
  fmt::print("  method_study: the model must be linear\n");
  fmt::print(
      "\nA bouc_wen with degradation and a slider whose friction_coefficient is a formula of the rate are laws for "
      "transients by steps, static states and modes alone.\n");
  return exit_done;
}

}  // namespace rubato::app
