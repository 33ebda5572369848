#include <rubato/report/json.hpp>
#include <rubato/report/reactions.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <unordered_map>

namespace rubato::report {
namespace {

constexpr std::string_view prefix = "reaction_";

/// A column that is a component of a reaction.
struct Component {
  std::size_t variable, label, joint;
  bool is_moment;
};

/// Which columns are components of which reaction.
struct Reactions {
  std::vector<LargestReaction> joints;
  std::vector<Component> components;

  explicit Reactions(const TableSource& table) {
    for (std::size_t v = 0; v < table.variables().size(); ++v) {
      const Variable& variable = table.variables()[v];
      if (!variable.name.starts_with(prefix) || !variable.dimension.ends_with("joint")) continue;
      const std::string_view what = std::string_view(variable.name).substr(prefix.size());
      for (std::size_t label = 0; label < variable.labels.size(); ++label)
        components.push_back({v, label, joint_of(variable.labels[label], what.starts_with("lock")),
                              what.find("moment") != std::string_view::npos});
    }
  }

 private:
  std::size_t joint_of(const std::string& name, bool is_of_lock) {
    const auto [found, is_new] = (is_of_lock ? locks_ : joints_).emplace(name, joints.size());
    if (is_new) joints.push_back({name, is_of_lock, NAN, NAN, NAN, NAN});
    return found->second;
  }

  std::unordered_map<std::string, std::size_t> joints_, locks_;
};

void raise(double& largest, double& time, double value, double t) {
  if (std::isnan(value) || value <= largest) return;
  largest = value;
  time = t;
}

/// Rows [first, first + count) of all reactions.
void add_rows(const TableSource& table, std::size_t first, std::size_t count, Reactions& reactions) {
  std::vector<double> times(count), values;
  table.read(0, first, count, 1, times);
  // Squares of forces and of moments, by joint and row.
  std::array<std::vector<double>, 2> squares;
  std::array<std::vector<char>, 2> exists;
  for (auto& part : squares) part.assign(reactions.joints.size() * count, 0.0);
  for (auto& part : exists) part.assign(reactions.joints.size(), 0);
  std::size_t read = static_cast<std::size_t>(-1), width = 0;
  for (const Component& component : reactions.components) {
    if (component.variable != read) {
      read = component.variable;
      width = table.variables()[read].width();
      values.resize(count * width);
      table.read(read, first, count, width, values);
    }
    const std::size_t part = component.is_moment ? 1 : 0;
    exists[part][component.joint] = 1;
    double* const sum = squares[part].data() + component.joint * count;
    for (std::size_t i = 0; i < count; ++i) {
      const double value = values[i * width + component.label];
      sum[i] += value * value;
    }
  }
  for (std::size_t joint = 0; joint < reactions.joints.size(); ++joint) {
    LargestReaction& largest = reactions.joints[joint];
    for (std::size_t i = 0; i < count; ++i) {
      if (exists[0][joint])
        raise(largest.force, largest.force_time, std::sqrt(squares[0][joint * count + i]), times[i]);
      if (exists[1][joint])
        raise(largest.moment, largest.moment_time, std::sqrt(squares[1][joint * count + i]), times[i]);
    }
  }
}

}  // namespace

std::vector<LargestReaction> largest_reactions(const TableSource& table) {
  Reactions reactions(table);
  if (reactions.joints.empty()) return {};
  const std::size_t piece = std::clamp<std::size_t>(piece_numbers / reactions.joints.size(), 1, piece_rows);
  for (std::size_t first = 0; first < table.rows(); first += piece)
    add_rows(table, first, std::min(piece, table.rows() - first), reactions);
  const auto or_none = [](double value) { return std::isnan(value) ? -1.0 : value; };
  std::stable_sort(reactions.joints.begin(), reactions.joints.end(),
                   [&](const LargestReaction& a, const LargestReaction& b) {
                     if (or_none(a.force) != or_none(b.force)) return or_none(a.force) > or_none(b.force);
                     return or_none(a.moment) > or_none(b.moment);
                   });
  return reactions.joints;
}

std::string reactions_json(const TableSource& table, std::size_t most) {
  const std::vector<LargestReaction> all = largest_reactions(table);
  if (all.empty()) return "null";
  std::string joints;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i) {
    const auto number = [](double value) { return json_number(value); };
    joints += fmt::format(R"({}{{"name":{},"is_of_lock":{},"force":{},"force_time":{},"moment":{},"moment_time":{}}})",
                          i > 0 ? "," : "", json_string(all[i].joint), all[i].is_of_lock, number(all[i].force),
                          number(all[i].force_time), number(all[i].moment), number(all[i].moment_time));
  }
  return fmt::format(R"({{"count":{},"joints":[{}]}})", all.size(), joints);
}

}  // namespace rubato::report
