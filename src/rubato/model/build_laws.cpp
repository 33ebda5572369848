#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/friction_coefficient.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::model {
namespace {

/// Sliders, stops, laws and contacts, whose names must differ: columns have them.
class LawBuilder {
 public:
  LawBuilder(const ModelDescription& description, const numerics::Parameters& parameters, NegativeLoad negative_load,
             const Places& places, Model& model)
      : description_(description),
        parameters_(parameters),
        negative_load_(negative_load),
        places_(places),
        model_(model) {}

  void build() {
    take_sliders();
    take_stops();
    take_laws();
    take_pressed_sliders();
    take_contacts();
  }

 private:
  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }

  double at_least_zero(const Quantity& quantity, const std::string& what, const std::string& remedy = "") const {
    return model::at_least_zero(quantity, parameters_, what, remedy);
  }

  double normal_load(const Quantity& quantity, const std::string& what) const {
    if (negative_load_ == NegativeLoad::zero) return std::max(number(quantity, what), 0.0);
    return at_least_zero(quantity, what, "; a slider cannot be pulled, its least load is 0");
  }

  template <class Description>
  static void refuse_joint(const Description& description, const std::string& part) {
    if (description.joint.empty()) return;
    throw InvalidInput(description.joint_where,
                       fmt::format("{} acts on the joint \"{}\", but the model has no [[joint]]; join two "
                                   "coordinates, with between = [\"NAME\", \"ground\"]",
                                   part, description.joint));
  }

  void take_sliders() {
    for (const SliderDescription& description : description_.sliders) {
      const std::string part = fmt::format("slider \"{}\"", description.name);
      if (description.name.empty()) throw InvalidInput(description.where, "a slider needs a name");
      refuse_unfit_name(description.name, description.where);
      if (is_slider(description.name))
        throw InvalidInput(description.where, fmt::format("two sliders are called \"{}\"", description.name));
      if (places_.has(description.name))
        throw InvalidInput(description.where,
                           fmt::format("{} has the name of a coordinate; results would mix them up", part));
      refuse_joint(description, part);
      Slider slider;
      slider.name = description.name;
      places_.join(description.between, description.between_where, part, slider.first, slider.second);
      slider.stiffness = number(description.stiffness, part + ": stiffness");
      if (!(slider.stiffness > 0.0))
        throw InvalidInput(description.stiffness.where,
                           fmt::format("{}: stiffness must be positive, got {}", part, slider.stiffness));
      if (description.normal_law.empty() && description.normal_law_where.line > 0)
        throw InvalidInput(description.normal_law_where,
                           fmt::format("{}: normal_load names no law; give the name of a stop or of another law, or a "
                                       "number",
                                       part));
      if (description.is_law()) {
        const auto law = build_slider_law(description, slider.stiffness, parameters_, part);
        pressed_.push_back({slider.name, "slider", slider.first, slider.second, law, {}, {}});
        continue;
      }
      const double mu = at_least_zero(description.friction_coefficient, part + ": friction_coefficient");
      slider.limit = mu * normal_load(description.normal_load, part + ": normal_load");
      model_.sliders.push_back(slider);
    }
  }

  /// Sliders that are laws, behind the laws that may press on them.
  void take_pressed_sliders() {
    std::size_t next = 0;
    for (const SliderDescription& description : description_.sliders) {
      if (!description.is_law()) continue;
      LawBetween& law = pressed_[next++];
      const std::string part = fmt::format("slider \"{}\"", law.name);
      if (has_constant_load(description))
        law.normal.value = normal_load(description.normal_load, part + ": normal_load");
      else
        law.normal = build_normal_force(description, description_, model_, parameters_, part);
    }
    model_.laws.insert(model_.laws.end(), pressed_.begin(), pressed_.end());
  }

  void take_contacts() {
    for (const ContactDescription& description : description_.contacts) {
      const std::string& name = description.name;
      if (name.empty()) throw InvalidInput(description.where, "a contact needs a name");
      refuse_unfit_name(name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == name; };
      const auto is_one_of = [&](const auto& parts) { return std::any_of(parts.begin(), parts.end(), is_called_so); };
      if (is_one_of(model_.blocks))
        throw InvalidInput(description.where, fmt::format("two contacts are called \"{}\"", name));
      if (is_slider(name) || is_one_of(model_.stops) || is_one_of(model_.laws) || places_.has(name))
        throw InvalidInput(
            description.where,
            fmt::format("contact \"{}\" has the name of a slider, a stop, a law or a coordinate; results "
                        "would mix them up",
                        name));
      model_.blocks.push_back(build_contact(description, model_, places_, parameters_));
    }
  }

  bool is_slider(const std::string& name) const {
    const auto is_called_so = [&](const auto& other) { return other.name == name; };
    return std::any_of(model_.sliders.begin(), model_.sliders.end(), is_called_so) ||
           std::any_of(pressed_.begin(), pressed_.end(), is_called_so);
  }

  void take_stops() {
    for (const StopDescription& description : description_.stops) {
      const std::string part = fmt::format("stop \"{}\"", description.name);
      if (description.name.empty()) throw InvalidInput(description.where, "a stop needs a name");
      refuse_unfit_name(description.name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == description.name; };
      if (std::any_of(model_.stops.begin(), model_.stops.end(), is_called_so))
        throw InvalidInput(description.where, fmt::format("two stops are called \"{}\"", description.name));
      if (is_slider(description.name) || places_.has(description.name))
        throw InvalidInput(description.where,
                           fmt::format("{} has the name of a slider or a coordinate; results would mix them up", part));
      refuse_joint(description, part);
      Stop stop;
      stop.name = description.name;
      places_.join(description.between, description.between_where, part, stop.first, stop.second);
      stop.gap = number(description.gap, part + ": gap");
      stop.stiffness = number(description.stiffness, part + ": stiffness");
      if (!(stop.stiffness > 0.0))
        throw InvalidInput(description.stiffness.where,
                           fmt::format("{}: stiffness must be positive, got {}", part, stop.stiffness));
      stop.damping = at_least_zero(description.damping, part + ": damping");
      model_.stops.push_back(stop);
    }
  }

  void take_laws() {
    for (const LawDescription& description : description_.laws) {
      const LawKind& kind = law_kind(description.kind);
      const std::string part = fmt::format("{} \"{}\"", description.kind, description.name);
      if (description.name.empty()) throw InvalidInput(description.where, fmt::format("{} needs a name", kind.title));
      refuse_unfit_name(description.name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == description.name; };
      if (std::any_of(model_.laws.begin(), model_.laws.end(), is_called_so))
        throw InvalidInput(description.where, fmt::format("two laws are called \"{}\"", description.name));
      if (is_slider(description.name) || std::any_of(model_.stops.begin(), model_.stops.end(), is_called_so) ||
          places_.has(description.name))
        throw InvalidInput(
            description.where,
            fmt::format("{} has the name of a slider, a stop or a coordinate; results would mix them up", part));
      refuse_joint(description, part);
      LawBetween law{description.name, description.kind, ground, ground, kind.make(description, parameters_, part)};
      if (description.shares.empty())
        places_.join(description.between, description.between_where, part, law.first, law.second);
      else
        law.shares = shares_of(description, part);
      model_.laws.push_back(std::move(law));
    }
  }

  /// u of a law as a sum of coordinates: those that are fixed drop out. A share of zero, as within a sweep, stays.
  std::vector<Share> shares_of(const LawDescription& law, const std::string& part) const {
    std::vector<Share> shares;
    for (const auto& [name, weight] : law.shares) {
      const double value = number(weight, fmt::format("{}: the share of \"{}\"", part, name));
      if (places_.stands(name)) continue;
      const Index place = places_.find(name, law.shares_where, part + " takes a share of");
      shares.push_back({place, value});
    }
    if (shares.empty())
      throw InvalidInput(law.shares_where, fmt::format("{}: no coordinate that moves has a share in its u", part));
    return shares;
  }

  const ModelDescription& description_;
  const numerics::Parameters& parameters_;
  NegativeLoad negative_load_;
  const Places& places_;
  Model& model_;
  std::vector<LawBetween> pressed_;  // sliders whose load does not stay the same
};

}  // namespace

void build_laws(const ModelDescription& description, const numerics::Parameters& parameters, NegativeLoad negative_load,
                const Places& places, Model& model) {
  LawBuilder(description, parameters, negative_load, places, model).build();
}

}  // namespace rubato::model
