#include <gtest/gtest.h>

#include <random>

#include "common/error.hpp"
#include "exchange/export_robot.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"
#include "robot/robot_file.hpp"
#include "support/seed.hpp"
#include "urdfs.hpp"

// URDFs that were good: each is refused in one line that says what is wrong, or what it still says
// is imported into a robot file that is read again.

namespace offnominal::test {
namespace {

// Damage as people and programs do it: a value, an attribute, an element or a line changed, doubled
// or gone, a file cut off, a byte turned.
class Damage {
 public:
  explicit Damage(std::mt19937_64& generator) : generator_(generator) {}

  void once(std::string& text) {
    static const std::string kValues[]{
        "nan",  "inf",  "",     "0",     "-1",    "1e300", "abc",      "1,5",    "0 0 0", "1 2",
        "${x}", "0x10", "hand", "world", "upper", "fixed", "floating", "planar", "-0.0",  "1e-320"};
    switch (below(7)) {
      case 0:
        text[below(text.size())] = static_cast<char>(generator_());
        break;
      case 1:  // a line is lost
        exchange_line(text, [](const std::string&) { return std::string(); });
        break;
      case 2:
        exchange_line(text, [](const std::string& line) { return line + line; });
        break;
      case 3:
        text.resize(text.size() - below(text.size() / 4));
        break;
      case 4:  // another line in its place
        exchange_line(text, [&](const std::string&) { return any_line(text); });
        break;
      case 5:  // an attribute is lost
        exchange_value(text, [](const std::string&) { return std::string("\" lost=\""); });
        break;
      default:
        exchange_value(text,
                       [&](const std::string&) { return kValues[below(std::size(kValues))]; });
        break;
    }
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : generator_() % end; }

  std::pair<std::size_t, std::size_t> line_at(const std::string& text) {
    const std::size_t at = below(text.size());
    const std::size_t begin = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t end = text.find('\n', at);
    const std::size_t first = begin == std::string::npos ? 0 : begin + 1;
    return {first, (end == std::string::npos ? text.size() : end + 1) - first};
  }
  std::string any_line(const std::string& text) {
    const auto [first, count] = line_at(text);
    return text.substr(first, count);
  }
  template <typename NewText>
  void exchange_line(std::string& text, const NewText& new_text) {
    const auto [first, count] = line_at(text);
    text.replace(first, count, new_text(text.substr(first, count)));
  }
  template <typename NewText>
  void exchange_value(std::string& text, const NewText& new_text) {
    const std::size_t begin = text.find("=\"", below(text.size()));
    const std::size_t end = begin == std::string::npos ? begin : text.find('"', begin + 2);
    if (end == std::string::npos) return;
    const std::string old_text = text.substr(begin + 2, end - begin - 2);
    text.replace(begin + 2, end - begin - 2, new_text(old_text));
  }

  std::mt19937_64& generator_;
};

TEST(DamagedUrdf, IsRefusedInOneLineOrReadForWhatItStillSays) {
  std::mt19937_64 generator = seeded_generator();
  const std::string good = sample_arm().text();
  int refused = 0;
  int read = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = good;
    for (std::size_t times = 1 + generator() % 3; times > 0; --times) Damage(generator).once(text);
    SCOPED_TRACE(text);
    try {
      const auto imported = desk::exchange::import_urdf(text, "arm.urdf", sample_arm().chain());
      const auto robot =
          desk::parse_robot(desk::exchange::robot_text_of(imported, "arm.urdf"), "arm.toml");
      EXPECT_GE(robot.joint_count(), 1);
      const auto urdf = desk::exchange::export_urdf(robot, "arm.toml");
      const auto again = desk::exchange::import_urdf(urdf.text, "again.urdf",
                                                     {"base", robot.joints.back().name + "_link"});
      EXPECT_EQ(again.robot.joint_count(), robot.joint_count());
      ++read;
    } catch (const desk::InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_NE(message.find("found "), std::string::npos) << message;
      EXPECT_NE(message.find("; to mend: "), std::string::npos) << message;
      EXPECT_EQ(message.find("urdfdom"), std::string::npos) << message;
      ++refused;
    }
  }
  EXPECT_GE(refused, 300);
  EXPECT_GE(read, 50);
  std::cout << refused << " refused, " << read << " read\n";
}

}  // namespace
}  // namespace offnominal::test
