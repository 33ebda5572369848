#pragma once

#include <rubato/steady/marching/period_map.hpp>

#include <deque>
#include <memory>
#include <vector>

namespace rubato::steady {

/// Guesses from marched periods where the march will end: a step x -> x + step that makes the residual r(x) = P(x) - x
/// vanish, for all lanes at once. Marching is the step r.
class OrbitExtrapolation {
 public:
  virtual ~OrbitExtrapolation() = default;
  /// A new search: what was seen before belongs to another map. Lanes other than before are strangers.
  virtual void begin(PeriodMap& map, Index lanes) = 0;
  /// Takes the residuals of the states marched last, and writes the steps [size x lanes].
  virtual void next(const LaneArray& states, const LaneArray& residuals, LaneArray& steps) = 0;
  /// Whether the last step guesses the distance to the end of the march: enough has been seen of how slowly it decays.
  virtual bool knows_distance(Index lane) const = 0;
  /// What was learnt in this lane misleads, if anything was.
  virtual void distrust(Index lane) = 0;
  /// Learns the derivative of the residuals anew, by marching a period from states beside the given ones, for the lanes
  /// that ask for it. Returns the periods marched; none where that costs more than it is worth.
  virtual int measure(PeriodMap& map, const LaneArray& states, const std::vector<char>& asks) = 0;
  virtual void forget() = 0;
};

/// Broyden's first method (1965) with the inverse H of -dr/dx, which starts from that of the structure without sliders
/// (PeriodMap::linear_update) and is kept from point to point:
///
///   step = H r,   H += -(s + H y) (s^T H) / (s^T H y),   s = dx, y = dr of the last two periods.
///
/// A slider that sticks through the period has no residual, and keeps its slip.
class BroydenExtrapolation final : public OrbitExtrapolation {
 public:
  void begin(PeriodMap& map, Index lanes) override;
  void next(const LaneArray& states, const LaneArray& residuals, LaneArray& steps) override;
  bool knows_distance(Index lane) const override;
  void distrust(Index lane) override;
  int measure(PeriodMap& map, const LaneArray& states, const std::vector<char>& asks) override;
  void forget() override { lanes_ = 0; }

 private:
  void update(const LaneArray& states, const LaneArray& residuals);

  Index size_ = 0, lanes_ = 0;
  Matrix first_;  // H of the structure without sliders, or identity
  bool knows_structure_ = false;
  std::vector<int> updates_;  // since H was the first
  LaneArray inverse_;         // H [size^2 x lanes], by rows
  LaneArray last_state_, last_residual_, s_, y_, hy_, sh_;
  bool has_last_ = false;
};

/// For large states, Anderson's mixing (Anderson 1965; Walker and Ni 2011, type II): with the last differences of the
/// states and of the residuals
///
///   step = r - (dX + dR) g,   g = argmin |r - dR g|.
class AndersonExtrapolation final : public OrbitExtrapolation {
 public:
  void begin(PeriodMap& map, Index lanes) override;
  void next(const LaneArray& states, const LaneArray& residuals, LaneArray& steps) override;
  bool knows_distance(Index lane) const override;
  void distrust(Index lane) override;
  int measure(PeriodMap&, const LaneArray&, const std::vector<char>&) override { return 0; }
  void forget() override {}

 private:
  struct History {
    std::deque<Vector> dx, dr;
    Vector last_x, last_r;
  };
  std::vector<History> histories_;
};

/// The one that fits the size of the states.
std::unique_ptr<OrbitExtrapolation> make_extrapolation(Index size);

}  // namespace rubato::steady
