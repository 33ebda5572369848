#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/equilibrium/static_equilibrium.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/integrate/law_energy.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/model/laws/elastic_contact.hpp>
#include <rubato/model/laws/jenkins.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include "support/contact_problems.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// Structures on elastic Coulomb contacts that open and close, against the same by other laws and against motions and
// static states that the reference of the friction family has (problems C, W and S: exact piecewise linear flows, and
// for two directions an integrator of eighth order with events).
namespace rubato::integrate {
namespace {

using testing::Columns;
using testing::contact;
using testing::coupled;
using testing::in_space;
using testing::masses;
using testing::wedge;

struct Works final : Observer {
  explicit Works(const system::LocallyNonlinear& of) : system(of), work(Vector::Zero(of.block_count())) {}
  bool accepted(const system::State& before, const system::State& after) override {
    for (Index b = 0; b < work.size(); ++b) work[b] += dissipated_by_block(system, b, before, after);
    return true;
  }
  const system::LocallyNonlinear& system;
  Vector work;
};

/// The state of a structure at some times: its coordinates, then their velocities, then friction forces.
struct At {
  double t;
  std::vector<double> q, v, force, work;
};

/// The largest error of a march at the times of a table, in two step sizes.
std::array<double, 2> errors_at(const system::LocallyNonlinear& system, const std::vector<At>& table, double h,
                                const std::vector<Index>& rows, const char* method = "average_acceleration") {
  std::array<double, 2> errors{};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto stepper = make_stepper(make_method(method), system);
    system::State state = consistent_start(system, system.start());
    Works works(system);
    for (const At& at : table) {
      EXPECT_EQ(march(*stepper, state, h / static_cast<double>(k + 1), at.t, &works, nullptr).end, MarchEnd::reached);
      for (std::size_t i = 0; i < at.q.size(); ++i) {
        const auto place = static_cast<Index>(i);
        errors[k] = std::max({errors[k], std::abs(state.q[place] - at.q[i]), std::abs(state.v[place] - at.v[i])});
      }
      for (std::size_t i = 0; i < at.force.size(); ++i)
        errors[k] = std::max(errors[k], std::abs(state.slider_force[rows[i]] - at.force[i]));
      for (std::size_t i = 0; i < at.work.size(); ++i)
        errors[k] = std::max(errors[k], std::abs(works.work[static_cast<Index>(i)] - at.work[i]));
    }
  }
  return errors;
}

TEST(Contacts, InOneDirectionMoveAsASliderPressedByAStop) {
  for (const char* name : {"generalized_alpha", "exponential", "rk4", "central_difference", "wilson_theta"}) {
    SCOPED_TRACE(name);
    std::vector<system::State> ends;
    for (const bool by_contact : {false, true}) {
      const auto system = coupled(1.2, by_contact);
      const auto stepper = make_stepper(make_method(name), system);
      system::State state = consistent_start(system, system.start());
      for (const double t : {7.0, 19.0, 30.0}) {
        ASSERT_EQ(march(*stepper, state, 0.01, t, nullptr, nullptr).end, MarchEnd::reached);
        ends.push_back(state);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((ends[i].q - ends[i + 3].q).norm(), 1e-10);
      EXPECT_LT((ends[i].v - ends[i + 3].v).norm(), 1e-10);
      EXPECT_NEAR(ends[i].slider_force[1], ends[i + 3].slider_force[0], 1e-10);  // friction, behind the stop
      EXPECT_NEAR(ends[i].slider_force[0], ends[i + 3].slider_force[1], 1e-10);  // what presses
    }
  }
}

TEST(Contacts, SlipOpenAndCloseInATransientAsTheExactFlow) {
  const std::vector<At> table{
      {2, {0.11695858069, 0.50322887692}, {-0.70554036835, -0.6326149258}, {0.11695858069}, {0.0}},
      {5, {0.33930416409, 1.0868517489}, {1.2816767399, -1.1480219463}, {0.8694813991}, {0.33893754603}},
      {10, {0.73944505064, -0.81201523249}, {0.78103151874, -2.957631051}, {0.0}, {1.5163150456}},
      {20, {-0.8378802497, -4.2181442438}, {-0.69345501431, 1.5407873702}, {0.0}, {2.1272049066}},
      {50, {-1.2699636324, -1.0231479574}, {0.2091093392, 2.9730336982}, {0.0}, {9.8447349027}}};
  const auto errors = errors_at(coupled(1.5, true), table, 4e-3, {0});
  EXPECT_LT(errors[1], 5e-4);
  EXPECT_GT(errors[0] / errors[1], 2.5);  // of second order
}

TEST(Contacts, OfAWedgeMoveAsTheExactFlow) {
  const std::vector<At> table{{0.2,
                               {0.023262551906, 0.052757172676, 0.038996543031, 0.089086836556},
                               {0.083638980367, 0.43895245408, 0.46776352942, 2.7219929621},
                               {1.0072285292, -1.0250555391},
                               {0.025215506172, 0.038386296335}},
                              {0.5,
                               {-0.086295075727, 0.033607258888, -0.013755948763, 0.08694828103},
                               {-0.58756462219, -0.83987768514, -0.74226859484, 1.4548099178},
                               {0.066184843902, -0.35285874664},
                               {0.11335346406, 0.099309995037}},
                              {1,
                               {0.11393101593, 0.168058953, 0.14626944104, 0.10280058256},
                               {0.47994610825, 1.2954738934, 0.66889876458, 1.2477765192},
                               {1.0341567925, -0.88965027815},
                               {0.16670316841, 0.13279953764}},
                              {2,
                               {0.15085289188, 0.28347852401, 0.25278127259, 0.14812637206},
                               {-1.5958609489, -1.8572175815, -2.1400214803, -0.39824100171},
                               {0.27802820293, -0.95355476497},
                               {0.39490019893, 0.17296247483}},
                              {4,
                               {-0.55329674332, -0.45828214787, -0.52623198961, 0.13354544444},
                               {2.3089225706, 1.9066785661, 2.3458889531, 0.051206217279},
                               {-0.68776321274, -0.39920971152},
                               {0.4424221364, 0.21710738416}}};
  const auto errors = errors_at(wedge(0.35, 3.0), table, 1e-3, {0, 2});
  EXPECT_LT(errors[1], 2e-3);
  EXPECT_GT(errors[0] / errors[1], 2.5);
}

const std::vector<At> space_table{{2,
                                   {0.061382130411, 0.32351241151, 0.64601654963},
                                   {-0.74322725578, 0.0081147087681, -0.46380979657},
                                   {0.061382130411, 0.32351241151},
                                   {0.0}},
                                  {5,
                                   {0.43597730402, -0.062142868177, 0.78993546834},
                                   {0.87204898378, 1.0805279601, -0.74101887992},
                                   {0.61929205883, 0.1258415437},
                                   {0.66921639014}},
                                  {10,
                                   {0.72766319699, 1.0292545178, -0.93160502789},
                                   {-0.33308684366, 0.72677846197, -0.74825950527},
                                   {0.0, 0.0},
                                   {1.8899997354}},
                                  {20,
                                   {-0.47038107019, -0.25241004775, 1.1493662517},
                                   {0.96913616697, -1.4876575586, 3.4867453372},
                                   {0.25129947729, -0.50661197016},
                                   {2.7626756756}},
                                  {40,
                                   {-0.27238251209, -0.50705956919, 1.4333299334},
                                   {1.1418113066, 0.015453271703, 1.11001956},
                                   {0.69693853067, -0.36831943729},
                                   {6.7129406657}}};

TEST(Contacts, InTwoDirectionsMoveAsTheReferenceInSpace) {
  for (const char* method : {"average_acceleration", "exponential"}) {
    const auto errors = errors_at(in_space(), space_table, 4e-3, {0, 1}, method);
    EXPECT_LT(errors[1], 5e-4) << method;
    EXPECT_GT(errors[0] / errors[1], 2.5) << method;
  }
}

TEST(Contacts, InTwoDirectionsAreMetByAutomaticSteps) {
  const auto system = in_space();
  const double tolerance = 1e-6;
  const Method method = make_method("generalized_alpha");
  const auto stepper = make_stepper(method, system);
  const auto estimator = make_estimator(LocalError{tolerance}, method, system, *stepper, 20.0, {});
  StepPlan plan;
  plan.largest = 0.3;
  system::State state = consistent_start(system, system.start());
  ASSERT_EQ(march(*stepper, *estimator, plan, system, state, 20.0, nullptr, nullptr).march.end, MarchEnd::reached);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(state.q[static_cast<Index>(i)], space_table[3].q[i], 40.0 * tolerance);
}

TEST(Contacts, DoNotKnowHowTheirDirectionsAreTurned) {
  std::vector<system::State> ends;
  std::vector<double> works;
  for (const double turn : {0.0, 0.7, 2.9}) {
    const auto system = in_space(turn);
    const auto stepper = make_stepper(make_method("generalized_alpha"), system);
    system::State state = consistent_start(system, system.start());
    Works work(system);
    ASSERT_EQ(march(*stepper, state, 0.02, 20.0, &work, nullptr).end, MarchEnd::reached);
    ends.push_back(state);
    works.push_back(work.work[0]);
  }
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_LT((ends[i].q - ends[0].q).norm(), 1e-10);
    EXPECT_LT((ends[i].v - ends[0].v).norm(), 1e-10);
    EXPECT_NEAR(works[i], works[0], 1e-10);
  }
}

/// Half peak-to-peak of the coordinates and the work of the contacts in the last of some periods.
std::vector<double> settled(const system::LocallyNonlinear& system, double angular_frequency, int periods) {
  const double period = 2.0 * std::numbers::pi / angular_frequency;
  const auto stepper = make_stepper(make_method("average_acceleration"), system);
  system::State state = consistent_start(system, system.start());
  EXPECT_EQ(march(*stepper, state, period / 1000, (periods - 1) * period, nullptr, nullptr).end, MarchEnd::reached);
  struct Extent final : Observer {
    explicit Extent(const system::LocallyNonlinear& of) : works(of) {}
    bool accepted(const system::State& before, const system::State& after) override {
      low = low.size() > 0 ? low.cwiseMin(after.q) : after.q;
      high = high.size() > 0 ? high.cwiseMax(after.q) : after.q;
      return works.accepted(before, after);
    }
    Works works;
    Vector low, high;
  } extent(system);
  EXPECT_EQ(march(*stepper, state, period / 1000, periods * period, &extent, nullptr).end, MarchEnd::reached);
  std::vector<double> found;
  for (Index i = 0; i < system.size(); ++i) found.push_back(0.5 * (extent.high[i] - extent.low[i]));
  found.insert(found.end(), extent.works.work.begin(), extent.works.work.end());
  return found;
}

TEST(Contacts, SettleOnTheOrbitsOfTheReference) {
  const std::vector<std::pair<double, std::vector<double>>> of_space{
      {1.2, {1.624344006, 2.040535643, 0.3842063884, 4.136846906}},
      {1.6, {0.7690779349, 0.5330234895, 1.620972012, 0.8962136567}},
      {2.0, {0.3665304549, 0.274221635, 0.566395461, 0.1769050225}}};
  for (const auto& [w, expected] : of_space) {
    const std::vector<double> found = settled(in_space(0.0, w), w, 70);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(found[i], expected[i], 1e-3 * expected[i] + 2e-4) << w;
  }
  const double w = 8.8;
  const std::vector<double> of_wedge{0.05450094966,  0.30130107102, 0.20740340101,
                                     0.079601839583, 0.6773071866,  0.38724995594};
  const std::vector<double> found = settled(wedge(0.35, 3.0, w), w, 120);
  for (std::size_t i = 0; i < of_wedge.size(); ++i) EXPECT_NEAR(found[i], of_wedge[i], 1e-3 * of_wedge[i]) << i;
}

// Both contacts slip under the load that grows from zero; without friction they press by a quarter more.
TEST(Contacts, HoldAWedgeWhereItSlipped) {
  const double with[] = {-0.014063739232, 0.012785217483, -0.00063926087416, 0.08919663591};
  const double without[] = {-0.03501037691, 0.031827615373, -0.0015913807687, 0.12275293946};
  for (const double friction : {0.35, 0.0}) {
    const StaticEquilibrium found = find_equilibrium(wedge(friction), {});
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    for (Index i = 0; i < 4; ++i) EXPECT_NEAR(found.state.q[i], (friction > 0.0 ? with : without)[i], 2e-11);
    EXPECT_NEAR(found.state.slider_force[1], friction > 0.0 ? 2.9414538987 : 3.6623237663, 1e-9);
    EXPECT_NEAR(found.state.slider_force[0], friction * found.state.slider_force[1], 1e-12);
    EXPECT_NEAR(found.state.slider_force[2], -friction * found.state.slider_force[3], 1e-12);
  }
}

// K q + T = F with |T| = mu N against the way from rest, of a contact that slips in two directions; or T = kT u of one
// that sticks.
TEST(Contacts, RestInTwoDirectionsWhereLoadsThatGrowLeadThem) {
  for (const double side : {0.2, 3.0}) {
    auto parts = masses(Vector::Ones(3), Vector::Zero(3), Eigen::Vector3d(1.0, 1.3, 1.0));
    parts.loads = system::Loads(
        {testing::harmonic(0, side, 0.0), testing::harmonic(1, -0.7 * side, 0.0), testing::harmonic(2, 1.5, 0.0)});
    parts.blocks = {contact("contact", {2, 1.0, 2.0, 0.4, 0.0}, {{{{0, 1.0}}, {{1, 1.0}}, {{2, 1.0}}}})};
    const system::LocallyNonlinear system(std::move(parts));
    const StaticEquilibrium found = find_equilibrium(system, {});
    ASSERT_EQ(found.outcome, StaticOutcome::found);
    const Vector &q = found.state.q, &f = found.state.slider_force;
    EXPECT_NEAR(q[0] + f[0], side, 1e-12);
    EXPECT_NEAR(1.3 * q[1] + f[1], -0.7 * side, 1e-12);
    EXPECT_NEAR(q[2], 0.5, 1e-12);
    EXPECT_NEAR(f[2], 1.0, 1e-12);
    EXPECT_NEAR(f[0] * q[1], f[1] * q[0], 1e-12);
    if (side > 1.0)
      EXPECT_NEAR(std::hypot(f[0], f[1]), 0.4, 1e-12);
    else
      EXPECT_NEAR(f[0], q[0], 1e-12);
  }
}

// Nothing holds the wedge where its contacts are open.
TEST(Contacts, HaveTheModesOfBothLimits) {
  const auto system = wedge(0.35);
  const auto frequencies = [&](const SparseMatrix& stiffness) -> Vector {
    return numerics::all_modes(stiffness, system.mass()).eigenvalues.cwiseMax(0.0).cwiseSqrt();
  };
  const Vector open = frequencies(system.free_stiffness()), stuck = frequencies(system.stuck_stiffness());
  const double expected_open[] = {0, 0, 7.745966692, 8.124038405};
  const double expected_stuck[] = {7.819706876, 9.841858886, 37.86732605, 40.04903637};
  for (Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(open[i], expected_open[i], 1e-6);
    EXPECT_NEAR(stuck[i], expected_stuck[i], 1e-8);
  }
  EXPECT_EQ(StructureKind(system).limit_count(), 2);
}

}  // namespace
}  // namespace rubato::integrate
