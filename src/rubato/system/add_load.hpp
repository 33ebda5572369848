#pragma once

#include <rubato/system/excitation.hpp>

namespace rubato::system {

/// Adds a load that follows a harmonic law to an excitation, whose `constant` has the size of the system.
/// @param where  its rows and weights; its own law is not looked at
/// @param order  of the law's frequency over the fundamental, as order_over has it; 0: it is static
void add_load(const system::LoadTerm& where, const model::HarmonicLaw& law, int order, Excitation& out);

}  // namespace rubato::system
