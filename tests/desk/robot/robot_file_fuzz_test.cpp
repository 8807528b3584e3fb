#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>

#include "common/error.hpp"
#include "expect_same_robot.hpp"
#include "robot/robot_file.hpp"
#include "robot/text_with_effects.hpp"
#include "sample_robot.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

// Damages a good file: bytes changed, pieces cut out, doubled, moved or exchanged for words that
// TOML knows.
class Damage {
 public:
  explicit Damage(std::mt19937_64& generator) : generator_(generator) {}

  std::string applied_to(std::string text) {
    for (std::size_t i = 1 + below(4); i > 0; --i) once(text);
    return text;
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : generator_() % end; }

  void once(std::string& text) {
    static const std::string kWords[]{
        "nan",        "inf",    "-inf",       "[]", "{}",
        "[[joint]]",  "true",   "1e999",      "-1", "0",
        "1e300",      "\"\"",   "=",          "\n", "99999999999999999999",
        "2020-01-01", "\"\"\"", "[estimator]"};
    const std::size_t at = below(text.size());
    const std::size_t length = below(40);
    switch (below(5)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(generator_());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(below(text.size()), length));
        break;
      case 3:
        text.insert(at, kWords[below(std::size(kWords))]);
        break;
      default: {
        const std::size_t value = text.find("= ", at);
        if (value == std::string::npos) break;
        const std::size_t end = text.find('\n', value);
        text.replace(value + 2, end - value - 2, kWords[below(std::size(kWords))]);
        break;
      }
    }
  }

  std::mt19937_64& generator_;
};

TEST(RobotFileFuzz, DamagedFilesAreRefusedInOneLineOrReadAsAGoodRobot) {
  auto generator = test::seeded_generator();
  Damage damage(generator);
  int refused = 0;
  int accepted = 0;
  for (int i = 0; i < 5000 && !testing::Test::HasFailure(); ++i) {
    const std::string text = damage.applied_to(test::kSampleRobot);
    SCOPED_TRACE(text);
    try {
      const RobotDescription robot = parse_robot(text, "r.toml");
      ++accepted;
      test::expect_same(robot, parse_robot(robot_text(robot), "written.toml"));
      const auto kept = text_with_effects(text, robot);
      if (kept) test::expect_same(robot, parse_robot(*kept, "kept.toml"));
    } catch (const InputError& error) {
      ++refused;
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with("r.toml: ")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 20);
}

}  // namespace
}  // namespace offnominal::desk
