#pragma once

#include <rubato/core/types.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// Forces and slopes of all contacts of a structure that has gone in a straight line from where nothing has moved.
class ContactsFromRest {
 public:
  explicit ContactsFromRest(const system::LocallyNonlinear& system);

  /// Forces and memories of a state by its displacements, and the slopes there.
  void load(system::State& state);

  /// Of each contact, by its own number [N/m].
  const Vector& slope() const { return slope_; }
  /// Of each law, df/dN by what presses on it [-].
  const Vector& by_normal() const { return by_normal_; }
  /// Of forces of blocks by other numbers than their own: take(contact, other contact, slope).
  template <class Take>
  void for_each_cross_slope(const Take& take) const {
    for (Index b = 0; b < system_.block_count(); ++b) {
      const Index first = system_.row_of_block(b), size = system_.blocks()[static_cast<std::size_t>(b)].law->size();
      const model::BlockAnswer& answer = block_slopes_[static_cast<std::size_t>(b)];
      for (Index i = 0; i < size; ++i)
        for (Index k = 0; k < size; ++k)
          if (i != k && answer.by_u[i][k] != 0.0) take(first + i, first + k, answer.by_u[i][k]);
    }
  }
  /// Whether the slopes make a symmetric tangent, whatever the displacements.
  bool is_symmetric() const { return is_symmetric_; }

  /// By how much the gap of each block is wider than it is [m]; at first zero.
  Vector& widened() { return widened_; }

 private:
  void load_block(Index b, system::State& state);
  void load_law(Index law, system::State& state);
  void take_normals();

  const system::LocallyNonlinear& system_;
  bool is_symmetric_ = true;
  Vector slope_, virgin_, widened_;
  Vector by_normal_, normal_at_rest_;  // of each law: df/dN, and what presses where nothing has moved
  std::vector<model::BlockAnswer> block_slopes_;
};

}  // namespace rubato::integrate
