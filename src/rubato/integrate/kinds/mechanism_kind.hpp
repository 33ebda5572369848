#pragma once

#include <rubato/integrate/kinds/mechanism_marches.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>
#include <utility>

namespace rubato::integrate {

/// A mechanism: bodies and beams that joints hold.
class MechanismKind final : public SystemKind {
 public:
  /// @param mechanism  must outlive this
  explicit MechanismKind(const system::Mechanism& mechanism) : mechanism_(mechanism) {}
  explicit MechanismKind(std::unique_ptr<const system::Mechanism> mechanism)
      : owned_(std::move(mechanism)), mechanism_(*owned_) {}

  const system::System& system() const override { return mechanism_; }
  const system::State& start() const override { return mechanism_.start(); }
  double reference() const override { return mechanism_.reference(); }
  bool is_constrained() const override { return true; }
  void show(KindVisitor& visitor) const override { visitor.mechanism(mechanism_); }
  /// Rows of locks that are open and of friction count nothing. What is left is what Gruebler and Kutzbach count,
  /// coordinates less rows, corrected by the rank of the start; drives hold what they drive.
  std::string summary() const override;
  std::vector<NonlinearPart> nonlinear_parts() const override;
  void for_each_time_law(const std::function<void(const model::TimeLaw&)>& show) const override;

  const MarchKind& marches() const override { return marches_; }

  std::vector<model::Held> held_displacements(const StaticRequest& request) const override;
  /// Assembles the mechanism; throws where it cannot be.
  system::State static_start(const Location& where, std::vector<std::string>& warnings) const override;
  bool finds_equilibrium_at_once() const override { return false; }
  /// Downhill from a configuration that is assembled; friction of joints is left out.
  Equilibrium find_equilibrium(const system::State& start, std::span<const model::Held> held) const override;

  Index mode_count(const ModesRequest& request) const override;
  /// With friction that takes no part.
  system::State held_still(const system::State& state, std::vector<std::string>& warnings) const override;
  FreeMotions free_motions(const system::State& state, Index limit, Index count) const override;
  std::vector<std::string> drives() const override;

 private:
  std::unique_ptr<const system::Mechanism> owned_;  // null: it is lent
  const system::Mechanism& mechanism_;
  MechanismMarches marches_{mechanism_};
};

}  // namespace rubato::integrate
