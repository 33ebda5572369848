#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// A row of the thesis's Tables 2.2 to 2.4.
struct PrintedRow {
  std::string title;       ///< as the thesis calls it
  std::string method;      ///< the method of the catalogue that it means
  std::string convention;  ///< how the printed figures arise, where it is not the method as it should be
  bool in_percent = false;
  double first_step_error = 0.0, indicator = 0.0;                  ///< as printed, in the unit of the table
  double correct_first_step_error = 0.0, correct_indicator = 0.0;  ///< of `method`, by the same measures and unit
};

/// Computes Tables 2.2 to 2.4 of the thesis "Calcolo della risposta dinamica non lineare ..." (Politecnico di Torino,
/// 2023) the way they were computed, faults included: 30,000 steps, relative errors at every sample, and
///
///   indicator = sum over j = 0..J of E_j / (J + 1),   E_j = |x_j - x(t_j)| / |x(t_j)|,   E_0 = 0
///
/// Explicit Euler: the "first step" is the second, and the last sample was never computed (E_J = 1). Runge-Kutta 3 and
/// 4: the load of the half step is that at t - h/2 (at t = 0 that at 0). Newmark: the printed beta, which for some rows
/// is Zienkiewicz's 2 beta; "accelerazione lineare II" with 1/3. These are no methods of the catalogue.
///
/// Beside them: the same two measures of the method that the row is named after.
///
/// Throws InvalidInput unless the system is one underdamped coordinate from rest under one harmonic load.
std::vector<PrintedRow> tables_as_printed(const integrate::SystemKind& kind, double step);

/// Throws what tables_as_printed throws, and computes nothing.
void require_model_as_printed(const integrate::SystemKind& kind);

}  // namespace rubato::analysis
