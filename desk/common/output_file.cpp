#include "common/output_file.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/input_name.hpp"

namespace offnominal::desk {

namespace {

// Absolute first: of a relative name nothing of which is there, weakly_canonical leaves a relative
// one, and an absolute one of "./" and the same name.
std::optional<std::filesystem::path> place_of(const std::string& file) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::absolute(file, failure);
  if (failure) return std::nullopt;
  std::filesystem::path place = std::filesystem::weakly_canonical(absolute, failure);
  if (failure) return std::nullopt;
  return place;
}

}  // namespace

bool same_file(const std::string& a, const std::string& b) {
  std::error_code failure;
  if (std::filesystem::equivalent(a, b, failure) && !failure) return true;
  const std::optional<std::filesystem::path> place = place_of(a);
  return place && place == place_of(b);
}

namespace {

std::string name_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  return option.get_snames().empty() ? option.get_name() : "-" + option.get_snames().front();
}

class Output {
 public:
  Output(const CLI::App& verb, const CLI::Option& option, std::string file)
      : verb_(verb), option_(option), file_(std::move(file)) {
    const CLI::Option* force = verb.get_option_no_throw("--force");
    forced_ = force != nullptr && force->count() > 0;
  }

  void check(bool (*is_page)(const std::filesystem::path&)) const {
    if (file_ == "-") refuse("-, which stands for a stream", "the name of a file");
    for (const CLI::Option* other : verb_.get_options()) {
      if (other != &option_) check_apart(*other);
    }
    const bool writes_page = option_.get_type_name() == kNewPage;
    std::error_code ignored;
    // What is no regular file is refused below, forced or not.
    if (std::filesystem::is_regular_file(file_, ignored) && !forced_ &&
        !(writes_page && is_page != nullptr && is_page(file_))) {
      refuse(file_ + ", which is there already",
             writes_page ? "a file that is not there yet, or a page of offnominal"
                         : "a file that is not there yet",
             "choose another name, or add --force to replace it");
    }
    check_can_be_written(file_);
  }

 private:
  [[noreturn]] void refuse(const std::string& found, const std::string& allowed,
                           const std::string& mend = {}) const {
    const CLI::App* program = verb_.get_parent();
    const std::string name = program == nullptr ? "" : program->get_name() + " ";
    throw InputError({name + verb_.get_name(), name_of(option_), found, allowed, mend});
  }

  // Of a recording of several files, one of them.
  [[nodiscard]] bool is_part_of(const std::string& word) const {
    const auto files = recording_files(word);
    return same_file(file_, word) ||
           std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& file) {
             return same_file(file_, file.string());
           });
  }

  void check_apart(const CLI::Option& other) const {
    const auto& words = other.results();
    if (std::none_of(words.begin(), words.end(),
                     [&](const std::string& word) { return is_part_of(word); })) {
      return;
    }
    const bool in_place = option_.get_type_name() == kNewRobotFile && other.check_name("--robot");
    if (in_place && forced_) return;
    refuse(fmt::format("{}, which is that of {}", file_, name_of(other)), "a file of its own",
           in_place ? "choose another name, or add --force to replace it" : "choose another name");
  }

  const CLI::App& verb_;
  const CLI::Option& option_;
  std::string file_;
  bool forced_ = false;
};

}  // namespace

void check_outputs(const CLI::App& verb, bool (*is_page)(const std::filesystem::path& file)) {
  for (const CLI::Option* option : verb.get_options()) {
    const std::string type = option->get_type_name();
    if (type != kNewFile && type != kNewPage && type != kNewRobotFile) continue;
    for (const std::string& file : option->results()) Output(verb, *option, file).check(is_page);
  }
}

}  // namespace offnominal::desk
