#include "common/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"

namespace offnominal::desk {
namespace {

using test::content_of;
using test::put;
using test::TemporaryFolder;
using testing::HasSubstr;

std::string refusal(const std::filesystem::path& path, Existing existing = Existing::kReplace) {
  try {
    write_file_atomically(path, "new", existing);
  } catch (const InputError& error) {
    return error.what();
  }
  return "written";
}

std::ptrdiff_t files_in(const TemporaryFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()),
                       std::filesystem::directory_iterator());
}

TEST(ReadTextFile, GivesEveryByte) {
  const TemporaryFolder folder;
  std::string content(200000, 'x');
  content[70000] = '\0';
  content += "end\r\n";
  put(folder / "a", content);
  EXPECT_EQ(read_text_file(folder / "a"), content);
  put(folder / "empty", "");
  EXPECT_EQ(read_text_file(folder / "empty"), "");
}

TEST(ReadTextFile, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_THROW(static_cast<void>(read_text_file(folder / "missing")), InputError);
  EXPECT_THROW(static_cast<void>(read_text_file(folder.path())), InputError);
}

TEST(WriteFileAtomically, ReplacesNothingThatIsKeptAsItIs) {
  const TemporaryFolder folder;
  put(folder / "recording", "measured");
  std::filesystem::create_hard_link(folder / "recording", folder / "other name");
  std::filesystem::create_symlink("recording", folder / "link");
  keep_as_it_is(folder / "link");
  for (const char* name : {"recording", "other name", "link"}) {
    EXPECT_THAT(refusal(folder / name), HasSubstr("what was read")) << name;
  }
  EXPECT_EQ(content_of(folder / "recording"), "measured");
  put(folder / "another", "old");
  EXPECT_EQ(refusal(folder / "another"), "written");
}

TEST(WriteFileAtomically, WritesANewFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string content(1 << 20, 'y');
  write_file_atomically(folder / "a", content, Existing::kRefuse);
  EXPECT_EQ(content_of(folder / "a"), content);
  EXPECT_EQ(files_in(folder), 1);
}

TEST(WriteFileAtomically, ReplacesOnlyWhenTold) {
  const TemporaryFolder folder;
  put(folder / "a", "old");
  EXPECT_THAT(refusal(folder / "a", Existing::kRefuse), HasSubstr("already there"));
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(refusal(folder / "a", Existing::kReplace), "written");
  EXPECT_EQ(content_of(folder / "a"), "new");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(CheckCanBeWritten, FindsBeforehandWhatWouldFail) {
  const TemporaryFolder folder;
  put(folder / "a", "old");
  EXPECT_NO_THROW(check_can_be_written(folder / "a"));
  EXPECT_NO_THROW(check_can_be_written(folder / "new"));
  EXPECT_THROW(check_can_be_written(folder / "missing/a"), InputError);
  EXPECT_THROW(check_can_be_written(folder / "a/b"), InputError);
  EXPECT_THROW(check_can_be_written(folder.path()), InputError);
  EXPECT_THROW(check_can_be_written("/dev/full"), InputError);
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(WriteFileAtomically, KeepsThePermissionsOfTheFileItReplaces) {
  const TemporaryFolder folder;
  put(folder / "a", "old");
  ASSERT_EQ(::chmod((folder / "a").c_str(), 0640), 0);
  write_file_atomically(folder / "a", "new", Existing::kReplace);
  struct stat status {};
  ASSERT_EQ(::stat((folder / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
}

TEST(WriteFileAtomically, FollowsALinkAndKeepsIt) {
  const TemporaryFolder folder;
  put(folder / "target", "old");
  std::filesystem::create_symlink("target", folder / "link");
  write_file_atomically(folder / "link", "new", Existing::kReplace);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(content_of(folder / "target"), "new");
}

TEST(WriteFileAtomically, NamesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal(folder / "missing/a"), HasSubstr("No such file or directory"));
  EXPECT_THAT(refusal(folder.path()), HasSubstr("a folder"));
  EXPECT_THAT(refusal("/dev/null"), HasSubstr("not a regular file"));
  std::filesystem::create_symlink("nothing", folder / "link");
  EXPECT_THAT(refusal(folder / "link"), HasSubstr("a link to nothing"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  std::filesystem::remove(folder / "link");
  EXPECT_EQ(files_in(folder), 0);
}

// A limit on the size of files stands in for a disk that fills up in the middle of the writing.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    static_cast<void>(std::signal(SIGXFSZ, handler_));
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

// A limit on files ends the program in the middle of the writing, as SIGKILL would.
TEST(WriteFileAtomically, LeavesNothingWhereTheProgramIsKilled) {
  const TemporaryFolder folder;
  put(folder / "a", "old");
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit{10000, 10000};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0 || std::signal(SIGXFSZ, SIG_DFL) == SIG_ERR) {
      ::_exit(1);
    }
    const rlimit no_core{0, 0};
    static_cast<void>(::setrlimit(RLIMIT_CORE, &no_core));
    write_file_atomically(folder / "a", std::string(20000, 'z'), Existing::kReplace);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "it was to be killed while it writes";
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(WriteFileAtomically, LeavesTheOldFileWhenWritingIsCutShort) {
  const TemporaryFolder folder;
  put(folder / "a", "old");
  {
    const FileSizeLimit limit(10000);
    EXPECT_THROW(write_file_atomically(folder / "a", std::string(20000, 'z'), Existing::kReplace),
                 InputError);
    EXPECT_THROW(write_file_atomically(folder / "b", std::string(20000, 'z')), InputError);
  }
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(files_in(folder), 1);
}

}  // namespace
}  // namespace offnominal::desk
