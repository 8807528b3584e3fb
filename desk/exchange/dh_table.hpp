#pragma once

#include <cstdint>
#include <filesystem>
#include <offnominal/model/quantity.hpp>
#include <optional>
#include <string>
#include <vector>

// A table of Denavit-Hartenberg parameters: the geometry of an arm as data sheets give it.

namespace offnominal::desk::exchange {

/// Which transformation a row stands for.
enum class DhConvention : std::uint8_t {
  kStandard,  // Rz(theta) Tz(d) Tx(a) Rx(alpha): joint i turns about z of the frame before (distal)
  kModified,  // Rx(alpha) Tx(a) Rz(theta) Tz(d): joint i turns about its own z (proximal; Craig)
};

[[nodiscard]] const char* name_of(DhConvention convention);  // "standard", "modified"

/// One joint. Its position adds to theta where it is revolute, to d where it is prismatic.
struct DhRow {
  std::string name;
  JointType type = JointType::kRevolute;
  double a_m = 0;
  double alpha_rad = 0;
  double d_m = 0;
  double theta_rad = 0;
};

struct DhTable {
  DhConvention convention = DhConvention::kStandard;
  std::vector<DhRow> rows;  // 1 to kMaxJoints, from the base outwards
  // What was left out of the file, and numbers that look like those of another unit than their name
  // says.
  std::vector<std::string> notes;
};

/// A CSV file with the columns a_m or a_mm, alpha_rad or alpha_deg, d_m or d_mm, theta_rad or
/// theta_deg and, if any joint slides, prismatic (0 or 1); or a file .toml with a [[joint]] of the
/// same keys each, beside them name and type, and the key convention. "-" is standard input, as
/// CSV. No two tables are told apart by their numbers: the convention is said in the file or by
/// `convention`, never assumed. Throws InputError where it is not, where both differ, where a
/// number is not finite or beyond 1e5, where one in rad is beyond a turn or one in m beyond 20, and
/// as readers of TOML and CSV do.
[[nodiscard]] DhTable read_dh_table(const std::filesystem::path& path,
                                    std::optional<DhConvention> convention);

}  // namespace offnominal::desk::exchange
