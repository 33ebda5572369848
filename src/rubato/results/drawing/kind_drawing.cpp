#include <rubato/results/drawing/kind_drawing.hpp>
#include <rubato/results/drawing/mechanism_drawing.hpp>
#include <rubato/system/mechanism.hpp>

namespace rubato::results {
namespace {

template <typename Draw>
class MechanismDrawer final : public integrate::KindVisitor {
 public:
  explicit MechanismDrawer(Draw draw) : draw_(draw) {}
  void structure(const system::LocallyNonlinear&) override {}
  void mechanism(const system::Mechanism& mechanism) override { draw_(mechanism.model()); }

 private:
  Draw draw_;
};

}  // namespace

void draw_start(const std::string& analysis, const integrate::SystemKind& kind, Sink& sink) {
  MechanismDrawer drawer([&](const model::Mechanism& model) { write_structure(analysis, model, sink); });
  kind.show(drawer);
}

void draw_configuration(const std::string& analysis, const integrate::SystemKind& kind, const system::State& state,
                        Sink& sink) {
  const std::span numbers(state.q.data(), static_cast<std::size_t>(state.q.size()));
  MechanismDrawer drawer([&](const model::Mechanism& model) { write_configuration(analysis, model, numbers, sink); });
  kind.show(drawer);
}

}  // namespace rubato::results
