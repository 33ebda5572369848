#pragma once

#include <rubato/analysis/mechanism_plan.hpp>
#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

#include <memory>
#include <string>

namespace rubato::analysis {

/// A transient of a mechanism, ready to go: the method, what measures its error, its events, and the state.
class MechanismMarch {
 public:
  /// @param plan  must outlive this
  MechanismMarch(const MechanismPlan& plan, const system::Mechanism& mechanism);

  /// Goes on to `end` [s]; observers may be null.
  integrate::AdaptiveReport go_to(double end, integrate::Observer* observer, integrate::TryLog* log);
  /// Why it ended before its time, and what may help.
  std::string failure(const integrate::AdaptiveReport& report) const;

  bool has_equal_steps() const;
  const system::State& state() const { return state_; }
  /// By which errors are measured now [m sqrt(kg)]; 0: by no size of the motion.
  double error_size() const { return estimator_->size(); }
  const integrate::MechanismTimeline& timeline() const { return timeline_; }

 private:
  const MechanismPlan& plan_;
  const system::Mechanism& mechanism_;
  std::unique_ptr<integrate::Stepper> stepper_;
  std::unique_ptr<integrate::Estimator> estimator_;
  integrate::MechanismTimeline timeline_;
  system::State state_;
};

}  // namespace rubato::analysis
