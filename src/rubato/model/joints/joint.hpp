#pragma once

#include <rubato/model/bodies/motion.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// Which entries of G and of its derivatives may differ from zero, in whatever configuration: the others are never
/// read.
struct JointPattern {
  std::vector<char> jacobian;   ///< [r x k] by rows
  std::vector<char> curvature;  ///< [k x k], as symmetric as curvature() is
};

/// A constraint between nodes, g(q, t) = 0 [r], with G = dg/dq. It knows no time step. Lengths are in metres, angles in
/// radians. The multiplier of a row is the force (or moment) that the joint makes against a growing g: the equations
/// carry G^T multiplier on their left side.
class Joint {
 public:
  explicit Joint(std::string name) : name_(std::move(name)) {}
  virtual ~Joint() = default;
  virtual std::unique_ptr<Joint> clone() const = 0;

  const std::string& name() const { return name_; }
  const std::vector<Index>& places() const { return places_; }              ///< tangent coordinates [k], or `ground`
  const std::vector<std::string>& row_names() const { return row_names_; }  ///< "x", "y", "moment" [r]
  int rows() const { return static_cast<int>(row_names_.size()); }

  /// @param g  [r]   @param jacobian  [r x k] by rows
  virtual void constraint(const Motion& motion, double* g, double* jacobian) const = 0;
  /// d(G^T multiplier)/dq. @param curvature  [k x k] by rows, overwritten
  virtual void curvature(const Motion& motion, const double* multiplier, double* curvature) const = 0;
  /// (dG/dt) v plus the second derivative of g in t alone: G a + this = 0. @param out  [r]
  virtual void second_rate(const Motion& motion, double* out) const = 0;
  /// The derivative of g in t alone: G v + this = 0. @param out  [r]
  virtual void rate(const Motion& motion, double* out) const {
    (void)motion;
    for (int i = 0; i < rows(); ++i) out[i] = 0.0;
  }
  virtual bool has_symmetric_curvature() const { return true; }
  /// constraint() and curvature() in one: what both need is found once.
  virtual void linearise(const Motion& motion, const double* multiplier, double* g, double* jacobian,
                         double* curvature) const {
    constraint(motion, g, jacobian);
    this->curvature(motion, multiplier, curvature);
  }
  /// All entries, unless a joint knows better.
  virtual JointPattern pattern() const {
    const std::size_t k = places_.size();
    return {std::vector<char>(row_names_.size() * k, 1), std::vector<char>(k * k, 1)};
  }
  /// False: the row says nothing in this phase (a lock that is open).
  virtual bool is_active(const Motion&) const { return true; }

 protected:
  std::string name_;
  std::vector<Index> places_;
  std::vector<std::string> row_names_;
};

}  // namespace rubato::model
