#pragma once

#include <rubato/model/laws/law.hpp>

#include <memory>

namespace rubato::model {

/// Values of a Bouc-Wen element that degrades.
struct DegradingBoucWenValues {
  double elastic;     ///< alpha k [N/m]
  double hysteretic;  ///< (1 - alpha) k > 0 [N/m]
  double a;           ///< A > 0 where nothing has happened [-]
  double beta;        ///< >= 0 [1/m^n]
  double gamma;       ///< >= -beta [1/m^n]
  double n;           ///< >= 1
  double a_loss;      ///< dA >= 0 [1/J]
  double nu_gain;     ///< dnu >= 0 [1/J]
  double eta_gain;    ///< deta >= 0 [1/J]
};

/// Baber and Wen 1981:
///
///   f = alpha k u + (1 - alpha) k z,   dz/dt = du/dt (A - nu |z|^n (gamma + beta sgn(z du/dt))) / eta
///   de/dt = (1 - alpha) k z du/dt,     A = max(0, A0 - dA e),  nu = 1 + dnu e,  eta = 1 + deta e
///
/// dA weakens it and softens it, dnu weakens it, deta softens it. At A = 0 it is spent. Its memory is z [m] and e [J].
///
/// It knows no rate: between turns of u both are functions of u, and advance() follows them by their Taylor series, to
/// round-off, in parts that end where z passes zero.
///
/// What it stores is what it gives back where it unloads to z = 0 with no loss: of the states (z, e) it then passes,
/// G(e) - (1 - alpha) k z^2/2 is the same, with dG/de = A/eta. While it moves this never falls as long as
/// |gamma| <= beta, so that its dissipation is never negative.
std::shared_ptr<const Law> make_degrading_bouc_wen(const DegradingBoucWenValues& values);

}  // namespace rubato::model
