#pragma once

#include <rubato/model/bodies/motion.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// A part of a mechanism that makes forces: a beam, a spring, a load. It knows no time step.
///
/// Forces are those of the left side of M a + f + G^T multiplier = 0: internal minus external. Local entries belong to
/// the tangent coordinates in `places`; `ground` stands for whatever is fixed.
class Element {
 public:
  explicit Element(std::string name) : name_(std::move(name)) {}
  virtual ~Element() = default;
  /// Its own workspace of formulas: one copy a thread.
  virtual std::unique_ptr<Element> clone() const = 0;

  const std::string& name() const { return name_; }
  const std::vector<Index>& places() const { return places_; }  ///< [k]
  /// Where its law ends, to be said after its name where it has no number.
  virtual std::string domain() const { return {}; }

  /// Writes the force. @param force  [k]
  virtual void force(const Motion& motion, double* force) const = 0;

  /// Writes the force and a weighted sum of its derivatives.
  /// @param stiffness  weight of df/dq   @param damping  weight of df/dv
  /// @param tangent    [k x k] by rows
  virtual void tangent(const Motion& motion, double stiffness, double damping, double* force,
                       double* tangent) const = 0;
  virtual bool has_symmetric_tangent() const { return true; }
  /// Whether its slopes may jump where q or v pass some value.
  virtual bool has_kinks() const { return false; }

  /// What it stores [J]; the rest of its work is that of a load or of a damper, as `role` says. Laws keep accounts of
  /// their own.
  virtual double stored_energy(const Motion&) const { return 0.0; }
  enum class Role { elastic, damper, load, law };
  virtual Role role() const { return Role::elastic; }

 protected:
  std::string name_;
  std::vector<Index> places_;
};

}  // namespace rubato::model
