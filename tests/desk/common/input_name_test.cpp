#include "common/input_name.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "desk/support/temporary_folder.hpp"

namespace offnominal::desk {
namespace {

TEST(InputName, OutlivesTheRun) {
  const test::TemporaryFolder folder;
  const std::string fifo = (folder / "fifo").string();
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  for (const char* standard : {"-", "/dev/stdin"}) {
    EXPECT_TRUE(is_stream(standard));
    EXPECT_EQ(input_name(standard), "standard input");
  }
  for (const std::string& pipe : {std::string("/dev/fd/63"), fifo}) {
    EXPECT_TRUE(is_stream(pipe));
    EXPECT_EQ(input_name(pipe), "a pipe");
  }
  test::put(folder / "a.csv", "");
  for (const char* file : {"a.csv", "no/such/a.csv"}) {
    EXPECT_FALSE(is_stream((folder / file).string()));
    EXPECT_EQ(input_name((folder / file).string()), "a.csv");
  }
}

}  // namespace
}  // namespace offnominal::desk
