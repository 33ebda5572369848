#include "io/study_text.hpp"

#include <gtest/gtest.h>

namespace rubato::testing {
namespace {

const std::string mesh_text =
    "[nodes]\n"                       // 1
    "file = \"nodes.csv\"\n"          // 2
    "[beams]\n"                       // 3
    "file = \"beams.csv\"\n"          // 4
    "section = \"tube\"\n"            // 5
    "material = \"steel\"\n"          // 6
    "[[material]]\n"                  // 7
    "name = \"steel\"\n"              // 8
    "young = 2.1e11\n"                // 9
    "poisson = 0.3\n"                 // 10
    "density = 7850.0\n"              // 11
    "[[section]]\n"                   // 12
    "name = \"tube\"\n"               // 13
    "area = 1e-3\n"                   // 14
    "inertia = 1e-6\n"                // 15
    "shear_factor = 0.5\n"            // 16
    "[[support]]\n"                   // 17
    "node = 1\n"                      // 18
    "fix = [\"x\", \"y\", \"rz\"]\n"  // 19
    "[[analysis]]\n"                  // 20
    "name = \"rest\"\n"               // 21
    "type = \"static\"\n";            // 22
const std::string nodes_text = "name,x,y\n# the foot\n1,0,0\n2,0,+1.5\n\n3,2e0,1.5\n";
const std::string beams_text = "first,second\n1,2\n2,3\n";

/// What is said of a mesh, without the folder, which is another in every run.
std::string verdict_on(const std::string& nodes, const std::string& beams, const std::string& study = mesh_text) {
  const ScratchFolder folder("mesh");
  folder.write("nodes.csv", nodes);
  folder.write("beams.csv", beams);
  std::string message = verdict(study, folder.path());
  const std::string name = folder.path().string() + "/";
  for (std::size_t place = message.find(name); place != std::string::npos; place = message.find(name))
    message.erase(place, name.size());
  return message;
}

TEST(Mesh, IsReadFromFilesAsFromTheStudy) {
  EXPECT_EQ(verdict_on(nodes_text, beams_text), "accepted");
  const ScratchFolder folder("mesh-values");
  folder.write("nodes.csv", nodes_text);
  folder.write("beams.csv", "name;first;second;material\nleg;1;2;\n\"\";2;3;steel\n");
  const std::string text = mesh_text +
                           "[[node]]\nname = \"tip\"\nposition = [3.0, 1.5]\n[[beam]]\nnodes = [3, \"tip\"]\n"
                           "section = \"tube\"\nmaterial = \"steel\"\n";
  const auto study = io::read_study_text(text, "study.toml", folder.path());
  const model::Model model = model::build(study.model, {});
  EXPECT_EQ(model.structure.names, (std::vector<std::string>{"tip", "1", "2", "3"}));
  EXPECT_EQ(model.structure.positions[3], model::Axis(2.0, 1.5, 0.0));
  EXPECT_EQ(model.structure.elements.size(), 3u);
  EXPECT_EQ(study.model.structure.beams[1].name, "leg");
  EXPECT_EQ(model.size(), 9);
}

TEST(MeshError, PointsAtTheRow) {
  EXPECT_EQ(verdict_on("name,x,y\n1,0,zero\n", beams_text),
            "nodes.csv:2: error: y must be a finite number, got \"zero\"");
  EXPECT_EQ(verdict_on("name,x,y\n1,0,0\n2,0\n", beams_text), "nodes.csv:3: error: 2 fields for 3 columns");
  EXPECT_EQ(verdict_on("name,x,y\n1,0,nan\n", beams_text),
            "nodes.csv:2: error: y must be a finite number, got \"nan\"");
  EXPECT_EQ(verdict_on("name,x,y\n1,0,0\n1,0,1\n", beams_text), "nodes.csv:3: error: two nodes are called \"1\"");
  EXPECT_EQ(verdict_on(nodes_text, "first,second\n1,2\n2,4\n"),
            "beams.csv:3: error: the beam from \"2\" to \"4\" joins \"4\", which is no node; known: 1, 2, 3");
  EXPECT_EQ(verdict_on(nodes_text, "first,second\n1,2\n2,2\n"),
            "beams.csv:3: error: the beam from \"2\" to \"2\" joins node \"2\" with itself");
  EXPECT_EQ(verdict_on(nodes_text, "first,second\n1,2\n2,\n"), "beams.csv:3: error: the field \"second\" is empty");
}

TEST(MeshError, PointsAtTheHeader) {
  EXPECT_EQ(verdict_on("name,x\n1,0\n", beams_text), "nodes.csv:1: error: the column \"y\" is missing");
  EXPECT_EQ(verdict_on("name,x,y,x\n1,0,0,0\n", beams_text), "nodes.csv:1: error: two columns are called \"x\"");
  EXPECT_EQ(
      verdict_on(nodes_text, "first,secnd\n1,2\n"),
      "beams.csv:1: error: the first row names the columns, and \"secnd\" is none of them; did you mean \"second\"? "
      "(known: first, second, name, section, material)");
  EXPECT_EQ(verdict_on(nodes_text, "first,second\n"),
            "beams.csv: error: the file has no rows; it needs a header and a row each");
}

TEST(MeshError, PointsAtWhatTheStudyLacks) {
  EXPECT_EQ(verdict_on(nodes_text, beams_text, edited("section = \"tube\"\n", "", mesh_text)),
            "beams.csv:2: error: the beam has no section; give [beams] \"section\", or the file a column \"section\"");
  EXPECT_EQ(verdict_on(nodes_text, beams_text, edited("\"nodes.csv\"", "\"node.csv\"", mesh_text)),
            "study.toml:2:8: error: the mesh \"node.csv\" does not exist");
  EXPECT_EQ(verdict_on(nodes_text, beams_text, edited("[beams]\n", "[beams]\nelements = 2\n", mesh_text)),
            "study.toml:4:1: error: [beams] has no key \"elements\"; known: section, material, mass, formulation, "
            "orientation, file");
}

TEST(MeshFault, RefusesABeamThatIsThereAlready) {
  const std::string said =
      "error: the beam from \"2\" to \"1\" is there already (line 2), and a second one would double "
      "its stiffness; remove one, or if two beams are meant give one of them a name";
  EXPECT_EQ(verdict_on(nodes_text, "first,second\n1,2\n2,3\n2,1\n"), "beams.csv:4: " + said);
  EXPECT_EQ(verdict_on(nodes_text, "name,first,second\n,1,2\n,2,3\ntwin,2,1\n"), "accepted");
}

}  // namespace
}  // namespace rubato::testing
