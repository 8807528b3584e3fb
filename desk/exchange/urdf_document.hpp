#pragma once

#include <urdf_model/model.h>

#include <memory>
#include <string>
#include <string_view>

#include "exchange/urdf_elements.hpp"

namespace offnominal::desk::exchange {

/// A URDF as urdfdom reads it: a tree of links with one root; and the lines where its parts stand.
struct UrdfDocument {
  std::string file;  // as the user named it
  UrdfElements elements;
  std::shared_ptr<urdf::ModelInterface> model;
  // Joints hang on a link `world` that no element says, as some simulators take for the ground.
  bool has_implied_world = false;

  // Of a name that the file has.
  [[nodiscard]] std::string link_place(const std::string& name) const;   // "line 3, link `arm`"
  [[nodiscard]] std::string joint_place(const std::string& name) const;  // "line 9, joint `elbow`"
  [[nodiscard]] const JointElement& joint(const std::string& name) const;
};

/// Throws InputError where read_urdf_elements() does, where a joint names a link that is not there,
/// and where the links are no tree: a loop, or parts that nothing joins.
[[nodiscard]] UrdfDocument parse_urdf(std::string_view text, const std::string& file);

}  // namespace offnominal::desk::exchange
