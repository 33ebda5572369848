#pragma once

#include <rubato/integrate/kinds/structure_marches.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>
#include <utility>

namespace rubato::integrate {

/// A linear structure with laws between its coordinates.
class StructureKind final : public SystemKind {
 public:
  /// @param system  must outlive this
  explicit StructureKind(const system::LocallyNonlinear& system) : system_(system) {}
  explicit StructureKind(std::unique_ptr<const system::LocallyNonlinear> system)
      : owned_(std::move(system)), system_(*owned_) {}

  const system::System& system() const override { return system_; }
  const system::State& start() const override { return system_.start(); }
  double reference() const override { return system_.reference(); }
  const system::MovingSupports* supports() const override { return system_.supports(); }
  bool is_constrained() const override { return false; }
  void show(KindVisitor& visitor) const override { visitor.structure(system_); }
  const system::LocallyNonlinear* structure() const override { return &system_; }
  std::string summary() const override;
  std::vector<NonlinearPart> nonlinear_parts() const override;
  void for_each_time_law(const std::function<void(const model::TimeLaw&)>& show) const override;
  /// Loads hold the workspace of their formulas.
  std::unique_ptr<const SystemKind> for_thread() const override {
    return std::make_unique<StructureKind>(std::make_unique<const system::LocallyNonlinear>(system_));
  }

  std::optional<HarmonicOscillator> oscillator() const override;
  const MarchKind& marches() const override { return marches_; }

  std::vector<model::Held> held_displacements(const StaticRequest& request) const override;
  system::State static_start(const Location&, std::vector<std::string>&) const override { return system_.start(); }
  bool finds_equilibrium_at_once() const override { return true; }
  Equilibrium find_equilibrium(const system::State& start, std::span<const model::Held> held) const override;

  Index mode_count(const ModesRequest& request) const override;
  Index limit_count() const override { return system_.has_friction() ? 2 : 1; }
  system::State held_still(const system::State& state, std::vector<std::string>&) const override { return state; }
  /// Of the linear model, whatever the state.
  FreeMotions free_motions(const system::State& state, Index limit, Index count) const override;

 private:
  std::unique_ptr<const system::LocallyNonlinear> owned_;  // null: it is lent
  const system::LocallyNonlinear& system_;
  StructureMarches marches_{system_};
};

}  // namespace rubato::integrate
