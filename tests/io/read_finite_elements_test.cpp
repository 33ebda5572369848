#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/model/finite_elements/check_finite_elements.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

// The brick: one element C3D8 with a clamped base, from CalculiX, and its matrices in the layout of other programs.
namespace rubato::testing {
namespace {

const std::filesystem::path data = std::filesystem::path(RUBATO_TEST_DATA) / "finite_elements";

const std::string calculix =
    "mesh = \"brick.inp\"\nstiffness = \"brick.sti\"\nmass = \"brick.mas\"\nrows = \"brick.dof\"\n";

std::string study_of(const std::string& files, const std::string& parts = "") {
  return "[model]\n" + files + parts + "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n";
}

std::shared_ptr<const model::FiniteElements> read(const std::string& files,
                                                  const std::filesystem::path& folder = data) {
  return io::read_study_text(study_of(files), "study.toml", folder).model.finite_elements;
}

std::string content(const std::string& name) {
  std::ifstream stream(data / name, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// What is said where a file of the brick has another content; without the folder, which is another in every run.
std::string verdict_on(const std::string& file, const std::string& text, const std::string& files = calculix,
                       const std::string& parts = "") {
  const ScratchFolder folder("finite-elements");
  for (const auto& entry : std::filesystem::directory_iterator(data))
    std::filesystem::copy(entry.path(), folder.path(), std::filesystem::copy_options::overwrite_existing);
  if (!file.empty()) folder.write(file, text);
  std::string message = verdict(study_of(files, parts), folder.path());
  const std::string name = folder.path().string() + "/";
  for (std::size_t at = message.find(name); at != std::string::npos; at = message.find(name))
    message.erase(at, name.size());
  return message;
}

std::string with(const std::string& file, const std::string& from, const std::string& to) {
  return edited(from, to, content(file));
}

void expect_says(const std::string& message, const std::string& place, const std::string& part) {
  EXPECT_TRUE(message.starts_with(place + ": error: ")) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

struct FilesOfTheBrick {
  const char* name;
  std::string files;
  double digits;
};

const std::vector<FilesOfTheBrick> formats{
    {"CalculiX", calculix, 1e-13},
    {"MatrixMarketWithATable", "stiffness = \"brick_stif.mtx\"\nmass = \"brick_mass.mtx\"\nrows = \"brick_map.csv\"\n",
     1e-13},
    {"AbaqusCoordinateWithATable",
     "stiffness = \"brick_STIF1_coordinate.mtx\"\nmass = \"brick_MASS1_coordinate.mtx\"\nrows = \"brick_map.csv\"\n",
     1e-13},
    {"AbaqusMatrixInput",
     "mesh = \"brick.inp\"\nstiffness = \"brick_STIF1_input.mtx\"\nmass = \"brick_MASS1_input.mtx\"\n", 1e-13},
    {"AbaqusSubstructure", "stiffness = \"brick_substructure.mtx\"\nmass = \"brick_substructure.mtx\"\n", 1e-13},
    {"NastranDmig", "mesh = \"brick.inp\"\nstiffness = \"brick.pch\"\nmass = \"brick.pch\"\n", 1e-9},
    {"NastranDmigByName",
     "stiffness = \"brick.pch\"\nmass = \"brick.pch\"\nstiffness_name = \"KAAX\"\nmass_name = \"MAAX\"\n", 1e-9},
    {"NastranOp4WithATable", "stiffness = \"brick.op4\"\nmass = \"brick.op4\"\nrows = \"brick_map.csv\"\n", 1e-13},
};

TEST(FiniteElementFiles, OfOneBrickGiveTheSameMatricesInEveryFormat) {
  const auto expected = read(calculix);
  ASSERT_EQ(expected->rows.size(), 12u);
  EXPECT_EQ(model::name_of(expected->rows.front()), "3.x");
  EXPECT_EQ(model::name_of(expected->rows.back()), "40.z");
  EXPECT_EQ(expected->stiffness.values.coeff(0, 0), 207.60482030956);
  EXPECT_EQ(expected->stiffness.values.coeff(1, 0), -51.603754407020);
  EXPECT_EQ(expected->stiffness.values.coeff(0, 1), -51.603754407020);
  for (const auto& format : formats) {
    const auto got = read(format.files);
    EXPECT_EQ(got->rows, expected->rows) << format.name;
    for (const auto matrix : {&model::FiniteElements::stiffness, &model::FiniteElements::mass}) {
      const Matrix difference = ((*got).*matrix).values - ((*expected).*matrix).values;
      const double size = ((*expected).*matrix).values.toDense().cwiseAbs().maxCoeff();
      EXPECT_LE(difference.cwiseAbs().maxCoeff(), format.digits * size) << format.name;
    }
  }
}

TEST(FiniteElementFiles, OfOneBrickGiveItsTwelveEigenvalues) {
  // From scipy on the files of CalculiX; ten digits, as many as these have.
  const std::vector<double> expected{151.1527001, 162.6614591, 270.6640966, 619.1416389, 1095.156738, 1237.865968,
                                     1364.806424, 1411.046818, 2148.643427, 2482.297810, 2588.735401, 2769.631665};
  for (const auto& format : formats) {
    const auto got = read(format.files);
    const auto modes = numerics::all_modes(got->stiffness.values, got->mass.values);
    ASSERT_EQ(modes.eigenvalues.size(), 12) << format.name;
    for (Index i = 0; i < 12; ++i)
      EXPECT_NEAR(modes.eigenvalues[i] / expected[static_cast<std::size_t>(i)], 1.0, 2e-9) << format.name << " " << i;
  }
}

TEST(FiniteElementFiles, MayHaveRowsInAnotherOrderInEachFile) {
  // The table turned over: rows of matrices without names are renumbered by hand here.
  const ScratchFolder folder("finite-elements-order");
  std::istringstream lines(content("brick.mas"));
  std::string reversed, row, column, value;
  while (lines >> row >> column >> value)
    reversed += std::to_string(13 - std::stoi(column)) + " " + std::to_string(13 - std::stoi(row)) + " " + value + "\n";
  std::istringstream names(content("brick.dof"));
  std::vector<std::string> labels;
  for (std::string label; names >> label;) labels.push_back(label);
  std::string other;
  for (auto label = labels.rbegin(); label != labels.rend(); ++label) other += *label + "\n";
  folder.write("k.mtx", content("brick_STIF1_input.mtx"));
  folder.write("m.mas", reversed);
  folder.write("rows.dof", other);
  const auto expected = read(calculix);
  const auto got = read("stiffness = \"k.mtx\"\nmass = \"m.mas\"\nrows = \"rows.dof\"\n", folder.path());
  EXPECT_EQ(got->rows, expected->rows);
  EXPECT_EQ((got->mass.values - expected->mass.values).norm(), 0.0);
}

TEST(FiniteElementFiles, GiveNodesTheirPlacesAndSets) {
  const auto model = read(calculix);
  ASSERT_TRUE(model->mesh);
  EXPECT_EQ(model->mesh->nodes.size(), 8u);
  EXPECT_EQ(model->nodes, (std::vector<std::int64_t>{3, 7, 12, 21, 22, 23, 24, 40}));
  EXPECT_EQ(std::count(model->is_held.begin(), model->is_held.end(), 1), 4);
  EXPECT_EQ(model->positions[7], (std::array<double, 3>{1.05, 1.1, 0.8}));
  ASSERT_EQ(model->mesh->sets.size(), 3u);
  EXPECT_EQ(model->mesh->sets[2].name, "NTOP");
  EXPECT_EQ(model->mesh->sets[2].nodes, (std::vector<std::int64_t>{12, 3, 40, 7}));
  // A table of rows tells places as well.
  const auto by_table = read(formats[1].files);
  EXPECT_EQ(by_table->positions[3], (std::array<double, 3>{1.05, 1.1, 0.8}));
}

TEST(FiniteElementFiles, ServeByTheNamesOfDegreesOfFreedom) {
  const std::string parts =
      "[[slider]]\nname = \"s\"\nbetween = [\"40.x\", \"21.x\"]\nstiffness = 1\nfriction_coefficient = 0.3\n"
      "normal_load = 1\n[[force]]\non = \"3.y\"\namplitude = 1\nfrequency = 1\n"
      "[[coordinate]]\nname = \"damper\"\nmass = 1\n[[spring]]\nbetween = [\"damper\", \"12.z\"]\nstiffness = 10\n"
      "[[mass]]\nnode = 7\nmass = 0.5\n[gravity]\nacceleration = [0, 0, -9.81]\n";
  EXPECT_EQ(verdict_on("", "", calculix, parts), "accepted");
  expect_says(verdict_on("", "", calculix, "[[force]]\non = \"3.w\"\namplitude = 1\nfrequency = 1\n"), "study.toml:7:6",
              "node 3 has x, y, z");
  expect_says(verdict_on("", "", calculix, "[[force]]\non = \"21.x\"\namplitude = 1\nfrequency = 1\n"),
              "study.toml:7:6", "which a support holds");
  expect_says(verdict_on("", "", calculix, "[[beam]]\nnodes = [\"3\", \"7\"]\nsection = \"a\"\nmaterial = \"b\"\n"),
              "study.toml:6:1", "does not go with [model]");
}

// A node that an equation ties to another has no row either, and moves: a spring to it is none to the ground.
TEST(FiniteElementFiles, TakeNoNodeForHeldThatTheDeckMayTieToOthers) {
  const std::string joined = "[[spring]]\nbetween = [\"21.x\", \"3.x\"]\nstiffness = 10\n";
  EXPECT_EQ(verdict_on("", "", calculix, joined), "accepted");
  const std::string deck = content("brick.inp") + "\n*EQUATION\n2\n21, 1, 1.0, 3, 1, -1.0\n";
  const std::string files =
      "mesh = \"tied.inp\"\nstiffness = \"brick.sti\"\nmass = \"brick.mas\"\nrows = \"brick.dof\"\n";
  const std::string message = verdict_on("tied.inp", deck, files, joined);
  expect_says(message, "study.toml:7:12", "joins \"21.x\", of which the matrices have no row");
  expect_says(message, "study.toml:7:12", "*EQUATION");
  expect_says(message, "study.toml:7:12", "\"ground\" where it is held");
  EXPECT_EQ(verdict_on("tied.inp", deck, files, "[[spring]]\nbetween = [\"ground\", \"3.x\"]\nstiffness = 10\n"),
            "accepted");
}

TEST(FiniteElementFiles, LoseTheRowsThatASupportHolds) {
  const auto study = io::read_study_text(
      study_of(calculix, "[[support]]\nnode = \"ntop\"\nfix = [\"z\"]\n[[support]]\nnode = 3\nfix = [\"x\"]\n"),
      "study.toml", data);
  const model::Model built = model::build(study.model, {});
  EXPECT_EQ(built.size(), 7);
  EXPECT_EQ(built.coordinates.front(), "3.y");
  const auto whole = read(calculix);
  EXPECT_EQ(built.matrices->stiffness.coeff(0, 1), whole->stiffness.values.coeff(1, 3));  // 3.y, 7.x
  // All rows move with the ground: the force on 3.y holds the share of those that a support holds.
  EXPECT_NEAR(built.matrices->inertia(0, 1), whole->mass.values.toDense().row(1).sum(), 1e-15);
  expect_says(verdict_on("", "", calculix, "[[support]]\nnode = \"NTIP\"\nfix = [\"z\"]\n"), "study.toml:7:8",
              "did you mean \"NTOP\"?");
  expect_says(verdict_on("", "", calculix, "[[support]]\nnode = \"NBASE\"\nfix = [\"z\"]\n"), "study.toml:8:8",
              "of which the matrices have no row");
}

TEST(FaultyMatrices, AreRefusedWithTheirLine) {
  const std::string k = content("brick.sti"), dof = content("brick.dof");
  expect_says(verdict_on("brick.sti", ""), "brick.sti", "the file is empty");
  expect_says(verdict_on("brick.sti", k.substr(0, 410)), "brick.sti:17", "cut off");
  expect_says(verdict_on("brick.sti", k.substr(0, 400)), "study.toml:3:13", "a file is cut off");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.9702528853790e+02", "2 2  1.97letters")), "brick.sti:3",
              "an entry must be ROW COLUMN VALUE, got \"2 2  1.97letters\"");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.9702528853790e+02", "2 2 nan")), "brick.sti:3",
              "no finite number");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.9702528853790e+02", "2 2 inf")), "brick.sti:3",
              "no finite number");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.97", "0 2  1.97")), "brick.sti:3", "count from 1");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.97", "2.5 2  1.97")), "brick.sti:3",
              "ROW COLUMN VALUE");
  expect_says(verdict_on("brick.sti", with("brick.sti", "2 2  1.97", "1 2  1.97")), "brick.sti:3",
              "entry (1, 2) is given twice");
  expect_says(verdict_on("brick.sti", k + "2 1 -5.0\n"), "brick.sti:79", "not symmetric");
  expect_says(verdict_on("brick.sti", k + "2 1 -51.603754407020\n"), "brick.sti:4", "elsewhere the file gives both");
  expect_says(verdict_on("brick.sti", k + "2000000000 2000000000 1.0\n"), "brick.sti",
              "a matrix of 2000000000 rows has only 79 entries");
  expect_says(verdict_on("brick.sti", k + "13 13 1.0\n"), "study.toml:3:13", "has 13 rows, and \"brick.dof\" names 12");
  expect_says(verdict_on("brick.mas", content("brick.mas") + "13 13 1.0\n"), "study.toml:4:8", "has 13 rows");
  expect_says(verdict_on("brick.mas", with("brick.mas", "2 2  2.7331558641975e-01", "2 2  0.0")), "study.toml:4:8",
              "nothing on the diagonal of row 2, 3.y");
  expect_says(verdict_on("brick.mas", with("brick.mas", "2 2  2.7", "2 2  -2.7")), "study.toml:4:8",
              "on the diagonal of row 2, 3.y");
  expect_says(verdict_on("brick.sti", std::string("\0\1\2", 3)), "brick.sti", "binary");
  expect_says(verdict_on("brick.sti", "hello\n"), "brick.sti:1", "none of the formats");
  expect_says(verdict_on("brick.sti", "title  key\n 1 1 1\nRSA 12 12 78 0\n"), "brick.sti:1", "Harwell-Boeing");
  expect_says(verdict_on("", "", edited("brick.sti", "none.sti", calculix)), "study.toml:3:13", "does not exist");
  expect_says(verdict_on("", "", "stiffness = \"brick.sti\"\nmass = \"brick.mas\"\n"), "study.toml:1:1",
              "does not tell what its rows are");
}

TEST(FaultyMatrices, OfOtherProgramsAreRefusedWithTheirLine) {
  const auto market = [](const std::string& text) { return verdict_on("brick_stif.mtx", text, formats[1].files); };
  expect_says(market("%%MatrixMarket matrix coordinate complex general\n"), "brick_stif.mtx:1",
              "the first line must be");
  expect_says(market("%%MatrixMarket matrix coordinate real symmetric\n2000000000 2000000000 1\n1 1 1.0\n"),
              "brick_stif.mtx", "only 1 entries");
  expect_says(market("%%MatrixMarket matrix coordinate real symmetric\n12 12 78\n1 1 1.0\n"), "brick_stif.mtx:3",
              "after 1 of 78 entries");
  expect_says(market("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n3 1 1.0\n"), "brick_stif.mtx:3",
              "outside the 2 x 2 matrix");
  expect_says(market("%%MatrixMarket matrix coordinate real symmetric\n2 2 4\n1 1 1.0\n2 2 1.0\n2 1 1.0\n1 2 1.0\n"),
              "brick_stif.mtx:6", "a symmetric file holds one of them");
  expect_says(market("%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 1.0\n2 2 1.0\n2 1 1.0\n"),
              "brick_stif.mtx:5", "a general file holds both triangles");
  const auto input = [](const std::string& from, const std::string& to) {
    return verdict_on("brick_STIF1_input.mtx", with("brick_STIF1_input.mtx", from, to), formats[3].files);
  };
  expect_says(input("3,2, 3,1", "-1,2, 3,1"), "brick_STIF1_input.mtx:2", "node -1 is one that Abaqus made");
  expect_says(input("3,2, 3,1", "3,11, 3,1"), "brick_STIF1_input.mtx:2", "degree of freedom 11 of node 3");
  expect_says(input("3,2, 3,1", "3,2 3"), "brick_STIF1_input.mtx:2", "NODE, DIRECTION");
  expect_says(input("3,2, 3,1", "3,1, 3,1"), "brick_STIF1_input.mtx:2", "entry (3.x, 3.x) is given twice");
  expect_says(verdict_on("brick_MASS1_input.mtx", "3,1, 3,1, 1.0\n", formats[3].files), "study.toml:4:8",
              "lacks 11 rows");
  const auto dmig = [](const std::string& text) { return verdict_on("brick.pch", text, formats[5].files); };
  expect_says(dmig(with("brick.pch", "       6       2       0", "       2       2       0")), "brick.pch:1",
              "the form 2");
  expect_says(dmig(with("brick.pch", "       6       2       0", "       6       4       0")), "brick.pch:1",
              "the type 4");
  expect_says(dmig(with("brick.pch", " 2.076048203D+02", " 2.07x048203D+02")), "brick.pch:3", "must be a number");
  expect_says(verdict_on("", "", formats[6].files + "damping = \"brick.pch\"\ndamping_name = \"BAAX\"\n"),
              "study.toml:7:16", "no matrix \"BAAX\"");
  const auto op4 = [](const std::string& text) { return verdict_on("brick.op4", text, formats[7].files); };
  expect_says(op4(content("brick.op4").substr(0, 1200)), "brick.op4:24", "is the file cut off?");
  expect_says(op4(with("brick.op4", "      25       1\n", "      25       9\n")), "brick.op4:3", "lie outside");
  const auto substructure = [](const std::string& text) {
    return verdict_on("brick_substructure.mtx", text, formats[4].files);
  };
  expect_says(substructure(content("brick_substructure.mtx").substr(0, 700)), "brick_substructure.mtx:15", "cut off");
  expect_says(substructure(with("brick_substructure.mtx", "** ELEMENT NODES\n", "** NODES\n")),
              "brick_substructure.mtx:6", "without their names");
}

TEST(FaultyRowsAndMeshes, AreRefusedWithTheirLine) {
  expect_says(verdict_on("brick.dof", with("brick.dof", "3.2", "3.1")), "brick.dof:2", "row 2 is 3.x, and so is row 1");
  expect_says(verdict_on("brick.dof", with("brick.dof", "3.2", "3.8")), "brick.dof:2", "a direction must be 1 to 6");
  expect_says(verdict_on("brick.dof", with("brick.dof", "3.2", "three")), "brick.dof:2", "NODE.DIRECTION");
  expect_says(verdict_on("brick.dof", "3.1\n3.2\n"), "study.toml:3:13", "names 2");
  expect_says(verdict_on("brick.dof", with("brick.dof", "3.2", "99.2")), "study.toml:2:8",
              "1 node of the matrices, the first 99, is not in the mesh \"brick.inp\": the program made them");
  const auto table = [](const std::string& from, const std::string& to) {
    return verdict_on("brick_map.csv", with("brick_map.csv", from, to), formats[1].files);
  };
  expect_says(table("row,node", "line,node"), "brick_map.csv:1", "\"line\" is none of them");
  expect_says(table("2,3,2,", "3,3,2,"), "brick_map.csv:3", "row 2 is missing");
  expect_says(table("2,3,2,", "1,3,2,"), "brick_map.csv:3", "row 1 is given twice");
  expect_says(table("2,3,2,1,", "2,3,2,nan,"), "brick_map.csv:3", "x must be a finite number");
  expect_says(table("2,3,2,1,", "2,3,2,5,"), "study.toml:4:8", "gives node 3 two places");
  expect_says(verdict_on("brick_map.csv", "%%MatrixMarket matrix array integer general\n", formats[1].files),
              "brick_map.csv:1", "BACK");
  const auto mesh = [](const std::string& from, const std::string& to) {
    return verdict_on("brick.inp", with("brick.inp", from, to));
  };
  expect_says(mesh("22,1,0,0", "21,1,0,0"), "brick.inp:3", "node 21 is given twice");
  expect_says(mesh("22,1,0,0", "22,one,0,0"), "brick.inp:3", "three finite numbers");
  expect_says(mesh("12,3,40,7\n*NSET", "12,3,40\n*NSET"), "brick.inp:11", "has 7 nodes, and needs 8");
  expect_says(mesh("*NSET,NSET=NTOP\n12,3", "*NSET,NSET=NTOP\n12,4"), "brick.inp:15", "node 4, which the mesh");
  expect_says(mesh("*MATERIAL,NAME=M", "*INSTANCE"), "brick.inp:16", "*INSTANCE is not read");
  expect_says(mesh("*MATERIAL,NAME=M", "*INCLUDE,INPUT=brick.inp"), "brick.inp:16", "does a file include itself?");
}

TEST(RowsOfAnsys, ComeFromTheMappingOfAHarwellBoeingFile) {
  std::string mapping = " Matrix Eqn   Node   DOF\n";
  const std::vector<std::string> words{"UX", "UY", "UZ"}, nodes{"3", "7", "12", "40"};
  for (std::size_t i = 0; i < 12; ++i)
    mapping += "  " + std::to_string(i + 1) + "   " + nodes[i / 3] + "   " + words[i % 3] + "\n";
  const ScratchFolder folder("finite-elements-ansys");
  folder.write("k.mtx", content("brick_stif.mtx"));
  folder.write("m.mtx", content("brick_mass.mtx"));
  folder.write("k.mapping", mapping);
  EXPECT_EQ(read("stiffness = \"k.mtx\"\nmass = \"m.mtx\"\nrows = \"k.mapping\"\n", folder.path())->rows,
            read(calculix)->rows);
}

TEST(FiniteElementFindings, TellMassCentreAndHeldNodes) {
  const auto findings = model::check_finite_elements(*read(calculix));
  const auto tells = [&](const std::string& part) {
    return std::any_of(findings.facts.begin(), findings.facts.end(),
                       [&](const std::string& fact) { return fact.find(part) != std::string::npos; });
  };
  EXPECT_TRUE(tells("4 nodes are held: elements have them, and no row does, those of NBASE"));
  EXPECT_TRUE(tells("mass of the rows 2.37919444 kg"));  // the sum of the x rows and columns of brick.mas
  EXPECT_TRUE(tells("consistent"));
  EXPECT_TRUE(findings.doubts.empty());
}

TEST(FiniteElementFindings, DoubtMatricesOfOneProgramWithOtherPatterns) {
  const ScratchFolder folder("finite-elements-pattern");
  for (const char* file : {"brick.inp", "brick.sti", "brick.dof"}) folder.write(file, content(file));
  folder.write("brick.mas", with("brick.mas", "1 4  6.6088734567901e-02\n", ""));
  const auto findings = model::check_finite_elements(*read(calculix, folder.path()));
  ASSERT_EQ(findings.doubts.size(), 2u);
  EXPECT_NE(findings.doubts[0].message.find("\"brick.mas\" has 77 entries and \"brick.sti\" has 78"),
            std::string::npos);
  // What is missing along x is there along y and z.
  EXPECT_NE(findings.doubts[1].message.find("that of solids is the same along all"), std::string::npos);
}

TEST(NodesOfATable, MayBeWrittenAsFloatingPointNumbers) {
  const std::string text = with("brick_map.csv", "2,3,2,", "2.0,3.000000000000000000e+00,2.0e0,");
  EXPECT_EQ(verdict_on("brick_map.csv", text, formats[1].files), "accepted");
  expect_says(verdict_on("brick_map.csv", with("brick_map.csv", "2,3,2,", "2,3.25e+00,2,"), formats[1].files),
              "brick_map.csv:3", "a node must be a whole number from 1 on, got \"3.25e+00\"");
  const std::string tens = with("brick_map.csv", "2,3,2,", "2,1.200000000000000000e+01,2,");
  // It is node 12, whose y another row has.
  expect_says(verdict_on("brick_map.csv", tens, formats[1].files), "brick_map.csv:9", "row 8 is 12.y");
}

TEST(RowsWithoutNames, AreNotGuessedBesideRowsWithNames) {
  const std::string files = "mesh = \"brick.inp\"\nstiffness = \"brick_STIF1_input.mtx\"\nmass = \"brick_mass.mtx\"\n";
  expect_says(verdict_on("", "", files), "study.toml:4:8", "\"brick_mass.mtx\" does not tell what its rows are");
  EXPECT_EQ(verdict_on("", "", files + "rows = \"brick.dof\"\n"), "accepted");
}

TEST(NamesOfMatrices, MustNotContradictWhatTheyAreTakenFor) {
  const std::string named = formats[5].files;
  expect_says(verdict_on("", "", named + "stiffness_name = \"MAAX\"\n"), "study.toml:5:18", "are the names exchanged?");
  const std::string pch = content("brick.pch");
  const std::size_t second = pch.find("MAAX");
  ASSERT_NE(second, std::string::npos);
  const std::string mass_alone = pch.substr(pch.rfind('\n', second) + 1);
  expect_says(verdict_on("brick.pch", mass_alone, named), "brick.pch", "the only matrix of the file is \"MAAX\"");
}

TEST(FiniteElementFindings, DoubtMatricesThatAreEqualOrExchanged) {
  const auto doubts = [](const std::string& k, const std::string& m) {
    const auto findings = model::check_finite_elements(
        *read("mesh = \"brick.inp\"\nstiffness = \"" + k + "\"\nmass = \"" + m + "\"\nrows = \"brick.dof\"\n"));
    std::string all;
    for (const auto& doubt : findings.doubts) all += doubt.message + "\n";
    return all;
  };
  EXPECT_NE(doubts("brick.mas", "brick.mas").find("are the same"), std::string::npos);
  EXPECT_NE(doubts("brick.mas", "brick.sti").find("exchanged"), std::string::npos);
  EXPECT_EQ(doubts("brick.sti", "brick.mas"), "");
}

TEST(DampingMatrices, MayLackRows) {
  const auto c = [](const std::string& text, const std::string& rows = "brick.dof") {
    const ScratchFolder folder("finite-elements-damping");
    for (const char* file : {"brick.inp", "brick.sti", "brick.mas", "brick.dof"}) folder.write(file, content(file));
    folder.write("c", text);
    return Matrix(read("mesh = \"brick.inp\"\nstiffness = \"brick.sti\"\nmass = \"brick.mas\"\nrows = \"" + rows +
                           "\"\ndamping = \"c\"\n",
                       folder.path())
                      ->damping->values);
  };
  for (const Matrix& got : {c("1 1 2.5\n"), c("3,1, 3,1, 2.5\n"),
                            c("%%MatrixMarket matrix coordinate real symmetric\n12 12 1\n1 1 2.5\n")}) {
    ASSERT_EQ(got.rows(), 12);
    EXPECT_EQ(got(0, 0), 2.5);
    EXPECT_EQ(got.norm(), 2.5);
  }
}

}  // namespace
}  // namespace rubato::testing
