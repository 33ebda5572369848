#pragma once

#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace rubato::testing {

/// A linear structure with sliders, stops and laws as a system without constraints, whose steps are solved by Newton's
/// method on all coordinates at once instead of on its contacts alone. The formulas of sliders and stops are written
/// out here once more: it is a judge of the condensed steps.
class StructureByNewton final : public system::ConstrainedSystem {
 public:
  /// @param structure  must outlive this
  explicit StructureByNewton(const system::LocallyNonlinear& structure)
      : structure_(structure), start_(structure.start()) {
    if (start_.slider_force.size() == 0) start_.slider_force = Vector::Zero(structure.contact_count());
    start_.acceleration = start_.auxiliary_acceleration = Vector::Zero(size());
    start_.multiplier.resize(0);
  }

  const system::LocallyNonlinear& structure() const { return structure_; }
  Index size() const override { return structure_.size(); }
  const std::vector<std::string>& coordinates() const override { return structure_.coordinates(); }
  bool is_rotation(Index i) const override { return structure_.is_rotation(i); }
  bool is_flat() const override { return true; }
  void retract(const Vector& q, const Vector& dq, Vector& out) const override { out = q + dq; }
  void difference(const Vector& q, const Vector& to, Vector& dq) const override { dq = to - q; }
  Index constraint_count() const override { return 0; }
  const std::vector<std::string>& rows() const override { return rows_; }
  const system::State& start() const override { return start_; }
  const SparseMatrix& mass() const override { return structure_.mass(); }
  void times_mass(const Vector& x, Vector& out) const override { out.noalias() = structure_.mass() * x; }
  bool has_kinks() const override { return true; }
  std::unique_ptr<system::ConstrainedEquations> equations() const override;

 private:
  const system::LocallyNonlinear& structure_;
  system::State start_;
  std::vector<std::string> rows_;
};

class StructureNewtonEquations final : public system::ConstrainedEquations {
 public:
  explicit StructureNewtonEquations(const StructureByNewton& of)
      : of_(of),
        s_(of.structure()),
        loads_(s_.loads()),
        from_(of.start()),
        contact_force_(s_.contact_count()),
        by_u_(s_.contact_count()),
        by_rate_(s_.contact_count()),
        by_normal_(Vector::Zero(s_.contact_count())),
        load_(s_.size()) {
    std::vector<system::SaddleMatrix::Entry> entries;
    for (Index i = 0; i < s_.size(); ++i)
      for (Index j = 0; j <= i; ++j) entries.emplace_back(i, j);
    saddle_.analyse(s_.mass(), 0, std::move(entries), false);
  }

  const system::ConstrainedSystem& system() const override { return of_; }
  void go_to(const system::State& state, model::Side side) override {
    state_ = &state;
    side_ = side;
    contact_force_ = state.slider_force;
    by_u_.setZero();
    by_rate_.setZero();
  }
  void begin_step(const system::State& from) override { from_ = from; }
  void go_to_end(const system::State& to, model::Side side) override {
    state_ = &to;
    side_ = side;
    find_contacts(to, nullptr);
  }
  using ConstrainedEquations::move_laws;
  void move_laws(system::State& to) override {
    find_contacts(to, &to);
    to.slider_force = contact_force_;
  }

  void residual(Vector& force, Vector&) override {
    loads_.evaluate(state_->t, load_, side_);
    force = s_.damping() * state_->v + s_.stiffness() * state_->q - load_;
    s_.add_slider_forces(contact_force_, 1.0, force);
  }
  void linearise(const Weights& weights, const Vector&, Vector& force, Vector& constraint) override {
    residual(force, constraint);
    saddle_.begin(weights.mass);
    add(s_.damping(), weights.damping);
    add(s_.stiffness(), weights.stiffness);
    for (Index i = 0; i < s_.contact_count(); ++i) {
      add_slope(i, i, slope_of(i, weights));
      // What presses on a law, and on what presses on it: the tangent is not symmetric there.
      double share = by_normal_[i];
      for (Index by = presser_of(i); share != 0.0 && by >= 0; by = presser_of(by)) {
        add_slope(i, by, share * slope_of(by, weights));
        share *= by_normal_[by];
      }
    }
    saddle_.end(1.0);
  }
  void constraints(Vector&) override {}
  void add_constraint_force(const Vector&, double, Vector&) const override {}
  void constraint_rate(const Vector&, Vector&) override {}
  void second_rate(Vector&) override {}
  void force_of_loads(Vector& out) override {
    loads_.evaluate(state_->t, out, side_);
    out = -out;
  }

 private:
  double slope_of(Index contact, const Weights& weights) const {
    return weights.stiffness * by_u_[contact] + weights.damping * by_rate_[contact];
  }
  Index presser_of(Index contact) const {
    return contact < s_.first_law() ? -1 : s_.normal_contact(contact - s_.first_law());
  }
  /// Of the force of one contact by the motion of another.
  void add_slope(Index of, Index by, double slope) {
    const auto [first, second] = s_.contacts()[static_cast<std::size_t>(of)];
    const auto [to_first, to_second] = s_.contacts()[static_cast<std::size_t>(by)];
    add_entry(first, to_first, slope);
    add_entry(second, to_second, slope);
    add_entry(first, to_second, -slope);
    add_entry(second, to_first, -slope);
  }
  void add_entry(Index i, Index j, double value) {
    if (i != ground && j != ground) saddle_.values()[saddle_.slot(i, j)] += value;
  }
  void add(const SparseMatrix& matrix, double weight) {
    for (Index column = 0; column < matrix.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
        add_entry(entry.row(), column, weight * entry.value());
  }

  /// Forces and slopes at the end of a step; the memory of laws into `moved` where it is given.
  void find_contacts(const system::State& to, system::State* moved) {
    by_u_.setZero();
    by_rate_.setZero();
    for (Index i = 0; i < s_.slider_count(); ++i) {
      const auto& slider = s_.sliders()[static_cast<std::size_t>(i)];
      const double way = s_.relative_displacement(i, to.q) - s_.relative_displacement(i, from_.q);
      const double stuck = from_.slider_force[i] + slider.stiffness * way;
      contact_force_[i] = std::clamp(stuck, -slider.limit, slider.limit);
      if (contact_force_[i] == stuck) by_u_[i] = slider.stiffness;
    }
    for (Index j = 0; j < s_.stop_count(); ++j) {
      const auto& stop = s_.stops()[static_cast<std::size_t>(j)];
      const Index i = s_.slider_count() + j;
      const double depth = s_.relative_displacement(i, to.q) - stop.gap;
      const double pushed = stop.stiffness * depth + stop.damping * s_.relative_displacement(i, to.v);
      contact_force_[i] = depth > 0.0 && pushed > 0.0 ? pushed : 0.0;
      if (!(contact_force_[i] > 0.0)) continue;
      by_u_[i] = stop.stiffness;
      by_rate_[i] = stop.damping;
    }
    if (moved) moved->memory.resize(s_.memory_size());
    memory_.resize(s_.memory_size());
    for (const Index j : s_.law_order()) {
      const Index i = s_.first_law() + j, place = s_.memory_of(j);
      model::LawPoint end = s_.law_point(j, to, model::Side::left);
      end.normal = s_.normal_force(j, to, contact_force_, model::Side::left);
      const auto answer = s_.laws()[static_cast<std::size_t>(j)].law->advance(
          s_.law_point(j, from_, model::Side::right), from_.memory.data() + place, end, memory_.data() + place);
      contact_force_[i] = answer.force;
      by_normal_[i] = answer.by_normal;
      by_u_[i] = answer.by_u;
      by_rate_[i] = answer.by_rate;
    }
    if (moved) moved->memory = memory_;
  }

  const StructureByNewton& of_;
  const system::LocallyNonlinear& s_;
  system::Loads loads_;
  system::State from_;
  const system::State* state_ = nullptr;
  model::Side side_ = model::Side::left;
  Vector contact_force_, by_u_, by_rate_, by_normal_, memory_, load_;
};

inline std::unique_ptr<system::ConstrainedEquations> StructureByNewton::equations() const {
  return std::make_unique<StructureNewtonEquations>(*this);
}

}  // namespace rubato::testing
