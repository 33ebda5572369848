#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/kinds/structure_flow.hpp>
#include <rubato/integrate/structure_balance.hpp>
#include <rubato/integrate/structure_energy.hpp>

#include <algorithm>
#include <numbers>

namespace rubato::integrate {
namespace {

constexpr int samples_a_period = 64;

/// The energy of a structure with the works that the flow itself finds, of which steps know nothing.
class ExactEnergy final : public EnergyPart {
 public:
  /// @param work  done since the last step that was booked; must outlive this
  ExactEnergy(const system::LocallyNonlinear& system, const ExactWork& work) : structure_(system), work_(work) {}

  std::vector<Account> accounts() const override { return structure_.accounts(); }
  void add_stored(const system::State& state, Entries row) override { structure_.add_stored(state, row); }
  void add_flow(const system::State&, const system::State&, Entries row) override {
    row[StructureEnergy::damper_dissipated] += work_.damper;
    row[StructureEnergy::slider_dissipated] += work_.slider;
    row[StructureEnergy::load_work] += work_.load;
  }

 private:
  StructureEnergy structure_;
  const ExactWork& work_;
};

// 64 a period of the fastest harmonic load; of the fastest mode where there is none.
double default_interval(const system::LocallyNonlinear& system) {
  double omega = 0.0;
  for (const auto& term : system.loads().terms())
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law))
      omega = std::max(omega, harmonic->angular_frequency);
  if (omega == 0.0) {
    TaylorPiece piece(system);
    const std::vector<SliderState> stuck(static_cast<std::size_t>(system.slider_count()), SliderState::stick);
    piece.start(system.start(), stuck, 0.0);
    omega = TaylorPiece::reach / piece.max_length();
  }
  return 2.0 * std::numbers::pi / omega / samples_a_period;
}

/// Notes work and events on the way to another visitor.
class Noting final : public ExactVisitor {
 public:
  Noting(ExactVisitor& visitor, ExactWork& work, ContactEvents& contacts)
      : visitor_(visitor), work_(work), contacts_(contacts) {}

  bool sample(const system::State& state, const ExactWork& work) override {
    work_ = work;
    return visitor_.sample(state, work);
  }
  bool transition(const system::State& state, const Transition& transition, const ExactWork& work) override {
    contacts_.note_slider(transition.t, transition.slider, transition.state == SliderState::stick);
    work_ = work;
    return visitor_.transition(state, transition, work);
  }
  bool piece(const TaylorPiece& piece, double start, double length, const std::vector<SliderState>& states) override {
    return visitor_.piece(piece, start, length, states);
  }

 private:
  ExactVisitor& visitor_;
  ExactWork& work_;
  ContactEvents& contacts_;
};

class StructureFlow final : public FlowMarch {
 public:
  StructureFlow(const MarchPlan& plan, const system::LocallyNonlinear& system)
      : system_(system), flow_(system), balance_(system), state_(plan.start), contacts_(system, plan.start) {}

  const system::State& state() const override { return state_; }
  Balance& balance() override { return balance_; }
  std::vector<std::unique_ptr<EnergyPart>> energy_parts() override {
    std::vector<std::unique_ptr<EnergyPart>> parts;
    parts.push_back(std::make_unique<ExactEnergy>(system_, work_));
    return parts;
  }
  void show(MarchVisitor& visitor) override { visitor.structure(system_); }
  Events events() const override { return contacts_.events(); }
  double sample_interval() const override { return default_interval(system_); }

  FlowReport go_to(double end, std::span<const double> times, ExactVisitor& visitor, bool with_work) override {
    Noting noting(visitor, work_, contacts_);
    const ExactReport report = flow_.advance(state_, end, times, noting, with_work);
    FlowReport told{report.end, report.transitions, {}};
    if (report.worst >= 0) told.worst = system_.sliders()[static_cast<std::size_t>(report.worst)].name;
    return told;
  }

 private:
  const system::LocallyNonlinear& system_;
  ExactFlow flow_;
  StructureBalance balance_;
  system::State state_;
  ContactEvents contacts_;
  ExactWork work_;  // up to the last state that was shown
};

}  // namespace

std::unique_ptr<FlowMarch> make_structure_flow(const MarchPlan& plan, const system::LocallyNonlinear& system) {
  return std::make_unique<StructureFlow>(plan, system);
}

}  // namespace rubato::integrate
