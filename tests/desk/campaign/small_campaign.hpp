#pragma once

#include <filesystem>
#include <string>

#include "campaign/campaign_file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "support/robots.hpp"

namespace offnominal::test {

/// A campaign of seconds on the paper's two-link arm. `plant` and `rest` are lines of the file.
inline std::string small_campaign(const std::string& rest = {},
                                  const std::string& kind = "mujoco") {
  return "format = 1\nname = \"small\"\nrobot = \"" + (kRobots / "two_link.toml").string() +
         "\"\nseed = 7\n[plant]\nkind = \"" + kind +
         "\"\ncad_error = 0.03\ntorque_noise = 0.002\nencoder_bits = 19\nperiod_s = 0.002\n"
         "[calibration]\nruns = 3\nduration_s = 8.0\nalarms_per_hour = 1.0\n"
         "[runs]\nper_fault = 2\nduration_s = 1.5\nfault_s = 0.8\nfault_free_hours = 0.002\n"
         "fault_free_duration_s = 3.0\n"
         "[[detector]]\nkind = \"torque\"\n[[detector]]\nkind = \"acceleration\"\n"
         "[[detector]]\nkind = \"momentum_observer\"\n[[detector]]\nkind = \"kdl\"\n"
         "[[fault]]\nkind = \"offset\"\njoint = \"each\"\nsizes = [0.2, 8.0]\n" +
         rest;
}

inline desk::campaign::Campaign campaign_of(const std::string& text) {
  const TemporaryFolder folder;
  put(folder / "campaign.toml", text);
  return desk::campaign::read_campaign(folder / "campaign.toml");
}

}  // namespace offnominal::test
