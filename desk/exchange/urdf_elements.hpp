#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

// The XML of a URDF, so far as it is about motion and masses. An XML reader that knows lines checks
// it here and hands on what urdfdom reads then: urdfdom knows no lines, and gives up a link for a
// mesh.

namespace offnominal::desk::exchange {

/// <joint>: what ties links together.
struct JointElement {
  std::string name;
  std::string type;
  std::string parent;
  std::string child;
  bool has_axis = false;  // else URDF says 1 0 0
  int line = 0;
};

/// An element or attribute that says nothing to a robot file, in all its places.
struct LeftOut {
  int line = 0;  // the first of them
  int times = 0;
};

struct UrdfElements {
  std::string robot_name;  // empty: the file has none
  // The first line with bytes that were taken for Windows-1252 (xml_encoding.hpp); 0: none.
  int assumed_encoding_line = 0;
  std::map<std::string, int> link_lines;
  std::vector<JointElement> joints;
  std::map<std::string, LeftOut> left_out;  // "<visual>", "`D` of <dynamics>"
  std::string xml;                          // for urdfdom: the rest, every number checked
};

/// Throws InputError with line, found, allowed and remedy: no XML, another format (xacro, SDF,
/// MJCF), a number that is none or that no robot has, a name that is missing or there twice, a part
/// without which a joint or link means nothing.
[[nodiscard]] UrdfElements read_urdf_elements(std::string_view text, const std::string& file);

}  // namespace offnominal::desk::exchange
