#include <rubato/core/error.hpp>
#include <rubato/io/folder_lock.hpp>

#include <gmock/gmock.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "io/sink_samples.hpp"

namespace rubato::io {
namespace {

namespace fs = std::filesystem;

class FolderLocked : public testing::SinkTest {
 protected:
  /// What is said to whoever wants the folder now; empty: they get it.
  std::string refusal() const {
    try {
      const FolderLock lock(folder_);
    } catch (const OutputError& fault) {
      return fault.what();
    }
    return {};
  }
};

TEST_F(FolderLocked, IsHeldByOneRunAtATimeAndNamesIt) {
  {
    const FolderLock lock(folder_);
    EXPECT_EQ(lock.warning(), "");
    EXPECT_EQ(refusal(), folder_.string() + ": another run is writing here (process " + std::to_string(::getpid()) +
                             "); wait for its end, or choose another folder (-o DIR)");
    EXPECT_EQ(lock.loss(), "");
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(refusal(), "");
}

TEST_F(FolderLocked, IsFreeOnceTheProcessIsKilled) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const FolderLock lock(folder_);
    std::ofstream(folder_ / "ready").flush();
    ::pause();
    ::_exit(0);
  }
  while (!fs::exists(folder_ / "ready")) ::usleep(1000);
  EXPECT_THAT(refusal(), ::testing::HasSubstr("(process " + std::to_string(child) + ")"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder_ / ".rubato-lock"));
  EXPECT_EQ(refusal(), "");
}

TEST_F(FolderLocked, SaysWhatBecameOfTheFolder) {
  const fs::path results = folder_ / "results";
  for (const bool is_moved : {false, true}) {
    fs::create_directory(results);
    const FolderLock lock(results);
    EXPECT_EQ(lock.loss(), "");
    if (is_moved)
      fs::rename(results, folder_ / "elsewhere");
    else
      fs::remove_all(results);
    EXPECT_EQ(lock.loss(), "was deleted or moved");
    fs::create_directory(results);  // another folder of that name is not the same
    EXPECT_EQ(lock.loss(), "was deleted or moved");
  }
  const FolderLock lock(results);
  fs::remove(results / ".rubato-lock");
  EXPECT_EQ(lock.loss(), "was emptied");
}

TEST_F(FolderLocked, CannotBeWhereNothingCanBeWritten) {
  EXPECT_THROW(FolderLock(folder_ / "nowhere"), InvalidInput);
  if (fs::exists("/proc/self")) {
    EXPECT_THROW(FolderLock("/proc/self"), InvalidInput);
  }
}

}  // namespace
}  // namespace rubato::io
