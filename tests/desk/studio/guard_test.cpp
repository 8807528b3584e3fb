#include "studio/guard.hpp"

#include <gtest/gtest.h>

#include <string>

namespace {

using offnominal::desk::studio::Guard;
using offnominal::desk::studio::random_token;

constexpr const char* kHost = "127.0.0.1:4000";
constexpr const char* kOrigin = "http://127.0.0.1:4000";

const Guard kGuard("0123456789abcdef", 4000);
const std::string kPath = "/0123456789abcdef/api/state";

TEST(StudioGuard, LetsThePageItselfIn) {
  EXPECT_EQ(kGuard.address(), "http://127.0.0.1:4000/0123456789abcdef/");
  EXPECT_EQ(kGuard.refusal({"GET", kPath, kHost, "", ""}), 0);
  EXPECT_EQ(kGuard.refusal({"GET", kPath, "localhost:4000", "http://localhost:4000", ""}), 0);
  EXPECT_EQ(kGuard.refusal({"POST", kPath, kHost, kOrigin, "same-origin"}), 0);
  EXPECT_EQ(kGuard.refusal({"DELETE", kPath, kHost, kOrigin, "same-origin"}), 0);
  // A link may lead to the page from anywhere, and to nothing else of it.
  EXPECT_EQ(kGuard.refusal({"GET", kGuard.path(), kHost, "", "cross-site"}), 0);
}

TEST(StudioGuard, RefusesAnotherToken) {
  for (const char* path :
       {"/", "/0123456789abcdee/api/state", "/0123456789abcdef", "/../etc/passwd", "",
        "//0123456789abcdef/", "/x/0123456789abcdef/api/state"}) {
    EXPECT_EQ(kGuard.refusal({"GET", path, kHost, "", ""}), 404) << path;
  }
}

TEST(StudioGuard, RefusesAnotherHostAsOfDnsRebinding) {
  for (const char* host : {"", "evil.example", "evil.example:4000", "127.0.0.1", "127.0.0.1:4001",
                           "127.0.0.1:40001", "127.0.0.1:4000.evil.example"}) {
    EXPECT_EQ(kGuard.refusal({"GET", kPath, host, "", ""}), 403) << host;
  }
}

TEST(StudioGuard, RefusesAnotherOrigin) {
  for (const char* origin :
       {"http://evil.example", "null", "https://127.0.0.1:4000", "http://127.0.0.1:4001"}) {
    EXPECT_EQ(kGuard.refusal({"GET", kPath, kHost, origin, ""}), 403) << origin;
    EXPECT_EQ(kGuard.refusal({"POST", kPath, kHost, origin, ""}), 403) << origin;
  }
  // Browsers always say it of what changes something.
  EXPECT_EQ(kGuard.refusal({"POST", kPath, kHost, "", ""}), 403);
  EXPECT_EQ(kGuard.refusal({"GET", kPath, kHost, "", "cross-site"}), 403);
  EXPECT_EQ(kGuard.refusal({"GET", kPath, kHost, "", "same-site"}), 403);
}

TEST(StudioGuard, RefusesOtherMethods) {
  for (const char* method : {"PUT", "PATCH", "HEAD", "OPTIONS", "TRACE"}) {
    EXPECT_EQ(kGuard.refusal({method, kPath, kHost, kOrigin, ""}), 405) << method;
  }
}

TEST(StudioGuard, TokensAre128BitsAndNeverTheSame) {
  const std::string token = random_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(token, random_token());
}

}  // namespace
