#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/numerics/gauss_legendre.hpp>
#include <rubato/steady/periodic/orbit.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace rubato::steady {
namespace {

// Exact to round-off for what turns by z rad: z^20 (10!)^4/(21 (20!)^3) = 5e-17 at 5, the products of displacements
// that turn by TaylorPiece::reach with harmonics that turn by `most_turn`.
constexpr int nodes = 10;
constexpr double most_turn = 3.0;
using Nodes = Eigen::Array<double, nodes, 1>;

// cos(k x) and sin(k x) of the nodes about the middle of an interval, which lie symmetrically, to round-off up to x of
// half of most_turn: terms to x^23/23!.
void turn_by(double x, const Nodes& offset, Nodes& cosine, Nodes& sine) {
  using Half = Eigen::Array<double, nodes / 2, 1>;
  static constexpr auto inverse = [] {
    std::array<double, 24> table{};
    for (std::size_t k = 1; k < table.size(); ++k) table[k] = 1.0 / static_cast<double>(k * (k + 1));
    return table;
  }();
  const Half angle = x * offset.head<nodes / 2>(), square = angle * angle;
  Half even = Half::Ones(), odd = even;
  for (std::size_t k = 22; k > 0; k -= 2) {
    even = 1.0 - even * (square * inverse[k - 1]);
    odd = 1.0 - odd * (square * inverse[k]);
  }
  odd *= angle;
  cosine << even, even.reverse();
  sine << odd, -odd.reverse();
}

double half_peak_to_peak(const integrate::ValueRange& range, bool half) {
  return half ? std::max(std::abs(range.low), std::abs(range.high)) : 0.5 * (range.high - range.low);
}

}  // namespace

void Orbit::add(const integrate::TaylorPiece& piece, double start, double length,
                const std::vector<integrate::SliderState>& states) {
  if (!(length > 0.0)) return;
  if (count_ == pieces_.size()) pieces_.emplace_back();
  Piece& kept = pieces_[count_++];
  kept.start = start;
  kept.length = length;
  kept.turn = piece.rate() * length;
  kept.terms =
      std::min(piece.terms(), integrate::TaylorPiece::terms_of(kept.turn) + 2);  // two more for the second derivative
  kept.states = states;
  const Index m = system_.slider_count();
  kept.q.resize(system_.size(), integrate::TaylorPiece::degree + 1);
  kept.q.leftCols(kept.terms) = piece.displacements().leftCols(kept.terms);
  kept.offset.resize(m);
  kept.limit.resize(m);
  for (Index i = 0; i < m; ++i) {
    kept.offset[i] = piece.offset(i);
    kept.limit[i] = piece.limit(i);
  }
}

bool Orbit::slips(Index slider) const {
  return std::any_of(pieces_.begin(), pieces_.begin() + static_cast<std::ptrdiff_t>(count_), [&](const Piece& piece) {
    return piece.states[static_cast<std::size_t>(slider)] != integrate::SliderState::stick;
  });
}

void Orbit::take_as_stuck(Index slider) {
  const auto& element = system_.sliders()[static_cast<std::size_t>(slider)];
  std::array<double, integrate::TaylorPiece::degree + 1> storage;
  for (std::size_t i = 0; i < count_; ++i) {
    Piece& piece = pieces_[i];
    integrate::SliderState& state = piece.states[static_cast<std::size_t>(slider)];
    if (state == integrate::SliderState::stick) continue;
    state = integrate::SliderState::stick;
    piece.offset[slider] -= element.stiffness * difference(piece, element.first, element.second, storage)[0];
  }
}

void Orbit::carry(integrate::FlowDerivative& derivative) const {
  for (std::size_t i = 0; i < count_; ++i) derivative.pass(pieces_[i].length, pieces_[i].turn, pieces_[i].states);
}

std::span<double> Orbit::difference(const Piece& piece, Index first, Index second, std::span<double> storage) const {
  const Index n = piece.q.rows();
  const double *a = first == ground ? nullptr : piece.q.data() + first,
               *b = second == ground ? nullptr : piece.q.data() + second;
  const auto terms = static_cast<std::size_t>(piece.terms);
  for (std::size_t k = 0; k < terms; ++k, a += a ? n : 0, b += b ? n : 0) storage[k] = (a ? *a : 0.0) - (b ? *b : 0.0);
  return storage.first(terms);
}

std::span<double> Orbit::observe(const Piece& piece, const SteadyRequest::Observed& what,
                                 std::span<double> storage) const {
  const auto terms = static_cast<std::size_t>(piece.terms);
  for (std::size_t k = 0; k < terms; ++k) storage[k] = what.of(piece.q.col(static_cast<Index>(k)));
  return storage.first(terms);
}

void Orbit::displacement_range(Index slider, double& low, double& high) const {
  integrate::ValueRange range;
  const auto& element = system_.sliders()[static_cast<std::size_t>(slider)];
  std::array<double, integrate::TaylorPiece::degree + 1> storage;
  for (std::size_t i = 0; i < count_; ++i)
    integrate::include_ranges(difference(pieces_[i], element.first, element.second, storage), pieces_[i].length,
                              {&range, 1});
  low = range.low;
  high = range.high;
}

void Orbit::measure(const system::Excitation& excitation, const SteadyRequest& request, bool half,
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
  std::array<double, integrate::TaylorPiece::degree + 1> storage;
  for (Index o = 0; o < observed; ++o) {
    const auto& what = request.observed[static_cast<std::size_t>(o)];
    std::array<integrate::ValueRange, 3> ranges;  // of the position, velocity and acceleration
    for (std::size_t i = 0; i < count_; ++i)
      integrate::include_ranges(observe(pieces_[i], what, storage), pieces_[i].length,
                                std::span(ranges).first(request.rates ? 3 : 1));
    response.amplitude[o] = half_peak_to_peak(ranges[0], half);
    if (!request.rates) continue;
    response.velocity_amplitude[o] = half_peak_to_peak(ranges[1], half);
    response.acceleration_amplitude[o] = half_peak_to_peak(ranges[2], half);
  }
}

// Quadrature over the pieces. The works of harmonic loads follow from the harmonics of what they act on: over a period
// Re(a exp(i k w t)) on Re(x exp(i k w t)) does pi k Im(a conj(x)), and a static load does none.
void Orbit::measure_integrals(const system::Excitation& excitation, const SteadyRequest& request, bool half,
                              SteadyResponse& response) const {
  static const numerics::GaussLegendre<nodes> gauss;
  static const Nodes node = Eigen::Map<const Nodes>(gauss.node.data());
  static const Nodes weight = Eigen::Map<const Nodes>(gauss.weight.data());
  static const Nodes offset = node - 0.5;
  const Index n = system_.size();
  const auto observed = static_cast<Index>(request.observed.size());
  const auto orders = static_cast<Index>(request.harmonics.size());
  const double omega = excitation.angular_frequency, period = excitation.period(), share = half ? 2.0 : 1.0;
  const SparseMatrix& damping = system_.damping();
  response.mean.setZero(observed);
  response.rms.setZero(observed);
  response.harmonics.setZero(observed, orders);
  response.viscous_work = response.input_work = 0.0;

  int highest = excitation.harmonics.empty() ? 1 : excitation.harmonics.back().order;
  for (const int order : request.harmonics) highest = std::max(highest, order);
  positions_.resize(nodes, n);
  velocities_.resize(nodes, n);
  // exp(i order w t) about the middle of a part, times the weights, and the middle's own.
  Nodes base_cosine, base_sine, cosine, sine;
  Complex middle;
  int present = 0;
  const auto rotate = [&](int order) {
    if (present > order) present = 0;
    if (present == 0) {
      cosine = weight;
      sine.setZero();
    }
    for (; present < order; ++present) {
      const Nodes before = cosine;
      cosine = before * base_cosine - sine * base_sine;
      sine = before * base_sine + sine * base_cosine;
    }
  };
  // The integral over the part of x exp(i order w t), per width.
  const auto moment = [&](const auto& x) { return Complex((x * cosine).sum(), (x * sine).sum()); };

  for (std::size_t i = 0; i < count_; ++i) {
    const Piece& piece = pieces_[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(highest * omega * piece.length / most_turn)));
    const double width = piece.length / parts;
    turn_by(omega * width, offset, base_cosine, base_sine);
    for (int part = 0; part < parts; ++part) {
      const Nodes s = width * (part + node);
      for (Index c = 0; c < n; ++c) {
        Nodes value = Nodes::Zero(), slope = Nodes::Zero();
        for (Index k = piece.terms; k-- > 0;) {
          slope = slope * s + value;
          value = value * s + piece.q(c, k);
        }
        positions_.col(c) = value;
        velocities_.col(c) = slope;
      }
      const double angle = omega * (piece.start + width * (part + 0.5));
      present = 0;
      int turned = 1;
      middle = std::polar(1.0, angle);
      const auto turn_middle = [&](int order) {
        if (order != turned) middle = std::polar(1.0, order * angle);
        turned = order;
      };

      for (Index o = 0; o < observed; ++o) {
        const auto& what = request.observed[static_cast<std::size_t>(o)];
        Nodes x = Nodes::Zero();
        what.for_each([&](Index coordinate, double share) { x += share * positions_.col(coordinate); });
        response.mean[o] += width * (weight * x).sum();
        response.rms[o] += width * (weight * x.square()).sum();
        for (Index h = 0; h < orders; ++h) {
          const int order = request.harmonics[static_cast<std::size_t>(h)];
          rotate(order);
          turn_middle(order);
          response.harmonics(o, h) += width * std::conj(middle * moment(x));
        }
      }
      for (const system::LoadHarmonic& load : excitation.harmonics) {
        rotate(load.order);
        turn_middle(load.order);
        Complex sum = 0.0;
        for (Index c = 0; c < n; ++c)
          if (load.amplitude[c] != 0.0) sum += load.amplitude[c] * moment(positions_.col(c));
        response.input_work += share * omega * load.order * width * (middle * sum).imag();
      }
      for (Index c = 0; c < damping.outerSize(); ++c) {
        const Nodes weighted = weight * velocities_.col(c);
        for (SparseMatrix::InnerIterator entry(damping, c); entry; ++entry)
          response.viscous_work += share * width * entry.value() * (velocities_.col(entry.row()) * weighted).sum();
      }
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
  response.dissipated.setZero(m);
  response.slip_share.setZero(m);
  response.offset.setZero(m);
  response.transitions = 0;
  std::array<double, integrate::TaylorPiece::degree + 1> storage;
  for (Index i = 0; i < m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto& slider = system_.sliders()[k];
    for (std::size_t p = 0; p < count_; ++p) {
      const Piece& piece = pieces_[p];
      const integrate::SliderState state = piece.states[k];
      const Piece& before = pieces_[p > 0 ? p - 1 : count_ - 1];
      // The piece before the first is the last, in half a period with the opposite sign.
      const auto sign_before = static_cast<int>(before.states[k]) * (p == 0 && half ? -1 : 1);
      if (piece.limit[i] > 0.0 && sign_before != static_cast<int>(state)) response.transitions += half ? 2 : 1;
      if (state == integrate::SliderState::stick) continue;
      const auto u = difference(piece, slider.first, slider.second, storage);
      response.dissipated[i] += share * piece.limit[i] * std::abs(integrate::polynomial(u, piece.length) - u[0]);
      response.slip_share[i] += share * piece.length / period;
    }
    if (count_ > 0 && !slips(i)) response.offset[i] = pieces_[0].offset[i];
  }
}

Waveform Orbit::waveform(const system::Excitation& excitation, bool half, int points) const {
  const Index n = system_.size(), m = system_.slider_count();
  Waveform wave{Vector(points), Matrix::Zero(n, points), Matrix::Zero(n, points), Matrix::Zero(m, points),
                Matrix::Zero(m, points)};
  if (count_ == 0) return wave;
  const double period = excitation.period();
  std::array<double, integrate::TaylorPiece::degree + 1> storage;
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
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const double u = integrate::polynomial(difference(piece, slider.first, slider.second, storage), s);
      const bool sticks = piece.states[static_cast<std::size_t>(i)] == integrate::SliderState::stick;
      const double force = piece.offset[i] + (sticks ? slider.stiffness * u : 0.0);
      wave.displacement(i, j) = sign * u;
      wave.slider_force(i, j) = sign * std::clamp(force, -piece.limit[i], piece.limit[i]);
    }
  }
  return wave;
}

}  // namespace rubato::steady
