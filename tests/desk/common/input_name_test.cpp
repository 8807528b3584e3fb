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

TEST(RecordingFiles, APlusJoinsFilesUnlessItIsPartOfAName) {
  const test::TemporaryFolder folder;
  const auto at = [&](const char* name) { return folder / name; };
  for (const char* name : {"a", "b", "a+b.csv", "c+d+e"}) test::put(at(name), "");
  using Files = std::vector<std::filesystem::path>;
  const auto files = [&](const std::string& words) {
    return recording_files(at("a").string() + words);
  };
  const std::string b = "+" + at("b").string();
  const std::string c = "+" + at("c+d+e").string();
  EXPECT_EQ(files(""), Files{at("a")});
  EXPECT_EQ(files(b), (Files{at("a"), at("b")}));
  EXPECT_EQ(files("+b.csv"), Files{at("a+b.csv")});
  EXPECT_EQ(files("+b.csv" + b), (Files{at("a+b.csv"), at("b")}));
  EXPECT_EQ(files(b + c), (Files{at("a"), at("b"), at("c+d+e")}));
  EXPECT_EQ(files(c + b), (Files{at("a"), at("c+d+e"), at("b")}));
  EXPECT_EQ(files("+no.csv"), (Files{at("a"), "no.csv"}));
  EXPECT_EQ(files("x+y.csv"), (Files{at("ax"), "y.csv"}));
  EXPECT_EQ(recording_files("-+" + at("b").string()), (Files{"-", at("b")}));
  for (const char* ending : {"+", "++b"})
    EXPECT_EQ(files(ending), Files{at("a").string() + ending});
  EXPECT_EQ(recording_files("+"), Files{"+"});
}

}  // namespace
}  // namespace offnominal::desk
