#include "campaign/restored_campaign.hpp"

#include <toml++/toml.h>

#include <sstream>
#include <string_view>

#include "campaign/campaign_file.hpp"
#include "common/error.hpp"
#include "common/file.hpp"
#include "common/toml_table.hpp"

namespace offnominal::desk::campaign {
namespace {

constexpr std::string_view kRobotMark = "\n\n# robot\n";
constexpr std::string_view kPlantMark = "\n# plant\n";

[[noreturn]] void refuse(const std::string& results) {
  throw InputError({results, "", "a campaign as another version of offnominal has it",
                    "one of this version", "give the campaign's file too, or run it anew"});
}

}  // namespace

Campaign restored_campaign(const std::string& identity, const std::filesystem::path& folder,
                           const std::string& results) {
  const auto keys_at = identity.find('\n');
  const auto robot_at = identity.find(kRobotMark);
  const auto plant_at = identity.rfind(kPlantMark);
  if (keys_at > robot_at || robot_at == std::string::npos || plant_at == std::string::npos ||
      plant_at < robot_at) {
    refuse(results);
  }
  const auto robot_begin = robot_at + kRobotMark.size();
  write_file_atomically(folder / "robot.toml", identity.substr(robot_begin, plant_at - robot_begin),
                        Existing::kReplace);
  write_file_atomically(folder / "plant.toml", identity.substr(plant_at + kPlantMark.size()),
                        Existing::kReplace);
  toml::table keys = parse_toml(identity.substr(keys_at, robot_at - keys_at), results);
  keys.insert_or_assign("robot", "robot.toml");
  if (toml::table* plant = keys["plant"].as_table()) plant->insert_or_assign("robot", "plant.toml");
  std::ostringstream text;
  text << toml::default_formatter(keys);
  write_file_atomically(folder / "campaign.toml", text.str(), Existing::kReplace);
  Campaign campaign = read_campaign(folder / "campaign.toml");
  if (campaign.identity != identity) refuse(results);
  return campaign;
}

}  // namespace offnominal::desk::campaign
