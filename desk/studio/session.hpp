#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studio/arm.hpp"
#include "studio/charts.hpp"
#include "studio/job.hpp"
#include "studio/save.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What the page and the server have in common: a workbench, the search in the background, and one
/// lock around both. Every function may be called by any thread, answers as docs/studio.md has it,
/// and throws Refused or InputError where the request cannot be done. Joints count from 1 here.
class Session {
 public:
  explicit Session(Input input);

  [[nodiscard]] nlohmann::ordered_json state();
  /// `only_time`: what a zoom changes.
  [[nodiscard]] nlohmann::json charts(const View& view, bool only_time);
  [[nodiscard]] nlohmann::ordered_json arm(const ArmView& view);
  /// Both answer with the new state.
  nlohmann::ordered_json add(const std::string& effect, int joint);
  nlohmann::ordered_json undo(std::size_t step);
  nlohmann::ordered_json save(const SaveRequest& request);
  nlohmann::ordered_json start_to_explain();
  nlohmann::ordered_json stop_to_explain();
  nlohmann::ordered_json explanation();
  /// Something was added that may not be saved.
  [[nodiscard]] bool has_steps();
  /// The page is gone, or the server ends: nothing goes on in the background.
  void leave() { job_.stop(); }

 private:
  void refuse_while_explaining() const;
  [[nodiscard]] nlohmann::ordered_json state_now();
  // Those that repeat the session.
  [[nodiscard]] std::vector<std::string> commands() const;

  std::mutex lock_;
  Workbench bench_;
  std::size_t revision_ = 0;  // of the model
  std::string saved_;         // the last file that was written, its name, and of which revision
  std::string saved_name_;
  std::size_t saved_revision_ = 0;
  bool is_robot_file_replaced_ = false;  // by one that was written: no command can start from it
  Job job_;
};

}  // namespace offnominal::desk::studio
