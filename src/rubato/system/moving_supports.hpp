#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/loads.hpp>
#include <rubato/system/state.hpp>

#include <span>
#include <string>
#include <vector>

namespace rubato::system {

/// Coordinates whose motion is given, qp(t), taken out of the equations of the others:
///
///   M_ff a + C_ff v + K_ff q = f - M_fp qp'' - C_fp qp' - K_fp qp
///   r = M_pf a + C_pf v + K_pf q + M_pp qp'' + C_pp qp' + K_pp qp - f_p
///
/// with r [p] the forces that move them. Vectors of all coordinates have the free ones first [n], then these [p].
class MovingSupports {
 public:
  struct Parts {
    std::vector<std::string> names;          ///< [p]
    std::vector<char> is_rotation;           ///< [p]
    std::vector<model::Prescribed> motions;  ///< [p]
    SparseMatrix mass, damping, stiffness;   ///< [p x (n + p)]
    SparseMatrix own_mass, own_stiffness;    ///< their last columns [p x p]
    Loads loads;                             ///< the forces on them [p]
  };
  explicit MovingSupports(Parts parts);

  Index size() const { return static_cast<Index>(parts_.names.size()); }
  const std::vector<std::string>& names() const { return parts_.names; }
  bool is_rotation(Index i) const {
    return !parts_.is_rotation.empty() && parts_.is_rotation[static_cast<std::size_t>(i)] != 0;
  }

  /// Appends where the supports are, with velocities and accelerations, to vectors of the free coordinates.
  void extend(double t, model::Side side, const Vector& free, Vector& all, int derivative) const;
  /// The forces that move them, from vectors of all coordinates [n + p].
  void reaction(double t, model::Side side, const Vector& q, const Vector& v, const Vector& a, Vector& force) const;

  /// The kinetic energy less that of the free coordinates alone, and the strain energy likewise [J].
  double kinetic(const Vector& v) const;
  double strain(const Vector& q) const;
  const SparseMatrix& damping() const { return parts_.damping; }
  const Loads& loads() const { return parts_.loads; }

 private:
  Parts parts_;
};

}  // namespace rubato::system
