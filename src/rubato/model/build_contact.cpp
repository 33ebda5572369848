#include <rubato/model/build_parts.hpp>
#include <rubato/model/friction_coefficient.hpp>
#include <rubato/model/laws/elastic_contact.hpp>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

constexpr const char* axes[3] = {".x", ".y", ".z"};

class Contact {
 public:
  Contact(const ContactDescription& description, const Model& model, const Places& places,
          const numerics::Parameters& parameters)
      : d_(description),
        model_(model),
        places_(places),
        parameters_(parameters),
        part_(fmt::format("contact \"{}\"", description.name)) {}

  BlockBetween build() {
    BlockBetween block{d_.name, "contact", nullptr, {}};
    std::vector<std::vector<Share>> columns = d_.normal.empty() ? columns_of_nodes() : columns_of_shares();
    std::move(columns.begin(), columns.end(), block.columns.begin());
    block.law = make_elastic_contact(values(static_cast<Index>(columns.size()) - 1));
    return block;
  }

 private:
  double number(const Quantity& quantity, const std::string& key) const {
    return evaluate(quantity, parameters_, part_ + ": " + key);
  }
  double positive(const Quantity& quantity, const std::string& key) const {
    const double value = number(quantity, key);
    if (!(value > 0.0))
      throw InvalidInput(quantity.where, fmt::format("{}: {} must be positive, got {}", part_, key, value));
    return value;
  }

  ContactValues values(Index directions) const {
    ContactValues values;
    values.directions = directions;
    values.normal_stiffness = positive(d_.normal_stiffness, "normal_stiffness");
    if (directions > 0) {
      values.tangential_stiffness = positive(*d_.tangential_stiffness, "tangential_stiffness");
      if (depends_on_rate(*d_.friction_coefficient))
        throw InvalidInput(
            d_.friction_coefficient->where,
            fmt::format("{}: friction_coefficient depends on the rate, which contacts do not take; take a "
                        "[[slider]] along the plane whose normal_load is a [[stop]] across it",
                        part_));
      values.friction_coefficient =
          at_least_zero(*d_.friction_coefficient, parameters_, part_ + ": friction_coefficient");
    }
    if (d_.gap) values.gap = number(*d_.gap, "gap");
    if (d_.normal_damping)
      values.normal_damping = at_least_zero(*d_.normal_damping, parameters_, part_ + ": normal_damping");
    if (d_.sliding_velocity) {
      values.sliding_velocity = number(*d_.sliding_velocity, "sliding_velocity");
      if (!std::isfinite(values.sliding_velocity))
        throw InvalidInput(d_.sliding_velocity->where, fmt::format("{}: sliding_velocity must be a number, got {}",
                                                                   part_, values.sliding_velocity));
    }
    if (d_.normal_load)
      values.gap = -at_least_zero(*d_.normal_load, parameters_, part_ + ": normal_load", "; give it a gap instead") /
                   values.normal_stiffness;
    return values;
  }

  std::vector<Share> shares(const ContactDescription::Shares& given, const std::string& key,
                            const Location& where) const {
    std::vector<Share> column;
    for (const auto& [name, weight] : given) {
      const double value = number(weight, fmt::format("the share of \"{}\" in {}", name, key));
      const Index place = places_.end_of(name, weight.where, part_ + " takes a share of");
      if (place != ground) column.push_back({place, value});
    }
    if (column.empty())
      throw InvalidInput(where, fmt::format("{}: no coordinate that moves has a share in {}", part_, key));
    return column;
  }

  std::vector<std::vector<Share>> columns_of_shares() const {
    std::vector<std::vector<Share>> columns;
    for (const ContactDescription::Shares& one : d_.tangential)
      columns.push_back(shares(one, "tangential", d_.tangential_where));
    columns.push_back(shares(d_.normal, "normal", d_.normal_where));
    return columns;
  }

  Axis direction(const std::vector<Quantity>& given, const char* key, const Location& where) const {
    const auto wanted = static_cast<std::size_t>(model_.structure.dimension);
    if (given.size() != wanted)
      throw InvalidInput(where, fmt::format("{}: {} takes {} numbers, as the positions of nodes do, got {}", part_, key,
                                            wanted, given.size()));
    Axis axis = Axis::Zero();
    for (std::size_t i = 0; i < wanted; ++i) axis[static_cast<Index>(i)] = number(given[i], key);
    const double length = axis.norm();
    if (!(length > 0.0)) throw InvalidInput(where, fmt::format("{}: its {} has no length", part_, key));
    return axis / length;
  }

  /// In the plane e_z x n; in space t1 and n x t1.
  std::vector<Axis> along(const Axis& n) const {
    constexpr double least = 1e-6;
    if (model_.structure.dimension == 2) {
      if (!d_.tangential_direction.empty())
        throw InvalidInput(d_.tangential_direction_where,
                           fmt::format("{}: in the plane there is one direction across the normal, which need not be "
                                       "told; leave tangential_direction out",
                                       part_));
      return {Axis(-n[1], n[0], 0.0)};
    }
    Axis t = Axis::Zero();
    if (d_.tangential_direction.empty()) {
      Index least_along = 0;
      n.cwiseAbs().minCoeff(&least_along);
      t[least_along] = 1.0;
    } else {
      t = direction(d_.tangential_direction, "tangential_direction", d_.tangential_direction_where);
      if (std::abs(t.dot(n)) > least)
        throw InvalidInput(d_.tangential_direction_where,
                           fmt::format("{}: tangential_direction is not at a right angle to normal_direction (the "
                                       "cosine between them is {:.3g})",
                                       part_, t.dot(n)));
    }
    t = (t - t.dot(n) * n).normalized();
    return {t, n.cross(t)};
  }

  /// axis . (x_first - x_second)
  std::vector<Share> column_along(const Axis& axis, double sign) const {
    std::vector<Share> column;
    for (std::size_t end = 0; end < 2; ++end) {
      if (d_.between[end] == "ground") continue;
      for (Index i = 0; i < model_.structure.dimension; ++i) {
        if (axis[i] == 0.0) continue;
        const Index place = places_.end_of(d_.between[end] + axes[i], d_.between_where[end], part_ + " joins");
        if (place != ground) column.push_back({place, (end == 0 ? sign : -sign) * axis[i]});
      }
    }
    return column;
  }

  void require_nodes() const {
    for (std::size_t end = 0; end < 2; ++end) {
      const std::string& name = d_.between[end];
      const auto& nodes = model_.structure.names;
      if (name == "ground" || std::find(nodes.begin(), nodes.end(), name) != nodes.end()) continue;
      const auto& known = model_.coordinates;
      if (std::find(known.begin(), known.end(), name) != known.end())
        throw InvalidInput(d_.between_where[end],
                           fmt::format("{} joins \"{}\", which is a coordinate and has no directions; instead of "
                                       "between write tangential = {{ {} = 1.0 }} and normal = {{ ... }}",
                                       part_, name, name));
      throw InvalidInput(d_.between_where[end],
                         fmt::format("{} joins \"{}\", which is no node{}", part_, name, suggestion(name, nodes)));
    }
    if (d_.between[0] == d_.between[1])
      throw InvalidInput(d_.between_where[1], fmt::format("{} joins \"{}\" with itself", part_, d_.between[1]));
  }

  std::vector<std::vector<Share>> columns_of_nodes() const {
    require_nodes();
    const Axis n = direction(d_.normal_direction, "normal_direction", d_.normal_direction_where);
    std::vector<std::vector<Share>> columns;
    const std::vector<Axis> plane = along(n);
    if (d_.friction_coefficient)
      for (const Axis& t : plane) columns.push_back(column_along(t, 1.0));
    columns.push_back(column_along(n, -1.0));
    if (columns.back().empty())
      throw InvalidInput(d_.between_where[1], fmt::format("{} joins \"{}\" with \"{}\", and neither moves along the "
                                                          "normal",
                                                          part_, d_.between[0], d_.between[1]));
    return columns;
  }

  const ContactDescription& d_;
  const Model& model_;
  const Places& places_;
  const numerics::Parameters& parameters_;
  std::string part_;
};

}  // namespace

BlockBetween build_contact(const ContactDescription& description, const Model& model, const Places& places,
                           const numerics::Parameters& parameters) {
  return Contact(description, model, places, parameters).build();
}

}  // namespace rubato::model
