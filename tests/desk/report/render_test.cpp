#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "report/page.hpp"
#include "sample.hpp"

namespace offnominal::desk::report {
namespace {

using test::chart_of;
using test::page_of;
using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t start = text.find(begin) + begin.size();
  return text.substr(start, text.find(end, start) - start);
}

std::string embedded_data(const std::string& html) {
  return between(html, "<script type=\"application/json\" id=\"data\">", "</script>");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

TEST(Render, EmbedsThePagesJson) {
  const Page page = page_of(chart_of({.name = "e", .x = {0.0, 1.0}, .y = {1.0, 2.5}}));
  EXPECT_EQ(nlohmann::json::parse(embedded_data(render(page))), to_json(page));
}

TEST(Render, NoTextCanLeaveItsPlace) {
  const std::string hostile = "</script><script>alert(1)</script><!-- {{data}} & \"'";
  Page page = page_of(Note{hostile});
  page.title = hostile;
  page.verdict.words = hostile;
  const std::string html = render(page);
  const std::string plain = render(page_of(Note{"harmless"}));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(count(html, "</script>"), count(plain, "</script>"));
  EXPECT_EQ(count(html, "<!--"), count(plain, "<!--"));
  EXPECT_EQ(between(html, "<title>", "</title>"),
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&lt;!-- {{data}} &amp; "
            "&quot;&#39;");
  EXPECT_EQ(nlohmann::json::parse(embedded_data(html)), to_json(page));
}

TEST(Render, TextThatIsNotUtf8IsMadeSo) {
  const std::string html = render(page_of(Note{"caf\xe9"}));
  EXPECT_THAT(embedded_data(html), HasSubstr("caf\xef\xbf\xbd"));
}

TEST(Render, TheSamePageGivesTheSameBytes) {
  const Page page = page_of(chart_of({.name = "e", .x = {0.0, 1.0}, .y = {1.0, 2.5}}));
  EXPECT_EQ(render(page), render(Page(page)));
}

TEST(Render, NeedsNoOtherFile) {
  const std::string html = render(page_of(Note{"x"}));
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("<script src")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("{{")));
  // Whose work is bundled with it.
  for (const char* notice : {"Apache ECharts, Copyright", "SPDX-License-Identifier: Apache-2.0",
                             "Copyright 2017 Baidu Inc., SPDX-License-Identifier: BSD-3-Clause"}) {
    EXPECT_THAT(html, HasSubstr(notice));
  }
  EXPECT_THAT(html, Not(HasSubstr("axe-core"))) << "what only the tests need";
}

TEST(Render, NamesItsGeneratorAndItsVersionEarlyInTheFile) {
  const std::string html = render(page_of(Note{"x"}));
  const std::string version = to_json(page_of(Note{"x"})).at("version");
  const std::string marker = "<meta name=\"generator\" content=\"offnominal " + version + "\">";
  EXPECT_LT(html.find(marker), 200U);
}

class WritePage : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("offnominal_report_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_;
};

TEST_F(WritePage, WritesWhatRenderGivesAndNothingElse) {
  const Page page = page_of(Note{"x"});
  write_page(folder_ / "page.html", page);
  EXPECT_EQ(text_of(folder_ / "page.html"), render(page));
  EXPECT_EQ(files(), 1U);
}

TEST_F(WritePage, GIVEN_an_older_page_WHEN_the_new_one_is_refused_THEN_the_old_one_stays) {
  write_page(folder_ / "page.html", page_of(Note{"old"}));
  const std::string old = text_of(folder_ / "page.html");
  EXPECT_ANY_THROW(write_page(folder_ / "page.html", page_of(Note{""})));
  EXPECT_EQ(text_of(folder_ / "page.html"), old);
  write_page(folder_ / "page.html", page_of(Note{"new"}));
  EXPECT_THAT(text_of(folder_ / "page.html"), HasSubstr("new"));
  EXPECT_EQ(files(), 1U);
}

TEST_F(WritePage, GIVEN_a_missing_folder_THEN_the_error_names_the_file) {
  try {
    write_page(folder_ / "missing" / "page.html", page_of(Note{"x"}));
    FAIL() << "written";
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing"));
  }
  EXPECT_EQ(files(), 0U);
}

}  // namespace
}  // namespace offnominal::desk::report
