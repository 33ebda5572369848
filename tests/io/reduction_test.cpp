#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/model/finite_elements/component_modes.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/model.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/system/assemble.hpp>

#include <Eigen/Dense>

#include <cmath>
#include <complex>
#include <map>
#include <numbers>

// The sector of a bladed disk, 882 rows, from CalculiX: published frequencies of reductions (the numbers come from an
// independent calculation with scipy), and reduced against unreduced models.
namespace rubato::testing {
namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;

const std::filesystem::path folder = std::filesystem::path(RUBATO_TEST_DATA) / "finite_elements" / "sector";
constexpr int sectors = 24;
constexpr double pi = std::numbers::pi;

const std::string files =
    "[model]\nmesh = \"sector.mat.inp\"\nstiffness = \"sector.sti\"\nmass = \"sector.mas\"\nrows = \"sector.dof\"\n";
const std::string modes = "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\ncount = 2\nobserve = [\"317.z\"]\n";

model::StudyDescription study_of(const std::string& parts) {
  return io::read_study_text(files + parts, "study.toml", folder);
}
model::Model model_of(const std::string& parts) { return model::build(study_of(parts).model, {}); }

Eigen::Matrix3d turn(double angle) { return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(); }

/// The rows of a node's x, y, z, and where it lies.
class Sector {
 public:
  explicit Sector(const model::Model& model) : model_(model) {
    for (std::size_t i = 0; i < model.structure.names.size(); ++i) nodes_[model.structure.names[i]] = i;
  }
  Index place(const std::string& node, int axis) const {
    return model_.structure.places[nodes_.at(node)][static_cast<std::size_t>(axis)];
  }
  Eigen::Vector3d at(const std::string& node) const { return model_.structure.positions[nodes_.at(node)]; }

  /// x = T y with x_right = exp(i k alpha) R x_left; y are all others [n x n - right].
  ComplexMatrix cyclic(const std::vector<std::string>& left, const std::vector<std::string>& right, int diameter) {
    const double alpha = 2.0 * pi / sectors;
    std::vector<char> is_right(static_cast<std::size_t>(model_.size()), 0);
    for (const auto& node : right)
      for (int axis = 0; axis < 3; ++axis)
        if (place(node, axis) >= 0) is_right[static_cast<std::size_t>(place(node, axis))] = 1;
    column.assign(is_right.size(), -1);
    Index count = 0;
    for (std::size_t i = 0; i < is_right.size(); ++i)
      if (is_right[i] == 0) column[i] = count++;
    ComplexMatrix map = ComplexMatrix::Zero(model_.size(), count);
    for (std::size_t i = 0; i < is_right.size(); ++i)
      if (column[i] >= 0) map(static_cast<Index>(i), column[i]) = 1.0;
    for (const auto& from : left) {
      if (place(from, 0) < 0) continue;
      const Eigen::Vector3d turned = turn(alpha) * at(from);
      std::string partner;
      for (const auto& to : right)
        if ((at(to) - turned).norm() < 1e-9) partner = to;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          map(place(partner, a), column[static_cast<std::size_t>(place(from, b))]) =
              std::polar(1.0, diameter * alpha) * turn(alpha)(a, b);
    }
    return map;
  }
  std::vector<Index> column;  // of each coordinate in y, or -1

 private:
  const model::Model& model_;
  std::map<std::string, std::size_t> nodes_;
};

std::vector<std::string> nodes_of(const model::StudyDescription& study, const std::string& set) {
  std::vector<std::string> names;
  for (const auto& one : study.model.finite_elements->mesh->sets)
    if (one.name == set)
      for (const auto node : one.nodes) names.push_back(std::to_string(node));
  return names;
}

std::vector<double> frequencies_of(const ComplexMatrix& stiffness, const ComplexMatrix& mass) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<ComplexMatrix> solver(stiffness, mass, Eigen::EigenvaluesOnly);
  std::vector<double> all;
  for (Index i = 0; i < 6; ++i) all.push_back(std::sqrt(solver.eigenvalues()[i]) / (2.0 * pi));
  return all;
}

void expect_cyclic_frequencies(int count, int diameter, const std::vector<double>& expected) {
  const auto study = study_of("[reduction]\nmodes = " + std::to_string(count) +
                              "\nkeep = [\"NLEFT\", \"NRIGHT\", \"172\", \"189\", \"211\", \"223\", \"305\"]\n"
                              "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\nobserve = [\"305.x\"]\n");
  const model::Model model = model::build(study.model, {});
  ASSERT_EQ(model.size(), 144 + 15 + count);
  Sector sector(model);
  const ComplexMatrix map = sector.cyclic(nodes_of(study, "NLEFT"), nodes_of(study, "NRIGHT"), diameter);
  const auto found = frequencies_of(map.adjoint() * Matrix(model.matrices->stiffness) * map,
                                    map.adjoint() * Matrix(model.matrices->mass) * map);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 2e-9 * expected[i]) << i;
}

TEST(Reduction, SectorHasThePublishedFrequenciesOfCraigAndBampton) {
  expect_cyclic_frequencies(20, 3, {457.9572902, 1385.5193862, 2083.7684476, 3140.9337345, 4073.8132242, 5298.6712001});
  expect_cyclic_frequencies(10, 3, {457.9645195, 1385.6400077, 2084.8406643, 3146.2886574, 4078.4883908, 5354.6147267});
  expect_cyclic_frequencies(20, 6, {457.8696956, 1511.5330234, 2578.3056228, 3145.2812349, 4294.4426412, 5365.1853603});
}

/// Hermitian A as a real symmetric matrix of twice the size, whose eigenvalues come twice.
SparseMatrix real_form(const ComplexMatrix& matrix) {
  const Index n = matrix.rows();
  Matrix real(2 * n, 2 * n);
  real << matrix.real(), -matrix.imag(), matrix.imag(), matrix.real();
  return (0.5 * (real + real.transpose())).sparseView(real.cwiseAbs().maxCoeff(), 1e-18);
}

/// The sector at nodal diameter 6, with the 15 degrees of freedom that sliders and the load name as interface.
struct AtSix {
  SparseMatrix stiffness, mass;
  std::vector<Index> kept;
  ComplexMatrix slider_rows;  // W of four sliders between platforms [4 x n]
};

AtSix at_six() {
  const auto study = study_of(modes);
  const model::Model model = model::build(study.model, {});
  Sector sector(model);
  const ComplexMatrix map = sector.cyclic(nodes_of(study, "NLEFT"), nodes_of(study, "NRIGHT"), 6);
  AtSix made;
  made.stiffness = real_form(map.adjoint() * model.matrices->stiffness.cast<Complex>() * map);
  made.mass = real_form(map.adjoint() * model.matrices->mass.cast<Complex>() * map);
  for (const char* node : {"172", "189", "211", "223", "305"})
    for (int axis = 0; axis < 3; ++axis) {
      const Index at = sector.column[static_cast<std::size_t>(sector.place(node, axis))];
      made.kept.push_back(at);
      made.kept.push_back(at + map.cols());
    }
  std::sort(made.kept.begin(), made.kept.end());
  made.slider_rows = ComplexMatrix::Zero(4, map.cols());
  const double alpha = 2.0 * pi / sectors;
  Index row = 0;
  for (const auto& [right, left] : {std::pair("211", "172"), std::pair("223", "189")}) {
    Eigen::Vector3d first = sector.at(right), second = turn(alpha) * sector.at(left);
    first.z() = second.z() = 0.0;
    const Eigen::Vector3d radial = (first.normalized() + second.normalized()).normalized();
    for (const Eigen::Vector3d& e : {radial, Eigen::Vector3d(Eigen::Vector3d::UnitZ())}) {
      const Eigen::Vector3d turned = turn(alpha).transpose() * e;
      for (int axis = 0; axis < 3; ++axis) {
        made.slider_rows(row, sector.column[static_cast<std::size_t>(sector.place(right, axis))]) = e[axis];
        made.slider_rows(row, sector.column[static_cast<std::size_t>(sector.place(left, axis))]) =
            -std::polar(1.0, 6 * alpha) * turned[axis];
      }
      ++row;
    }
  }
  return made;
}

double frequency_of(double eigenvalue) { return std::sqrt(eigenvalue) / (2.0 * pi); }

TEST(Reduction, EstimatesOfErrorsAreThePublishedOnesAndNotBelowTheTruth) {
  const AtSix six = at_six();
  const auto truth = numerics::lowest_modes(six.stiffness, six.mass, 12);
  model::ComponentModes craig(six.stiffness, six.mass, six.kept, Matrix(six.stiffness.rows(), 0));
  ASSERT_TRUE(craig.is_held());
  ASSERT_TRUE(craig.find(model::ReductionMethod::craig_bampton, 20));
  const auto expect = [&](Index count, const std::vector<double>& errors, const std::vector<double>& estimates) {
    craig.take(count);
    const auto found = craig.estimates(craig.reduced(six.stiffness), craig.reduced(six.mass), 12);
    for (std::size_t i = 0; i < 6; ++i) {
      const double right = frequency_of(truth.eigenvalues[static_cast<Index>(2 * i)]);
      const double error = found[2 * i].frequency / right - 1.0;
      EXPECT_NEAR(error, errors[i], 0.006 * errors[i]) << i;
      EXPECT_NEAR(found[2 * i].error, estimates[i], 0.006 * estimates[i]) << i;
      EXPECT_GE(found[2 * i].error, error) << i;
    }
  };
  // Three digits; eigenvalues come in pairs here, so that 10 modes are 20.
  expect(20, {1.84e-5, 9.87e-5, 6.90e-4, 1.75e-3, 1.33e-3, 1.26e-2},
         {1.84e-5, 9.90e-5, 6.96e-4, 1.78e-3, 1.37e-3, 1.37e-2});
  expect(10, {5.33e-5, 4.12e-4, 2.98e-3, 2.08e-3, 1.62e-2, 3.21e-2},
         {5.33e-5, 4.15e-4, 3.05e-3, 2.18e-3, 1.74e-2, 3.88e-2});
}

TEST(Reduction, FreeModesWithStaticShapesHaveThePublishedErrorsUnderSpringsBetweenPlatforms) {
  const AtSix six = at_six();
  model::ComponentModes rubin(six.stiffness, six.mass, six.kept, Matrix(six.stiffness.rows(), 0));
  ASSERT_TRUE(rubin.find(model::ReductionMethod::rubin, 20));
  rubin.take(20);
  const Matrix stiffness = rubin.reduced(six.stiffness), mass = rubin.reduced(six.mass);
  // Largest errors of the first 3 and 6 frequencies.
  const std::map<double, std::pair<double, double>> expected{
      {0.0, {0.0, 0.0}}, {1e6, {5.8e-8, 7.9e-7}}, {1e8, {7.5e-6, 7.7e-5}}};
  for (const auto& [k, errors] : expected) {
    const SparseMatrix springs = real_form(k * six.slider_rows.adjoint() * six.slider_rows);
    const auto truth = numerics::lowest_modes(SparseMatrix(six.stiffness + springs), six.mass, 12);
    const auto found = rubin.estimates(stiffness + rubin.reduced(springs), mass, 12);
    if (k == 1e6) {
      EXPECT_NEAR(frequency_of(truth.eigenvalues[0]), 495.890, 5e-4);
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double error = found[2 * i].frequency / frequency_of(truth.eigenvalues[static_cast<Index>(2 * i)]) - 1.0;
      worst = std::max(worst, error);
      if (i == 2) {
        EXPECT_NEAR(worst, errors.first, 0.02 * errors.first + 1e-10) << k;
      }
      // Measured 0.99 to 1.2 of the truth.
      EXPECT_GE(found[2 * i].error, 0.95 * error - 1e-10) << k << " " << i;
      EXPECT_LE(found[2 * i].error, 1.5 * error + 1e-10) << k << " " << i;
    }
    EXPECT_NEAR(worst, errors.second, 0.02 * errors.second + 1e-10) << k;
  }
}

const std::string parts =
    "[damping]\nrayleigh = { mass = 3.0, stiffness = 8e-7 }\n"
    "[[slider]]\nname = \"rim\"\nbetween = [\"211.x\", \"ground\"]\nstiffness = 1e6\nfriction_coefficient = 1.0\n"
    "normal_load = 10.0\n"
    "[[spring]]\nbetween = [\"172.z\", \"ground\"]\nstiffness = 1e5\n"
    "[[force]]\non = \"305.y\"\namplitude = 2.0\nangular_frequency = 2800.0\n";

/// X of K + i w C - w^2 M at a coordinate by its name.
Complex response(const model::Model& model, const std::string& name, double omega) {
  const auto system = system::assemble(model);
  ComplexMatrix z = Matrix(system.stiffness() - omega * omega * system.mass()).cast<Complex>();
  z += Complex(0.0, omega) * Matrix(system.damping()).cast<Complex>();
  Eigen::VectorXcd force = Eigen::VectorXcd::Zero(system.size());
  force[model.forces[0].coordinate] = 2.0;
  const Eigen::VectorXcd x = z.partialPivLu().solve(force);
  for (Index i = 0; i < model.size(); ++i)
    if (model.coordinates[static_cast<std::size_t>(i)] == name) return x[i];
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(Reduction, ModesAreTakenUntilEstimatesPassAndTrueErrorsAreWithin) {
  const auto study = study_of("[reduction]\nerror = 1e-4\n" + parts + modes);
  const model::Model reduced = model::build(study.model, {}), whole = model_of(parts + modes);
  const auto& report = *study.model.finite_elements->reduction->store->report;
  EXPECT_EQ(report.before, 882);
  EXPECT_EQ(report.interface, 4);  // slider, spring, force, observed
  EXPECT_EQ(report.interface + report.modes, reduced.size());
  EXPECT_LT(reduced.size(), 60);
  EXPECT_LE(report.worst(), 1e-4);
  const auto system = system::assemble(whole);
  SparseMatrix stuck = system.stiffness();
  const auto& slider = whole.sliders[0];
  stuck.coeffRef(slider.first, slider.first) += slider.stiffness;
  for (const auto& [stiffness, estimates] : {std::pair(&system.stiffness(), &report.free),
                                             std::pair(static_cast<const SparseMatrix*>(&stuck), &report.stuck)}) {
    const auto truth = numerics::lowest_modes(*stiffness, system.mass(), 6);
    ASSERT_EQ(estimates->size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
      const double error = (*estimates)[i].frequency / frequency_of(truth.eigenvalues[static_cast<Index>(i)]) - 1.0;
      EXPECT_GE((*estimates)[i].error, 0.999 * error - 1e-11) << i;
      EXPECT_LE((*estimates)[i].error, 1.5 * error + 1e-11) << i;
    }
  }
}

TEST(Reduction, ResponsesOfTheReducedSectorAreThoseOfTheWholeOne) {
  const model::Model whole = model_of(parts + modes);
  for (const std::string method : {"craig_bampton", "rubin"}) {
    const model::Model reduced = model_of("[reduction]\nmethod = \"" + method + "\"\nmodes = 40\n" + parts + modes);
    for (const char* name : {"305.y", "211.x", "317.z"}) {
      // Statics of loads on the interface are exact.
      const Complex rest = response(whole, name, 0.0);
      EXPECT_LT(std::abs(response(reduced, name, 0.0) - rest), 1e-9 * std::abs(rest)) << name << " " << method;
      for (const double frequency : {300.0, 455.0, 1000.0}) {
        const Complex exact = response(whole, name, 2.0 * pi * frequency);
        EXPECT_LT(std::abs(response(reduced, name, 2.0 * pi * frequency) - exact), 1e-4 * std::abs(exact))
            << name << " " << frequency << " " << method;
      }
    }
  }
}

TEST(Reduction, AllModesGiveTheWholeModelBackWithContactsAndMasses) {
  const std::string brick =
      "[model]\nmesh = \"brick.inp\"\nstiffness = \"brick.sti\"\nmass = \"brick.mas\"\n"
      "rows = \"brick.dof\"\n";
  const std::string more =
      "[[coordinate]]\nname = \"damper\"\nmass = 0.5\n[[spring]]\nbetween = [\"damper\", \"40.x\"]\n"
      "stiffness = 20.0\n[[mass]]\nnode = \"7\"\nmass = 0.1\n[[support]]\nnode = \"12\"\n"
      "fix = [\"y\"]\n[gravity]\nacceleration = [0.0, 0.0, -9.81]\n"
      "[[contact]]\nname = \"c\"\nbetween = [\"3\", \"ground\"]\nnormal_direction = [0, 0, 1]\n"
      "tangential_stiffness = 5.0\nnormal_stiffness = 9.0\nfriction_coefficient = 0.3\n";
  const auto build = [&](const std::string& reduction) {
    return model::build(io::read_study_text(brick + reduction + more + modes, "study.toml", folder.parent_path()).model,
                        {});
  };
  const model::Model whole = build("");
  const model::Model reduced = build("[reduction]\nmodes = 7\n");
  ASSERT_EQ(reduced.size(), whole.size());
  ASSERT_EQ(reduced.size(), 12);
  const auto a = system::assemble(whole), b = system::assemble(reduced);
  const auto exact = numerics::all_modes(a.stiffness(), a.mass()), found = numerics::all_modes(b.stiffness(), b.mass());
  for (Index i = 0; i < 12; ++i)
    EXPECT_NEAR(found.eigenvalues[i], exact.eigenvalues[i], 1e-10 * exact.eigenvalues[i]) << i;
  // Gravity, by the work of its forces along the statics under it, and the contact's three displacements.
  const Matrix k(a.stiffness()), r(b.stiffness());
  const Vector f = whole.matrices->inertia.col(2), g = reduced.matrices->inertia.col(2);
  EXPECT_NEAR(g.dot(r.llt().solve(g)), f.dot(k.llt().solve(f)), 1e-10 * f.dot(k.llt().solve(f)));
  const auto displaced = [](const model::Model& model, const Vector& q) {
    double u = 0.0;
    for (const auto& column : model.blocks[0].columns)
      for (const auto& share : column) u += share.weight * q[share.coordinate];
    return u;
  };
  const double u = displaced(whole, k.llt().solve(f));
  EXPECT_NEAR(displaced(reduced, r.llt().solve(g)), u, 1e-10 * std::abs(u));
}

TEST(Reduction, GravityHasItsStaticShapeHoweverFewModesThereAre) {
  const std::string load = "[gravity]\nacceleration = [0.0, -9.81, 0.0]\n";
  const model::Model whole = model_of(load + modes), reduced = model_of("[reduction]\nmodes = 2\n" + load + modes);
  ASSERT_EQ(reduced.size(), 1 + 2 + 1);
  const auto tip = [](const model::Model& model) {
    const Matrix k(model.matrices->stiffness);
    const Vector q = k.llt().solve(Vector(model.matrices->inertia.col(1)));
    for (Index i = 0; i < model.size(); ++i)
      if (model.coordinates[static_cast<std::size_t>(i)] == "317.z") return q[i];
    return 0.0;
  };
  EXPECT_NEAR(tip(reduced), tip(whole), 1e-9 * std::abs(tip(whole)));
}

TEST(Reduction, IsRefusedByNameWhereItCannotBe) {
  const auto refused = [](const std::string& text, const std::string& part, const std::string& of = files) {
    try {
      (void)model::build(io::read_study_text(of + text + modes, "study.toml", folder).model, {});
      ADD_FAILURE() << "taken: " << text;
    } catch (const InvalidInput& fault) {
      EXPECT_NE(std::string(fault.what()).find(part), std::string::npos) << fault.what();
    }
  };
  refused("[reduction]\nmodes = 4\nerror = 1e-3\n", "give one of them");
  refused("[reduction]\nerror = \"2*0.1\"\n", "takes a number");
  refused("[reduction]\nerror = 2.0\n", "between 0 and 1");
  refused("[reduction]\nmodes = -1\n", "from 0 to 100000");
  refused("[reduction]\nmodes = 882\n", "the model has 881");
  refused("[reduction]\nkeep = [\"NTIPP\"]\n", "did you mean \"NTIP\"?");
  refused("[[coordinate]]\nname = \"c\"\nmass = 1.0\n[reduction]\nmodes = 4\n", "there is none", "");
  refused("[[coordinate]]\nname = \"mode_1\"\nmass = 1.0\n[reduction]\nmodes = 4\n", "rename the coordinate");
  refused("[damping]\nmodal_ratio = 0.01\nmodes = 20\n[reduction]\nmodes = 4\n", "damp fewer");
}

}  // namespace
}  // namespace rubato::testing
