#include <rubato/model/finite_elements/component_modes.hpp>
#include <rubato/model/finite_elements/reduce_model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <unordered_map>

namespace rubato::model {
namespace {

constexpr double default_error = 1e-4;     // of frequencies
constexpr Index first_batch = 20;          // modes
constexpr Index most_modes = 1000;         // beyond, a reduced model of full matrices is no gain
constexpr Index largest_interface = 3000;  // its reduced matrices are full

class Reducer {
 public:
  Reducer(Model& model, const FiniteElements& elements, const ReductionDescription& description, Index before)
      : model_(model), elements_(elements), description_(description), before_(before) {}

  void reduce() {
    find_interface();
    const auto b = static_cast<Index>(kept_.size());
    if (b == model_.size()) {
      const std::lock_guard lock(description_.store->mutex);
      if (!description_.store->report)
        description_.store->report = ReductionReport{description_.method, b, b, 0, 0, 0.0, {}, {}};
      return;
    }
    if (b > largest_interface)
      throw InvalidInput(description_.where,
                         fmt::format("[reduction]: {} of {} coordinates are named by parts, `observe` and `keep`, and "
                                     "stay as they are; the matrices of an interface are full, and up to {} are "
                                     "taken: name fewer, or leave [reduction] out",
                                     b, model_.size(), largest_interface));
    refuse_names_of_modes();
    const std::lock_guard lock(description_.store->mutex);
    ReductionStore& store = *description_.store;
    Vector key = key_of_matrices();
    if (store.matrices && store.key.size() == key.size() && store.key == key) {
      model_.matrices = *store.matrices;
      rename(b, model_.matrices->mass.rows() - b);
      return;
    }
    ComponentModes modes(model_.matrices->stiffness, model_.matrices->mass, kept_, inertia_loads());
    require_held(modes);
    if (!store.modes)
      store.modes = choose(modes);
    else
      find(modes, *store.modes);
    modes.take(*store.modes);
    if (!store.report) store.report = report_of(modes);
    replace(modes);
    store.key = std::move(key);
    store.matrices = std::make_shared<const FullMatrices>(*model_.matrices);
    rename(b, modes.shapes().cols());
  }

 private:
  void keep(Index coordinate) {
    if (coordinate != ground) is_kept_[static_cast<std::size_t>(coordinate)] = 1;
  }
  template <class Parts>
  void keep_ends(const Parts& parts) {
    for (const auto& part : parts) {
      keep(part.first);
      keep(part.second);
    }
  }

  void find_interface() {
    is_kept_.assign(static_cast<std::size_t>(model_.size()), 0);
    for (Index i = 0; i < before_; ++i) keep(i);
    keep_ends(model_.springs);
    keep_ends(model_.dashpots);
    keep_ends(model_.sliders);
    keep_ends(model_.stops);
    keep_ends(model_.laws);
    for (const LawBetween& law : model_.laws)
      for (const Share& share : law.shares) keep(share.coordinate);
    for (const BlockBetween& block : model_.blocks)
      for (const auto& column : block.columns)
        for (const Share& share : column) keep(share.coordinate);
    for (const Force& force : model_.forces) keep(force.coordinate);
    for (const auto* held : {&model_.held_forces, &model_.held_displacements})
      for (const Held& one : *held) keep(one.coordinate);
    for (const Prescribed& motion : model_.prescribed) keep(motion.coordinate);
    keep_named();
    for (Index i = 0; i < model_.size(); ++i)
      if (is_kept_[static_cast<std::size_t>(i)] != 0) kept_.push_back(i);
  }

  void keep_named() {
    std::unordered_map<std::string, Index> places;
    for (Index i = 0; i < model_.size(); ++i) places.emplace(model_.coordinates[static_cast<std::size_t>(i)], i);
    for (const std::string& name : description_.observed)
      if (const auto found = places.find(name); found != places.end()) keep(found->second);
    for (std::size_t i = 0; i < description_.keep.size(); ++i) {
      const std::string& name = description_.keep[i];
      if (const auto found = places.find(name); found != places.end())
        keep(found->second);
      else
        keep_nodes(name, i < description_.keep_where.size() ? description_.keep_where[i] : description_.where);
    }
  }

  void keep_nodes(const std::string& name, const Location& where) {
    const Structure& nodes = model_.structure;
    const auto keep_node = [&](const std::string& node) {
      const auto found = std::find(nodes.names.begin(), nodes.names.end(), node);
      if (found == nodes.names.end()) return false;
      for (const Index place : nodes.places[static_cast<std::size_t>(found - nodes.names.begin())]) keep(place);
      return true;
    };
    if (keep_node(name)) return;
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    std::vector<std::string> known;
    if (elements_.mesh)
      for (const NodeSet& set : elements_.mesh->sets) {
        known.push_back(set.name);
        if (set.name != upper) continue;
        for (const std::int64_t node : set.nodes) (void)keep_node(std::to_string(node));
        return;
      }
    throw InvalidInput(where,
                       fmt::format("[reduction]: keep names \"{}\", which is no degree of freedom with a row, no "
                                   "node and no node set of the model{}",
                                   name, suggestion(upper, known)));
  }

  void refuse_names_of_modes() const {
    for (Index i = 0; i < before_; ++i) {
      const std::string& name = model_.coordinates[static_cast<std::size_t>(i)];
      if (name.starts_with("mode_"))
        throw InvalidInput(description_.where, fmt::format("[reduction] calls its modes mode_1, mode_2 and so on; "
                                                           "rename the coordinate \"{}\"",
                                                           name));
    }
  }

  /// What the reduced matrices depend on, as far as it changes with parameters: masses on nodes, and which rows
  /// supports hold; and the interface.
  Vector key_of_matrices() const {
    const Index n = model_.size();
    const auto b = static_cast<Index>(kept_.size());
    const Matrix loads = inertia_loads();
    Vector key(3 * n + b + 1);
    for (Index i = 0; i < b; ++i) key[i] = static_cast<double>(kept_[static_cast<std::size_t>(i)]);
    key[b] = static_cast<double>(loads.cols());
    key.segment(b + 1, n) = model_.matrices->stiffness.diagonal();
    key.segment(b + 1 + n, n) = model_.matrices->mass.diagonal();
    key.tail(n) = loads.cols() > 0 ? Vector(loads.rowwise().sum()) : Vector(Vector::Zero(n));
    return key;
  }

  /// Forces of even accelerations along the axes in which the study has gravity or moves the ground.
  Matrix inertia_loads() const {
    std::vector<Index> axes;
    for (Index axis = 0; axis < 3; ++axis)
      if (model_.gravity[axis] != 0.0 || (model_.base_motion && model_.base_motion->translation[axis] != 0.0))
        axes.push_back(axis);
    Matrix loads(model_.size(), static_cast<Index>(axes.size()));
    for (std::size_t i = 0; i < axes.size(); ++i)
      loads.col(static_cast<Index>(i)) = model_.matrices->inertia.col(axes[i]);
    return loads;
  }

  void require_held(const ComponentModes& modes) const {
    if (modes.is_held()) return;
    throw InvalidInput(
        description_.where,
        fmt::format("[reduction]: with the {} degree{} of freedom held that parts, `observe` and `keep` name, the rest "
                    "of the model still moves freely, or has a negative stiffness, and has no static shapes; keep "
                    "more (keep = [...]), such as six that hold it as a rigid body, or add a [[support]]",
                    kept_.size(), kept_.size() == 1 ? "" : "s"));
  }

  void find(ComponentModes& modes, Index count) const {
    if (modes.find(description_.method, count)) return;
    throw InvalidInput(description_.where,
                       fmt::format("[reduction]: {} modes of the model were not found to more than a few digits; are "
                                   "stiffnesses or masses too far apart?",
                                   count));
  }

  /// Between coordinates of the interface: springs, and sliders that stick [b + n x b + n].
  Matrix with_springs(Matrix stiffness, bool with_sliders) const {
    const auto at = [&](Index coordinate) {
      return coordinate == ground ? ground : std::lower_bound(kept_.begin(), kept_.end(), coordinate) - kept_.begin();
    };
    const auto add = [&](Index first, Index second, double k) {
      const Index i = at(first), j = at(second);
      if (i != ground) stiffness(i, i) += k;
      if (j != ground) stiffness(j, j) += k;
      if (i == ground || j == ground) return;
      stiffness(i, j) -= k;
      stiffness(j, i) -= k;
    };
    for (const LinearElement& spring : model_.springs) add(spring.first, spring.second, spring.coefficient);
    if (!with_sliders) return stiffness;
    for (const Slider& slider : model_.sliders) add(slider.first, slider.second, slider.stiffness);
    for (const LawBetween& law : model_.laws)
      if (law.shares.empty()) add(law.first, law.second, law.law->sticking_stiffness());
    for (const BlockBetween& block : model_.blocks)
      for (std::size_t i = 0; i < block.columns.size(); ++i) {
        if (block.columns[i].empty()) continue;
        const double k = block.law->limit_stiffness(static_cast<Index>(i), true);
        for (const Share& a : block.columns[i])
          for (const Share& b : block.columns[i])
            stiffness(at(a.coordinate), at(b.coordinate)) += k * a.weight * b.weight;
      }
    return stiffness;
  }

  ReductionReport report_of(const ComponentModes& modes) const {
    ReductionReport report;
    report.method = description_.method;
    report.before = model_.size();
    report.interface = static_cast<Index>(kept_.size());
    report.modes = modes.shapes().cols();
    report.statics = modes.statics();
    report.next = std::sqrt(modes.next()) / (2.0 * std::numbers::pi);
    const Matrix stiffness = modes.reduced(model_.matrices->stiffness), mass = modes.reduced(model_.matrices->mass);
    const auto count = static_cast<Index>(description_.frequencies);
    report.free = modes.estimates(with_springs(stiffness, false), mass, count);
    if (!model_.sliders.empty() || !model_.laws.empty() || !model_.blocks.empty())
      report.stuck = modes.estimates(with_springs(stiffness, true), mass, count);
    return report;
  }

  Index choose(ComponentModes& modes) const {
    const Index most = modes.rest();
    if (description_.modes) {
      if (*description_.modes > most)
        throw InvalidInput(description_.modes_where,
                           fmt::format("[reduction]: modes = {}, and beside the {} degrees of freedom that parts, "
                                       "`observe` and `keep` name the model has {}",
                                       *description_.modes, kept_.size(), most));
      find(modes, static_cast<Index>(*description_.modes));
      return static_cast<Index>(*description_.modes);
    }
    const double error = description_.error ? description_.error->value : default_error;
    const auto worst = [&](Index count) {
      modes.take(count);
      return report_of(modes).worst();
    };
    Index below = 0;
    for (Index batch = std::min(first_batch, most);; batch = std::min({2 * batch, most, most_modes})) {
      find(modes, batch);
      double reached = worst(batch);
      if (reached <= error) {
        // Fewer may do.
        Index enough = batch;
        while (enough > below) {
          const Index middle = (enough + below) / 2;
          if (worst(middle) <= error)
            enough = middle;
          else
            below = middle + 1;
        }
        return enough;
      }
      if (batch == most || batch >= most_modes)
        throw InvalidInput(description_.where,
                           fmt::format("[reduction]: with {} modes the estimated error of the first {} frequencies is "
                                       "{:.2g}, more than {:.2g}; ask for fewer frequencies or a larger error, or keep "
                                       "more degrees of freedom",
                                       batch, description_.frequencies, reached, error));
      below = batch + 1;
    }
  }

  /// In place of all coordinates: the interface, then the modes.
  void replace(const ComponentModes& modes) {
    const auto b = static_cast<Index>(kept_.size());
    const Index n = modes.shapes().cols();
    Vector scale = Vector::Ones(b + n);
    for (Index j = 0; j < n; ++j) {
      Index largest = 0;
      modes.shapes().col(j).cwiseAbs().maxCoeff(&largest);
      scale[b + j] = 1.0 / modes.shapes()(largest, j);
    }
    FullMatrices& matrices = *model_.matrices;
    const auto scaled = [&](const SparseMatrix& matrix) {
      const Matrix full = scale.asDiagonal() * modes.reduced(matrix) * scale.asDiagonal();
      return SparseMatrix(full.sparseView());
    };
    SparseMatrix stiffness = scaled(matrices.stiffness), mass = scaled(matrices.mass);
    SparseMatrix damping = matrices.damping.nonZeros() > 0 ? scaled(matrices.damping) : SparseMatrix(b + n, b + n);
    Eigen::Matrix<double, Eigen::Dynamic, 3> inertia(b + n, 3), on_rest(modes.rest(), 3);
    for (Index i = 0; i < modes.rest(); ++i)
      on_rest.row(i) = matrices.inertia.row(modes.rest_places()[static_cast<std::size_t>(i)]);
    inertia.topRows(b) = modes.static_shapes().transpose() * on_rest;
    for (Index i = 0; i < b; ++i) inertia.row(i) += matrices.inertia.row(kept_[static_cast<std::size_t>(i)]);
    inertia.bottomRows(n) = scale.tail(n).asDiagonal() * (modes.shapes().transpose() * on_rest);
    matrices.stiffness = std::move(stiffness);
    matrices.mass = std::move(mass);
    matrices.damping = std::move(damping);
    matrices.inertia = std::move(inertia);
  }

  void rename(Index b, Index n) {
    const auto all = static_cast<std::size_t>(b + n);
    place_.assign(static_cast<std::size_t>(model_.size()), ground);
    for (Index i = 0; i < b; ++i) place_[static_cast<std::size_t>(kept_[static_cast<std::size_t>(i)])] = i;
    std::vector<std::string> names;
    std::vector<char> is_rotation(all, 0);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
      const auto from = static_cast<std::size_t>(kept_[i]);
      names.push_back(std::move(model_.coordinates[from]));
      is_rotation[i] = model_.is_rotation[from];
    }
    for (Index j = 1; j <= n; ++j) names.push_back(fmt::format("mode_{}", j));
    const auto pick = [&](Vector& values) {
      Vector picked = Vector::Zero(b + n);
      for (Index i = 0; i < b; ++i) picked[i] = values[kept_[static_cast<std::size_t>(i)]];
      values = picked;
    };
    pick(model_.position);
    pick(model_.velocity);
    if (model_.base_motion) pick(model_.base_motion->direction);
    model_.coordinates = std::move(names);
    model_.is_rotation = std::move(is_rotation);
    const auto move = [&](Index& coordinate) {
      if (coordinate != ground) coordinate = place_[static_cast<std::size_t>(coordinate)];
    };
    const auto move_ends = [&](auto& parts) {
      for (auto& part : parts) {
        move(part.first);
        move(part.second);
      }
    };
    move_ends(model_.springs);
    move_ends(model_.dashpots);
    move_ends(model_.sliders);
    move_ends(model_.stops);
    move_ends(model_.laws);
    for (LawBetween& law : model_.laws)
      for (Share& share : law.shares) move(share.coordinate);
    for (BlockBetween& block : model_.blocks)
      for (auto& column : block.columns)
        for (Share& share : column) move(share.coordinate);
    for (Force& force : model_.forces) move(force.coordinate);
    for (auto* held : {&model_.held_forces, &model_.held_displacements})
      for (Held& one : *held) move(one.coordinate);
    for (Prescribed& motion : model_.prescribed) move(motion.coordinate);
    for (auto& places : model_.structure.places)
      for (Index& place : places) move(place);
  }

  Model& model_;
  const FiniteElements& elements_;
  const ReductionDescription& description_;
  Index before_;
  std::vector<char> is_kept_;
  std::vector<Index> kept_, place_;
};

}  // namespace

void reduce(Model& model, const FiniteElements& elements, const ReductionDescription& description, Index before) {
  Reducer(model, elements, description, before).reduce();
}

}  // namespace rubato::model
