#include <gtest/gtest.h>

#include <rubato/model/description.hpp>
#include <rubato/model/finite_elements/check_finite_elements.hpp>

#include <Eigen/Dense>

#include <algorithm>
#include <memory>
#include <vector>

// A bar of cubes in space: struts between neighbouring nodes of a lattice, point masses at them. Struts do not resist
// rigid motions.
namespace rubato::model {
namespace {

struct Lattice {
  std::vector<Eigen::Vector3d> places;
  Mesh mesh;
  std::vector<Eigen::Triplet<double>> stiffness, mass;
};

/// @param length  cubes along z
Lattice lattice(int length, double scale = 1.0) {
  Lattice made;
  for (int k = 0; k <= length; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) made.places.emplace_back(i + 0.1 * k, j, k);
  for (std::size_t i = 0; i < made.places.size(); ++i) {
    made.places[i] *= scale;
    made.mesh.nodes.push_back(static_cast<std::int64_t>(i) + 1);
    made.mesh.positions.push_back({made.places[i].x(), made.places[i].y(), made.places[i].z()});
  }
  for (int k = 0; k < length; ++k) {
    const std::size_t first = static_cast<std::size_t>(4 * k);
    made.mesh.elements.push_back({k + 1, "C3D8", made.mesh.element_nodes.size(), 8});
    for (std::size_t i = 0; i < 8; ++i) made.mesh.element_nodes.push_back(first + i);
    for (std::size_t i = 0; i < 8; ++i) {
      for (int a = 0; a < 3; ++a) {
        const int row = static_cast<int>(3 * (first + i)) + a;
        made.mass.emplace_back(row, row, 0.5);
      }
      for (std::size_t j = 0; j < i; ++j) {
        const Eigen::Vector3d n = (made.places[first + i] - made.places[first + j]).normalized();
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            const double value = 1e6 * n[a] * n[b];
            const int ia = static_cast<int>(3 * (first + i)) + a, ib = static_cast<int>(3 * (first + i)) + b;
            const int ja = static_cast<int>(3 * (first + j)) + a, jb = static_cast<int>(3 * (first + j)) + b;
            made.stiffness.emplace_back(ia, ib, value);
            made.stiffness.emplace_back(ja, jb, value);
            made.stiffness.emplace_back(ia, jb, -value);
            made.stiffness.emplace_back(ja, ib, -value);
          }
      }
    }
  }
  return made;
}

/// The lattice without the rows of its first `held` nodes.
FiniteElementFiles files_of(const Lattice& lattice, int held) {
  const int all = static_cast<int>(3 * lattice.places.size()), first = 3 * held;
  FiniteElementFiles files;
  const auto take = [&](FiniteElementMatrix& matrix, const std::vector<Eigen::Triplet<double>>& entries) {
    SparseMatrix whole(all, all);
    whole.setFromTriplets(entries.begin(), entries.end());
    matrix.file = "matrix";
    matrix.values = whole.bottomRightCorner(all - first, all - first);
    for (int i = first; i < all; ++i) matrix.labels.push_back({i / 3 + 1, i % 3 + 1});
  };
  take(files.stiffness, lattice.stiffness);
  take(files.mass, lattice.mass);
  files.mesh = lattice.mesh;
  return files;
}

bool tells(const FiniteElementFindings& findings, const std::string& part) {
  return std::any_of(findings.facts.begin(), findings.facts.end(),
                     [&](const std::string& fact) { return fact.find(part) != std::string::npos; });
}

TEST(RigidMotions, CostNothingAwayFromHeldNodes) {
  const auto findings = check_finite_elements(join_finite_elements(files_of(lattice(6), 4)));
  EXPECT_TRUE(tells(findings, "rigid motions cost nothing away from held nodes"));
  EXPECT_TRUE(tells(findings, "4 nodes are held"));
  EXPECT_TRUE(tells(findings, "lumped (diagonal)"));
  EXPECT_TRUE(findings.doubts.empty());
}

TEST(RigidMotions, TellMassCentreAndInertiaOfAFreeBody) {
  // One cube of side 1: eight masses of 0.5 at its corners, shifted by 0.1 along x at the top.
  const auto findings = check_finite_elements(join_finite_elements(files_of(lattice(1), 0)));
  EXPECT_TRUE(tells(findings, "mass of the rows 4 kg"));
  // x: sum of (0.5 +- and 0.05 +-)^2: 4 (0.25 + 0.0025) = 1.01; y and z: 4 * 0.25 = 1.
  EXPECT_TRUE(tells(findings,
                    "centre of gravity (0.55, 0.5, 0.5) m; inertia about it (2, 2.01, 2.01) kg m2, products "
                    "(0, 0, 0.1)"))
      << findings.facts[4];
  EXPECT_TRUE(tells(findings, "no node is held"));
}

TEST(RigidMotions, AreResistedWhereTheMeshIsAnother) {
  FiniteElementFiles files = files_of(lattice(6), 4);
  for (auto& at : files.mesh->positions) at[0] *= 1.01;
  const auto findings = check_finite_elements(join_finite_elements(std::move(files)));
  ASSERT_EQ(findings.doubts.size(), 1u);
  EXPECT_NE(findings.doubts[0].message.find("a rigid turn about"), std::string::npos);
}

TEST(RigidMotions, AreResistedWhereRowsAreInAnotherOrder) {
  FiniteElementFiles files = files_of(lattice(6), 4);
  std::swap(files.stiffness.labels[20], files.stiffness.labels[21]);
  EXPECT_FALSE(check_finite_elements(join_finite_elements(std::move(files))).doubts.empty());
}

TEST(SpinSoftening, IsRecognisedInAnyUnitsAndAboutAnyAxis) {
  for (const double scale : {1.0, 1e3}) {
    FiniteElementFiles files = files_of(lattice(6, scale), 4);
    // K - Omega^2 M (1 - a a^T) of 120 rad/s about a; what a preload adds to turns is another matter.
    const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    Matrix softened = files.stiffness.values;
    for (Index i = 0; i < softened.rows(); ++i)
      for (Index b = 0; b < 3; ++b)
        softened(i, i - i % 3 + b) -= 120.0 * 120.0 * files.mass.values.coeff(i, i) * across(i % 3, b);
    files.stiffness.values = softened.sparseView();
    const auto findings = check_finite_elements(join_finite_elements(std::move(files)));
    EXPECT_TRUE(tells(findings, "spin softening of 120 rad/s about the direction (0.333333, 0.666667, 0.666667)"));
    for (const auto& doubt : findings.doubts) EXPECT_EQ(doubt.message.find("is resisted"), std::string::npos);
  }
}

TEST(SpinSoftening, IsNotSeenInSpringsToTheGround) {
  FiniteElementFiles files = files_of(lattice(6), 4);
  files.stiffness.values.coeffRef(70, 70) += 1e4;
  const auto findings = check_finite_elements(join_finite_elements(std::move(files)));
  EXPECT_FALSE(tells(findings, "spin"));
  EXPECT_EQ(findings.doubts.size(), 1u);
}

TEST(DoubtfulUnits, AreToldByTheMaterialOrByMassOverVolume) {
  FiniteElementFiles files = files_of(lattice(6), 4);
  files.mesh->materials.push_back({"STEEL", 206000.0, 7.8e-9, {}});
  const auto by_material = check_finite_elements(join_finite_elements(std::move(files)));
  ASSERT_EQ(by_material.doubts.size(), 1u);
  EXPECT_NE(by_material.doubts[0].message.find("has the density 7.8e-09, as of a metal in t/mm3"), std::string::npos);
  const auto by_volume = check_finite_elements(join_finite_elements(files_of(lattice(6, 1e3), 4)));
  ASSERT_EQ(by_volume.doubts.size(), 1u);
  EXPECT_NE(by_volume.doubts[0].message.find("which no structure has"), std::string::npos);
}

TEST(DoubtfulEntries, AreLargerThanTheirDiagonalAllows) {
  FiniteElementFiles files = files_of(lattice(6), 4);
  files.stiffness.values.coeffRef(3, 5) = files.stiffness.values.coeffRef(5, 3) = 1e8;
  const auto findings = check_finite_elements(join_finite_elements(std::move(files)));
  ASSERT_FALSE(findings.doubts.empty());
  EXPECT_NE(findings.doubts[0].message.find("entry (6.x, 6.z) of the stiffness matrix"), std::string::npos);
}

TEST(HeldRows, OfAPenaltyAreLeftOut) {
  FiniteElementFiles files = files_of(lattice(2), 0);
  for (Index row = 0; row < 12; ++row) files.stiffness.values.coeffRef(row, row) = 1e36;
  const FiniteElements joined = join_finite_elements(std::move(files));
  EXPECT_EQ(joined.rows.size(), 24u);
  EXPECT_EQ(std::count(joined.is_held.begin(), joined.is_held.end(), 1), 4);
  ASSERT_EQ(joined.notes.size(), 1u);
  EXPECT_NE(joined.notes[0].find("12 rows, the first 1.x"), std::string::npos);
}

/// Two beam elements of length 1 along x, in bending: y and rz of three nodes, with the matrices of Hermite's cubics.
FiniteElementFiles beam() {
  FiniteElementFiles files;
  Eigen::Matrix4d k, m;
  k << 12, 6, -12, 6, 6, 4, -6, 2, -12, -6, 12, -6, 6, 2, -6, 4;
  m << 156, 22, 54, -13, 22, 4, 13, -3, 54, 13, 156, -22, -13, -3, -22, 4;
  Matrix stiffness = Matrix::Zero(6, 6), mass = stiffness;
  for (Index first : {0, 2}) {
    stiffness.block<4, 4>(first, first) += k;
    mass.block<4, 4>(first, first) += m / 420.0;
  }
  files.stiffness.values = stiffness.sparseView();
  files.mass.values = mass.sparseView();
  for (int node = 1; node <= 3; ++node)
    for (const int direction : {2, 6}) {
      files.stiffness.labels.push_back({node, direction});
      files.mass.labels.push_back({node, direction});
    }
  files.mesh.emplace();
  files.mesh->nodes = {1, 2, 3};
  files.mesh->positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  files.mesh->elements = {{1, "B21", 0, 2}, {2, "B21", 2, 2}};
  files.mesh->element_nodes = {0, 1, 1, 2};
  return files;
}

/// Without the rows y of its ends.
FiniteElementFiles hinged_beam() {
  FiniteElementFiles files = beam();
  const std::vector<Index> kept{1, 2, 3, 5};
  for (FiniteElementMatrix* matrix : {&files.stiffness, &files.mass}) {
    const Matrix whole = matrix->values;
    matrix->values = Matrix(whole(kept, kept)).sparseView();
    matrix->labels = {{1, 6}, {2, 2}, {2, 6}, {3, 6}};
  }
  return files;
}

std::vector<DoubtfulValue> doubts_of(FiniteElementFiles files, const std::vector<double>& gravity) {
  ModelDescription description;
  description.finite_elements = std::make_shared<const FiniteElements>(join_finite_elements(std::move(files)));
  description.gravity.emplace();
  for (const double value : gravity) description.gravity->acceleration.emplace_back(value);
  return doubtful_values(description, {});
}

TEST(HeldNodes, MayTurn) {
  const FiniteElements joined = join_finite_elements(hinged_beam());
  EXPECT_EQ(joined.freedoms[0][1], Freedom::held);
  EXPECT_EQ(joined.freedoms[0][5], Freedom::free);
  EXPECT_EQ(joined.freedoms[0][2], Freedom::absent);  // a beam in the plane
  EXPECT_EQ(joined.freedoms[1][1], Freedom::free);
  const auto findings = check_finite_elements(joined);
  EXPECT_TRUE(findings.doubts.empty()) << findings.doubts.front().message;
  EXPECT_TRUE(tells(findings, "held in part, for lack of a row: x at 3 nodes, y at 2 nodes"));
}

TEST(GravityOfHeldNodes, IsMissingWhereAHingeHoldsThemAlongIt) {
  const auto doubts = doubts_of(hinged_beam(), {0.0, -9.81, 0.0});
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_NE(doubts[0].message.find("the share of 2 nodes, the first 1, in the consistent mass"), std::string::npos);
  EXPECT_TRUE(doubts_of(beam(), {0.0, -9.81, 0.0}).empty());
  EXPECT_TRUE(doubts_of(hinged_beam(), {0.0, 0.0, -9.81}).empty());
}

TEST(GravityOfHeldNodes, IsThereWhereALargeDiagonalHoldsThem) {
  FiniteElementFiles files = beam();
  const Matrix mass = files.mass.values;
  for (const Index row : {0, 4}) files.stiffness.values.coeffRef(row, row) = 1e36;
  const FiniteElements joined = join_finite_elements(files);
  ASSERT_EQ(joined.rows.size(), 4u);
  EXPECT_EQ(joined.freedoms[0][1], Freedom::held_in_files);
  // The row y of the middle: with its own 312/420 the whole of an element's mass, 1.
  EXPECT_NEAR(joined.mass_of_held(1, 1), 108.0 / 420.0, 1e-15);
  EXPECT_NEAR(joined.mass_of_held(0, 1), mass(1, 0), 1e-15);
  EXPECT_TRUE(doubts_of(files, {0.0, -9.81, 0.0}).empty());
}

}  // namespace
}  // namespace rubato::model
