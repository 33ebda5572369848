#include <rubato/integrate/steady/lane_map.hpp>

#include <rubato/integrate/steady/lane_kernel.hpp>
#include <rubato/integrate/steady/pack.hpp>
#include <rubato/integrate/steady/stepper_map.hpp>
#include <rubato/integrate/stepper.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace rubato::integrate {
namespace {

constexpr Index widest = 16;               // lanes of a pack
constexpr double couples = 1e-11;          // damping between modes, relative to the largest entry, that counts
constexpr double slowest_sweep = 0.3;      // contraction of a sweep of the slider forces beyond which it is not used
constexpr double nearly_singular = 1e-12;  // reciprocal condition of a resonance without damping

double& lane_of(double& value, Index) { return value; }
double lane_of(const double& value, Index) { return value; }
template <std::size_t N>
double lane_of(const Pack<N>& value, Index lane) {
  return value.lanes[lane];
}
void set_lane(double& value, Index, double number) { value = number; }
template <std::size_t N>
void set_lane(Pack<N>& value, Index lane, double number) {
  value.lanes[lane] = number;
}

/// Points that move together.
template <class Real>
struct Group {
  Index first = 0, count = 0;
  LaneState<Real> state;
  std::vector<Real> samples;
};

/// A step of a given length, and the response of the method to unit harmonic loads.
struct Prepared {
  LaneStep step;
  Matrix propagator;                     // E, whole
  Matrix end_force;                      // G1
  std::vector<int> orders;               // of the harmonics; 0: static
  std::vector<ComplexMatrix> responses;  // yp of unit loads on the coordinates, one an order [size x n]
  bool is_sound = false;
};

class LaneMap final : public PeriodMap {
 public:
  LaneMap(const Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request);

  Index size() const override { return n_ * width_ + m_; }
  Index slip_start() const override { return 2 * n_; }
  Index slips() const override { return m_; }
  Index lanes() const override { return widest; }

  bool prepare(std::span<const Excitation> excitations, int steps) override;
  bool advance(const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records, Index first) override;
  void encode(const system::State& state, LaneArray& states, Index lane) override;
  double observed_size(const LaneArray& differences, Index lane) const override;
  Matrix linear_update() override;

 private:
  // Row of an outer state for number c of coordinate k.
  Index row_of(Index k, Index c) const { return c < 2 ? c * n_ + k : 2 * n_ + m_ + k; }
  system::LocallyNonlinear coordinates_with(std::vector<system::LoadTerm> terms) const;
  Prepared prepare_step(int steps, const std::vector<int>& orders) const;
  void read_propagator(Stepper& stepper, double h, double quiet, Prepared& result) const;
  bool read_response(int order, double h, const Prepared& prepared, ComplexMatrix& response) const;
  Vector scaled(const system::State& state) const;
  template <class Real>
  void load(std::span<const Excitation> excitations, Group<Real>& group) const;
  template <class Real>
  void advance(Group<Real>& group, const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records,
               Index first);

  Method method_;
  Index n_, m_, width_;
  double unit_mass_ = 1.0, omega_ = 0.0;
  bool is_coupled_ = false;
  Matrix modes_, to_modes_;     // q = modes x, x = to_modes q, modes^T M modes = unit_mass I
  Matrix stiffness_, damping_;  // of the coordinates x, per unit of mass
  Matrix relative_, push_;      // u = relative x; acceleration of x by slider forces
  Vector slider_stiffness_;
  LaneObservation observation_;
  std::vector<Prepared> prepared_;  // for this frequency
  std::size_t current_ = 0;
  std::vector<std::variant<Group<double>, Group<Pack<8>>, Group<Pack<16>>>> groups_;
  system::State start_;
  // For encoding: the system under the loads bound last, one a lane.
  std::vector<Excitation> excitations_;
  const system::LocallyNonlinear& system_;
};

LaneMap::LaneMap(const Method& method, const system::LocallyNonlinear& system, const SteadyRequest& request)
    : method_(method),
      n_(system.size()),
      m_(system.slider_count()),
      width_(std::holds_alternative<Exponential>(method.formula) ? 2 : 3),
      system_(system) {
  const Matrix mass(system.mass());
  unit_mass_ = mass.trace() / static_cast<double>(n_);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver{Matrix(system.stiffness()), mass};
  modes_ = std::sqrt(unit_mass_) * solver.eigenvectors();
  to_modes_ = modes_.transpose() * mass / unit_mass_;
  stiffness_ = solver.eigenvalues().asDiagonal();
  damping_ = modes_.transpose() * Matrix(system.damping()) * modes_ / unit_mass_;
  Matrix between = damping_;
  between.diagonal().setZero();
  is_coupled_ = between.cwiseAbs().maxCoeff() > couples * damping_.cwiseAbs().maxCoeff();
  if (!is_coupled_) damping_ = Vector(damping_.diagonal()).asDiagonal();
  relative_.setZero(m_, n_);
  slider_stiffness_.resize(m_);
  for (Index i = 0; i < m_; ++i) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(i)];
    if (slider.first != ground) relative_.row(i) += modes_.row(slider.first);
    if (slider.second != ground) relative_.row(i) -= modes_.row(slider.second);
    slider_stiffness_[i] = slider.stiffness;
  }
  push_ = relative_.transpose() / unit_mass_;

  observation_.observed = static_cast<int>(request.observed.size());
  observation_.work_unit = unit_mass_;
  for (const auto& observed : request.observed)
    for (Index k = 0; k < n_; ++k) observation_.combination.push_back(observe(observed, modes_.col(k)));
  for (Index k = 0; k < n_; ++k) {
    for (Index l = 0; l < n_; ++l) {
      observation_.stiffness.push_back(stiffness_(k, l));
      observation_.damping.push_back(damping_(k, l));
    }
    for (Index i = 0; i < m_; ++i) observation_.slider_push.push_back(push_(k, i));
  }
}

system::LocallyNonlinear LaneMap::coordinates_with(std::vector<system::LoadTerm> terms) const {
  system::LocallyNonlinear::Parts parts;
  parts.mass.resize(n_, n_);
  parts.mass.setIdentity();
  parts.damping = damping_.sparseView(0.0, 0.0);
  parts.stiffness = stiffness_.sparseView(0.0, 0.0);
  parts.loads = system::Loads(std::move(terms));
  return system::LocallyNonlinear(std::move(parts));
}

Vector LaneMap::scaled(const system::State& state) const {
  Vector y(n_ * width_);
  for (Index k = 0; k < n_; ++k) {
    y[k * width_] = state.q[k];
    y[k * width_ + 1] = state.v[k] / omega_;
    if (width_ == 3) y[k * width_ + 2] = state.auxiliary_acceleration[k] / (omega_ * omega_);
  }
  return y;
}

// E by unit states, in all modes at once where they do not know of each other.
void LaneMap::read_propagator(Stepper& stepper, double h, double quiet, Prepared& result) const {
  const Index size = n_ * width_;
  const double units[] = {1.0, omega_, omega_ * omega_};
  system::State from, to;
  const auto step_from = [&](Index first, Index last, Index number) {
    from.t = quiet;
    from.q = from.v = from.auxiliary_acceleration = Vector::Zero(n_);
    Vector& part = number == 0 ? from.q : number == 1 ? from.v : from.auxiliary_acceleration;
    part.segment(first, last - first).setConstant(units[number]);
    from.slider_force.resize(0);
    to = from;
    result.is_sound = result.is_sound && stepper.attempt(from, h, quiet + h, to).outcome == StepOutcome::accepted;
    return scaled(to);
  };
  result.propagator.setZero(size, size);
  for (Index c = 0; c < width_; ++c) {
    if (is_coupled_) {
      for (Index k = 0; k < n_; ++k) result.propagator.col(k * width_ + c) = step_from(k, k + 1, c);
      continue;
    }
    const Vector y = step_from(0, n_, c);
    for (Index k = 0; k < n_; ++k)
      result.propagator.block(k * width_, k * width_ + c, width_, 1) = y.segment(k * width_, width_);
  }
}

// The periodic response of the method to cos(order omega t) on each coordinate: (exp(i order omega h) - E) Y = L, where
// Re(F exp(i phi) L) is what a load Re(F exp(i (phi + order omega s))) adds in a step.
bool LaneMap::read_response(int order, double h, const Prepared& prepared, ComplexMatrix& response) const {
  const double frequency = order * omega_;
  const Index size = n_ * width_;
  ComplexMatrix added = ComplexMatrix::Zero(size, n_);
  for (Index k = 0; k < (is_coupled_ ? n_ : 1); ++k) {
    system::LoadTerm term;
    for (Index l = is_coupled_ ? k : 0; l < (is_coupled_ ? k + 1 : n_); ++l) {
      term.rows.push_back(l);
      term.weights.push_back(1.0);
    }
    term.law = model::HarmonicLaw{1.0, frequency, 0.0};
    const system::LocallyNonlinear loaded = coordinates_with({term});
    const auto stepper = make_stepper(method_, loaded);
    system::State from = loaded.start(), to = from;
    Vector parts[2] = {Vector::Zero(size), Vector::Zero(size)};
    for (int quadrature = 0; quadrature < (order == 0 ? 1 : 2); ++quadrature) {
      from.t = quadrature == 0 ? 0.0 : -0.5 * std::numbers::pi / frequency;
      if (stepper->attempt(from, h, from.t + h, to).outcome != StepOutcome::accepted) return false;
      parts[quadrature] = scaled(to);
    }
    for (Index row = 0; row < size; ++row) added(row, is_coupled_ ? k : row / width_) = {parts[0][row], parts[1][row]};
  }
  const std::complex<double> turn = std::polar(1.0, frequency * h);
  response.setZero(size, n_);
  const Index block = is_coupled_ ? size : width_;
  for (Index b = 0; b < size / block; ++b) {
    ComplexMatrix difference =
        -prepared.propagator.block(b * block, b * block, block, block).cast<std::complex<double>>();
    difference.diagonal().array() += turn;
    const Eigen::PartialPivLU<ComplexMatrix> factor(difference);
    if (!(factor.rcond() > nearly_singular)) return false;
    const Index first = is_coupled_ ? 0 : b, columns = is_coupled_ ? n_ : 1;
    response.block(b * block, first, block, columns) = factor.solve(added.block(b * block, first, block, columns));
  }
  return response.allFinite();
}

Prepared LaneMap::prepare_step(int steps, const std::vector<int>& orders) const {
  Prepared result;
  const double h = 2.0 * std::numbers::pi / (omega_ * steps);
  const Index size = n_ * width_;
  // A hat over two steps for each slider, one after the other; then quiet.
  std::vector<system::LoadTerm> terms;
  for (Index i = 0; i < m_; ++i) {
    system::LoadTerm term;
    const double start = static_cast<double>(2 * i) * h;
    term.law = model::TableLaw{{start, start + h, start + 2.0 * h}, {0.0, 1.0, 0.0}, model::TableLaw::Beyond::zero, ""};
    for (Index k = 0; k < n_; ++k) {
      term.rows.push_back(k);
      term.weights.push_back(-push_(k, i));
    }
    terms.push_back(std::move(term));
  }
  const system::LocallyNonlinear coordinates = coordinates_with(std::move(terms));
  const auto stepper = make_stepper(method_, coordinates);
  result.is_sound = true;
  read_propagator(*stepper, h, static_cast<double>(2 * m_ + 2) * h, result);
  Matrix start_force(size, m_);
  result.end_force.resize(size, m_);
  system::State from = coordinates.start(), to = from;
  for (Index i = 0; i < m_; ++i) {
    const double start = static_cast<double>(2 * i) * h;
    from.t = start;
    result.is_sound = result.is_sound && stepper->attempt(from, h, start + h, to).outcome == StepOutcome::accepted;
    result.end_force.col(i) = scaled(to);
    from.t = start + h;
    result.is_sound =
        result.is_sound && stepper->attempt(from, h, start + 2.0 * h, to).outcome == StepOutcome::accepted;
    start_force.col(i) = scaled(to);
  }

  LaneStep& step = result.step;
  step.coordinates = static_cast<int>(n_);
  step.sliders = static_cast<int>(m_);
  step.width = static_cast<int>(width_);
  step.blocks = is_coupled_ ? 1 : static_cast<int>(n_);
  step.block = static_cast<int>(is_coupled_ ? size : width_);
  step.steps = steps;
  for (Index b = 0; b < step.blocks; ++b)
    for (Index r = 0; r < step.block; ++r)
      for (Index c = 0; c < step.block; ++c)
        step.propagator.push_back(result.propagator(b * step.block + r, b * step.block + c));
  const Matrix from_force = result.propagator * result.end_force + start_force;
  Matrix compliance = Matrix::Zero(m_, m_);
  for (Index k = 0; k < n_; ++k) compliance -= relative_.col(k) * result.end_force.row(k * width_);
  const auto append = [](const Matrix& matrix, std::vector<double>& out) {
    for (Index r = 0; r < matrix.rows(); ++r)
      for (Index c = 0; c < matrix.cols(); ++c) out.push_back(matrix(r, c));
  };
  append(from_force, step.from_force);
  append(result.end_force, step.end_force);
  append(relative_, step.relative);
  append(compliance, step.coupling);
  double contraction = 0.0;
  for (Index i = 0; i < m_; ++i) {
    const double stiffness = slider_stiffness_[i], own = 1.0 + stiffness * compliance(i, i);
    step.stiffness.push_back(stiffness);
    step.flexibility.push_back(1.0 / stiffness);
    step.share.push_back(1.0 / own);
    contraction =
        std::max(contraction, stiffness * (compliance.row(i).cwiseAbs().sum() - std::abs(compliance(i, i))) / own);
    result.is_sound = result.is_sound && own > 0.0;
  }
  result.is_sound = result.is_sound && contraction < slowest_sweep;
  constexpr double round_off = 1e-15;
  step.sweeps =
      contraction > round_off ? 1 + static_cast<int>(std::ceil(std::log(round_off) / std::log(contraction))) : 2;
  if (m_ < 2) step.sweeps = 1;

  result.orders = orders;
  for (const int order : orders) {
    result.responses.emplace_back();
    result.is_sound = result.is_sound && read_response(order, h, result, result.responses.back());
  }
  step.harmonics = static_cast<int>(std::count_if(orders.begin(), orders.end(), [](int order) { return order > 0; }));
  for (int j = 0; j <= steps; ++j)
    for (const int order : orders) {
      if (order == 0) continue;
      const double angle = 2.0 * std::numbers::pi * static_cast<double>((static_cast<long>(order) * j) % steps) / steps;
      step.turn.push_back(std::cos(angle));
      step.turn.push_back(std::sin(angle));
    }
  return result;
}

bool LaneMap::prepare(std::span<const Excitation> excitations, int steps) {
  std::vector<int> orders;
  bool has_static = false;
  for (const Excitation& excitation : excitations) {
    has_static = has_static || (excitation.constant.size() > 0 && excitation.constant.cwiseAbs().maxCoeff() > 0.0);
    for (const LoadHarmonic& harmonic : excitation.harmonics) orders.push_back(harmonic.order);
  }
  if (has_static) orders.push_back(0);
  std::sort(orders.begin(), orders.end());
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  if (excitations[0].angular_frequency != omega_) prepared_.clear();
  omega_ = excitations[0].angular_frequency;
  const auto known = std::find_if(prepared_.begin(), prepared_.end(), [&](const Prepared& prepared) {
    return prepared.step.steps == steps && prepared.orders == orders;
  });
  current_ = static_cast<std::size_t>(known - prepared_.begin());
  if (known == prepared_.end()) prepared_.push_back(prepare_step(steps, orders));
  if (!prepared_[current_].is_sound) return false;
  observation_.angular_frequency = omega_;

  excitations_.assign(excitations.begin(), excitations.end());
  groups_.clear();
  const Index count = static_cast<Index>(excitations.size());
  for (Index first = 0; first < count;) {
    const Index left = count - first;
    // Two lanes of a pack are not worth its width.
    if (left > 8)
      groups_.emplace_back(Group<Pack<16>>{first, std::min<Index>(left, 16), {}, {}});
    else if (left > 2)
      groups_.emplace_back(Group<Pack<8>>{first, left, {}, {}});
    else
      groups_.emplace_back(Group<double>{first, 1, {}, {}});
    std::visit(
        [&](auto& group) {
          load(excitations, group);
          first += group.count;
        },
        groups_.back());
  }
  return true;
}

template <class Real>
void LaneMap::load(std::span<const Excitation> excitations, Group<Real>& group) const {
  const Prepared& prepared = prepared_[current_];
  const LaneStep& step = prepared.step;
  const auto size = static_cast<std::size_t>(n_ * width_), n = static_cast<std::size_t>(n_),
             m = static_cast<std::size_t>(m_), parts = static_cast<std::size_t>(1 + 2 * step.harmonics);
  LaneState<Real>& lane = group.state;
  const Real zero = Real(0.0);
  lane.w.assign(size, zero);
  lane.force.assign(m, zero);
  lane.slip.assign(m, zero);
  lane.limit.assign(m, zero);
  lane.load.assign(parts * n, zero);
  lane.load_state.assign(parts * size, zero);
  lane.load_relative.assign(parts * m, zero);
  for (Index l = 0; l < group.count; ++l) {
    const Excitation& excitation = excitations[static_cast<std::size_t>(group.first + l)];
    for (std::size_t i = 0; i < m; ++i) set_lane(lane.limit[i], l, excitation.limits[static_cast<Index>(i)]);
    std::size_t part = 1;
    for (std::size_t k = 0; k < prepared.orders.size(); ++k) {
      const int order = prepared.orders[k];
      ComplexVector force = ComplexVector::Zero(n_);
      if (order == 0 && excitation.constant.size() > 0) force = excitation.constant.cast<std::complex<double>>();
      for (const LoadHarmonic& harmonic : excitation.harmonics)
        if (harmonic.order == order) force = harmonic.amplitude;
      const ComplexVector on_coordinates = modes_.transpose() * force / unit_mass_;
      const ComplexVector state = prepared.responses[k] * on_coordinates;
      ComplexVector u = ComplexVector::Zero(m_);
      for (Index c = 0; c < n_; ++c) u += state[c * width_] * relative_.col(c);
      const auto put = [&](const ComplexVector& values, std::vector<Real>& out) {
        const auto rows = static_cast<std::size_t>(values.size());
        for (std::size_t r = 0; r < rows; ++r) {
          const std::complex<double> value = values[static_cast<Index>(r)];
          if (order == 0) {
            set_lane(out[r], l, value.real());
            continue;
          }
          set_lane(out[part * rows + r], l, value.real());
          set_lane(out[(part + 1) * rows + r], l, -value.imag());
        }
      };
      put(on_coordinates, lane.load);
      put(state, lane.load_state);
      put(u, lane.load_relative);
      if (order > 0) part += 2;
    }
  }
}

bool LaneMap::advance(const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records, Index first) {
  to.resize(from.rows(), from.cols());
  for (auto& any : groups_) std::visit([&](auto& group) { advance(group, from, to, records, first); }, any);
  return to.allFinite();
}

template <class Real>
void LaneMap::advance(Group<Real>& group, const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records,
                      Index first) {
  const Prepared& prepared = prepared_[current_];
  const LaneStep& step = prepared.step;
  const Index size = n_ * width_;
  LaneState<Real>& lane = group.state;
  // yp at the phase zero: static, and the part in phase of each harmonic.
  const auto load_state = [&](Index row, Index l) {
    double sum = lane_of(lane.load_state[static_cast<std::size_t>(row)], l);
    for (int h = 0; h < step.harmonics; ++h)
      sum += lane_of(lane.load_state[static_cast<std::size_t>((1 + 2 * h) * size + row)], l);
    return sum;
  };
  for (Index l = 0; l < group.count; ++l) {
    const auto x = from.col(group.first + l);
    Vector force(m_);
    for (Index i = 0; i < m_; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const double u = relative_.row(i).dot(x.head(n_).matrix());
      force[i] = cut(slider_stiffness_[i] * (u - x[2 * n_ + i]), lane_of(lane.limit[row], l));
      set_lane(lane.force[row], l, force[i]);
      set_lane(lane.slip[row], l, u - force[i] / slider_stiffness_[i]);
    }
    for (Index k = 0; k < n_; ++k)
      for (Index c = 0; c < width_; ++c) {
        const Index row = k * width_ + c;
        set_lane(lane.w[static_cast<std::size_t>(row)], l,
                 x[row_of(k, c)] - load_state(row, l) - prepared.end_force.row(row).dot(force));
      }
  }
  if (records) {
    const PeriodRecord& one = (*records)[static_cast<std::size_t>(group.first)];
    observation_.has_rates = one.acceleration.rows() > 0;
    observation_.has_works = one.has_works;
    group.samples.resize(static_cast<std::size_t>((step.steps + 1) * observation_.rows(step.sliders)));
    lane.viscous_work = lane.input_work = Real(0.0);
  }
  march_period(step, lane, records ? &observation_ : nullptr, group.samples.data());
  for (Index l = 0; l < group.count; ++l) {
    auto x = to.col(group.first + l);
    Vector force(m_);
    for (Index i = 0; i < m_; ++i) {
      force[i] = lane_of(lane.force[static_cast<std::size_t>(i)], l);
      x[2 * n_ + i] = lane_of(lane.slip[static_cast<std::size_t>(i)], l);
    }
    for (Index k = 0; k < n_; ++k)
      for (Index c = 0; c < width_; ++c) {
        const Index row = k * width_ + c;
        x[row_of(k, c)] = lane_of(lane.w[static_cast<std::size_t>(row)], l) + load_state(row, l) +
                          prepared.end_force.row(row).dot(force);
      }
    if (!records) continue;
    PeriodRecord& record = (*records)[static_cast<std::size_t>(group.first + l)];
    if (first >= record.steps) continue;
    record.viscous_work += lane_of(lane.viscous_work, l);
    record.input_work += lane_of(lane.input_work, l);
    const Real* sample = group.samples.data();
    const auto take = [&](Matrix& out, Index column) {
      for (Index r = 0; r < out.rows(); ++r) out(r, column) = lane_of(*sample++, l);
    };
    for (Index j = 0; j <= step.steps; ++j) {
      take(record.position, first + j);
      take(record.velocity, first + j);
      take(record.acceleration, first + j);
      take(record.slider_force, first + j);
      take(record.displacement, first + j);
    }
  }
}

void LaneMap::encode(const system::State& state, LaneArray& states, Index lane) {
  const system::LocallyNonlinear loaded = with_excitation(system_, excitations_[static_cast<std::size_t>(lane)]);
  system::State start = state;
  start.t = 0.0;
  start = consistent_start(loaded, std::move(start));
  auto x = states.col(lane);
  x.segment(0, n_) = to_modes_ * start.q;
  x.segment(n_, n_) = to_modes_ * start.v / omega_;
  for (Index i = 0; i < m_; ++i)
    x[2 * n_ + i] = loaded.relative_displacement(i, start.q) - start.slider_force[i] / slider_stiffness_[i];
  if (width_ == 3) x.segment(2 * n_ + m_, n_) = to_modes_ * start.auxiliary_acceleration / (omega_ * omega_);
}

double LaneMap::observed_size(const LaneArray& differences, Index lane) const {
  double size = 0.0;
  for (Index i = 0; i < observation_.observed; ++i) {
    const double* const combination = observation_.combination.data() + i * n_;
    double q = 0.0, v = 0.0;
    for (Index k = 0; k < n_; ++k) {
      q += combination[k] * differences(k, lane);
      v += combination[k] * differences(n_ + k, lane);
    }
    size = std::max(size, std::hypot(q, v));
  }
  return size;
}

Matrix LaneMap::linear_update() {
  const Prepared& prepared = prepared_[current_];
  const Matrix inverse = resolvent_of_power(prepared.propagator, prepared.step.steps);
  if (inverse.size() == 0) return {};
  Matrix update = Matrix::Identity(this->size(), this->size());
  for (Index k = 0; k < n_; ++k)
    for (Index c = 0; c < width_; ++c)
      for (Index l = 0; l < n_; ++l)
        for (Index d = 0; d < width_; ++d) update(row_of(k, c), row_of(l, d)) = inverse(k * width_ + c, l * width_ + d);
  return update;
}

}  // namespace

std::unique_ptr<PeriodMap> make_lane_map(const Method& method, const system::LocallyNonlinear& system,
                                         const SteadyRequest& request) {
  if (!std::holds_alternative<GeneralizedAlpha>(method.formula) && !std::holds_alternative<Exponential>(method.formula))
    return nullptr;
  if (system.stop_count() > 0 || system.size() > largest_lane_model || system.slider_count() > largest_lane_model)
    return nullptr;
  return std::make_unique<LaneMap>(method, system, request);
}

}  // namespace rubato::integrate
