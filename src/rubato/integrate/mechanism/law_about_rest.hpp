#pragma once

#include <rubato/model/laws/block_law.hpp>
#include <rubato/model/laws/law.hpp>

#include <memory>

namespace rubato::integrate {

/// A law as small motions about a rest see it: u, the memory and the force are those beside the rest,
///
///   f'(u', m') = f(u + u', m + m') - f(u, m)
///
/// so that nothing at all stands for the rest. Energies stay those of the law itself. A law that rests where u, memory
/// and force are zero is the same.
/// @param u       where it rests [m] or [rad]
/// @param memory  there, [law->memory_size()]
/// @param normal  what presses on it for good [N]
std::shared_ptr<const model::Law> law_about_rest(std::shared_ptr<const model::Law> law, double u, const double* memory,
                                                 double normal);

/// The same of a law of several numbers.
/// @param rest    where it rests, without rates
/// @param memory  there, [law->memory_size()]
std::shared_ptr<const model::BlockLaw> law_about_rest(std::shared_ptr<const model::BlockLaw> law,
                                                      const model::BlockPoint& rest, const double* memory);

}  // namespace rubato::integrate
