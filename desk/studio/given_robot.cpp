#include "studio/given_robot.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/refused.hpp"
#include "common/shell_word.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"
#include "robot/robot_file.hpp"
#include "studio/upload_folder.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

GivenRobot robot_of_toml(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  GivenRobot robot{parse_robot(read_text_file(file), name), {file.string(), name}};
  const auto& channels = robot.description.channels;
  if (channels && !channels->dbc.empty()) {
    throw InputError({name, "channels.dbc", "the name of another file",
                      "none in a file that is dropped on the page",
                      "start Studio with --robot and this file"});
  }
  return robot;
}

ordered_json to_json(const GivenRobot& robot) {
  ordered_json joints = ordered_json::array();
  for (std::size_t i = 0; i < robot.description.joints.size(); ++i) {
    joints.push_back({{"joint", i + 1}, {"name", robot.description.joints[i].name}});
  }
  return {{"name", robot.description.name},
          {"file", std::filesystem::path(robot.file.path).filename().string()},
          {"joints", std::move(joints)},
          {"notes", robot.notes}};
}

GivenUrdf::GivenUrdf(std::filesystem::path file)
    : file_(std::move(file)),
      text_(read_text_file(file_)),
      chains_(exchange::chains_in(text_, file_.filename().string())) {}

GivenRobot GivenUrdf::robot(UploadFolder& folder) const { return import_chain({}, folder); }

GivenRobot GivenUrdf::robot(std::size_t chain, UploadFolder& folder) const {
  if (chain >= chains_.size()) {
    throw Refused(Refused::Why::kBadRequest, "There is no such chain.");
  }
  const exchange::ChainRequest request{chains_[chain].base, chains_[chain].tip};
  GivenRobot robot = import_chain(request, folder);
  robot.import_command = "offnominal import-urdf " + shell_word(file_.filename().string()) +
                         exchange::options_of(request);
  return robot;
}

GivenRobot GivenUrdf::import_chain(const exchange::ChainRequest& request,
                                   UploadFolder& folder) const {
  const std::string name = file_.filename().string();
  const exchange::ImportedRobot imported = exchange::import_urdf(text_, name, request);
  const std::string text = exchange::robot_text_of(imported, name);
  const std::string own = file_.stem().string() + ".toml";
  GivenRobot robot{parse_robot(text, own), {"", own}};
  for (const exchange::ImportNote& note : imported.notes) {
    robot.notes.push_back(std::string(name_of(note.kind)) + ": " + note.text);
  }
  robot.file.path = folder.put(own, text).string();
  return robot;
}

ordered_json GivenUrdf::json() const {
  ordered_json chains = ordered_json::array();
  for (const exchange::ChainChoice& chain : chains_) {
    chains.push_back({{"base", chain.base}, {"tip", chain.tip}, {"joints", chain.joints}});
  }
  return {{"file", file_.filename().string()},
          {"chains", std::move(chains)},
          {"chosen", chosen_ ? ordered_json(*chosen_ + 1) : ordered_json(nullptr)}};
}

}  // namespace offnominal::desk::studio
