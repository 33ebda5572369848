#include <gtest/gtest.h>

#include "io/study_text.hpp"

namespace rubato::testing {
namespace {

const std::string by_table = edited("amplitude = 20.0\nangular_frequency = 7.0", "table = \"load.csv\"");
const std::string by_matrices =
    "[matrices]\n"                  // 1
    "mass = \"m.mtx\"\n"            // 2
    "stiffness = \"k.mtx\"\n"       // 3
    "\n"                            // 4
    "[[slider]]\n"                  // 5
    "name = \"contact\"\n"          // 6
    "between = [2, \"ground\"]\n"   // 7
    "stiffness = 1.0\n"             // 8
    "friction_coefficient = 0.5\n"  // 9
    "normal_load = 1.0\n"           // 10
    "\n"                            // 11
    "[[analysis]]\n"                // 12
    "name = \"response\"\n"         // 13
    "type = \"transient\"\n"        // 14
    "step = 0.01\n"                 // 15
    "duration = 2.0\n";             // 16
const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
const std::string general = "%%MatrixMarket matrix coordinate real general\n";

/// The last word on a message: without the folder, which is another in every run.
std::string without_folder(std::string message, const ScratchFolder& folder) {
  const std::string name = folder.path().string() + "/";
  const std::size_t place = message.find(name);
  return place == std::string::npos ? message : message.erase(place, name.size());
}

std::string verdict_on_table(const std::string& table, const std::string& study = by_table) {
  const ScratchFolder folder("table");
  folder.write("load.csv", table);
  return without_folder(verdict(study, folder.path()), folder);
}

std::string verdict_on_matrices(const std::string& stiffness, const std::string& study = by_matrices,
                                const std::string& mass = symmetric + "2 2 2\n1 1 3\n2 2 1\n") {
  const ScratchFolder folder("matrices");
  folder.write("m.mtx", mass);
  folder.write("k.mtx", stiffness);
  return without_folder(verdict(study, folder.path()), folder);
}

const std::string chain = symmetric + "% two springs\n2 2 3\n1 1 2\n2 1 -1\n2 2 1\n";

TEST(Table, IsReadWithOrWithoutAHeaderCommentsAndByteOrderMark) {
  EXPECT_EQ(verdict_on_table("time [s],force [N]\n# rest\n0,0\n60, +1.5e1\n"), "accepted");
  EXPECT_EQ(verdict_on_table("\xef\xbb\xbf"
                             "0;0\r\n60;1\r\n"),
            "accepted");
  const ScratchFolder folder("table-values");
  folder.write("load.csv",
               "\xef\xbb\xbf"
               "0,1\n2,5\n2,-5\n");
  const auto study = io::read_study_text(by_table, "study.toml", folder.path());
  const auto& table = std::get<model::TableDescription>(study.model.forces.at(0).law);
  EXPECT_EQ(table.times, (std::vector<double>{0.0, 2.0, 2.0}));
  EXPECT_EQ(table.values, (std::vector<double>{1.0, 5.0, -5.0}));
}

TEST(TableError, PointsAtTheKeyWhereTheFileIsMissing) {
  EXPECT_EQ(verdict(by_table, "no-such-folder"), "study.toml:34:9: error: the table \"load.csv\" does not exist");
}

TEST(TableError, GivesTheLineOfTheTable) {
  const std::string wanted = "error: a row must be two numbers, time and value, with a comma between them; got ";
  EXPECT_EQ(verdict_on_table("time,force\n0,0\n1,x\n"), "load.csv:3: " + wanted + "\"1,x\"");
  EXPECT_EQ(verdict_on_table("0,0\n1,2,3\n"), "load.csv:2: " + wanted + "\"1,2,3\"");
  EXPECT_EQ(verdict_on_table("0.O,0\n1,2\n2,3\n"), "load.csv:1: " + wanted + "\"0.O,0\"");
  EXPECT_EQ(verdict_on_table("0,0\n1,nan\n"), "load.csv:2: error: a number is not finite: \"1,nan\"");
  EXPECT_EQ(verdict_on_table("0,0\n1,1\n0.5,2\n"), "load.csv:3: error: times must not fall: 0.5 after 1");
  EXPECT_EQ(verdict_on_table("0,0\n1,1\n1,2\n1,3\n"),
            "load.csv:4: error: more than two rows at the time 1; two are a jump");
}

// The unit stands for itself alone: nothing is converted.
TEST(TableError, RefusesUnitsThatAreReadAsOthers) {
  const std::string rows = "0,0\n60,1\n";
  for (const std::string header : {"time [s],force [N]", "\"time [s]\";\"moment [N*m]\"", "t,F [N m]", "time,force"})
    EXPECT_EQ(verdict_on_table(header + "\n" + rows), "accepted") << header;
  EXPECT_EQ(
      verdict_on_table("time [ms],force [N]\n" + rows),
      "load.csv:1: error: the header says that the time is in [ms], and it is read in [s]; convert the column, and "
      "write [s]");
  EXPECT_EQ(verdict_on_table("# a hammer\ntime [s],force [kN]\n" + rows),
            "load.csv:2: error: the header says that the value is in [kN], and it is read in [N] or [N m]; convert the "
            "column, and write [N]");
}

TEST(TableError, IsSaidOfEmptyShortAndBinaryTables) {
  EXPECT_EQ(verdict_on_table(""), "load.csv: error: the table has 0 row(s) of numbers; it needs two or more");
  EXPECT_EQ(verdict_on_table("t,f\n0,0\n"), "load.csv: error: the table has 1 row(s) of numbers; it needs two or more");
  EXPECT_EQ(verdict_on_table(std::string("0,0\n1\0,2\n", 9)),
            "load.csv: error: the file is binary (byte 6 is zero); a table is a text of two columns, time and value");
}

TEST(TableError, RefusesARunBeyondTheTable) {
  EXPECT_EQ(verdict_on_table("0,0\n1,1\n"),
            "study.toml:36:1: error: the table \"load.csv\" reaches from 0 s to 1 s, the analysis from 0 s to 60 s; "
            "extend it, "
            "or say beyond = \"zero\" or \"hold\" where it is used");
  EXPECT_EQ(verdict_on_table("0,0\n1,1\n",
                             edited("table = \"load.csv\"", "table = \"load.csv\"\nbeyond = \"hold\"", by_table)),
            "accepted");
  EXPECT_EQ(verdict_on_table("0,0\n1,1\n",
                             edited("table = \"load.csv\"", "table = \"load.csv\"\nbeyond = \"holds\"", by_table)),
            "study.toml:35:10: error: the force on \"blade\": beyond cannot be \"holds\"; did you mean \"hold\"? "
            "(known: error, "
            "zero, hold)");
}

TEST(Matrices, AreReadInEveryFormat) {
  EXPECT_EQ(verdict_on_matrices(chain), "accepted");
  EXPECT_EQ(verdict_on_matrices(general + "2 2 4\n1 1 2\n1 2 -1\n2 1 -1\n2 2 1\n"), "accepted");
  EXPECT_EQ(verdict_on_matrices("%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1\n1\n"), "accepted");
  EXPECT_EQ(verdict_on_matrices("%%MatrixMarket matrix array integer symmetric\n2 2\n2\n-1\n1\n"), "accepted");
}

TEST(Matrices, GoByNumberAndByName) {
  const ScratchFolder folder("matrix-names");
  folder.write("m.mtx", symmetric + "2 2 2\n1 1 3\n2 2 1\n");
  folder.write("k.mtx", chain);
  const std::string named =
      edited("stiffness = \"k.mtx\"",
             "stiffness = \"k.mtx\"\nnames = [\"root\", \"tip\"]\nposition = { 1 = 0.5, tip = 2 }", by_matrices) +
      "observe = [2, \"tip - 1\"]\n";
  EXPECT_EQ(verdict(named, folder.path()), "accepted");
  const auto study = io::read_study_text(named, "study.toml", folder.path());
  const auto built = model::build(study.model, {});
  EXPECT_EQ(built.sliders.at(0).first, 1);
  EXPECT_EQ(built.position[0], 0.5);
  EXPECT_EQ(built.position[1], 2.0);
  EXPECT_EQ(built.matrices->stiffness.coeff(0, 1), -1.0);
  EXPECT_EQ(built.matrices->stiffness.coeff(1, 0), -1.0);
  const auto& observe = *std::get<model::TransientDescription>(study.analyses.at(0).task).observe;
  EXPECT_EQ(observe.at(0).first, "tip");
  EXPECT_EQ(observe.at(1).second, "root");
}

TEST(MatrixError, IsSaidOfTheWrongSize) {
  EXPECT_EQ(verdict_on_matrices(symmetric + "3 3 3\n1 1 1\n2 2 1\n3 3 1\n"),
            "study.toml:3:13: error: the matrix \"k.mtx\" is 3 x 3, but the mass matrix is 2 x 2");
  EXPECT_EQ(verdict_on_matrices(general + "2 3 1\n1 1 1\n"), "k.mtx:2: error: the matrix must be square, it is 2 x 3");
}

TEST(MatrixError, NamesTheEntryThatIsNotSymmetric) {
  EXPECT_EQ(verdict_on_matrices(general + "2 2 4\n1 1 2\n1 2 -1\n2 1 -1.5\n2 2 2\n"),
            "k.mtx: error: the matrix is not symmetric: entry (1, 2) is -1, entry (2, 1) is -1.5");
}

TEST(MatrixError, PointsAtTheKeyWhereTheFileIsMissing) {
  EXPECT_EQ(verdict(by_matrices, "no-such-folder"), "study.toml:2:8: error: the matrix \"m.mtx\" does not exist");
}

TEST(MatrixError, GivesTheLineOfTheFile) {
  const std::string header =
      "error: the first line must be \"%%MatrixMarket matrix coordinate real symmetric\" (or general, integer, array); "
      "got ";
  EXPECT_EQ(verdict_on_matrices("2 2 2\n1 1 1\n"), "k.mtx:1: " + header + "\"2 2 2\"");
  EXPECT_EQ(verdict_on_matrices("%%MatrixMarket matrix coordinate complex symmetric\n"),
            "k.mtx:1: " + header + "\"%%MatrixMarket matrix coordinate complex symmetric\"");
  EXPECT_EQ(verdict_on_matrices(symmetric + "two 2 2\n"),
            "k.mtx:2: error: the line of sizes must be ROWS COLUMNS ENTRIES, got \"two 2 2\"");
  EXPECT_EQ(verdict_on_matrices(symmetric + "% note\n2 2 3\n1 1 2\n2 1 x\n2 2 2\n"),
            "k.mtx:5: error: an entry must be ROW COLUMN VALUE, got \"2 1 x\"");
  EXPECT_EQ(verdict_on_matrices(symmetric + "2 2 2\n1 1 2\n3 1 1\n"),
            "k.mtx:4: error: entry (3, 1) lies outside the 2 x 2 matrix");
  EXPECT_EQ(verdict_on_matrices(symmetric + "2 2 2\n1 1.5 2\n2 2 1\n"),
            "k.mtx:3: error: row and column must be whole numbers, got 1 1.5");
  EXPECT_EQ(
      verdict_on_matrices(symmetric + "2 2 3\n1 1 2\n1 2 -1\n2 2 2\n"),
      "k.mtx:4: error: entry (1, 2) lies above the diagonal; a symmetric file holds the lower triangle, a general one "
      "holds both");
  EXPECT_EQ(verdict_on_matrices(symmetric + "2 2 2\n1 1 nan\n2 2 1\n"), "k.mtx:3: error: an entry is not finite");
  EXPECT_EQ(verdict_on_matrices(symmetric + "2 2 1\n1 1 2\n2 2 2\n"),
            "k.mtx:4: error: more than the 1 entries announced");
}

TEST(MatrixError, IsSaidOfEmptyCutAndBinaryFiles) {
  EXPECT_EQ(
      verdict_on_matrices(""),
      "k.mtx: error: the file is empty; the first line must be \"%%MatrixMarket matrix coordinate real symmetric\" (or "
      "general, integer, array)");
  EXPECT_EQ(verdict_on_matrices(symmetric), "k.mtx: error: the line of sizes is missing");
  EXPECT_EQ(verdict_on_matrices(symmetric + "2 2 3\n1 1 2\n"), "k.mtx: error: the file ends after 1 of 3 entries");
  EXPECT_EQ(verdict_on_matrices(std::string(3, '\0')),
            "k.mtx: error: the file is binary (byte 1 is zero); a Matrix Market file is text");
}

TEST(MatrixError, NamesTheCoordinateWithoutAMass) {
  EXPECT_EQ(verdict_on_matrices(chain, by_matrices, symmetric + "2 2 1\n1 1 3\n"),
            "study.toml:2:8: error: the mass matrix \"m.mtx\" gives coordinate \"2\" the mass 0; it must be positive");
  EXPECT_EQ(verdict_on_matrices(chain, by_matrices, symmetric + "2 2 2\n1 1 -3\n2 2 1\n"),
            "study.toml:2:8: error: the mass matrix \"m.mtx\" gives coordinate \"1\" the mass -3; it must be positive");
  // A size that no memory holds is refused before anything of it is made.
  EXPECT_EQ(verdict_on_matrices(chain, by_matrices, symmetric + "2000000000 2000000000 1\n1 1 3\n"),
            "study.toml:2:8: error: the mass matrix \"m.mtx\" gives coordinate \"2\" the mass 0; it must be positive");
}

TEST(MatrixError, RefusesElementsAndSecondDampingBesideMatrices) {
  EXPECT_EQ(
      verdict_on_matrices(chain, "[[spring]]\nbetween = [1, 2]\nstiffness = 1\n" + by_matrices),
      "study.toml:1:1: error: [[spring]] does not go with [matrices], which hold the whole structure; add it to the "
      "matrices");
  EXPECT_EQ(verdict_on_matrices(chain, "[[coordinate]]\nname = \"a\"\nmass = 1\n" + by_matrices),
            "study.toml:2:8: error: [[coordinate]] does not go with [matrices], which hold the whole structure; add it "
            "to the "
            "matrices");
  const std::string twice =
      "[damping]\nrayleigh = { mass = 1 }\n" + edited("stiffness", "damping = \"k.mtx\"\nstiffness", by_matrices);
  EXPECT_EQ(
      verdict_on_matrices(chain, twice),
      "study.toml:2:12: error: [damping] and the damping matrix of [matrices] would count damping twice; keep one");
}

TEST(MatrixError, RefusesNamesThatDoNotFit) {
  const auto with = [](const std::string& line) {
    return verdict_on_matrices(chain, edited("stiffness = \"k.mtx\"", "stiffness = \"k.mtx\"\n" + line, by_matrices));
  };
  EXPECT_EQ(with("names = [\"u\"]"), "study.toml:1:1: error: [matrices]: 1 names for 2 coordinates");
  EXPECT_EQ(with("names = [\"u\", \"u\"]"), "study.toml:4:15: error: two coordinates are called \"u\"");
  EXPECT_EQ(
      with("names = [\"2\", \"1\"]"),
      "study.toml:4:10: error: [matrices]: the name \"2\" of coordinate 1 is a number, and numbers mean places; choose "
      "another");
  EXPECT_EQ(with("names = [\"root\", \"tip\"]\nvelocity = { 2 = 1.0, tip = 2.0 }"),
            "study.toml:5:29: error: velocity names one coordinate twice, as \"2\" and as \"tip\"");
  EXPECT_EQ(with("position = { 3 = 1.0 }"),
            "study.toml:4:18: error: position names \"3\", which is no coordinate; known: 1, 2");
}

}  // namespace
}  // namespace rubato::testing
