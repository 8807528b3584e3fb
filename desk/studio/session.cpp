#include "studio/session.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "common/refused.hpp"
#include "studio/cards.hpp"
#include "studio/commands.hpp"
#include "studio/spans.hpp"
#include "studio/state_json.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

Session::Session(Input input) : bench_(std::move(input)) {
  if (bench_.input().keep_beside) kept_ = KeptSession(*bench_.input().keep_beside, bench_.input());
  take_up_kept();
}

void Session::take_up_kept() {
  const SessionState& found = kept_.found();
  try {
    for (const Step& step : found.steps) {
      if (step.joint >= bench_.robot().joints.size()) break;
      bench_.add(step.kind, step.joint);
      ++taken_up_;
      ++revision_;
    }
  } catch (const std::exception& error) {
    not_taken_up_ = on_one_line(error.what());
  }
  const bool is_all = taken_up_ == found.steps.size() && found.unknown == 0;
  if (!is_all) {
    if (not_taken_up_.empty()) {
      not_taken_up_ = "this program does not know all of its effects and joints";
    }
    kept_.set_found_aside();
  }
  if (not_taken_up_.empty()) not_taken_up_ = kept_.damaged();
  take_up_view(found);
  answer_ = found.answer;
  if (!answer_.is_object()) return;
  const bool is_of_now = found.answers_now && is_all;
  // No model of this session has that one: a number that JSON has, too.
  answer_["revision"] = is_of_now ? ordered_json(revision_) : ordered_json(-1);
}

// Of a file that somebody has changed it may be of a joint that is not there.
void Session::take_up_view(const SessionState& found) {
  if (!found.view) return;
  try {
    check(bench_, *found.view);
    view_ = found.view;
  } catch (const Refused&) {
    view_.reset();
  }
}

void Session::take_answer() {
  const Job::Report report = job_.report();
  if (report.state != Job::State::kDone || is_answer_kept_) return;
  is_answer_kept_ = true;
  answer_ = to_json(report);
  without_pictures(answer_);
  keep_state();
}

void Session::keep() {
  take_answer();
  keep_state();
}

void Session::keep_state() {
  const bool answers_now = answer_.is_object() && answer_.at("revision") == revision_;
  kept_.keep({bench_.steps(), 0, answer_, answers_now, view_});
}

ordered_json Session::state_now() {
  ordered_json json = state_of(bench_);
  json["revision"] = revision_;
  json["look"] = view_ ? json_of(*view_) : ordered_json(nullptr);
  const Input& input = bench_.input();
  json["save"] = {{"name", saved_.empty() ? proposed_name(input) : saved_name_},
                  {"fixed", input.output.has_value()},
                  {"saved", nullptr},
                  {"commands", commands()},
                  {"commands_note", input.commands_note}};
  if (!saved_.empty() && saved_revision_ == revision_) json["save"]["saved"] = saved_;
  json["kept"] = {{"file", kept_.file()},
                  {"problem", kept_.problem()},
                  {"taken_up", taken_up_},
                  {"not_taken_up", not_taken_up_}};
  return json;
}

std::vector<std::string> Session::commands() const {
  if (is_robot_file_replaced_) return {};
  return commands_of(bench_, saved_.empty() ? place_of_name(bench_.input(), "").string() : saved_);
}

ordered_json Session::state() {
  const std::lock_guard guard(lock_);
  return state_now();
}

nlohmann::json Session::charts_now(const Compared& now, const View& view) {
  const auto explanation = job_.report().explanation;
  return charts_of(bench_, now, view, spans_of(bench_, view, explanation.get()));
}

nlohmann::json Session::charts(const View& view) {
  const std::lock_guard guard(lock_);
  return {{"revision", revision_},
          {"charts", charts_now(bench_.now(), view)},
          {"waterfall", waterfall_of(bench_, view.joint)}};
}

nlohmann::json Session::map(const View& view, const ErrorOver& x, const ErrorOver& y) {
  const std::lock_guard guard(lock_);
  return {{"revision", revision_}, {"chart", map_of(bench_, bench_.now(), view, x, y)}};
}

nlohmann::json Session::spectrum(const View& view, SpectrumOver over) {
  const std::lock_guard guard(lock_);
  return {{"revision", revision_}, {"chart", spectrum_of(bench_, bench_.now(), view, over)}};
}

nlohmann::json Session::evidence_of_step(std::size_t step) {
  const std::lock_guard guard(lock_);
  const Compared without = bench_.compared_with(bench_.robot_without(step));
  return {{"revision", revision_},
          {"chart", evidence_of(without, bench_.now(), bench_.effect(step))}};
}

nlohmann::json Session::evidence_of_finding(std::size_t search, std::size_t finding) {
  const std::lock_guard guard(lock_);
  const Job::Report report = job_.report();
  std::optional<std::size_t> at;
  if (report.explanation && search == searches_) at = improved_effect(*report.explanation, finding);
  if (!at) {
    throw Refused(Refused::Why::kNotNow,
                  "There is no such finding whose picture can be drawn: search again.");
  }
  const RobotDescription& robot = report.explanation->improved;
  RobotDescription less = robot;
  less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(*at));
  return {{"revision", revision_},
          {"chart", evidence_of(bench_.compared_with(less), bench_.compared_with(robot),
                                robot.effects[*at])}};
}

ordered_json Session::moved(const MovedNumber& number, const View& view) {
  const std::lock_guard guard(lock_);
  check(bench_, view);
  const Compared now =
      bench_.compared_with(bench_.robot_with(number.step, number.parameter, number.value));
  const auto percent = [&](const Comparisons& all) {
    return number_or_null(all.joints[view.joint].relative_error_percent);
  };
  return {{"revision", revision_},
          {"fitted_percent", percent(now.fitted)},
          {"held_out_percent", now.held_out ? percent(*now.held_out) : nullptr},
          {"charts", charts_now(now, view)}};
}

ordered_json Session::arm(const ArmView& view) {
  const std::lock_guard guard(lock_);
  ordered_json json{{"revision", revision_}};
  json.update(arm_of(bench_, view));
  return json;
}

void Session::refuse_while_explaining() const {
  if (!job_.is_running()) return;
  throw Refused(Refused::Why::kNotNow,
                "A search for missing effects is running: stop it, or wait for its answer.");
}

ordered_json Session::add(const std::string& effect, int joint) {
  const std::lock_guard guard(lock_);
  refuse_while_explaining();
  const std::optional<EffectKind> kind = effect_named(effect);
  if (!kind) throw Refused(Refused::Why::kBadRequest, "There is no effect of that name.");
  if (joint > bench_.input().robot.joint_count()) {
    throw Refused(Refused::Why::kBadRequest, "There is no such joint.");
  }
  bench_.add(*kind, static_cast<std::size_t>(joint - 1));
  ++revision_;
  keep();
  return state_now();
}

ordered_json Session::undo(std::size_t step) {
  const std::lock_guard guard(lock_);
  refuse_while_explaining();
  bench_.undo(step);
  ++revision_;
  keep();
  return state_now();
}

ordered_json Session::look_at(const View& view) {
  const std::lock_guard guard(lock_);
  check(bench_, view);
  if (view_ && json_of(*view_) == json_of(view)) return ordered_json::object();
  view_ = view;
  // Whoever only looks leaves nothing beside the recordings.
  if (!bench_.steps().empty() || answer_.is_object()) keep_state();
  return ordered_json::object();
}

ordered_json Session::undo_all() {
  const std::lock_guard guard(lock_);
  refuse_while_explaining();
  bench_.undo_all();
  taken_up_ = 0;
  not_taken_up_.clear();
  ++revision_;
  keep();
  return state_now();
}

ordered_json Session::save_page(const SaveRequest& request) {
  const std::lock_guard guard(lock_);
  return {{"saved", studio::save_page(bench_, request).string()}};
}

ordered_json Session::save(const SaveRequest& request) {
  const std::lock_guard guard(lock_);
  saved_ = studio::save(bench_, request).string();
  saved_name_ = request.name.empty() ? proposed_name(bench_.input()) : request.name;
  saved_revision_ = revision_;
  if (same_file(saved_, bench_.input().robot_file)) is_robot_file_replaced_ = true;
  return {{"saved", saved_}, {"commands", commands()}};
}

ordered_json Session::start_to_explain() {
  const std::lock_guard guard(lock_);
  refuse_while_explaining();
  ExplainOptions options;
  options.threads = bench_.input().threads;
  options.robot_file = bench_.input().robot_file;
  options.reading = bench_.input().options;
  options.source = bench_.input().source;
  is_answer_kept_ = false;
  ++searches_;
  job_.start(bench_.robot(), bench_.input().recordings, std::move(options), revision_);
  return to_json(job_.report());
}

ordered_json Session::stop_to_explain() {
  job_.stop();
  return to_json(job_.report());
}

bool Session::has_steps() {
  const std::lock_guard guard(lock_);
  return !bench_.steps().empty();
}

ordered_json Session::explanation() {
  const std::lock_guard guard(lock_);
  const Job::Report report = job_.report();
  if (report.state == Job::State::kNone && answer_.is_object()) return answer_;
  take_answer();
  ordered_json json = to_json(report);
  json["search"] = searches_;
  return json;
}

}  // namespace offnominal::desk::studio
