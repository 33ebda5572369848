#include <rubato/io/write_csv.hpp>
#include <rubato/results/memory_sink.hpp>
#include <rubato/results/variable_names.hpp>

#include <gmock/gmock.h>

#include <cmath>

#include "io/sink_samples.hpp"

namespace rubato::results {
namespace {

using io::testing::transient_layout;
using ::testing::ElementsAre;

class MemorySinks : public io::testing::SinkTest {};

TEST_F(MemorySinks, ValuesOfABlockLieTogether) {
  MemorySink sink({"response"});
  const double first[] = {0.5, 1, 2, 10, 20, -3}, second[] = {1.0, 3, 4, 30, 40, -4};
  {
    const auto rows = sink.open(transient_layout());
    rows->append(first);
    rows->append(second);
  }
  const MemoryTable& table = *sink.analyses().front().tables.front();
  EXPECT_EQ(table.rows, 2u);
  EXPECT_THAT(table.values, ElementsAre(ElementsAre(0.5, 1.0), ElementsAre(1, 2, 3, 4), ElementsAre(10, 20, 30, 40),
                                        ElementsAre(-3, -4)));
}

TEST_F(MemorySinks, WhatIsWrittenLaterIsWhatWouldHaveBeenWrittenAtOnce) {
  const double first[] = {1, 2.5, 0}, second[] = {0, std::nan(""), 1}, rows[] = {0.5, 1, 2, 10, 20, -3};
  const auto fill = [&](Sink& sink) {
    const auto words = sink.open(io::testing::word_layout());
    words->append(first);
    words->append(second);
    sink.open(transient_layout())->append(rows);
  };
  MemorySink memory({});
  fill(memory);
  io::CsvSink later(folder_);
  write(memory.analyses(), later);
  const std::string words = text("study.orders.csv"), table = text("response.csv");
  io::CsvSink at_once(folder_);
  fill(at_once);
  EXPECT_EQ(words, text("study.orders.csv"));
  EXPECT_EQ(table, text("response.csv"));
  EXPECT_FALSE(table.empty());
}

TEST_F(MemorySinks, ALaterConclusionLeavesWhatItDoesNotSay) {
  MemorySink sink({"first", "second"});
  sink.conclude("second", "done", "", {{"steps", "10"}, {"rows", "11"}});
  sink.conclude("second", "failed", "the disk is full", {{"rows", "3"}});
  ASSERT_EQ(sink.analyses().size(), 2u);
  EXPECT_EQ(sink.analyses()[0].status, "unfinished");
  const MemoryAnalysis& second = sink.analyses()[1];
  EXPECT_EQ(second.status, "failed");
  EXPECT_EQ(second.message, "the disk is full");
  EXPECT_THAT(second.attributes, ElementsAre(std::pair<std::string, std::string>("steps", "10"),
                                             std::pair<std::string, std::string>("rows", "3")));
}

TEST_F(MemorySinks, VariablesOfOneNameAreToldApartByTheirDimension) {
  TableLayout layout;
  layout.blocks = {{"time", "s", "", "", {}},
                   {"force", "N", "", "slider", {"pad"}},
                   {"force", "N", "", "stop", {"wall"}},
                   {"force", "N", "", "nothing", {}},
                   {"slider", "1", "", "stop", {"wall"}}};
  EXPECT_THAT(variable_names(layout), ElementsAre("time", "force", "stop_force", "force", "stop_slider"));
}

}  // namespace
}  // namespace rubato::results
