#include "exchange/urdf_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/shell_word.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::exchange {
namespace {

using Link = urdf::LinkConstSharedPtr;

bool moves(const urdf::Joint& joint) { return joint.type != urdf::Joint::FIXED; }

Link link_named(const UrdfDocument& document, const std::string& option, const std::string& name) {
  if (Link link = document.model->getLink(name)) return link;
  std::vector<std::string> names;
  for (const auto& [known, line] : document.elements.link_lines) names.push_back(known);
  const std::string meant = nearest(name, names);
  constexpr std::size_t kShown = 12;
  const std::string more = names.size() > kShown ? ", ..." : "";
  names.resize(std::min(names.size(), kShown));
  throw InputError({.file = option,
                    .place = "",
                    .found = fmt::format("`{}`, which is no link of {}", name, document.file),
                    .allowed = list_of(names) + more,
                    .mend = meant.empty() ? "name a link" : fmt::format("write `{}`", meant)});
}

// From the base outwards; none where `base` is not above `tip`.
std::optional<std::vector<urdf::JointConstSharedPtr>> moving_between(const Link& base,
                                                                     const Link& tip) {
  std::vector<urdf::JointConstSharedPtr> joints;
  Link at = tip;
  while (at != base) {
    const urdf::JointConstSharedPtr joint = at->parent_joint;
    if (joint == nullptr) return std::nullopt;
    if (moves(*joint)) joints.push_back(joint);
    at = at->getParent();
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

std::vector<Link> links_below(const Link& base) {
  std::vector<Link> links{base};
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& children = links[i]->child_links;
    links.insert(links.end(), children.begin(), children.end());
  }
  return links;
}

// Links in which a chain may end: where joints move beyond in several branches, and where none
// does.
std::vector<Link> ends_of_chains(const Link& base) {
  const std::vector<Link> links = links_below(base);
  std::map<const urdf::Link*, int> branches;  // with a moving joint in each
  for (std::size_t i = links.size(); i-- > 0;) {
    const Link& link = links[i];
    if (link == base) continue;
    const bool any = moves(*link->parent_joint) || branches[link.get()] > 0;
    if (any) ++branches[link->getParent().get()];
  }
  std::vector<Link> ends;
  for (const Link& link : links) {
    const int count = branches[link.get()];
    const bool last = count == 0 && link != base && moves(*link->parent_joint);
    if (last || (count > 1 && link != base && !moving_between(base, link)->empty())) {
      ends.push_back(link);
    }
  }
  return ends;
}

Link only_tip(const UrdfDocument& document, const Link& base) {
  const std::vector<Link> ends = ends_of_chains(base);
  if (ends.size() == 1) return ends[0];
  const auto refuse = [&](const std::string& found, const std::string& allowed,
                          const std::string& mend) {
    throw InputError({.file = document.file,
                      .place = document.link_place(base->name),
                      .found = found,
                      .allowed = allowed,
                      .mend = mend});
  };
  if (ends.empty()) {
    refuse("no joint that moves beyond it", "a chain of moving joints",
           "name another link by --base, or another file");
  }
  const auto words = [&](const Link& link) {
    const std::size_t count = moving_between(base, link)->size();
    return fmt::format("{} ({} {})", link->name, count, count == 1 ? "joint" : "joints");
  };
  refuse("more than one chain of moving joints beyond it", "--tip one of " + list_of(ends, words),
         "add --tip");
  return nullptr;
}

}  // namespace

std::string options_of(const ChainRequest& request) {
  std::string words;
  if (request.base) words += " --base " + shell_word(*request.base);
  if (request.tip) words += " --tip " + shell_word(*request.tip);
  return words;
}

std::vector<ChainChoice> chains_of(const UrdfDocument& document) {
  const Link root = document.model->getRoot();
  const std::vector<Link> tips = ends_of_chains(root);
  std::vector<Link> bases{root};
  bases.insert(bases.end(), tips.begin(), tips.end());
  std::vector<ChainChoice> chains;
  for (const Link& base : bases) {
    for (const Link& tip : ends_of_chains(base)) {
      chains.push_back({base->name, tip->name, moving_between(base, tip)->size()});
    }
  }
  return chains;
}

UrdfChain choose_chain(const UrdfDocument& document, const ChainRequest& request) {
  UrdfChain chain;
  chain.base = request.base ? link_named(document, "--base", *request.base)
                            : Link(document.model->getRoot());
  chain.tip =
      request.tip ? link_named(document, "--tip", *request.tip) : only_tip(document, chain.base);
  const auto refuse = [&](const std::string& found, const std::string& allowed,
                          const std::string& mend) {
    throw InputError({.file = document.file,
                      .place = document.link_place(chain.tip->name),
                      .found = found,
                      .allowed = allowed,
                      .mend = mend});
  };
  const auto between = moving_between(chain.base, chain.tip);
  if (!between) {
    const bool turned = moving_between(chain.tip, chain.base).has_value();
    refuse(fmt::format("a tip that is not beyond the base `{}`", chain.base->name),
           "a link that hangs on the base, through other links",
           turned ? "exchange --base and --tip" : "name a base that is nearer to the root");
  }
  if (between->empty()) {
    refuse(fmt::format("no joint that moves between `{}` and it", chain.base->name),
           fmt::format("1 to {} moving joints", kMaxJoints), "name another --base or --tip");
  }
  if (between->size() > static_cast<std::size_t>(kMaxJoints)) {
    refuse(fmt::format("{} moving joints between `{}` and it", between->size(), chain.base->name),
           fmt::format("1 to {}", kMaxJoints), "name a part of the chain by --base and --tip");
  }
  chain.moving = *between;
  return chain;
}

}  // namespace offnominal::desk::exchange
