#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>

// The keys of ranges of values and of sweeps over parameters.
namespace rubato::model {

/// The table { from, to, points, spacing }, which may stand where a list of values does.
void fields(auto& visit, ValuesDescription& values) {
  visit.quantity("from", values.from, {.required = true, .says = "the first value"});
  visit.quantity("to", values.to, {.required = true, .says = "the last value"});
  visit.quantity("points", values.points, {.required = true, .says = "how many, both ends included"});
  visit.word("spacing", values.logarithmic, {{"linear", false}, {"log", true}},
             {.says = "equal differences or equal ratios", .unless = "linear"});
}

/// Where a damper curve looks for peaks.
struct PeakRangeDescription {
  Quantity from, to;
  std::optional<Quantity> points;
  Location where;
};

void fields(auto& visit, PeakRangeDescription& range) {
  visit.where(range.where);
  visit.quantity("from", range.from, {.required = true, .says = "the lowest frequency"});
  visit.quantity("to", range.to, {.required = true, .says = "the highest frequency"});
  visit.quantity(
      "points", range.points,
      {.says = "how many are looked at before peaks are refined, besides natural frequencies", .unless = "17"});
}

void fields(auto& visit, DistributionDescription& distribution) {
  using Kind = DistributionDescription::Kind;
  visit.where(distribution.where);
  visit.check([](auto& reader) {
    if (!reader.has("distribution")) reader.refuse_to_lack("distribution");
  });
  visit.word("distribution", distribution.kind,
             {{"normal", Kind::normal}, {"uniform", Kind::uniform}, {"lognormal", Kind::lognormal}},
             {.required = true, .says = "of a sample"});
  if (visit.applies(distribution.kind == Kind::uniform)) {
    visit.quantity("from", distribution.first, {.required = true, .says = "of uniform: the lower end"});
    visit.quantity("to", distribution.second, {.required = true, .says = "of uniform: the upper end"});
  }
  if (visit.applies(distribution.kind == Kind::normal))
    visit.quantity("mean", distribution.first, {.required = true, .says = "of normal"});
  if (visit.applies(distribution.kind == Kind::lognormal))
    visit.quantity("median", distribution.first, {.required = true, .says = "of lognormal"});
  if (visit.applies(distribution.kind != Kind::uniform))
    visit.quantity("deviation", distribution.second,
                   {.required = true, .says = "standard deviation; of lognormal that of the logarithm"});
  visit.of_words(
      "distribution",
      {{"normal", {"mean", "deviation"}}, {"uniform", {"from", "to"}}, {"lognormal", {"median", "deviation"}}});
}

void fields(auto& visit, CaseSweepDescription& sweep) {
  visit.text("file", sweep.file,
             {.required = true, .says = "CSV file whose header names the parameters; relative to the study"});
  visit.where(sweep.where, "file");
}

void fields(auto& visit, RandomSweepDescription& sweep) {
  using Sampling = RandomSweepDescription::Sampling;
  visit.where(sweep.where);
  visit.quantity("samples", sweep.samples, {.required = true, .says = "how many"});
  visit.whole("seed", sweep.seed, 1, {}, {.says = "of the random numbers", .unless = "1"});
  visit.word("sampling", sweep.sampling,
             {{"latin_hypercube", Sampling::latin_hypercube}, {"sobol", Sampling::sobol}, {"random", Sampling::random}},
             {.says = "how they are spread", .unless = "latin_hypercube"});
  visit.distributions("parameters", sweep.parameters, {.required = true, .says = "the distribution of each"});
}

}  // namespace rubato::model
