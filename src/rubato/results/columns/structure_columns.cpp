#include <rubato/results/columns/block_columns.hpp>
#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/results/columns/law_columns.hpp>
#include <rubato/results/columns/structure_columns.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rubato::results {
namespace {

/// Of coordinates, then of supports that move.
class ObservedWithSupports final : public ObservedColumns {
 public:
  ObservedWithSupports(const system::MovingSupports& supports, const std::vector<Observed>& observed)
      : ObservedColumns(observed, of_motion), supports_(supports) {}

 private:
  const Vector& values(Quantity quantity, const system::State& state, Vector& workspace) override {
    const Vector& free = quantity == Quantity::position   ? state.q
                         : quantity == Quantity::velocity ? state.v
                                                          : state.acceleration;
    supports_.extend(state.t, model::Side::right, free, workspace, static_cast<int>(quantity));
    return workspace;
  }

  const system::MovingSupports& supports_;
};

/// With the values of the sliders among the attributes of the table.
class DescribedSliders final : public SliderColumns {
 public:
  explicit DescribedSliders(const system::LocallyNonlinear& system) : SliderColumns(system), system_(system) {}

  void add(TableLayout& layout) const override {
    SliderColumns::add(layout);
    if (system_.slider_count() == 0) return;
    std::vector<double> stiffness, limit;
    for (const Index i : order()) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      stiffness.push_back(slider.stiffness);
      limit.push_back(slider.limit);
    }
    layout.attributes.emplace_back("slider_stiffness", fmt::format("{}", fmt::join(stiffness, ", ")));
    layout.attributes.emplace_back("slider_limit", fmt::format("{}", fmt::join(limit, ", ")));
  }

 private:
  const system::LocallyNonlinear& system_;
};

/// The forces that move supports, then the moments that turn them.
class SupportColumns final : public ColumnGroup {
 public:
  explicit SupportColumns(const system::MovingSupports& supports) : supports_(supports) {
    for (Index i = 0; i < supports.size(); ++i) (supports.is_rotation(i) ? turning_ : moving_).push_back(i);
  }

  void add(TableLayout& layout) const override {
    if (!moving_.empty())
      layout.blocks.push_back({"reaction", "N", "force that moves the support", "moving_support", names_of(moving_)});
    if (!turning_.empty())
      layout.blocks.push_back(
          {"reaction_moment", "N m", "moment that turns the support", "turning_support", names_of(turning_)});
  }

  void append(const system::State& state, std::vector<double>& row) override {
    const auto side = model::Side::right;
    supports_.extend(state.t, side, state.q, q_, 0);
    supports_.extend(state.t, side, state.v, v_, 1);
    supports_.extend(state.t, side, state.acceleration, a_, 2);
    supports_.reaction(state.t, side, q_, v_, a_, reaction_);
    for (const auto* supports : {&moving_, &turning_})
      for (const Index i : *supports) row.push_back(reaction_[i]);
  }

 private:
  std::vector<std::string> names_of(const std::vector<Index>& supports) const {
    std::vector<std::string> names;
    for (const Index i : supports) names.push_back(supports_.names()[static_cast<std::size_t>(i)]);
    return names;
  }

  const system::MovingSupports& supports_;
  std::vector<Index> moving_, turning_;
  Vector q_, v_, a_, reaction_;  // of all coordinates
};

}  // namespace

ColumnGroups columns_of_motion(const system::LocallyNonlinear& system, const std::vector<Observed>& observed) {
  ColumnGroups groups;
  if (system.supports())
    groups.push_back(std::make_unique<ObservedWithSupports>(*system.supports(), observed));
  else
    groups.push_back(std::make_unique<ObservedColumns>(observed, ObservedColumns::of_motion));
  groups.push_back(std::make_unique<DescribedSliders>(system));
  groups.push_back(std::make_unique<StopColumns>(system));
  if (system.law_count() > 0) groups.push_back(std::make_unique<LawColumns>(system, true));
  if (system.block_count() > 0) groups.push_back(std::make_unique<BlockColumns>(system, true));
  if (system.supports()) groups.push_back(std::make_unique<SupportColumns>(*system.supports()));
  return groups;
}

}  // namespace rubato::results
