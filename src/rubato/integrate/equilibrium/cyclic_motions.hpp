#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/finite_elements/cyclic.hpp>

namespace rubato::integrate {

/// The lowest modes y of Hermitian K, C and M of twice the size, [Re -Im; Im Re], each of which comes twice there
/// (y and i y), or of real ones. Not converged where pairs do not come out as such.
numerics::DampedModes modes_of_diameter(const model::CyclicSector& sector, Index diameter,
                                        const SparseMatrix& stiffness, const SparseMatrix& damping,
                                        const SparseMatrix& mass, Index count);

/// Which free motions of a disk are wanted.
struct CyclicMotions {
  Index diameter = 0;  ///< 0 to N/2
  Index limit = 0;     ///< as of SystemKind::free_motions
  Index count = 0;     ///< the lowest so many
};

/// The lowest free motions of a disk of equal sectors, of which a structure is one: shapes are those of sector 0 [n].
FreeMotions cyclic_motions(const SystemKind& sector_kind, const model::CyclicSector& sector,
                           const CyclicMotions& wanted);

}  // namespace rubato::integrate
