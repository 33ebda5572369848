#include <rubato/core/error.hpp>
#include <rubato/results/columns/beam_section_forces.hpp>
#include <rubato/results/columns/block_columns.hpp>
#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/results/columns/kind_columns.hpp>
#include <rubato/results/columns/law_columns.hpp>
#include <rubato/results/columns/mechanism_columns.hpp>
#include <rubato/results/columns/structure_columns.hpp>

namespace rubato::results {

OwnedColumns columns_of_equilibrium(const integrate::SystemKind& kind, const std::vector<Observed>& observed,
                                    const model::SectionForcesDescription& section_forces, const std::string& title) {
  struct Maker final : integrate::KindVisitor {
    const std::vector<Observed>& observed;
    const model::SectionForcesDescription& section_forces;
    const std::string& title;
    OwnedColumns made;

    Maker(const std::vector<Observed>& shown, const model::SectionForcesDescription& forces, const std::string& of)
        : observed(shown), section_forces(forces), title(of) {}

    void structure(const system::LocallyNonlinear& system) override {
      made.groups.push_back(
          std::make_unique<ObservedColumns>(observed, std::vector{ObservedColumns::Quantity::position}));
      made.groups.push_back(std::make_unique<SliderColumns>(system));
      made.groups.push_back(std::make_unique<StopColumns>(system));
      made.groups.push_back(std::make_unique<LawColumns>(system, false));
      made.groups.push_back(std::make_unique<BlockColumns>(system, false));
    }
    void mechanism(const system::Mechanism& mechanism) override {
      const auto equations = std::make_shared<system::MechanismEquations>(mechanism);
      made = {equations, columns_of_equilibrium(*equations, observed, section_forces, title)};
    }
  };
  Maker maker(observed, section_forces, title);
  kind.show(maker);
  return std::move(maker.made);
}

ColumnGroups columns_of_motion(integrate::March& march, const std::vector<Observed>& observed,
                               const model::SectionForcesDescription& section_forces) {
  struct Maker final : integrate::MarchVisitor {
    const std::vector<Observed>& observed;
    const model::SectionForcesDescription& section_forces;
    ColumnGroups made;

    Maker(const std::vector<Observed>& shown, const model::SectionForcesDescription& forces)
        : observed(shown), section_forces(forces) {}

    void structure(const system::LocallyNonlinear& system) override { made = columns_of_motion(system, observed); }
    void mechanism(system::MechanismEquations& equations) override {
      made = columns_of_motion(equations, observed, section_forces);
    }
  };
  Maker maker(observed, section_forces);
  march.show(maker);
  return std::move(maker.made);
}

void check_section_forces(const integrate::SystemKind& kind, const model::SectionForcesDescription& wanted,
                          const std::string& title) {
  struct Check final : integrate::KindVisitor {
    const model::SectionForcesDescription& wanted;
    const std::string& title;

    Check(const model::SectionForcesDescription& forces, const std::string& of) : wanted(forces), title(of) {}

    void structure(const system::LocallyNonlinear&) override {
      if (wanted.is_wanted())
        throw InvalidInput(wanted.where, title +
                                             "section_forces are kept of geometrically exact beams, in mechanisms; "
                                             "leave it out");
    }
    void mechanism(const system::Mechanism& mechanism) override { (void)BeamSectionForces(mechanism, wanted, title); }
  };
  Check check(wanted, title);
  kind.show(check);
}

}  // namespace rubato::results
