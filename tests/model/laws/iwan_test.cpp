#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <support/laws.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rubato::model {
namespace {

using rubato::testing::made;

struct Parameters {
  double stiffness, slip_force, chi, beta;

  std::shared_ptr<const Law> law() const { return made("iwan", {stiffness, slip_force, chi, beta}); }
  double share() const { return beta + (chi + 1.0) / (chi + 2.0); }
  double longest() const { return slip_force * (1.0 + beta) / (stiffness * share()); }
};
constexpr Parameters reference{1.0, 1.0, -0.5, 0.1};  // friction-family reference, section 8

/// Many sliders side by side, whose spring deflections are limited: Iwan's picture.
class DiscreteSliders {
 public:
  DiscreteSliders(const Parameters& p, int count) {
    const double r = p.slip_force * (p.chi + 1.0) / (std::pow(p.longest(), p.chi + 2.0) * p.share());
    for (int i = 0; i < count; ++i) {
      // Borders closer together where phi is small; each slider with the stiffness of its range, at its mean phi.
      const double a = p.longest() * std::pow(double(i) / count, 2.0),
                   b = p.longest() * std::pow((i + 1.0) / count, 2.0);
      const double stiffness = r * (std::pow(b, p.chi + 1.0) - std::pow(a, p.chi + 1.0)) / (p.chi + 1.0);
      const double moment = r * (std::pow(b, p.chi + 2.0) - std::pow(a, p.chi + 2.0)) / (p.chi + 2.0);
      sliders_.push_back({stiffness, moment / stiffness, 0.0});
    }
    sliders_.push_back({p.slip_force * p.beta / (p.longest() * p.share()), p.longest(), 0.0});
  }
  void move(double travel) {
    for (Slider& s : sliders_) {
      const double before = s.deflection;
      s.deflection = std::clamp(before + travel, -s.longest, s.longest);
      dissipated += s.stiffness * s.longest * std::abs(before + travel - s.deflection);
    }
  }
  double force() const {
    double sum = 0.0;
    for (const Slider& s : sliders_) sum += s.stiffness * s.deflection;
    return sum;
  }
  double stored() const {
    double sum = 0.0;
    for (const Slider& s : sliders_) sum += 0.5 * s.stiffness * s.deflection * s.deflection;
    return sum;
  }
  double dissipated = 0.0;

 private:
  struct Slider {
    double stiffness, longest, deflection;
  };
  std::vector<Slider> sliders_;
};

/// A law with its memory, moved from place to place.
class Moved {
 public:
  explicit Moved(std::shared_ptr<const Law> law)
      : law_(std::move(law)), memory_(static_cast<std::size_t>(law_->memory_size())), next_(memory_) {}
  double to(double place) {
    const LawPoint from{u_}, there{place, place - u_};
    force_ = law_->advance(from, memory_.data(), there, next_.data());
    const double step = law_->dissipated(from, memory_.data(), there, next_.data());
    least_loss = std::min(least_loss, step);
    dissipated += step;
    memory_.swap(next_);
    u_ = place;
    return force_.force;
  }
  double stored() const { return law_->stored_energy(u_, memory_.data()); }
  int turns() const {
    return static_cast<int>(std::count_if(memory_.begin(), memory_.end(), [](double r) { return r != 0.0; }));
  }
  const std::vector<double>& memory() const { return memory_; }
  double dissipated = 0.0, least_loss = 0.0;

 private:
  std::shared_ptr<const Law> law_;
  std::vector<double> memory_, next_;
  double u_ = 0.0;
  LawAnswer force_;
};

TEST(Iwan, LoadsFirstAsItsFourParametersSay) {
  const struct {
    double amplitude, force, work;
  } rows[] = {{0.01, 0.00961960853669, 3.04313170648e-06}, {0.1, 0.0879709657346, 0.000962322741234},
              {0.5, 0.365511308394, 0.0537954766423},      {1.0, 0.61960853669, 0.304313170648},
              {2.0, 0.924090467153, 1.72145525255},        {4.0, 1.0, 8.97041420118}};
  for (const auto& [amplitude, force, work] : rows) {
    Moved joint(reference.law());
    EXPECT_NEAR(joint.to(amplitude), force, 1e-11);
    for (int cycle = 0; cycle < 3; ++cycle) {
      const double before = joint.dissipated;
      EXPECT_NEAR(joint.to(-amplitude), -force, 1e-11);
      EXPECT_NEAR(joint.to(amplitude), force, 1e-11);
      EXPECT_NEAR(joint.dissipated - before, work, 2e-11 * work);
      EXPECT_EQ(joint.turns(), 1);  // closed loops are forgotten
    }
  }
}

TEST(Iwan, IsTheSumOfManySliders) {
  std::mt19937 generator(7);
  for (const Parameters& p :
       {reference, Parameters{20.0, 3.0, -0.8, 0.0}, {5.0, 2.0, 0.6, 2.0}, {1.0, 0.3, -0.3, 0.02}}) {
    SCOPED_TRACE(::testing::Message() << p.chi << " " << p.beta);
    Moved joint(p.law());
    DiscreteSliders sliders(p, 4000);
    std::uniform_real_distribution<double> place(-1.3 * p.longest(), 1.3 * p.longest());
    double u = 0.0, work = 0.0, force = 0.0;
    for (int i = 0; i < 60; ++i) {
      const double to = (i % 3 == 0 ? 1.0 : 0.4) * place(generator);
      const double then = joint.to(to);
      sliders.move(to - u);
      EXPECT_NEAR(then, sliders.force(), 3e-6 * p.slip_force) << i;
      EXPECT_NEAR(joint.stored(), sliders.stored(), 1e-5 * p.slip_force * p.longest());
      EXPECT_NEAR(joint.dissipated, sliders.dissipated, 2e-5 * (1.0 + i) * p.slip_force * p.longest());
      u = to;
      force = then;
      work = joint.stored() + joint.dissipated;
    }
    EXPECT_GT(work, 0.0);
    EXPECT_LE(std::abs(force), p.slip_force);
    EXPECT_EQ(joint.least_loss, 0.0);
  }
}

TEST(Iwan, DoesNotMindInHowManyPartsAMotionIsMade) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(-2.0, 2.0);
  Moved once(reference.law()), parts(reference.law());
  double u = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double to = place(generator);
    once.to(to);
    double force = 0.0;
    for (const double share : {0.11, 0.4, 0.93, 1.0}) force = parts.to(u + share * (to - u));
    u = to;
    EXPECT_NEAR(force, once.to(to), 1e-13);
    EXPECT_NEAR(parts.dissipated, once.dissipated, 1e-12 * (1.0 + i));
    EXPECT_NEAR(parts.stored(), once.stored(), 1e-12);
  }
}

// The work along each branch by Gauss's rule, against what is stored and dissipated by their own formulas.
TEST(Iwan, StoresAndDissipatesItsWork) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  const auto law = reference.law();
  Moved joint(law);
  double u = 0.0, work = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double to = (i % 2 == 0 ? 1.0 : 0.3) * place(generator);
    constexpr int parts = 4000;
    double before = joint.to(u);
    for (int k = 1; k <= parts; ++k) {
      const double after = joint.to(u + (to - u) * k / parts);
      work += 0.5 * (before + after) * (to - u) / parts;
      before = after;
    }
    u = to;
    EXPECT_NEAR(joint.stored() + joint.dissipated, work, 1e-5 * (1.0 + i));
  }
  EXPECT_EQ(joint.least_loss, 0.0);
}

TEST(Iwan, HasTheSlopesThatBelongToItsForce) {
  const auto law = reference.law();
  const auto* own = dynamic_cast<const LawSlopes*>(law.get());
  ASSERT_NE(own, nullptr);
  const std::size_t size = static_cast<std::size_t>(law->memory_size()), row = 4 + size;
  // A branch goes on, a turn, one loop closes, two close, the first loading is passed.
  std::vector<double> memory(size);
  const std::vector<double> turns{1.5, -1.1, 0.7, -0.3};
  std::copy(turns.begin(), turns.end(), memory.begin());
  for (const double travel : {-0.1, 0.25, -0.9, -2.5, -0.7, 3.1}) {
    SCOPED_TRACE(travel);
    std::vector<double> slopes((1 + size) * row), after(size), before(size), next(size);
    own->slopes({0.0}, memory.data(), {travel, travel}, slopes.data());
    const LawAnswer answer = law->advance({0.0}, memory.data(), {travel, travel}, next.data());
    EXPECT_NEAR(slopes[0], answer.by_u, 1e-14);
    constexpr double h = 1e-6;
    const auto compare = [&](std::size_t column, const LawPoint& a0, const std::vector<double>& m0, const LawPoint& a1,
                             const LawPoint& b0, const std::vector<double>& m1, const LawPoint& b1) {
      const double high = law->advance(a0, m0.data(), a1, after.data()).force;
      const double low = law->advance(b0, m1.data(), b1, before.data()).force;
      EXPECT_NEAR(slopes[column], (high - low) / (2.0 * h), 1e-7) << column;
      for (std::size_t i = 0; i < size; ++i)
        EXPECT_NEAR(slopes[(1 + i) * row + column], (after[i] - before[i]) / (2.0 * h), 1e-7) << column << " " << i;
    };
    compare(0, {0.0}, memory, {travel + h, travel}, {0.0}, memory, {travel - h, travel});
    compare(2, {h}, memory, {travel, travel}, {-h}, memory, {travel, travel});
    for (std::size_t i = 0; i < turns.size(); ++i) {
      std::vector<double> more = memory, less = memory;
      more[i] += h;
      less[i] -= h;
      compare(4 + i, {0.0}, more, {travel, travel}, {0.0}, less, {travel, travel});
    }
  }
}

// Where nothing has happened, and nothing moves: the first iterate of a balance of harmonics.
TEST(Iwan, HasTheSlopesOfASpringAtRest) {
  const auto law = reference.law();
  const auto* own = dynamic_cast<const LawSlopes*>(law.get());
  const std::size_t size = static_cast<std::size_t>(law->memory_size()), row = 4 + size;
  for (const double travel : {0.0, 1e-9, -1e-9}) {
    SCOPED_TRACE(travel);
    std::vector<double> memory(size), slopes((1 + size) * row);
    own->slopes({0.0}, memory.data(), {travel}, slopes.data());
    for (const std::size_t r : {0u, 1u}) {
      EXPECT_NEAR(slopes[r * row], 1.0, 1e-4);
      EXPECT_NEAR(slopes[r * row + 2], -1.0, 1e-4);
      EXPECT_NEAR(slopes[r * row + 4], 1.0, 1e-4);
    }
  }
}

// A vibration that dies away nests a turn in each half cycle: more than are remembered. What is then joined changes
// neither the force nor, but little, what is done by the next large load.
TEST(Iwan, JoinsTurnsBeyondThoseThatItRemembers) {
  Moved joint(reference.law());
  DiscreteSliders sliders(reference, 20000);
  double u = 0.0, largest = 0.0;
  const auto go = [&](double to) {
    sliders.move(to - u);
    u = to;
    largest = std::max(largest, std::abs(joint.to(to) - sliders.force()));
  };
  for (int i = 0; i < 400; ++i) go((i % 2 == 0 ? 2.0 : -2.0) * std::exp(-0.01 * i));
  EXPECT_EQ(joint.turns(), joint.memory().size());
  EXPECT_LT(largest, 2e-6);  // while it decays nothing of what was joined is passed
  EXPECT_GE(joint.least_loss, 0.0);
  EXPECT_NEAR(joint.dissipated, sliders.dissipated, 1e-4 * sliders.dissipated);
  largest = 0.0;
  for (int i = 0; i <= 200; ++i) go(u + 0.015);  // out again, through all loops
  EXPECT_LT(largest, 1e-3);                      // of the slip force: 1/32^2
  EXPECT_GT(largest, 1e-7);
  EXPECT_EQ(joint.turns(), 1);
  EXPECT_NEAR(joint.to(u + 2.0), 1.0, 1e-12);
  EXPECT_NEAR(joint.stored() + joint.dissipated, sliders.stored() + sliders.dissipated + 2.0, 1e-2);
}

TEST(Iwan, LoadsAndUnloadsWithOtherSlopesAwayFromZero) {
  const auto law = reference.law();
  std::vector<double> memory(static_cast<std::size_t>(law->memory_size()));
  EXPECT_EQ(law->at({0.0, 1.0}, memory.data()).by_u, 1.0);
  memory[0] = 1.0;
  const double on = 1.0 - 2.0 * 0.285293597482;  // kT - R u^(chi + 1)/(chi + 1)
  EXPECT_NEAR(law->at({1.0, 1.0}, memory.data()).by_u, on, 1e-11);
  EXPECT_EQ(law->at({1.0, -1.0}, memory.data()).by_u, 1.0);
  EXPECT_NEAR(law->at({1.0, 0.0}, memory.data()).by_u, 0.5 * (1.0 + on), 1e-11);
}

TEST(Iwan, RefusesWhatItCannotBe) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& wrong : std::vector<std::vector<double>>{{0.0, 1.0, -0.5, 0.1},
                                                                           {1.0, -1.0, -0.5, 0.1},
                                                                           {1.0, 1.0, -1.2, 0.1},
                                                                           {1.0, 1.0, -0.5, -0.1},
                                                                           {infinite, 1.0, -0.5, 0.1},
                                                                           {1.0, 1.0, std::nan(""), 0.1}})
    EXPECT_THROW(made("iwan", wrong), InvalidInput);
  try {
    made("iwan", {1.0, 1.0, -1.0, 0.1});
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("chi must be greater than -1, got -1"), std::string::npos);
  }
}

}  // namespace
}  // namespace rubato::model
