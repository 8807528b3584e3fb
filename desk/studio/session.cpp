#include "studio/session.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/json_text.hpp"
#include "common/output_file.hpp"
#include "common/refused.hpp"
#include "robot/read_effect.hpp"
#include "studio/cards.hpp"
#include "studio/commands.hpp"
#include "studio/state_json.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

EffectKind kind_of(const std::string& name) {
  for (const EffectInfo* info : file_effects()) {
    if (name == info->name) return info->kind;
  }
  throw Refused(Refused::Why::kBadRequest, "There is no effect of that name.");
}

}  // namespace

Session::Session(Input input) : bench_(std::move(input)) {}

ordered_json Session::state_now() {
  ordered_json json = state_of(bench_);
  json["revision"] = revision_;
  const Input& input = bench_.input();
  json["save"] = {{"name", saved_.empty() ? proposed_name(input) : saved_name_},
                  {"fixed", input.output.has_value()},
                  {"saved", nullptr},
                  {"commands", commands()},
                  {"commands_note", input.commands_note}};
  if (!saved_.empty() && saved_revision_ == revision_) json["save"]["saved"] = saved_;
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

nlohmann::json Session::charts(const View& view, bool only_time) {
  const std::lock_guard guard(lock_);
  nlohmann::json json{{"revision", revision_}};
  json["charts"] = only_time ? time_charts_of(bench_, view) : charts_of(bench_, view);
  if (!only_time) json["waterfall"] = waterfall_of(bench_, view.joint);
  return json;
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
  const EffectKind kind = kind_of(effect);
  if (joint < 1 || joint > bench_.input().robot.joint_count()) {
    throw Refused(Refused::Why::kBadRequest, "There is no such joint.");
  }
  bench_.add(kind, static_cast<std::size_t>(joint - 1));
  ++revision_;
  return state_now();
}

ordered_json Session::undo(std::size_t step) {
  const std::lock_guard guard(lock_);
  refuse_while_explaining();
  bench_.undo(step);
  ++revision_;
  return state_now();
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
  options.source = bench_.input().source;
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

ordered_json Session::explanation() { return to_json(job_.report()); }

}  // namespace offnominal::desk::studio
