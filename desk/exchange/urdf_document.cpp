#include "exchange/urdf_document.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <map>
#include <set>

#include "common/error.hpp"
#include "common/nearest.hpp"

namespace offnominal::desk::exchange {
namespace {

// What urdfdom would print, while it lives.
class Messages : public console_bridge::OutputHandler {
 public:
  Messages() { console_bridge::useOutputHandler(this); }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  ~Messages() override { console_bridge::restorePreviousOutputHandler(); }

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_error.empty())
      first_error = text;
  }

  std::string first_error;
};

// Adds the link `world` where joints hang on it and nothing says it; whether that was so.
bool imply_world(UrdfElements& elements) {
  const std::string world = "world";
  const auto hangs = std::find_if(elements.joints.begin(), elements.joints.end(),
                                  [&](const JointElement& one) { return one.parent == world; });
  if (hangs == elements.joints.end() || elements.link_lines.contains(world)) return false;
  const std::size_t end = elements.xml.rfind("</robot>");
  if (end == std::string::npos) return false;
  elements.xml.insert(end, "<link name=\"world\"/>");
  elements.link_lines.emplace(world, hangs->line);
  return true;
}

void check_links_of_joints(const UrdfElements& elements, const std::string& file) {
  std::vector<std::string> names;
  for (const auto& [name, line] : elements.link_lines) names.push_back(name);
  for (const JointElement& joint : elements.joints) {
    for (const std::string& link : {joint.parent, joint.child}) {
      if (elements.link_lines.contains(link)) continue;
      const std::string meant = nearest(link, names);
      throw InputError({.file = file,
                        .place = fmt::format("line {}, joint `{}`", joint.line, joint.name),
                        .found = fmt::format("the link `{}`, which is not there", link),
                        .allowed = "a link of this file",
                        .mend = meant.empty() ? "add the link, or remove the joint"
                                              : fmt::format("write `{}`, or add the link", meant)});
    }
  }
}

// Every link hangs on one joint at most, and on one root.
void check_tree(const UrdfElements& elements, const std::string& file) {
  std::map<std::string, const JointElement*> joint_of;
  for (const JointElement& joint : elements.joints) {
    const auto [at, added] = joint_of.emplace(joint.child, &joint);
    if (added) continue;
    throw InputError(
        {.file = file,
         .place = fmt::format("line {}, joint `{}`", joint.line, joint.name),
         .found = fmt::format("the link `{}` as its child, which is that of joint `{}` in line {} "
                              "already: a closed loop",
                              joint.child, at->second->name, at->second->line),
         .allowed = "a tree, every link the child of one joint at most",
         .mend = "cut the loop: remove the joint without a drive"});
  }
  std::vector<std::string> roots;
  for (const auto& [link, line] : elements.link_lines) {
    if (!joint_of.contains(link)) roots.push_back(fmt::format("`{}` (line {})", link, line));
  }
  if (roots.size() > 1) {
    constexpr std::size_t kShown = 4;
    const std::string more =
        roots.size() > kShown ? fmt::format(" and {} more", roots.size() - kShown) : "";
    const std::size_t count = roots.size();
    roots.resize(std::min(count, kShown));
    throw InputError({.file = file,
                      .place = "",
                      .found = fmt::format("{} links that are no joint's child: {}{}", count,
                                           list_of(roots), more),
                      .allowed = "one root, to which every link is joined",
                      .mend = "add the joint that is missing, or remove the other links"});
  }
  for (const auto& [link, line] : elements.link_lines) {
    std::set<std::string> on_the_way;
    for (auto at = joint_of.find(link); at != joint_of.end();
         at = joint_of.find(at->second->parent)) {
      if (on_the_way.insert(at->first).second) continue;
      throw InputError(
          {.file = file,
           .place = fmt::format("line {}, joint `{}`", at->second->line, at->second->name),
           .found = fmt::format("links that lead back to `{}`: a closed loop", at->first),
           .allowed = "a tree with one root",
           .mend = "remove the joint that closes the loop"});
    }
  }
  if (!roots.empty()) return;
  throw InputError({.file = file,
                    .place = "",
                    .found = "no link",
                    .allowed = "a robot of links and joints",
                    .mend = "name another file"});
}

}  // namespace

std::string UrdfDocument::link_place(const std::string& name) const {
  return fmt::format("line {}, link `{}`", elements.link_lines.at(name), name);
}

std::string UrdfDocument::joint_place(const std::string& name) const {
  return fmt::format("line {}, joint `{}`", joint(name).line, name);
}

const JointElement& UrdfDocument::joint(const std::string& name) const {
  return *std::find_if(elements.joints.begin(), elements.joints.end(),
                       [&](const JointElement& one) { return one.name == name; });
}

UrdfDocument parse_urdf(std::string_view text, const std::string& file) {
  UrdfDocument document{file, read_urdf_elements(text, file), nullptr};
  document.has_implied_world = imply_world(document.elements);
  check_links_of_joints(document.elements, file);
  check_tree(document.elements, file);
  const Messages messages;
  document.model = urdf::parseURDF(document.elements.xml);
  if (document.model == nullptr || document.model->getRoot() == nullptr) {
    throw InputError({.file = file,
                      .place = "",
                      .found = "a URDF that urdfdom refuses: " + messages.first_error,
                      .allowed = "a URDF",
                      .mend = "mend what it says"});
  }
  return document;
}

}  // namespace offnominal::desk::exchange
