#include "studio/save.hpp"

#include <algorithm>
#include <system_error>

#include "common/file.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "common/refused.hpp"
#include "compare/compare_report.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::studio {
namespace {

constexpr std::size_t kLongestName = 120;

bool is_never_in_a_name(char c) {
  return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

bool is_plain_name(const std::string& name) {
  if (name.size() > kLongestName || !name.ends_with(".toml") || name.starts_with(".")) return false;
  return std::none_of(name.begin(), name.end(), is_never_in_a_name);
}

// Of UTF-8, one that does not begin a character.
bool is_inside_a_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

void check_is_no_input(const Input& input, const std::string& path) {
  for (const auto* files : {&input.log_files, &input.holdout_files}) {
    for (const std::string& recording : *files) {
      for (const std::filesystem::path& file : recording_files(recording)) {
        if (!same_file(file.string(), path)) continue;
        throw Refused(Refused::Why::kBadRequest,
                      "That is a recording of this session: choose another name.");
      }
    }
  }
}

void refuse_what_is_there(const std::filesystem::path& path, const SaveRequest& request) {
  std::error_code ignored;
  if (request.replace || !std::filesystem::exists(path, ignored)) return;
  throw Refused(Refused::Why::kMustConfirm, path.string() + " is there already.");
}

}  // namespace

std::string proposed_name(const Input& input) {
  if (input.output) return *input.output;
  const std::string ending = "_studio.toml";
  std::string name = as_utf8(std::filesystem::path(input.robot_file).stem().string());
  name.erase(0, name.find_first_not_of('.'));
  std::replace_if(name.begin(), name.end(), is_never_in_a_name, '_');
  std::size_t length = std::min(name.size(), kLongestName - ending.size());
  while (length > 0 && length < name.size() && is_inside_a_character(name[length])) --length;
  name.resize(length);
  return (name.empty() ? "robot" : name) + ending;
}

std::filesystem::path place_of_name(const Input& input, const std::string& name) {
  const std::string own = name.empty() ? proposed_name(input) : name;
  if (input.output) return own;
  return std::filesystem::path(input.robot_file).parent_path() / std::filesystem::path(own);
}

std::filesystem::path place_to_save(const Input& input, const std::string& name) {
  if (input.output) {
    if (!name.empty() && name != *input.output) {
      throw Refused(Refused::Why::kBadRequest,
                    "This session writes the file that -o names, and no other.");
    }
    return *input.output;
  }
  const std::string own = name.empty() ? proposed_name(input) : name;
  if (!is_plain_name(own)) {
    throw Refused(Refused::Why::kBadRequest,
                  "The name has to be that of a file beside the robot file, without a folder, and "
                  "end in .toml.");
  }
  std::filesystem::path path = place_of_name(input, own);
  check_is_no_input(input, path.string());
  return path;
}

std::filesystem::path save_page(const Workbench& bench, const SaveRequest& request) {
  const Input& input = bench.input();
  std::filesystem::path path = place_to_save(input, request.name);
  path.replace_extension(".html");
  refuse_what_is_there(path, request);
  const auto all = [](const Compared& compared) {
    std::vector<Comparison> recordings = compared.fitted.recordings;
    if (compared.held_out) {
      const std::vector<Comparison>& others = compared.held_out->recordings;
      recordings.insert(recordings.end(), others.begin(), others.end());
    }
    return together(std::move(recordings));
  };
  CompareNames names{input.log_files, input.robot_file, ""};
  names.logs.insert(names.logs.end(), input.holdout_files.begin(), input.holdout_files.end());
  report::Page page;
  if (bench.steps().empty()) {
    page = page_of(all(bench.now()), names);
  } else {
    names.against_file = input.robot_file;
    names.robot_file = place_to_save(input, request.name).filename().string();
    const Comparisons start = all(bench.start());
    page = page_of(all(bench.now()), names, &start);
  }
  report::write_page(path, page, existing_if(request.replace));
  return path;
}

std::filesystem::path save(const Workbench& bench, const SaveRequest& request) {
  if (bench.steps().empty()) {
    throw Refused(Refused::Why::kNotNow, "There is nothing to save yet: add an effect first.");
  }
  std::filesystem::path path = place_to_save(bench.input(), request.name);
  for (std::size_t i = 0; i < bench.steps().size() && !request.accept_doubts; ++i) {
    if (bench.fitted(i).result.doubts.empty()) continue;
    throw Refused(Refused::Why::kMustConfirm, bench.fitted(i).result.doubts.front());
  }
  refuse_what_is_there(path, request);
  write_robot_file(bench.robot(), path, existing_if(request.replace));
  return path;
}

}  // namespace offnominal::desk::studio
