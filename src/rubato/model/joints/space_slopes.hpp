#pragma once

#include <rubato/model/joints/space_rows.hpp>

// Private to the joints: sums of the slopes of rows, written where they are asked for.
namespace rubato::model {

using SlopeSum = Eigen::Map<Eigen::Matrix<double, 12, 12, Eigen::RowMajor>>;

/// sum += weight * the slope of a row: SpaceValue::slope
void add_slope(const SpaceRow& row, const SpacePair& pair, double weight, SlopeSum& sum);

}  // namespace rubato::model
