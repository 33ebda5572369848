#pragma once

#include <rubato/model/description.hpp>
#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/moving_supports.hpp>
#include <rubato/system/system.hpp>

#include <optional>
#include <vector>

namespace rubato::analysis {

using results::Observed;

/// Whether supports that move count among the coordinates, after the free ones, as in MovingSupports.
enum class Supports { left_out, observed };

/// Where what is observed is looked up.
struct Observable {
  const system::System& system;
  const system::MovingSupports* supports = nullptr;  ///< null: none moves
  Supports supports_are = Supports::left_out;
};

/// Looks up a coordinate or a difference. Throws InvalidInput at its place, with the nearest name.
Observed observed_of(const model::ObservationDescription& description, const Observable& in);

/// Every coordinate of a system, in its order.
std::vector<Observed> every_coordinate(const system::System& system);

/// What is asked for, or every coordinate: displacements, then rotations.
std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const Observable& in);

}  // namespace rubato::analysis
