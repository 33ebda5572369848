#include <rubato/model/build_contact_values.hpp>
#include <rubato/model/build_parts.hpp>
#include <rubato/model/laws/elastic_contact.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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
        read_(description, parameters, model.structure.dimension),
        part_(read_.part()) {}

  BlockBetween build() {
    refuse_places_of_bodies();
    BlockBetween block{d_.name, "contact", nullptr, {}};
    std::vector<std::vector<Share>> columns = d_.normal.empty() ? columns_of_nodes() : columns_of_shares();
    std::move(columns.begin(), columns.end(), block.columns.begin());
    block.law = make_elastic_contact(read_.values(static_cast<Index>(columns.size()) - 1));
    return block;
  }

 private:
  void refuse_places_of_bodies() const {
    constexpr const char* remedy =
        "goes with bodies and joints, whose parts turn; in a structure a contact acts at its nodes, along the "
        "displacements of which it follows: leave it out";
    if (!d_.at.empty()) throw InvalidInput(d_.at_where, fmt::format("{}: at {}", part_, remedy));
    if (!d_.to.empty()) throw InvalidInput(d_.to_where, fmt::format("{}: to {}", part_, remedy));
    if (d_.radius) throw InvalidInput(d_.radius->where, fmt::format("{}: radius {}", part_, remedy));
  }

  std::vector<Share> shares(const ContactDescription::Shares& given, const std::string& key,
                            const Location& where) const {
    std::vector<Share> column;
    for (const auto& [name, weight] : given) {
      const double value = read_.number(weight, fmt::format("the share of \"{}\" in {}", name, key));
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
    const Axis n = read_.normal();
    std::vector<std::vector<Share>> columns;
    const std::vector<Axis> plane = read_.along(n);
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
  ContactReading read_;
  std::string part_;
};

}  // namespace

BlockBetween build_contact(const ContactDescription& description, const Model& model, const Places& places,
                           const numerics::Parameters& parameters) {
  return Contact(description, model, places, parameters).build();
}

}  // namespace rubato::model
