#pragma once

#include <filesystem>
#include <string>

#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

struct SaveRequest {
  std::string name = {};       // of the file; empty: proposed_name()
  bool replace = false;        // a file that is there
  bool accept_doubts = false;  // steps with which the held-out error does not fall
};

/// What is written unless the user says another name: that of -o, or "emps_studio.toml" for
/// emps.toml: always a name that place_to_save() takes, unless it is that of a recording.
std::string proposed_name(const Input& input);

/// Where a file of that name is; empty: of the proposed one.
std::filesystem::path place_of_name(const Input& input, const std::string& name);

/// The file of that name that a session may write: that of -o, or one beside the robot file. Throws
/// Refused where the name is none of a TOML file in that folder, or is that of an input other than
/// the robot file.
std::filesystem::path place_to_save(const Input& input, const std::string& name);

/// Writes the robot with all steps as `offnominal add` writes it, whole or not at all, and returns
/// its path. Throws Refused where there is no step, and kMustConfirm where a file is there or a
/// step is in doubt and the request does not say that this is meant; InputError where it cannot be
/// written.
std::filesystem::path save(const Workbench& bench, const SaveRequest& request);

/// Writes the report page of `compare`, of all recordings with all steps and as read, under the
/// same name with ".html", whole or not at all, and returns its path. Throws as save(), but of
/// doubts.
std::filesystem::path save_page(const Workbench& bench, const SaveRequest& request);

}  // namespace offnominal::desk::studio
