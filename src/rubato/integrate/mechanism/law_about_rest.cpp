#include <rubato/integrate/mechanism/law_about_rest.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace rubato::integrate {
namespace {

using model::BlockAnswer;
using model::BlockPoint;
using model::LawAnswer;
using model::LawPoint;

/// A memory with that of the rest added; small ones need no storage of their own.
class Memory {
 public:
  Memory(const Vector& rest, const double* beside) {
    const auto size = static_cast<std::size_t>(rest.size());
    if (size > few_.size()) many_.resize(size);
    values_ = size > few_.size() ? many_.data() : few_.data();
    for (std::size_t i = 0; i < size; ++i) values_[i] = rest[static_cast<Index>(i)] + (beside ? beside[i] : 0.0);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  double* data() { return values_; }
  /// Writes what is beside the rest.
  void leave(const Vector& rest, double* beside) const {
    for (Index i = 0; i < rest.size(); ++i) beside[i] = values_[i] - rest[i];
  }

 private:
  std::array<double, 16> few_;
  std::vector<double> many_;
  double* values_ = nullptr;
};

class LawAboutRest : public model::Law {
 public:
  LawAboutRest(std::shared_ptr<const model::Law> law, double u, Vector memory, double force)
      : law_(std::move(law)), u_(u), memory_(std::move(memory)), force_(force) {}

  Index memory_size() const override { return memory_.size(); }
  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    Memory before(memory_, memory), after(memory_, nullptr);
    const LawAnswer answer = law_->advance(at_place(from), before.data(), at_place(to), after.data());
    after.leave(memory_, next);
    return beside(answer);
  }
  LawAnswer at(const LawPoint& point, const double* memory) const override {
    Memory there(memory_, memory);
    return beside(law_->at(at_place(point), there.data()));
  }
  double stored_energy(double u, const double* memory) const override {
    Memory there(memory_, memory);
    return law_->stored_energy(u_ + u, there.data());
  }
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double* next) const override {
    Memory before(memory_, memory), after(memory_, next);
    return law_->dissipated(at_place(from), before.data(), at_place(to), after.data());
  }
  double largest_stiffness() const override { return law_->largest_stiffness(); }
  bool is_exact_between_guards() const override { return law_->is_exact_between_guards(); }
  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    Memory before(memory_, memory);
    return law_->guard(at_place(from), before.data(), at_place(to), near);
  }
  bool takes_normal() const override { return law_->takes_normal(); }
  double sticking_stiffness() const override { return law_->sticking_stiffness(); }
  Contact contact(const LawPoint& point, const double* memory, double near) const override {
    Memory there(memory_, memory);
    return law_->contact(at_place(point), there.data(), near);
  }
  bool depends_on_rate() const override { return law_->depends_on_rate(); }
  bool depends_on_time() const override { return law_->depends_on_time(); }
  const numerics::Formula* formula_of_time() const override { return law_->formula_of_time(); }
  std::vector<double> breakpoints(double from, double to) const override { return law_->breakpoints(from, to); }

 protected:
  LawPoint at_place(LawPoint point) const {
    point.u += u_;
    return point;
  }
  LawAnswer beside(LawAnswer answer) const {
    answer.force -= force_;
    return answer;
  }

  std::shared_ptr<const model::Law> law_;
  double u_;
  Vector memory_;
  double force_;
};

/// Of a law that knows the slopes of its steps: they are the same.
class SlopedLawAboutRest final : public LawAboutRest, public model::LawSlopes {
 public:
  using LawAboutRest::LawAboutRest;
  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    Memory before(memory_, memory);
    dynamic_cast<const model::LawSlopes&>(*law_).slopes(at_place(from), before.data(), at_place(to), slopes);
  }
};

class BlockAboutRest : public model::BlockLaw {
 public:
  BlockAboutRest(std::shared_ptr<const model::BlockLaw> law, const BlockPoint& rest, Vector memory)
      : law_(std::move(law)), rest_(rest), memory_(std::move(memory)), at_rest_(law_->at(rest_, memory_.data())) {}

  Index size() const override { return law_->size(); }
  Index memory_size() const override { return memory_.size(); }
  BlockAnswer advance(const BlockPoint& from, const double* memory, const BlockPoint& to, double* next) const override {
    Memory before(memory_, memory), after(memory_, nullptr);
    const BlockAnswer answer = law_->advance(at_place(from), before.data(), at_place(to), after.data());
    after.leave(memory_, next);
    return beside(answer);
  }
  BlockAnswer at(const BlockPoint& point, const double* memory) const override {
    Memory there(memory_, memory);
    return beside(law_->at(at_place(point), there.data()));
  }
  double stored_energy(const double* u, const double* memory) const override {
    BlockPoint point;
    std::copy_n(u, size(), point.u);
    Memory there(memory_, memory);
    return law_->stored_energy(at_place(point).u, there.data());
  }
  double dissipated(const BlockPoint& from, const double* memory, const BlockPoint& to,
                    const double* next) const override {
    Memory before(memory_, memory), after(memory_, next);
    return law_->dissipated(at_place(from), before.data(), at_place(to), after.data());
  }
  double limit_stiffness(Index i, bool is_stuck) const override {
    const Index normal = size() - 1;
    if (i < normal) return law_->limit_stiffness(i, is_stuck);
    return is_stuck || at_rest_.force[normal] > 0.0 ? law_->limit_stiffness(normal, true) : 0.0;
  }
  double closed_damping() const override { return law_->closed_damping(); }
  double clearance() const override { return law_->clearance() - rest_.u[size() - 1]; }
  double sliding_velocity() const override { return law_->sliding_velocity(); }
  model::Law::Contact contact(const BlockPoint& point, const double* memory) const override {
    Memory there(memory_, memory);
    return law_->contact(at_place(point), there.data());
  }

 protected:
  BlockPoint at_place(BlockPoint point) const {
    for (Index i = 0; i < size(); ++i) point.u[i] += rest_.u[i];
    return point;
  }
  BlockAnswer beside(BlockAnswer answer) const {
    for (Index i = 0; i < size(); ++i) answer.force[i] -= at_rest_.force[i];
    return answer;
  }

  std::shared_ptr<const model::BlockLaw> law_;
  BlockPoint rest_;
  Vector memory_;
  BlockAnswer at_rest_;
};

/// Of a block that knows the slopes of its steps: they are the same.
class SlopedBlockAboutRest final : public BlockAboutRest, public model::BlockSlopes {
 public:
  using BlockAboutRest::BlockAboutRest;
  bool slopes(const BlockPoint& from, const double* memory, const BlockPoint& to, Matrix& slopes) const override {
    Memory before(memory_, memory);
    return dynamic_cast<const model::BlockSlopes&>(*law_).slopes(at_place(from), before.data(), at_place(to), slopes);
  }
};

}  // namespace

std::shared_ptr<const model::Law> law_about_rest(std::shared_ptr<const model::Law> law, double u, const double* memory,
                                                 double normal) {
  Vector rest(law->memory_size());
  std::copy(memory, memory + rest.size(), rest.data());
  const double force = law->at({u, 0.0, 0.0, model::Side::right, normal}, rest.data()).force;
  if (u == 0.0 && force == 0.0 && (rest.array() == 0.0).all()) return law;
  if (dynamic_cast<const model::LawSlopes*>(law.get()))
    return std::make_shared<SlopedLawAboutRest>(std::move(law), u, std::move(rest), force);
  return std::make_shared<LawAboutRest>(std::move(law), u, std::move(rest), force);
}

std::shared_ptr<const model::BlockLaw> law_about_rest(std::shared_ptr<const model::BlockLaw> law,
                                                      const BlockPoint& rest, const double* memory) {
  Vector at_rest(law->memory_size());
  std::copy(memory, memory + at_rest.size(), at_rest.data());
  if (dynamic_cast<const model::BlockSlopes*>(law.get()))
    return std::make_shared<SlopedBlockAboutRest>(std::move(law), rest, std::move(at_rest));
  return std::make_shared<BlockAboutRest>(std::move(law), rest, std::move(at_rest));
}

}  // namespace rubato::integrate
