#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/integrate/equilibrium/cyclic_motions.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

// A disk of 24 sectors by one of them, 882 rows from CalculiX: frequencies by nodal diameter from an independent
// calculation with scipy, which agree with CalculiX's own cyclic ones to its seven digits.
namespace rubato::testing {
namespace {

const std::filesystem::path folder = std::filesystem::path(RUBATO_TEST_DATA) / "finite_elements" / "sector";
const std::string files =
    "[model]\nmesh = \"sector.mat.inp\"\nstiffness = \"sector.sti\"\nmass = \"sector.mas\"\nrows = \"sector.dof\"\n";
const std::string cyclic = "[cyclic]\nsectors = 24\naxis = [0, 0, 1]\nleft = \"NLEFT\"\nright = \"NRIGHT\"\n";
const std::string modes = "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\ncount = 6\nobserve = [\"305.x\"]\n";

struct Disk {
  explicit Disk(const std::string& text)
      : study(io::read_study_text(text, "study.toml", folder)),
        model(model::build(study.model, {})),
        system(system::assemble(model)),
        sector(*study.model.finite_elements->cyclic, *study.model.finite_elements, model, {}) {}
  numerics::DampedModes modes(Index diameter, Index count = 6) const {
    return integrate::modes_of_diameter(sector, diameter, system.free_stiffness(), system.free_damping(), system.mass(),
                                        count);
  }

  model::StudyDescription study;
  model::Model model;
  system::LocallyNonlinear system;
  model::CyclicSector sector;
};

double hertz(const numerics::DampedMode& mode) { return mode.angular_frequency / (2.0 * std::numbers::pi); }

void expect_frequencies(const Disk& disk, Index diameter, const std::array<double, 6>& expected) {
  const auto found = disk.modes(diameter);
  EXPECT_TRUE(found.has_converged);
  ASSERT_EQ(found.modes.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(hertz(found.modes[i]), expected[i], 1e-9 * expected[i]) << diameter << " " << i;
}

TEST(Cyclic, DiskHasThePublishedFrequenciesOfEachNodalDiameter) {
  const Disk disk(files + cyclic + modes);
  EXPECT_EQ(disk.sector.pairs(), 24);
  EXPECT_LT(disk.sector.largest_distance(), 1e-12);
  expect_frequencies(disk, 0, {457.0269321, 1237.5992056, 1883.3726454, 3148.1751011, 3816.0396400, 5110.3294924});
  expect_frequencies(disk, 1, {457.5365882, 1230.9171138, 1885.5586941, 3146.2890391, 3884.6691405, 5123.1591773});
  expect_frequencies(disk, 3, {457.9570255, 1385.5120437, 2083.6944829, 3140.8329079, 4073.3336428, 5297.5202424});
  expect_frequencies(disk, 6, {457.8694303, 1511.5260048, 2578.2584690, 3145.1814866, 4294.2416481, 5364.6563610});
  expect_frequencies(disk, 8, {457.7415912, 1524.5531862, 2677.3433244, 3146.6222527, 4332.0429701, 5369.7945308});
  expect_frequencies(disk, 12, {457.6131444, 1530.6678142, 2729.1497039, 3147.0274462, 4351.6297134, 5371.0430689});
}

TEST(Cyclic, ReducedSectorHasThePublishedFrequencies) {
  const Disk disk(files + cyclic + "[reduction]\nmodes = 20\nkeep = [\"172\", \"189\", \"211\", \"223\", \"305\"]\n" +
                  modes);
  EXPECT_EQ(disk.system.size(), 144 + 15 + 20);
  expect_frequencies(disk, 3, {457.9572902, 1385.5193862, 2083.7684476, 3140.9337345, 4073.8132242, 5298.6712001});
  expect_frequencies(disk, 6, {457.8696956, 1511.5330234, 2578.3056228, 3145.2812349, 4294.4426412, 5365.1853603});
}

TEST(Cyclic, SidesAreToldApartByTheRotationThatFits) {
  const Disk disk(files + cyclic + modes);
  const Disk exchanged(files + "[cyclic]\nsectors = 24\naxis = [0, 0, 1]\nleft = \"NRIGHT\"\nright = \"NLEFT\"\n" +
                       modes);
  EXPECT_FALSE(disk.sector.is_exchanged());
  EXPECT_TRUE(exchanged.sector.is_exchanged());
  EXPECT_EQ(hertz(disk.modes(3, 1).modes[0]), hertz(exchanged.modes(3, 1).modes[0]));
}

/// Shapes repeat from sector to sector, and leave no force: of a whole disk assembled from its sectors.
TEST(Cyclic, ShapesAreModesOfTheWholeDisk) {
  const Disk disk(files + cyclic + modes);
  for (const Index k : {0, 5, 12}) {
    const auto found = disk.modes(k, 3);
    for (const auto& mode : found.modes) {
      const double square = mode.angular_frequency * mode.angular_frequency;
      const Eigen::VectorXcd inertia = disk.system.mass() * mode.shape;
      EXPECT_NEAR(mode.shape.dot(inertia).real(), 1.0, 1e-10);
      const Eigen::VectorXcd elastic = disk.system.stiffness() * mode.shape;
      const Eigen::VectorXcd left_over = elastic - square * inertia;
      // What is left over acts at the sides only, and does no work on motions of this nodal diameter.
      double inside = 0.0;
      for (std::size_t node = 0; node < disk.model.structure.names.size(); ++node) {
        const auto& at = disk.model.structure.positions[node];
        const double angle = std::atan2(at.x(), at.y()) * 180.0 / std::numbers::pi;
        if (std::abs(angle) > 3.0) continue;
        for (const Index place : disk.model.structure.places[node])
          if (place >= 0) inside = std::max(inside, std::abs(left_over[place]));
      }
      EXPECT_LT(inside, 1e-7 * elastic.cwiseAbs().maxCoeff()) << k;
      EXPECT_LT(std::abs(mode.shape.dot(left_over)), 1e-7 * square) << k;
    }
  }
}

TEST(Cyclic, RayleighDampingGivesItsRatiosAtEveryNodalDiameter) {
  const Disk disk(files + cyclic + "[damping]\nrayleigh = { mass = 3.0, stiffness = 8e-7 }\n" + modes);
  for (const Index k : {0, 4}) {
    for (const auto& mode : disk.modes(k, 4).modes) {
      const double omega = mode.angular_frequency, ratio = 0.5 * (3.0 / omega + 8e-7 * omega);
      EXPECT_NEAR(mode.damping_ratio, ratio, 1e-8 * ratio) << k;
    }
  }
}

TEST(Cyclic, IsRefusedByNameWhereItCannotBe) {
  const auto refused = [](const std::string& text, const std::string& part) {
    const std::string said = verdict(text, folder);
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  EXPECT_EQ(verdict(files + cyclic + modes, folder), "accepted");
  refused(files + edited("24", "23", cyclic) + modes, "the worst is node");
  refused(files + edited("24", "1", cyclic) + modes, "from 2 to 10000");
  EXPECT_EQ(verdict(files + cyclic + modes + "nodal_diameters = [0, 12]\n", folder), "accepted");
  refused(files + cyclic + modes + "nodal_diameters = [0, 13]\n", "whole numbers from 0 to 12, got 13");
  refused(files + cyclic + modes + "nodal_diameters = [1.5]\n", "got 1.5");
  refused(files + modes + "nodal_diameters = [3]\n", "add [cyclic], or leave them out");
  refused(files + edited("NLEFT", "NLEFTT", cyclic) + modes, "did you mean \"NLEFT\"?");
  refused(files + edited("NLEFT", "NTIP", cyclic) + modes, "both sides must have the same mesh");
  refused(files + edited("NLEFT", "NRIGHT", cyclic) + modes, "belongs to both sides");
  refused(files + edited("[0, 0, 1]", "[0, 0, 0]", cyclic) + modes, "axis must have a length");
  refused(files + edited("[0, 0, 1]", "[0, 1]", cyclic) + modes, "axis");
  refused(files + cyclic + "[[support]]\nnode = \"NLEFT\"\nfix = [\"x\"]\n" + modes, "one is held in a direction");
  refused(files + cyclic + "[damping]\nmodal_ratio = 0.01\n" + modes, "take rayleigh");
  refused(files + cyclic + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n", "only type = \"modes\"");
  refused(files + cyclic + "[[analysis]]\nname = \"t\"\ntype = \"transient\"\nstep = 1e-5\nduration = 1e-3\n",
          "only type = \"modes\"");
  refused(files + cyclic + "[parameters]\nm = 3.0\n[damping]\nrayleigh = { mass = \"m\", stiffness = 0.0 }\n" + modes +
              "sweep = { m = [1.0, 2.0] }\n",
          "are not swept yet");
  refused("[[coordinate]]\nname = \"c\"\nmass = 1.0\n" + cyclic + modes, "there is none");
}

}  // namespace
}  // namespace rubato::testing
