#pragma once

#include <rubato/steady/marching/time_marching.hpp>

namespace rubato::steady {

/// The steady response to loads without a common period (two blades excited at incommensurate frequencies, say), or to
/// any other loads that go on for ever: no route but marching finds it. The system is marched from its own start,
/// window after window, until the half peak to peak of what is observed differs by less than the tolerance between
/// consecutive windows, three times over.
///
/// Of the last window: amplitudes, mean, rms, slip shares; works and transitions of all of it. No harmonics: there is
/// no fundamental. The status is quasi_periodic, or not_converged after options.max_periods windows; `iterations`
/// counts windows, `residual` is the last change of the amplitudes from window to window. `error` comes from the march
/// with half of the steps to the same window.
/// @param window   [s]; longer than the longest beat of the loads, else its ups and downs are taken for a transient
/// @param options  as of TimeMarchingSolver; `steps_per_period` are steps of the shortest period of the harmonic loads
/// (of
///                 a window where there are none)
/// Throws InvalidInput as TimeMarchingSolver does, and for a window that is not positive.
SteadyResponse solve_quasi_periodic(const system::LocallyNonlinear& system, TimeMarchingOptions options,
                                    const SteadyRequest& request, double window);

}  // namespace rubato::steady
