#include <rubato/steady/marching/lane_kernel.hpp>
#include <rubato/steady/marching/pack.hpp>

#include <algorithm>
#include <array>

// Fused multiplications are off everywhere, so that all clones give the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define RUBATO_CLONES __attribute__((target_clones("default", "avx2", "avx512f"), flatten))
#else
#define RUBATO_CLONES
#endif

#pragma GCC diagnostic ignored "-Wpsabi"

namespace rubato::steady {
namespace {

constexpr int most = largest_lane_model;  // coordinates, and sliders
constexpr int largest_state = 3 * most;

// Writes one sample, and the load and damping forces on the coordinates for the works.
template <class Real>
[[gnu::always_inline]] inline void write_sample(const LaneStep& p, const LaneState<Real>& lane,
                                                const LaneObservation& o, int j, const Real* w, const Real* force,
                                                const Real* u, Real* sample, Real* position, Real* damping,
                                                Real* load) {
  const int n = p.coordinates, m = p.sliders, size = p.size(), columns = 2 * p.harmonics;
  std::array<Real, most> velocity;
  const double* turn = p.turn.data() + static_cast<std::ptrdiff_t>(j) * columns;
  for (int k = 0; k < n; ++k) {
    for (int c = 0; c < 2; ++c) {
      const int row = k * p.width + c;
      Real y = w[row] + lane.load_state[static_cast<std::size_t>(row)];
      for (int i = 0; i < m; ++i) y += p.end_force[static_cast<std::size_t>(row * m + i)] * force[i];
      for (int h = 0; h < columns; ++h) y += turn[h] * lane.load_state[static_cast<std::size_t>((1 + h) * size + row)];
      (c == 0 ? position[k] : velocity[static_cast<std::size_t>(k)]) = c == 0 ? y : o.angular_frequency * y;
    }
  }
  Real* out = sample;
  const auto observe = [&](const Real* motion) {
    for (int i = 0; i < o.observed; ++i) {
      Real sum = Real(0.0);
      for (int k = 0; k < n; ++k) sum += o.combination[static_cast<std::size_t>(i * n + k)] * motion[k];
      *out++ = sum;
    }
  };
  observe(position);
  observe(velocity.data());
  if (o.has_rates || o.has_works) {
    for (int k = 0; k < n; ++k) {
      Real sum = lane.load[static_cast<std::size_t>(k)];
      for (int h = 0; h < columns; ++h) sum += turn[h] * lane.load[static_cast<std::size_t>((1 + h) * n + k)];
      load[k] = sum;
      Real drag = Real(0.0);
      for (int l = 0; l < n; ++l)
        drag += o.damping[static_cast<std::size_t>(k * n + l)] * velocity[static_cast<std::size_t>(l)];
      damping[k] = drag;
    }
  }
  if (o.has_rates) {
    std::array<Real, most> acceleration;
    for (int k = 0; k < n; ++k) {
      Real sum = load[k] - damping[k];
      for (int l = 0; l < n; ++l) sum = sum - o.stiffness[static_cast<std::size_t>(k * n + l)] * position[l];
      for (int i = 0; i < m; ++i) sum = sum - o.slider_push[static_cast<std::size_t>(k * m + i)] * force[i];
      acceleration[static_cast<std::size_t>(k)] = sum;
    }
    observe(acceleration.data());
  }
  for (int i = 0; i < m; ++i) *out++ = force[i];
  for (int i = 0; i < m; ++i) *out++ = u[i];
}

/// Block: numbers of a block of E, Sliders: their number; 0 where they are known at run time only.
template <class Real, int Block, int Sliders>
[[gnu::always_inline]] inline void march(const LaneStep& p, LaneState<Real>& lane, const LaneObservation* o,
                                         Real* samples) {
  const int block = Block > 0 ? Block : p.block, m = Sliders > 0 ? Sliders : p.sliders;
  const int blocks = p.blocks, n = p.coordinates, width = p.width, size = block * blocks, columns = 2 * p.harmonics;
  std::array<Real, largest_state> now, next;
  std::array<Real, most> force, slip, limit, u;
  std::copy_n(lane.w.data(), size, now.data());
  for (int i = 0; i < m; ++i) {
    force[static_cast<std::size_t>(i)] = lane.force[static_cast<std::size_t>(i)];
    slip[static_cast<std::size_t>(i)] = lane.slip[static_cast<std::size_t>(i)];
    limit[static_cast<std::size_t>(i)] = lane.limit[static_cast<std::size_t>(i)];
  }
  Real *w = now.data(), *w1 = next.data();
  const double* e = p.propagator.data();
  const double* g = p.from_force.data();
  const double* turn = p.turn.data();
  const Real* up = lane.load_relative.data();

  std::array<Real, most> position, damping, load, last_position, last_damping, last_load;
  const int rows = o ? o->rows(m) : 0;
  const auto write = [&](int j) {
    write_sample(p, lane, *o, j, w, force.data(), u.data(), samples + static_cast<std::ptrdiff_t>(j) * rows,
                 position.data(), damping.data(), load.data());
    if (!o->has_works) return;
    if (j > 0)
      for (int k = 0; k < n; ++k) {
        const auto c = static_cast<std::size_t>(k);
        const Real travel = position[c] - last_position[c];
        lane.viscous_work += (0.5 * o->work_unit) * (travel * (damping[c] + last_damping[c]));
        lane.input_work += (0.5 * o->work_unit) * (travel * (load[c] + last_load[c]));
      }
    std::copy_n(position.data(), n, last_position.data());
    std::copy_n(damping.data(), n, last_damping.data());
    std::copy_n(load.data(), n, last_load.data());
  };
  if (o) {
    for (int i = 0; i < m; ++i)
      u[static_cast<std::size_t>(i)] = slip[static_cast<std::size_t>(i)] +
                                       p.flexibility[static_cast<std::size_t>(i)] * force[static_cast<std::size_t>(i)];
    write(0);
  }

  for (int j = 1; j <= p.steps; ++j) {
    for (int k = 0; k < blocks; ++k)
      for (int r = 0; r < block; ++r) {
        const int row = k * block + r;
        const double* line = e + static_cast<std::ptrdiff_t>(row) * block;
        Real sum = line[0] * w[k * block];
        for (int c = 1; c < block; ++c) sum += line[c] * w[k * block + c];
        for (int i = 0; i < m; ++i) sum += g[row * m + i] * force[static_cast<std::size_t>(i)];
        w1[row] = sum;
      }
    std::swap(w, w1);
    const double* phase = turn + static_cast<std::ptrdiff_t>(j) * columns;
    std::array<Real, most> free;
    for (int i = 0; i < m; ++i) {
      Real sum = up[i];
      for (int h = 0; h < columns; ++h) sum += phase[h] * up[(1 + h) * m + i];
      const double* line = p.relative.data() + static_cast<std::ptrdiff_t>(i) * n;
      for (int k = 0; k < n; ++k) sum += line[k] * w[k * width];
      free[static_cast<std::size_t>(i)] = sum;
    }
    for (int sweep = 0; sweep < p.sweeps; ++sweep)
      for (int i = 0; i < m; ++i) {
        const auto row = static_cast<std::size_t>(i);
        Real travel = free[row] - slip[row];
        for (int l = 0; l < m; ++l)
          if (l != i)
            travel = travel - p.coupling[static_cast<std::size_t>(i * m + l)] * force[static_cast<std::size_t>(l)];
        force[row] = cut((p.stiffness[row] * p.share[row]) * travel, limit[row]);
      }
    for (int i = 0; i < m; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Real sum = free[row];
      for (int l = 0; l < m; ++l)
        sum = sum - p.coupling[static_cast<std::size_t>(i * m + l)] * force[static_cast<std::size_t>(l)];
      u[row] = sum;
      slip[row] = sum - p.flexibility[row] * force[row];
    }
    if (o) write(j);
  }
  std::copy_n(w, size, lane.w.data());
  for (int i = 0; i < m; ++i) {
    lane.force[static_cast<std::size_t>(i)] = force[static_cast<std::size_t>(i)];
    lane.slip[static_cast<std::size_t>(i)] = slip[static_cast<std::size_t>(i)];
  }
}

template <class Real>
[[gnu::always_inline]] inline void choose(const LaneStep& p, LaneState<Real>& lane, const LaneObservation* o,
                                          Real* samples) {
  if (o || p.blocks == 1 || p.sliders == 0 || p.sliders > 2)
    march<Real, 0, 0>(p, lane, o, samples);
  else if (p.block == 2)
    p.sliders == 1 ? march<Real, 2, 1>(p, lane, nullptr, nullptr) : march<Real, 2, 2>(p, lane, nullptr, nullptr);
  else
    p.sliders == 1 ? march<Real, 3, 1>(p, lane, nullptr, nullptr) : march<Real, 3, 2>(p, lane, nullptr, nullptr);
}

// Clones are made of plain functions only.
RUBATO_CLONES void march_scalar(const LaneStep& p, LaneState<double>& lane, const LaneObservation* o, double* samples) {
  choose(p, lane, o, samples);
}
RUBATO_CLONES void march_eight(const LaneStep& p, LaneState<Pack<8>>& lane, const LaneObservation* o,
                               Pack<8>* samples) {
  choose(p, lane, o, samples);
}
RUBATO_CLONES void march_sixteen(const LaneStep& p, LaneState<Pack<16>>& lane, const LaneObservation* o,
                                 Pack<16>* samples) {
  choose(p, lane, o, samples);
}

}  // namespace

template <>
void march_period(const LaneStep& step, LaneState<double>& state, const LaneObservation* observation, double* samples) {
  march_scalar(step, state, observation, samples);
}
template <>
void march_period(const LaneStep& step, LaneState<Pack<8>>& state, const LaneObservation* observation,
                  Pack<8>* samples) {
  march_eight(step, state, observation, samples);
}
template <>
void march_period(const LaneStep& step, LaneState<Pack<16>>& state, const LaneObservation* observation,
                  Pack<16>* samples) {
  march_sixteen(step, state, observation, samples);
}

}  // namespace rubato::steady
