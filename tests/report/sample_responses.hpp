#pragma once

#include <rubato/results/sink.hpp>

// Tables of steady responses as their analyses leave them, from a closed form: one mass with a slider by the describing
// function of the hysteresis loop.
namespace rubato::test {

/// Five preloads with both linear limits, waveforms, and some points that did not converge.
void add_preload_sweep(results::Sink& sink);

/// A grid of preloads and friction coefficients: many curves, coloured by a parameter.
void add_grid_sweep(results::Sink& sink);

/// 400 random samples of 201 frequencies with percentile bands: more than a page can hold.
void add_random_sweep(results::Sink& sink);

/// A damper curve over 60 preloads with its optimum and the tracked peaks.
void add_damper_curve(results::Sink& sink);
/// Of three coefficients of friction, with two peaks each.
void add_swept_damper_curve(results::Sink& sink);

/// Modes of five coordinates, free and stuck.
void add_modes(results::Sink& sink);

}  // namespace rubato::test
