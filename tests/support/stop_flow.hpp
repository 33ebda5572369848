#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <variant>
#include <vector>

namespace rubato::testing {

/// The exact motion of an undamped structure with one undamped stop under tabulated loads: the modes with the stop open
/// and with it closed, joined where the gap closes and opens, and where a table has a row.
class StopFlow {
 public:
  StopFlow(const system::LocallyNonlinear& system, const system::State& start, double end)
      : open_(system, false), closed_(system, true), stop_(system.stops().at(0)) {
    if (system.stop_count() != 1 || system.slider_count() > 0 || system.damping().nonZeros() > 0 || stop_.damping > 0.0)
      throw std::logic_error("StopFlow is for one undamped stop on an undamped structure");
    double t = start.t;
    Vector q = start.q, v = start.v;
    bool is_closed = displacement(q) > stop_.gap;
    std::vector<double> rows = system.loads().breakpoints(t, end);
    rows.push_back(end);
    for (auto row = rows.begin();;) {
      pieces_.push_back(piece_from(t, q, v, is_closed));
      t = next_transition(t, *row);
      q = at(pieces_.back(), t, 0);
      v = at(pieces_.back(), t, 1);
      if (t < *row) {
        is_closed = !is_closed;
        transitions_.push_back(t);
      } else if (++row == rows.end()) {
        return;
      }
    }
  }

  /// The derivative of the given order, 0 or 1, of q at t.
  Vector at(double t, int order = 0) const {
    auto piece = std::upper_bound(pieces_.begin(), pieces_.end(), t,
                                  [](double time, const Piece& candidate) { return time < candidate.start; });
    if (piece != pieces_.begin()) --piece;
    return at(*piece, t, order);
  }
  const std::vector<double>& transitions() const { return transitions_; }

 private:
  struct Modes {
    Modes(const system::LocallyNonlinear& system, bool with_stop) {
      const model::Stop& stop = system.stops().at(0);
      Vector joins = Vector::Zero(system.size());
      if (stop.first != ground) joins[stop.first] += 1.0;
      if (stop.second != ground) joins[stop.second] -= 1.0;
      const double held = with_stop ? stop.stiffness : 0.0;
      mass = Matrix(system.mass());
      const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(
          Matrix(system.stiffness()) + held * joins * joins.transpose(), mass);
      shapes = modes.eigenvectors();
      omega = modes.eigenvalues().cwiseSqrt();
      constant = (held * stop.gap) * (shapes.transpose() * joins).cwiseQuotient(modes.eigenvalues());
      stiffness = modes.eigenvalues();
      for (const auto& term : system.loads().terms()) {
        Vector load = Vector::Zero(system.size());
        for (std::size_t i = 0; i < term.rows.size(); ++i) load[term.rows[i]] += term.weights[i];
        loads.push_back({std::get<model::TableLaw>(term.law), (shapes.transpose() * load).cwiseQuotient(stiffness)});
      }
    }
    struct Load {
      model::TableLaw law;
      Vector still;  // the modal displacements that a load of one holds
    };
    Matrix mass, shapes;
    Vector stiffness, omega, constant;
    std::vector<Load> loads;
  };
  struct Piece {
    double start;
    const Modes* modes;
    Vector still, drift;  // the particular solution still + drift (t - start)
    Vector cosine, sine;
    bool is_closed;
  };

  double displacement(const Vector& q) const {
    return (stop_.first == ground ? 0.0 : q[stop_.first]) - (stop_.second == ground ? 0.0 : q[stop_.second]);
  }

  Piece piece_from(double t, const Vector& q, const Vector& v, bool is_closed) const {
    const Modes& m = is_closed ? closed_ : open_;
    Piece piece{t, &m, m.constant, Vector::Zero(q.size()), {}, {}, is_closed};
    for (const auto& load : m.loads) {
      const auto& times = load.law.times;
      const auto next = std::upper_bound(times.begin(), times.end(), t);
      piece.still += model::value(load.law, t) * load.still;
      if (next == times.end() || next == times.begin()) continue;
      const auto row = static_cast<std::size_t>(next - times.begin());
      piece.drift += (load.law.values[row] - load.law.values[row - 1]) / (times[row] - times[row - 1]) * load.still;
    }
    piece.cosine = m.shapes.transpose() * (m.mass * q) - piece.still;
    piece.sine = (m.shapes.transpose() * (m.mass * v) - piece.drift).cwiseQuotient(m.omega);
    return piece;
  }

  static Vector at(const Piece& piece, double t, int order) {
    const Modes& m = *piece.modes;
    const double since = t - piece.start;
    Vector y = order == 0 ? piece.still + since * piece.drift : piece.drift;
    for (Index i = 0; i < y.size(); ++i) {
      const double w = m.omega[i], c = std::cos(w * since), s = std::sin(w * since);
      y[i] += order == 0 ? piece.cosine[i] * c + piece.sine[i] * s : w * (piece.sine[i] * c - piece.cosine[i] * s);
    }
    return m.shapes * y;
  }

  /// Looked for at an eighth of a radian of the highest mode that a stop of this stiffness has, then bisected.
  double next_transition(double t, double end) const {
    const Piece& piece = pieces_.back();
    const double stride = 0.125 / closed_.omega.maxCoeff(), side = piece.is_closed ? 1.0 : -1.0;
    const auto beyond = [&](double time) { return side * (displacement(at(piece, time, 0)) - stop_.gap) < 0.0; };
    double low = t + 1e-3 * stride;
    while (low < end) {
      double high = std::min(end, low + stride);
      if (beyond(high)) {
        for (int i = 0; i < 60; ++i) {
          const double middle = 0.5 * (low + high);
          (beyond(middle) ? high : low) = middle;
        }
        return high;
      }
      low = high;
    }
    return end;
  }

  Modes open_, closed_;
  model::Stop stop_;
  std::vector<Piece> pieces_;
  std::vector<double> transitions_;
};

}  // namespace rubato::testing
