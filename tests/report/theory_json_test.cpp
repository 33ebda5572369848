#include <rubato/report/theory_json.hpp>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::HasSubstr;

TEST(TheoryJson, GivesTheMethodsOfOneOrderOneStabilityFunction) {
  // Any explicit method with as many stages as its order has the Taylor polynomial of exp.
  EXPECT_THAT(theory_json(), HasSubstr(R"({"names":["explicit_euler"],"coefficients":[1,1]})"));
  EXPECT_THAT(theory_json(), HasSubstr(R"({"names":["heun","midpoint","ralston"],"coefficients":[1,1,0.5]})"));
}

TEST(TheoryJson, PlacesNewmarksMethodsByTheirNumbers) {
  EXPECT_THAT(theory_json(), HasSubstr(R"("names":["central_difference"],"beta":0,"gamma":0.5)"));
  EXPECT_THAT(theory_json(), HasSubstr(R"("names":["damped_newmark"],"beta":0.3025,"gamma":0.6)"));
}

}  // namespace
}  // namespace rubato::report
