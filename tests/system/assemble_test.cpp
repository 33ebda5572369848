#include <rubato/core/error.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/system/assemble.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace rubato::system {
namespace {

/// The damper model as a user describes it: elements and 2 % of the modes without sliders.
model::Model described_damper() {
  model::Model m;
  m.coordinates = {"disk1", "blade1", "disk2", "blade2", "damper"};
  m.mass.resize(5);
  m.mass << 10, 1, 10, 1, 1;
  m.position = m.velocity = Vector::Zero(5);
  m.springs = {{0, ground, 100}, {0, 1, 50}, {2, ground, 100}, {2, 3, 50}, {4, ground, 10}};
  m.damping = model::ModalDampingRatios{{0.02}, -1};
  m.sliders = {{"contact1", 1, 4, 10.0, 5.0}, {"contact2", 3, 4, 10.0, 5.0}};
  return m;
}

// Reference page, section 4: C = a K + b M in each sector, and the damper's entry; printed to 15 digits.
TEST(Assemble, GivesTheDampingMatrixOfTheUnderPlatformDamper) {
  const LocallyNonlinear system = assemble(described_damper());
  const Matrix expected(testing::damper_model().damping());
  EXPECT_LT((Matrix(system.damping()) - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.maxCoeff() + 1e-14);
  EXPECT_EQ(Matrix(system.stiffness()), Matrix(testing::damper_model().stiffness()));
}

// Reference page, section 4, with the sliders removed and stuck.
TEST(Assemble, GivesTheModesOfTheUnderPlatformDamper) {
  const LocallyNonlinear system = assemble(described_damper());
  const auto frequencies = [&](const SparseMatrix& stiffness) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes{Matrix(stiffness), Matrix(system.mass())};
    return Vector(modes.eigenvalues().cwiseSqrt());
  };
  Vector free(5), stuck(5);
  free << 2.985807624388833, 2.985807624388833, 3.162277660168379, 7.488988772200257, 7.488988772200257;
  stuck << 2.996205323187844, 3.162277660168379, 5.137956574909118, 8.062257748298550, 8.344109053436982;
  EXPECT_LT((frequencies(system.stiffness()) - free).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((frequencies(system.stuck_stiffness()) - stuck).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Assemble, DampsOnlyTheModesThatAreAskedFor) {
  model::Model m = described_damper();
  m.sliders.clear();
  m.damping = model::ModalDampingRatios{{0.01, 0.03, 0.05}, 3};
  const LocallyNonlinear system = assemble(m);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes{Matrix(system.stiffness()), Matrix(system.mass())};
  const Matrix modal = modes.eigenvectors().transpose() * system.damping() * modes.eigenvectors();
  EXPECT_NEAR(modal(2, 2), 2 * 0.05 * 3.162277660168379, 1e-12);
  EXPECT_NEAR(modal(3, 3), 0.0, 1e-12);
  // The two lowest share a frequency: their sum does not depend on which combination is which.
  EXPECT_NEAR(modal(0, 0) + modal(1, 1), 2 * (0.01 + 0.03) * 2.985807624388833, 1e-12);
}

// The same structure in coordinates relative to the moving ground and in absolute ones, where the ground pushes through
// the spring k and the dashpot c: x_absolute = x_relative + ground, exactly.
TEST(Assemble, MakesBaseMotionTheMotionOfTheGround) {
  const double w = 4.4, amplitude = 0.1, k = 30.0, c = 0.4;
  model::Model relative;
  relative.coordinates = {"a", "b"};
  relative.mass.resize(2);
  relative.mass << 2.0, 1.0;
  relative.position = relative.velocity = Vector::Zero(2);
  relative.springs = {{0, ground, k}, {0, 1, 20.0}};
  relative.dashpots = {{0, ground, c}};
  relative.sliders = {{"s", 1, 0, 5.0, 0.1}};
  model::Model absolute = relative;
  relative.base_motion = model::BaseMotion{Vector::Ones(2), model::HarmonicLaw{-amplitude * w * w, w, 0.0}};
  absolute.position = Vector::Constant(2, amplitude);
  absolute.forces = {{0, model::HarmonicLaw{k * amplitude, w, 0.0}},
                     {0, model::HarmonicLaw{c * amplitude * w, w, 0.5 * M_PI}}};
  struct Blind final : integrate::ExactVisitor {
    bool sample(const State&, const integrate::ExactWork&) override { return true; }
    bool transition(const State&, const integrate::Transition&, const integrate::ExactWork&) override { return true; }
  } blind;
  const auto end = [&](const model::Model& m) {
    const LocallyNonlinear system = assemble(m);
    State state = system.start();
    const auto report = integrate::ExactFlow(system).advance(state, 7.3, {}, blind);
    EXPECT_GT(report.transitions, 10);
    return state.q;
  };
  const Vector moved = Vector::Constant(2, amplitude * std::cos(w * 7.3));
  EXPECT_LT((end(absolute) - end(relative) - moved).norm(), 1e-12);
}

TEST(Assemble, NamesTheCoordinateThatHasNoMass) {
  model::Model m;
  m.coordinates = {"a", "b"};
  model::FullMatrices full;
  Matrix mass = Matrix::Zero(2, 2);
  mass(0, 0) = 1.0;
  full.mass = testing::sparse(mass);
  full.stiffness = testing::sparse(Matrix::Identity(2, 2));
  full.damping = SparseMatrix(2, 2);
  m.matrices = full;
  m.position = m.velocity = Vector::Zero(2);
  try {
    assemble(m);
    FAIL() << "accepted";
  } catch (const InvalidInput& fault) {
    EXPECT_EQ(fault.message(),
              "the mass matrix is singular: coordinate \"b\" has the mass 0; give it one, or remove it");
  }
}

// Inertia along two of three oblique directions: the third has none but for round-off, of either sign.
TEST(Assemble, RefusesAMassMatrixThatIsSingularToRoundOff) {
  for (int i = 1; i <= 20; ++i) {
    const Eigen::Vector3d a(1.0, 0.3 * i, -0.7), b(0.2, 1.0 / i, 1.1), along = a.normalized();
    model::Model m;
    m.coordinates = {"a", "b", "c"};
    model::FullMatrices full;
    full.mass = testing::sparse(Matrix(2.0 * along * along.transpose() + b * b.transpose()));
    full.stiffness = testing::sparse(Matrix::Identity(3, 3));
    full.damping = SparseMatrix(3, 3);
    m.matrices = full;
    m.position = m.velocity = Vector::Zero(3);
    EXPECT_THROW(assemble(m), InvalidInput) << i;
  }
}

// A jump has a value on either side; between rows the table is linear; outside it says what it was told.
TEST(TableLaw, HasALeftAndARightValueWhereItJumps) {
  model::TableLaw table{{0.0, 1.0, 1.0, 3.0}, {0.0, 2.0, 5.0, 7.0}, model::TableLaw::Beyond::zero, ""};
  EXPECT_EQ(model::value(table, 0.5), 1.0);
  EXPECT_EQ(model::value(table, 1.0, model::Side::left), 2.0);
  EXPECT_EQ(model::value(table, 1.0, model::Side::right), 5.0);
  EXPECT_EQ(model::value(table, 2.0), 6.0);
  EXPECT_EQ(model::value(table, 3.0, model::Side::left), 7.0);
  EXPECT_EQ(model::value(table, 3.0, model::Side::right), 0.0);
  EXPECT_EQ(model::value(table, 3.5), 0.0);
  table.beyond = model::TableLaw::Beyond::hold;
  EXPECT_EQ(model::value(table, 3.5), 7.0);
  EXPECT_EQ(model::value(table, -1.0), 0.0);
}

// With beyond = "zero" the first and the last row are jumps where their values are not zero, except at t = 0, which no
// time of the study precedes.
TEST(TableLaw, JumpsWhereItBeginsAndEndsWithAValue) {
  model::TableLaw late{{1.0, 3.0}, {4.0, 7.0}, model::TableLaw::Beyond::zero, ""};
  EXPECT_EQ(model::value(late, 1.0, model::Side::left), 0.0);
  EXPECT_EQ(model::value(late, 1.0, model::Side::right), 4.0);
  EXPECT_EQ(model::value(late, 3.0, model::Side::left), 7.0);
  EXPECT_EQ(model::value(late, 3.0, model::Side::right), 0.0);
  const model::TableLaw from_the_start{{0.0, 3.0}, {4.0, 7.0}, model::TableLaw::Beyond::zero, ""};
  EXPECT_EQ(model::value(from_the_start, 0.0, model::Side::left), 4.0);
  EXPECT_EQ(model::value(from_the_start, 0.0, model::Side::right), 4.0);
}

}  // namespace
}  // namespace rubato::system
