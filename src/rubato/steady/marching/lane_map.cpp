#include <rubato/steady/marching/lane_map.hpp>

#include <rubato/steady/marching/lane_map_parts.hpp>
#include <rubato/steady/marching/stepper_map.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace rubato::steady {
namespace {

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

}  // namespace

bool LaneMap::prepare(std::span<const system::Excitation> excitations, int steps) {
  std::vector<int> orders;
  bool has_static = false;
  for (const system::Excitation& excitation : excitations) {
    has_static = has_static || (excitation.constant.size() > 0 && excitation.constant.cwiseAbs().maxCoeff() > 0.0);
    for (const system::LoadHarmonic& harmonic : excitation.harmonics) orders.push_back(harmonic.order);
  }
  if (has_static) orders.push_back(0);
  std::sort(orders.begin(), orders.end());
  orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
  if (excitations[0].angular_frequency != omega_) prepared_.clear();
  omega_ = excitations[0].angular_frequency;
  const auto known = std::find_if(prepared_.begin(), prepared_.end(), [&](const PreparedLanes& prepared) {
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
      groups_.emplace_back(LaneGroup<Pack<16>>{first, std::min<Index>(left, 16), {}, {}});
    else if (left > 2)
      groups_.emplace_back(LaneGroup<Pack<8>>{first, left, {}, {}});
    else
      groups_.emplace_back(LaneGroup<double>{first, 1, {}, {}});
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
void LaneMap::load(std::span<const system::Excitation> excitations, LaneGroup<Real>& group) const {
  const PreparedLanes& prepared = prepared_[current_];
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
    const system::Excitation& excitation = excitations[static_cast<std::size_t>(group.first + l)];
    for (std::size_t i = 0; i < m; ++i) set_lane(lane.limit[i], l, excitation.limits[static_cast<Index>(i)]);
    std::size_t part = 1;
    for (std::size_t k = 0; k < prepared.orders.size(); ++k) {
      const int order = prepared.orders[k];
      ComplexVector force = ComplexVector::Zero(n_);
      if (order == 0 && excitation.constant.size() > 0) force = excitation.constant.cast<std::complex<double>>();
      for (const system::LoadHarmonic& harmonic : excitation.harmonics)
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
void LaneMap::advance(LaneGroup<Real>& group, const LaneArray& from, LaneArray& to, std::vector<PeriodRecord>* records,
                      Index first) {
  const PreparedLanes& prepared = prepared_[current_];
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
  start = integrate::consistent_start(loaded, std::move(start));
  auto x = states.col(lane);
  x.segment(0, n_) = to_modes_ * start.q;
  x.segment(n_, n_) = to_modes_ * start.v / omega_;
  for (Index i = 0; i < m_; ++i)
    x[2 * n_ + i] = loaded.relative_displacement(i, start.q) - start.slider_force[i] / slider_stiffness_[i];
  if (width_ == 3) x.segment(2 * n_ + m_, n_) = to_modes_ * start.auxiliary_acceleration / (omega_ * omega_);
}

void LaneMap::displace(const Vector& by, LaneArray& states, Index lane) {
  states.col(lane).segment(0, n_) += (to_modes_ * by).array();
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
  const PreparedLanes& prepared = prepared_[current_];
  const Matrix inverse = resolvent_of_power(prepared.propagator, prepared.step.steps);
  if (inverse.size() == 0) return {};
  Matrix update = Matrix::Identity(this->size(), this->size());
  for (Index k = 0; k < n_; ++k)
    for (Index c = 0; c < width_; ++c)
      for (Index l = 0; l < n_; ++l)
        for (Index d = 0; d < width_; ++d) update(row_of(k, c), row_of(l, d)) = inverse(k * width_ + c, l * width_ + d);
  return update;
}

std::unique_ptr<PeriodMap> make_lane_map(const integrate::Method& method, const system::LocallyNonlinear& system,
                                         const SteadyRequest& request) {
  if (!std::holds_alternative<integrate::GeneralizedAlpha>(method.formula) &&
      !std::holds_alternative<integrate::Exponential>(method.formula))
    return nullptr;
  if (system.stop_count() > 0 || system.has_laws()) return nullptr;
  if (system.size() > largest_lane_model || system.slider_count() > largest_lane_model) return nullptr;
  return std::make_unique<LaneMap>(method, system, request);
}

}  // namespace rubato::steady
