#include <rubato/model/model.hpp>

#include "support/frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace rubato::model {
namespace {

/// What is said of the frame after a change; "accepted" if nothing.
std::string verdict(const std::function<void(ModelDescription&)>& change) {
  ModelDescription description = testing::portal_frame();
  change(description);
  try {
    (void)build(description, {});
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
}

std::string verdict_of_frame(const std::function<void(StructureDescription&)>& change) {
  return verdict([&](ModelDescription& description) { change(description.structure); });
}

TEST(Structure, EliminatesWhatSupportsHold) {
  const Model model = build(testing::portal_frame(), {});
  EXPECT_EQ(model.size(), 16);
  EXPECT_EQ(model.coordinates.front(), "1.y");
  EXPECT_EQ(model.structure.places[0][0], ground);
  EXPECT_EQ(model.structure.places[0][1], 0);
}

TEST(Structure, StandsBesideCoordinatesAndIsJoinedToThem) {
  ModelDescription description = testing::portal_frame();
  description.coordinates = {{"tower", 10.0, 0.5, 0.0, {}}};
  description.springs = {{{"tower", "4.x"}, {}, 100.0, {}}, {{"7.x", "tower"}, {}, 50.0, {}}};
  const Model model = build(description, {});
  ASSERT_EQ(model.size(), 17);
  EXPECT_EQ(model.coordinates[1], "1.y");
  EXPECT_EQ(model.position[0], 0.5);
  EXPECT_EQ(model.coordinates[static_cast<std::size_t>(model.springs[0].second)], "4.x");
  EXPECT_EQ(model.springs[1].first, ground);  // what a support holds is ground
}

TEST(Structure, DividesABeamAndNamesTheNodesWithin) {
  ModelDescription description = testing::portal_frame();
  description.structure.beams[0].elements = 4;
  const Model model = build(description, {});
  EXPECT_EQ(model.structure.elements.size(), 9u);
  EXPECT_EQ(model.structure.names[7], "1-2:1");
  EXPECT_EQ(model.structure.positions[8], Axis(2.5, 2.7, 0.0));
}

TEST(StructureFault, NamesWhatIsUnknownAndTheNearestName) {
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.beams[0].section = "tub"; }),
            "the beam from \"1\" to \"2\" has the section \"tub\", which is no section; did you mean \"tube\"? (known: "
            "tube)");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.beams[0].material = "stel"; }),
            "the beam from \"1\" to \"2\" has the material \"stel\", which is no material; did you mean \"steel\"? "
            "(known: steel)");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.beams[0].nodes[1] = "22"; }),
            "the beam from \"1\" to \"22\" joins \"22\", which is no node; known: 1, 2, 3, 4, 5, 6, 7");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.supports[0].node = "9"; }),
            "a support is at \"9\", which is no node; known: 1, 2, 3, 4, 5, 6, 7");
}

TEST(StructureFault, NamesWhatIsThereTwice) {
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.nodes[1].name = "1"; }), "two nodes are called \"1\"");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.sections.push_back(frame.sections[0]); }),
            "two sections are called \"tube\"");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.materials.push_back(frame.materials[0]); }),
            "two materials are called \"steel\"");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.supports.push_back(frame.supports[0]); }),
            "node \"1\" is fixed in x twice");
  EXPECT_EQ(verdict([](auto& description) {
              description.coordinates = {{"4.x", 1.0, 0.0, 0.0, {}}};
            }),
            "a coordinate and a degree of freedom are both called \"4.x\"; rename the coordinate");
}

TEST(StructureFault, NamesABeamWithoutLength) {
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.nodes[1].position = frame.nodes[0].position; }),
            "the beam from \"1\" to \"2\" has no length: nodes \"1\" and \"2\" lie in the same place");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.beams[0].nodes[1] = "1"; }),
            "the beam from \"1\" to \"1\" joins node \"1\" with itself");
}

TEST(StructureFault, NamesASectionWithoutInertiaOrShear) {
  EXPECT_EQ(
      verdict_of_frame([](auto& frame) { frame.sections[0].inertia.clear(); }),
      "the beam from \"1\" to \"2\" has the section \"tube\", which has no inertia; give the section one [m4], or "
      "take a [[truss]]");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.sections[0].inertia = {0.0}; }),
            "section \"tube\": inertia must be positive, got 0");
  EXPECT_EQ(
      verdict_of_frame([](auto& frame) { frame.sections[0].shear_factor.clear(); }),
      "the beam from \"1\" to \"2\" is a Timoshenko beam, and its section \"tube\" has no shear_factor (5/6 for a "
      "rectangle); give it one, or take formulation = \"euler_bernoulli\"");
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.materials[0].poisson.reset(); }),
            "the beam from \"1\" to \"2\" needs the shear modulus of the material \"steel\"; give the material "
            "\"poisson\" or \"shear_modulus\"");
}

TEST(StructureFault, NamesANodeThatNothingJoins) {
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.nodes.push_back(testing::node_at("8", 5.0, 5.0)); }),
            "node \"8\" is joined by nothing: no beam, truss or mass names it");
}

TEST(StructureFault, NamesAFreedomWithoutInertia) {
  EXPECT_EQ(
      verdict([](auto& description) {
        description.structure.nodes.push_back(testing::node_at("8", 5.0, 5.0));
        PointMassDescription mass;
        mass.node = "8";
        mass.mass = 2.0;
        description.structure.masses = {mass};
        description.springs = {{{"8.rz", "4.rz"}, {}, 10.0, {}}};
      }),
      "the spring between \"8.rz\" and \"4.rz\" joins \"8.rz\", and node \"8\" has no inertia in rz: join it by a "
      "beam, or give it a [[mass]] with an inertia");
}

TEST(StructureFault, NamesFreedomsThatANodeHasNot) {
  EXPECT_EQ(verdict_of_frame([](auto& frame) { frame.supports[0].fix = {"z"}; }),
            "the support at node \"1\" fixes \"z\"; a node in the plane has x, y, rz");
  const auto spring = [](const std::string& first, const std::string& second) {
    return verdict([&](auto& description) { description.springs = {{{first, second}, {}, 10.0, {}}}; });
  };
  EXPECT_EQ(spring("4.z", "ground"),
            "the spring between \"4.z\" and \"ground\" joins \"4.z\", but a node has x, y, rz in the plane");
  EXPECT_EQ(spring("4.x", "4.rz"),
            "the spring between \"4.x\" and \"4.rz\" joins a displacement [m] and a rotation [rad]");
  EXPECT_EQ(spring("7.x", "7.y"),
            "the spring between \"7.x\" and \"7.y\" joins \"7.x\" with \"7.y\", and neither moves");
  EXPECT_EQ(verdict([](auto& description) {
              description.forces = {{"7.x", HarmonicDescription{}, {}}};
            }),
            "a force is on \"7.x\", which a support holds");
}

/// A vertical and a horizontal beam in space, clamped below.
ModelDescription mast() {
  ModelDescription description;
  StructureDescription& mast = description.structure;
  mast.nodes = {{"foot", {0.0, 0.0, 0.0}, {}}, {"top", {0.0, 0.0, 3.0}, {}}, {"arm", {2.0, 0.0, 3.0}, {}}};
  mast.materials = {{"steel", 2.1e11, 0.3, {}, 7800.0, {}}};
  mast.sections = {{"tube", 2e-3, {1e-6, 1e-6}, 2e-6, {0.5}, {}}};
  for (const auto& nodes : {std::array<std::string, 2>{"foot", "top"}, std::array<std::string, 2>{"top", "arm"}}) {
    BeamDescription beam;
    beam.nodes = nodes;
    beam.section = "tube";
    beam.material = "steel";
    mast.beams.push_back(beam);
  }
  SupportDescription foot;
  foot.node = "foot";
  foot.fix = {"x", "y", "z", "rx", "ry", "rz"};
  mast.supports = {foot};
  return description;
}

TEST(StructureInSpace, HasSixFreedomsANode) {
  const Model model = build(mast(), {});
  EXPECT_EQ(model.size(), 12);
  EXPECT_EQ(model.coordinates.back(), "arm.rz");
}

TEST(StructureInSpaceFault, NamesAnOrientationAlongTheBeam) {
  const auto verdict = [](const std::function<void(StructureDescription&)>& change) {
    ModelDescription description = mast();
    change(description.structure);
    try {
      (void)build(description, {});
      return std::string("accepted");
    } catch (const InvalidInput& fault) {
      return fault.message();
    }
  };
  EXPECT_EQ(
      verdict([](auto& mast) {
        mast.beams[0].orientation = {0.0, 0.0, 2.0};
      }),
      "the beam from \"foot\" to \"top\": the orientation [0, 0, 2] lies along the beam; give a vector across it, "
      "in its local x-y plane");
  EXPECT_EQ(verdict([](auto& mast) {
              mast.sections[0].inertia = {1e-6, 2e-6};
            }),
            "the beam from \"foot\" to \"top\" is vertical, and its section is not the same about both axes; give "
            "\"orientation\", a vector in its local x-y plane");
  EXPECT_EQ(
      verdict([](auto& mast) { mast.sections[0].torsion.reset(); }),
      "the beam from \"foot\" to \"top\" has the section \"tube\", which has no torsion constant; give the section "
      "\"torsion\" [m4]");
  EXPECT_EQ(verdict([](auto& mast) { mast.sections[0].inertia = {1e-6}; }),
            "section \"tube\": inertia takes two numbers in space, [Iy, Iz], got 1");
  EXPECT_EQ(
      verdict([](auto& mast) {
        mast.nodes[1].position = {0.0, 3.0};
      }),
      "node \"top\" has 2 numbers for its position, and node \"foot\" has 3: a model lies in the plane or in space");
}

/// What is said of the mast with an arm to (2, 1, 4) and releases at its free end; "accepted" if nothing.
std::string verdict_of_oblique_arm(
    const std::vector<std::string>& released, const std::function<void(StructureDescription&)>& change = [](auto&) {}) {
  ModelDescription description = mast();
  description.structure.nodes[2].position = {2.0, 1.0, 4.0};
  description.structure.beams[1].release[1] = released;
  change(description.structure);
  try {
    (void)build(description, {});
    return "accepted";
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
}

// About the arm, (2, 1, 1) / sqrt(6), about its local y, which is normal to it and in the plane with z, and along the
// arm itself.
TEST(ReleaseFault, NamesAFreeEndThatMovesObliquelyWithoutInertia) {
  EXPECT_EQ(verdict_of_oblique_arm({"rx"}),
            "the releases of beams leave node \"arm\" free to turn about (0.816, 0.408, 0.408), oblique to the axes of "
            "the model, without mass or stiffness; leave out one of them, or give the node a [[mass]] with an inertia");
  EXPECT_THAT(verdict_of_oblique_arm({"ry"}), ::testing::HasSubstr("free to turn about (-0.365, -0.183, 0.913)"));
  EXPECT_THAT(verdict_of_oblique_arm({"x"}), ::testing::HasSubstr("free to move along (0.816, 0.408, 0.408)"));
  EXPECT_THAT(verdict_of_oblique_arm({"ry", "rz"}), ::testing::HasSubstr("free to turn about"));
  const auto in_plane = verdict_of_frame([](auto& frame) {
    frame.nodes.push_back(testing::node_at("8", 4.0, 3.7));
    frame.beams.push_back(frame.beams[0]);
    frame.beams.back().nodes = {"1", "8"};
    frame.beams.back().release[1] = {"x"};
  });
  EXPECT_THAT(in_plane, ::testing::HasSubstr("node \"8\" free to move along (0.707, 0.707), oblique"));
}

// An inertia however small, a second beam or a support at the end, and what all rotations or an axis of the model
// release.
TEST(Release, IsNoFaultWhereEveryMotionOfItsNodeHasInertiaOrDoesNotExist) {
  const auto with_inertia = [](auto& frame) {
    PointMassDescription mass;
    mass.node = "arm";
    mass.inertia = {1e-9, 1e-9, 1e-9};
    frame.masses = {mass};
  };
  const auto with_beam = [](auto& frame) {
    frame.nodes.push_back({"end", {3.0, 1.0, 5.0}, {}});
    frame.beams.push_back(frame.beams[1]);
    frame.beams.back().nodes = {"arm", "end"};
    frame.beams.back().release = {};
  };
  const auto with_support = [](auto& frame) {
    SupportDescription support;
    support.node = "arm";
    support.fix = {"rx"};
    frame.supports.push_back(support);
  };
  for (const std::string axis : {"rx", "ry", "rz"})
    for (const auto& held :
         std::vector<std::function<void(StructureDescription&)>>{with_inertia, with_beam, with_support})
      EXPECT_EQ(verdict_of_oblique_arm({axis}, held), "accepted") << axis;
  EXPECT_EQ(verdict_of_oblique_arm({"ry"},
                                   [&](auto& frame) {  // hinges about other directions at one node
                                     with_beam(frame);
                                     frame.beams.back().release[0] = {"ry"};
                                   }),
            "accepted");
  EXPECT_EQ(verdict_of_oblique_arm({"rx", "ry", "rz"}), "accepted");
  for (const std::vector<std::string>& released :
       {std::vector<std::string>{"rx"}, {"ry"}, {"rz"}, {"x"}, {"ry", "rz"}, {"rx", "ry"}})
    EXPECT_EQ(verdict_of_oblique_arm(released,
                                     [](auto& frame) {
                                       frame.nodes[2].position = {2.0, 1e-7, 3.0};  // along x to seven digits
                                     }),
              "accepted");
}

}  // namespace
}  // namespace rubato::model
