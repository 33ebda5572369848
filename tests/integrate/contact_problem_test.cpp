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

}  // namespace
}  // namespace rubato::integrate
