// One mass with a slider to the ground, as a program that embeds Rubato would march it.
#include <rubato/core/version.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/io/read_study.hpp>

#include <cmath>
#include <cstdio>

int main() {
  rubato::system::LocallyNonlinear::Parts parts;
  parts.mass.resize(1, 1);
  parts.mass.setIdentity();
  parts.stiffness = parts.mass;
  parts.damping = 0.5 * parts.mass;
  parts.sliders = {{"contact", 0, rubato::ground, 1.0, 0.1}};
  parts.start.q = rubato::Vector::Constant(1, 1.0);
  parts.coordinates = {"mass"};
  const rubato::system::LocallyNonlinear system(std::move(parts));

  const auto stepper = rubato::integrate::make_stepper(rubato::integrate::make_method("generalized_alpha"), system);
  auto state = rubato::integrate::consistent_start(system, system.start());
  const auto report = rubato::integrate::march(*stepper, state, 0.001, 100.0);

  // Friction brings the mass to rest where spring and slider balance: |k x| <= mu N.
  std::printf("rubato %s: %ld steps, x = %g m\n", rubato::version, report.steps, state.q[0]);
  const bool rests = report.end == rubato::integrate::MarchEnd::reached && std::abs(state.q[0]) <= 0.1 + 1e-9;

  // The readers come with the library too: this links what they need.
  try {
    rubato::io::read_study_text("tittle = \"misspelt\"\n", "none.toml");
  } catch (const rubato::InvalidInput& error) {
    std::printf("%s\n", error.what());
    return rests ? 0 : 1;
  }
  return 1;
}
