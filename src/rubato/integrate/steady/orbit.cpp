#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/integrate/steady/orbit.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace rubato::integrate {
namespace {

constexpr int nodes = 12;  // exact to round-off over the longest piece, for harmonics that turn by up to 3 rad in it
constexpr double turn = 3.0;
using Nodes = Eigen::Array<double, nodes, 1>;

// The number of terms of a piece that matter, if a share x / reach of its longest length is used: x^k/k! below
// round-off, and two more for the second derivative.
Index terms_of(double x) {
  Index k = 1;
  double term = x;
  while (k < TaylorPiece::degree - 2 && term > 1e-18) term *= x / static_cast<double>(++k);
  return std::min<Index>(k + 3, TaylorPiece::degree + 1);
}

struct Range {
  double low = HUGE_VAL, high = -HUGE_VAL;
  double half_peak_to_peak(bool half) const {
    return half ? std::max(std::abs(low), std::abs(high)) : 0.5 * (high - low);
  }
};

// The derivative of a polynomial, in place.
std::span<const double> differentiate(std::span<double> c) {
  for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] = static_cast<double>(k + 1) * c[k + 1];
  return c.first(c.size() - 1);
}

}  // namespace

void Orbit::add(const TaylorPiece& piece, double start, double length, const std::vector<SliderState>& states) {
  if (!(length > 0.0)) return;
  if (count_ == pieces_.size()) pieces_.emplace_back();
  Piece& kept = pieces_[count_++];
  kept.start = start;
  kept.length = length;
  kept.terms = terms_of(TaylorPiece::reach * std::min(length / piece.max_length(), 1.0));
  kept.states = states;
  const Index m = system_.slider_count();
  kept.q = piece.displacements().leftCols(kept.terms);
  kept.u.resize(kept.terms, m);
  kept.offset.resize(m);
  kept.limit.resize(m);
  for (Index i = 0; i < m; ++i) {
    kept.u.col(i) = Eigen::Map<const Vector>(piece.relative_displacement(i), kept.terms);
    kept.offset[i] = piece.offset(i);
    kept.limit[i] = piece.limit(i);
  }
}

bool Orbit::slips(Index slider) const {
  return std::any_of(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(count_), [&](const Piece& piece) {
    return piece.states[static_cast<std::size_t>(slider)] != SliderState::stick;
  });
}

void Orbit::displacement_range(Index slider, double& low, double& high) const {
  Range range;
  for (std::size_t i = 0; i < count_; ++i)
    include_range({pieces_[i].u.col(slider).data(), static_cast<std::size_t>(pieces_[i].terms)}, pieces_[i].length,
                  range.low, range.high);
  low = range.low;
  high = range.high;
}

void Orbit::measure(const Excitation& excitation, const SteadyRequest& request, bool half,
                    SteadyResponse& response) const {
  measure_ranges(request, half, response);
  measure_integrals(excitation, request, half, response);
  measure_sliders(excitation.period(), half, response);
}

void Orbit::measure_ranges(const SteadyRequest& request, bool half, SteadyResponse& response) const {
  const auto observed = static_cast<Index>(request.observed.size());
  response.amplitude.resize(observed);
  response.velocity_amplitude.resize(request.rates ? observed : 0);
  response.acceleration_amplitude.resize(request.rates ? observed : 0);
  std::array<double, TaylorPiece::degree + 1> storage;
  for (Index o = 0; o < observed; ++o) {
    const auto& what = request.observed[static_cast<std::size_t>(o)];
    Range position, velocity, acceleration;
    for (std::size_t i = 0; i < count_; ++i) {
      const Piece& piece = pieces_[i];
      std::span<double> c(storage.data(), static_cast<std::size_t>(piece.terms));
      for (Index k = 0; k < piece.terms; ++k)
        c[static_cast<std::size_t>(k)] =
            piece.q(what.first, k) - (what.second == ground ? 0.0 : piece.q(what.second, k));
      include_range(c, piece.length, position.low, position.high);
      if (!request.rates) continue;
      const auto rate = differentiate(c);
      include_range(rate, piece.length, velocity.low, velocity.high);
      include_range(differentiate(c.first(rate.size())), piece.length, acceleration.low, acceleration.high);
    }
    response.amplitude[o] = position.half_peak_to_peak(half);
    if (!request.rates) continue;
    response.velocity_amplitude[o] = velocity.half_peak_to_peak(half);
    response.acceleration_amplitude[o] = acceleration.half_peak_to_peak(half);
  }
}

// Quadrature over the pieces. The works of harmonic loads follow from the harmonics of what they act on: over a period
// Re(a exp(i k w t)) on Re(x exp(i k w t)) does pi k Im(a conj(x)), and a static load does none.
void Orbit::measure_integrals(const Excitation& excitation, const SteadyRequest& request, bool half,
                              SteadyResponse& response) const {
  static const numerics::GaussLegendre<nodes> gauss;
  static const Nodes node = Eigen::Map<const Nodes>(gauss.node.data());
  static const Nodes weight = Eigen::Map<const Nodes>(gauss.weight.data());
  const Index n = system_.size();
  const auto observed = static_cast<Index>(request.observed.size());
  const auto orders = static_cast<Index>(request.harmonics.size());
  const double omega = excitation.angular_frequency, period = excitation.period(), share = half ? 2.0 : 1.0;
  const SparseMatrix& damping = system_.damping();
  response.mean = Vector::Zero(observed);
  response.rms = Vector::Zero(observed);
  response.harmonics = ComplexMatrix::Zero(observed, orders);
  response.viscous_work = response.input_work = 0.0;

  int highest = excitation.harmonics.empty() ? 1 : excitation.harmonics.back().order;
  for (const int order : request.harmonics) highest = std::max(highest, order);
  Eigen::Array<double, nodes, Eigen::Dynamic> q(nodes, n), v(nodes, n);
  std::array<std::complex<double>, nodes> turned, rotated;
  const auto rotate = [&](int order) {  // exp(i order w t)
    for (std::size_t j = 0; j < nodes; ++j) {
      std::complex<double> power = turned[j];
      for (int k = 1; k < order; ++k) power *= turned[j];
      rotated[j] = power;
    }
  };

  for (std::size_t i = 0; i < count_; ++i) {
    const Piece& piece = pieces_[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(highest * omega * piece.length / turn)));
    const double width = piece.length / parts;
    for (int part = 0; part < parts; ++part) {
      const Nodes s = width * (part + node);
      for (Index c = 0; c < n; ++c) {
        Nodes value = Nodes::Zero(), slope = Nodes::Zero();
        for (Index k = piece.terms; k-- > 0;) {
          slope = slope * s + value;
          value = value * s + piece.q(c, k);
        }
        q.col(c) = value;
        v.col(c) = slope;
      }
      for (std::size_t j = 0; j < nodes; ++j)
        turned[j] = std::polar(1.0, omega * (piece.start + s[static_cast<Index>(j)]));

      for (Index o = 0; o < observed; ++o) {
        const auto& what = request.observed[static_cast<std::size_t>(o)];
        Nodes x = q.col(what.first);
        if (what.second != ground) x -= q.col(what.second);
        response.mean[o] += width * (weight * x).sum();
        response.rms[o] += width * (weight * x.square()).sum();
      }
      for (Index h = 0; h < orders; ++h) {
        rotate(request.harmonics[static_cast<std::size_t>(h)]);
        for (Index o = 0; o < observed; ++o) {
          const auto& what = request.observed[static_cast<std::size_t>(o)];
          std::complex<double> sum = 0.0;
          for (Index j = 0; j < nodes; ++j) {
            const double x = q(j, what.first) - (what.second == ground ? 0.0 : q(j, what.second));
            sum += weight[j] * x * std::conj(rotated[static_cast<std::size_t>(j)]);
          }
          response.harmonics(o, h) += width * sum;
        }
      }
      for (const LoadHarmonic& load : excitation.harmonics) {
        rotate(load.order);
        std::complex<double> sum = 0.0;
        for (Index c = 0; c < n; ++c) {
          if (load.amplitude[c] == 0.0) continue;
          std::complex<double> moment = 0.0;
          for (Index j = 0; j < nodes; ++j) moment += weight[j] * q(j, c) * rotated[static_cast<std::size_t>(j)];
          sum += load.amplitude[c] * moment;
        }
        response.input_work += share * omega * load.order * width * sum.imag();
      }
      for (Index c = 0; c < damping.outerSize(); ++c)
        for (SparseMatrix::InnerIterator entry(damping, c); entry; ++entry)
          response.viscous_work += share * width * entry.value() * (weight * v.col(entry.row()) * v.col(c)).sum();
    }
  }
  if (half) response.mean.setZero();
  response.mean /= period;
  response.rms = (share * response.rms / period).cwiseSqrt();
  response.harmonics *= 2.0 * share / period;
  if (half)
    for (Index h = 0; h < orders; ++h)
      if (request.harmonics[static_cast<std::size_t>(h)] % 2 == 0) response.harmonics.col(h).setZero();
}

void Orbit::measure_sliders(double period, bool half, SteadyResponse& response) const {
  const Index m = system_.slider_count();
  const double share = half ? 2.0 : 1.0;
  response.dissipated = Vector::Zero(m);
  response.slip_share = Vector::Zero(m);
  response.offset = Vector::Zero(m);
  response.transitions = 0;
  for (Index i = 0; i < m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (std::size_t p = 0; p < count_; ++p) {
      const Piece& piece = pieces_[p];
      const SliderState state = piece.states[k];
      const Piece& before = pieces_[p > 0 ? p - 1 : count_ - 1];
      // The piece before the first is the last, in half a period with the opposite sign.
      const auto sign_before = static_cast<int>(before.states[k]) * (p == 0 && half ? -1 : 1);
      if (piece.limit[i] > 0.0 && sign_before != static_cast<int>(state)) response.transitions += half ? 2 : 1;
      if (state == SliderState::stick) continue;
      const std::span<const double> u(piece.u.col(i).data(), static_cast<std::size_t>(piece.terms));
      response.dissipated[i] += share * piece.limit[i] * std::abs(polynomial(u, piece.length) - u[0]);
      response.slip_share[i] += share * piece.length / period;
    }
    if (count_ > 0 && !slips(i)) response.offset[i] = pieces_[0].offset[i];
  }
}

Waveform Orbit::waveform(const Excitation& excitation, bool half, int points) const {
  const Index n = system_.size(), m = system_.slider_count();
  Waveform wave{Vector(points), Matrix::Zero(n, points), Matrix::Zero(n, points), Matrix::Zero(m, points),
                Matrix::Zero(m, points)};
  if (count_ == 0) return wave;
  const double period = excitation.period();
  for (int j = 0; j < points; ++j) {
    wave.time[j] = period * j / points;
    const bool mirrored = half && 2 * j >= points;
    const double sign = mirrored ? -1.0 : 1.0, t = wave.time[j] - (mirrored ? 0.5 * period : 0.0);
    std::size_t p = 0;
    while (p + 1 < count_ && t >= pieces_[p + 1].start) ++p;
    const Piece& piece = pieces_[p];
    const double s = std::clamp(t - piece.start, 0.0, piece.length);
    for (Index k = piece.terms; k-- > 0;) {
      wave.velocity.col(j) = s * wave.velocity.col(j) + wave.position.col(j);
      wave.position.col(j) = s * wave.position.col(j) + piece.q.col(k);
    }
    wave.position.col(j) *= sign;
    wave.velocity.col(j) *= sign;
    for (Index i = 0; i < m; ++i) {
      const double u = polynomial({piece.u.col(i).data(), static_cast<std::size_t>(piece.terms)}, s);
      const bool sticks = piece.states[static_cast<std::size_t>(i)] == SliderState::stick;
      const double force =
          piece.offset[i] + (sticks ? system_.sliders()[static_cast<std::size_t>(i)].stiffness * u : 0.0);
      wave.displacement(i, j) = sign * u;
      wave.slider_force(i, j) = sign * std::clamp(force, -piece.limit[i], piece.limit[i]);
    }
  }
  return wave;
}

}  // namespace rubato::integrate
