#pragma once

#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/results/sink.hpp>

#include <complex>
#include <string>
#include <vector>

// Columns and values that the tables of a frequency response share.
namespace rubato::analysis {

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description);

/// Phases are in radians whatever moves.
void add_phases(const std::vector<Observed>& observed, const std::string& variable, const std::string& description,
                std::vector<results::Block>& blocks);

/// The swept parameters, or those of them that are wanted.
void add_parameters(const FrequencyResponsePlan& plan, const std::vector<bool>& wanted,
                    std::vector<results::Block>& blocks);

results::Block direction();
results::Block angular_frequency();

/// In (-pi, pi]: the argument of -1 - 0i would be -pi.
double phase_of(const std::complex<double>& harmonic);

void append(const Vector& values, std::vector<double>& rows);

}  // namespace rubato::analysis
