#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studio/arm.hpp"
#include "studio/charts.hpp"
#include "studio/error_views.hpp"
#include "studio/job.hpp"
#include "studio/kept_session.hpp"
#include "studio/save.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// A number of a step, which the reader drags.
struct MovedNumber {
  std::size_t step = 0;  // its id
  std::string parameter;
  double value = 0;  // in the unit of the robot file
};

/// What the page and the server have in common: a workbench, the search in the background, and one
/// lock around both. Every function may be called by any thread, answers as docs/studio.md has it,
/// and throws Refused or InputError where the request cannot be done. Joints count from 1 here.
class Session {
 public:
  explicit Session(Input input);

  [[nodiscard]] nlohmann::ordered_json state();
  [[nodiscard]] nlohmann::json charts(const View& view);
  [[nodiscard]] nlohmann::json map(const View& view, const ErrorOver& x, const ErrorOver& y);
  [[nodiscard]] nlohmann::json spectrum(const View& view, SpectrumOver over);
  /// Of an effect that was added, and of one that the search found: by its place in the
  /// answer of that search.
  [[nodiscard]] nlohmann::json evidence_of_step(std::size_t step);
  [[nodiscard]] nlohmann::json evidence_of_finding(std::size_t search, std::size_t finding);
  /// The charts and errors with one number of a step off its fit; the model stays as it is.
  [[nodiscard]] nlohmann::ordered_json moved(const MovedNumber& number, const View& view);
  [[nodiscard]] nlohmann::ordered_json arm(const ArmView& view);
  /// What the page shows: the next one that is opened over the session begins there. Of a session
  /// that is kept in a file it goes there too.
  nlohmann::ordered_json look_at(const View& view);
  /// Both answer with the new state.
  nlohmann::ordered_json add(const std::string& effect, int joint);
  nlohmann::ordered_json undo(std::size_t step);
  /// Without any step, as it began.
  nlohmann::ordered_json undo_all();
  nlohmann::ordered_json save(const SaveRequest& request);
  /// A page for those who have no Studio.
  nlohmann::ordered_json save_page(const SaveRequest& request);
  nlohmann::ordered_json start_to_explain();
  nlohmann::ordered_json stop_to_explain();
  nlohmann::ordered_json explanation();
  /// Something was added that may not be saved.
  [[nodiscard]] bool has_steps();
  /// The page is gone, or the server ends: nothing goes on in the background.
  void leave() { job_.stop(); }

 private:
  [[nodiscard]] nlohmann::json charts_now(const Compared& now, const View& view);
  void take_up_kept();
  void take_up_view(const SessionState& found);
  void keep();
  void keep_state();
  void take_answer();
  void refuse_while_explaining() const;
  [[nodiscard]] nlohmann::ordered_json state_now();
  // Those that repeat the session.
  [[nodiscard]] std::vector<std::string> commands() const;

  std::mutex lock_;
  Workbench bench_;
  KeptSession kept_;
  std::size_t taken_up_ = 0;       // steps that were kept by a session before
  std::string not_taken_up_;       // why not all of them, or empty
  nlohmann::ordered_json answer_;  // of the search, what was kept of it; null: none
  bool is_answer_kept_ = false;    // of the search that was started last
  std::optional<View> view_;       // that the page shows; none: it has not said so
  std::size_t revision_ = 0;       // of the model
  std::size_t searches_ = 0;
  std::string saved_;  // the last file that was written, its name, and of which revision
  std::string saved_name_;
  std::size_t saved_revision_ = 0;
  bool is_robot_file_replaced_ = false;  // by one that was written: no command can start from it
  Job job_;
};

}  // namespace offnominal::desk::studio
