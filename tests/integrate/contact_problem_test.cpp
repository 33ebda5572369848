#include <rubato/integrate/contact_problem.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rubato::integrate {
namespace {

struct Problem {
  Matrix compliance;
  std::vector<model::Slider> sliders;
  Vector trial, previous;
};

// W = B^T S^-1 B with fewer coordinates than sliders now and then: shared coordinates make it singular.
Problem random_problem(std::mt19937& random, Index m) {
  std::uniform_real_distribution<double> any(-1.0, 1.0), positive(0.1, 3.0);
  const Index rank = 1 + static_cast<Index>(random() % static_cast<unsigned>(m + 2));
  Problem p;
  const Matrix half = Matrix::NullaryExpr(m, rank, [&] { return any(random); });
  p.compliance = half * half.transpose();
  p.trial = Vector::NullaryExpr(m, [&] { return 4.0 * any(random); });
  p.previous.resize(m);
  for (Index i = 0; i < m; ++i) {
    p.sliders.push_back({"", 0, ground, positive(random), random() % 9 == 0 ? 0.0 : positive(random)});
    p.previous[i] = p.sliders.back().limit * std::clamp(2.0 * any(random), -1.0, 1.0);
  }
  return p;
}

double residual(const Problem& p, const Vector& force) {
  double largest = 0.0;
  for (Index i = 0; i < force.size(); ++i) {
    const auto& slider = p.sliders[static_cast<std::size_t>(i)];
    const double mapped =
        std::clamp(p.trial[i] - slider.stiffness * p.compliance.row(i).dot(force), -slider.limit, slider.limit);
    largest = std::max(largest, std::abs(mapped - force[i]));
  }
  return largest;
}

// The return maps hold together to round-off of sums of a hundred terms of order one to ten.
TEST(ContactProblem, FindsForcesThatFulfilAllReturnMapsAtOnce) {
  std::mt19937 random(11);
  for (const Index m : {1, 2, 3, 5, 12, 100})
    for (int trial = 0; trial < (m == 100 ? 20 : 2000); ++trial) {
      const Problem p = random_problem(random, m);
      ContactProblem contact;
      contact.reset(p.compliance, p.sliders);
      Vector force(m);
      ASSERT_TRUE(contact.solve(p.trial.data(), p.previous.data(), force.data())) << m << ' ' << trial;
      ASSERT_LT(residual(p, force), m == 100 ? 1e-10 : 1e-12) << m << ' ' << trial;
      ASSERT_FALSE(
          (force.array().abs() >
           Vector::NullaryExpr(m, [&](Index i) { return p.sliders[static_cast<std::size_t>(i)].limit; }).array())
              .any());
    }
}

// With a positive definite W the solution is unique: where the search begins must not show, not in a bit.
TEST(ContactProblem, DoesNotDependOnWhereItBegins) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    Problem p = random_problem(random, 6);
    p.compliance += 0.5 * Matrix::Identity(6, 6);
    ContactProblem contact;
    contact.reset(p.compliance, p.sliders);
    Vector a(6), b(6);
    ASSERT_TRUE(contact.solve(p.trial.data(), p.previous.data(), a.data()));
    const Vector rest = Vector::Zero(6);
    ASSERT_TRUE(contact.solve(p.trial.data(), rest.data(), b.data()));
    ASSERT_EQ(a, b) << trial;
  }
}

TEST(ContactProblem, EndsOnInputThatIsNotANumber) {
  std::mt19937 random(3);
  for (const Index m : {1, 2, 4}) {
    Problem p = random_problem(random, m);
    p.trial[0] = std::numeric_limits<double>::quiet_NaN();
    ContactProblem contact;
    contact.reset(p.compliance, p.sliders);
    Vector force = Vector::Zero(m);
    const bool solved = contact.solve(p.trial.data(), p.previous.data(), force.data());
    EXPECT_TRUE(!solved || !force.allFinite()) << m;
  }
}

struct StopProblem {
  Matrix compliance, velocity_compliance;
  std::vector<model::Slider> sliders;
  std::vector<model::Stop> stops;
  Vector trial, previous, penetration;
};

// What an alpha method makes of sliders and stops: W' is W times gamma/(beta h).
StopProblem random_stop_problem(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0), positive(0.1, 3.0);
  const Index sliders = static_cast<Index>(random() % 3), m = sliders + 1 + static_cast<Index>(random() % 3);
  StopProblem p;
  const Matrix half = Matrix::NullaryExpr(m, m, [&] { return any(random); });
  p.compliance = half * half.transpose() + 0.1 * Matrix::Identity(m, m);
  p.velocity_compliance = positive(random) * p.compliance;
  p.trial = Vector::NullaryExpr(m, [&] { return 4.0 * any(random); });
  p.previous = p.penetration = Vector::Zero(m);
  for (Index i = 0; i < sliders; ++i) {
    p.sliders.push_back({"", 0, ground, positive(random), positive(random)});
    p.previous[i] = p.sliders.back().limit * std::clamp(2.0 * any(random), -1.0, 1.0);
  }
  for (Index i = sliders; i < m; ++i) {
    p.stops.push_back({"", 0, ground, 0.0, positive(random), random() % 3 == 0 ? 0.0 : positive(random)});
    const auto& stop = p.stops.back();
    p.penetration[i] = any(random);
    p.trial[i] = stop.stiffness * p.penetration[i] + stop.damping * 2.0 * any(random);
    p.previous[i] = random() % 2 == 0 ? 0.0 : positive(random);
  }
  return p;
}

/// All consistent combinations of states, each by its own linear system.
std::vector<Vector> enumerate(const StopProblem& p) {
  const auto m = static_cast<Index>(p.trial.size()), sliders = static_cast<Index>(p.sliders.size());
  std::vector<Vector> found;
  int combinations = 1;
  for (Index i = 0; i < m; ++i) combinations *= 3;
  for (int code = 0; code < combinations; ++code) {
    Matrix rows = Matrix::Zero(m, m), law(m, m);
    Vector right(m);
    std::vector<int> state;
    for (Index i = 0, rest = code; i < m; ++i, rest /= 3) {
      state.push_back(static_cast<int>(rest % 3));
      const bool slides = i < sliders;
      const auto& stop = p.stops[static_cast<std::size_t>(std::max<Index>(0, i - sliders))];
      if (slides)
        law.row(i) = p.sliders[static_cast<std::size_t>(i)].stiffness * p.compliance.row(i);
      else
        law.row(i) = stop.stiffness * p.compliance.row(i) + stop.damping * p.velocity_compliance.row(i);
      const double limit = slides ? p.sliders[static_cast<std::size_t>(i)].limit : 0.0;
      if (state.back() == 0) {
        rows.row(i) = law.row(i);
        rows(i, i) += 1.0;
        right[i] = p.trial[i];
      } else if (slides || state.back() == 1) {
        rows(i, i) = 1.0;
        right[i] = state.back() == 1 ? limit : -limit;
      } else {
        rows.row(i) = p.compliance.row(i);
        right[i] = p.penetration[i];
      }
    }
    const Vector force = rows.fullPivLu().solve(right);
    const Vector rest = p.trial - law * force, depth = p.penetration - p.compliance * force;
    bool is_consistent = true;
    for (Index i = 0; i < m; ++i) {
      const int s = state[static_cast<std::size_t>(i)];
      if (i < sliders) {
        const double limit = p.sliders[static_cast<std::size_t>(i)].limit;
        is_consistent &= s == 0 ? std::abs(force[i]) <= limit : (s == 1 ? rest[i] >= limit : rest[i] <= -limit);
      } else if (s == 0) {
        is_consistent &= force[i] >= 0.0 && depth[i] >= -1e-12;
      } else if (s == 1) {
        is_consistent &= depth[i] <= 0.0 || rest[i] <= 0.0;
      } else {
        is_consistent &= force[i] >= 0.0 && force[i] <= rest[i] + 1e-12;
      }
    }
    if (is_consistent) found.push_back(force);
  }
  return found;
}

// Of all 3^m combinations of states the consistent ones have one and the same forces, and solve() finds them.
TEST(ContactProblem, OfSlidersAndStopsIsSolvedAsByTryingEveryCombination) {
  std::mt19937 random(17);
  int touching = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const StopProblem p = random_stop_problem(random);
    const std::vector<Vector> all = enumerate(p);
    ASSERT_FALSE(all.empty()) << trial;
    for (const Vector& other : all) ASSERT_LT((other - all.front()).norm(), 1e-9) << trial;
    ContactProblem contact;
    contact.reset(p.compliance, p.velocity_compliance, p.sliders, p.stops);
    Vector force(p.trial.size());
    ASSERT_TRUE(contact.solve(p.trial.data(), p.previous.data(), force.data(), p.penetration.data())) << trial;
    ASSERT_LT((force - all.front()).cwiseAbs().maxCoeff(), 1e-10) << trial;
    const Vector depth = p.penetration - p.compliance * force;
    for (Index i = static_cast<Index>(p.sliders.size()); i < force.size(); ++i)
      touching += force[i] > 0.0 && std::abs(depth[i]) < 1e-12;
  }
  EXPECT_GT(touching, 50);
}

}  // namespace
}  // namespace rubato::integrate
