#include "explain/explainer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <offnominal/model/effect_memory.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/list_of_joints.hpp"
#include "common/shell_word.hpp"
#include "compare/measurement.hpp"
#include "explain/beside_free_links.hpp"
#include "explain/classes.hpp"
#include "explain/contradicted.hpp"
#include "explain/describe.hpp"
#include "explain/find_model.hpp"
#include "explain/free_function.hpp"
#include "explain/friction_family.hpp"
#include "explain/given_part.hpp"
#include "explain/link_share.hpp"
#include "explain/offset_instead.hpp"
#include "explain/questions.hpp"
#include "explain/taken_back.hpp"
#include "explain/undecided.hpp"
#include "explain/verdict.hpp"
#include "identify/stretches.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// What is held is not what moves, and a model of what happens at rest knows neither time nor what
// friction did on the way: readings are no path.
void check_kind(const std::vector<Log>& logs, bool at_rest, const RobotDescription& robot) {
  for (const Log& log : logs) {
    if (log.at_rest != at_rest) {
      throw InputError({log.file, "", log.at_rest ? "a hold map" : "a recording in time",
                        "recordings of one kind", "explain hold maps by themselves"});
    }
  }
  for (const RobotEffect& effect : robot.effects) {
    const EffectTraits& traits = info_of(effect.kind)->traits;
    const bool of_instant = !(traits.acts_at_rest && traits.counts_time) &&
                            !remembers(effect.kind) && chain_may_have(effect.kind);
    if (!at_rest || of_instant) continue;
    throw InputError(
        {logs.front().file, "", "a hold map",
         "a model of rigid transmissions, without effects in time or with a memory",
         fmt::format("leave {} out of the robot file for it", info_of(effect.kind)->name)});
  }
}

void check_lengths(const std::vector<Log>& logs, const FilterPlan& plan) {
  for (const Log& log : logs) {
    const FilterPlan own = plan_for(log, plan);
    const Index left = (log.sample_count() - 2 * own.edge_samples) / own.decimation;
    if (left >= kMinFilteredSamples) continue;
    throw InputError({log.file, "", fmt::format("{} samples", log.sample_count()),
                      fmt::format("{} or more with this filter",
                                  kMinFilteredSamples * own.decimation + 2 * own.edge_samples),
                      "record for longer"});
  }
}

}  // namespace

Explainer::Explainer(const RobotDescription& robot, const std::vector<Log>& logs,
                     const std::vector<Log>& holdout, const ExplainOptions& options,
                     const OnProgress& on_progress)
    : file_(robot),
      robot_(robot),
      logs_(logs),
      holdout_(holdout),
      judged_(file_, logs_, holdout_, plan_),
      options_(options),
      on_progress_(on_progress) {
  given_ = part_that_may_differ(logs, options_);
  check_kind(logs, logs.front().at_rest, robot_);
  check_kind(holdout, logs.front().at_rest, robot_);
  plan_ = plan_filter(logs, robot_);
  const FilterPlan& plan = plan_;
  check_lengths(logs, plan);
  check_lengths(holdout, plan);
  NuisanceOptions nuisance = with_link_share({}, options.link_share.value_or(kUsualLinkShare));
  if (options.keep_effects) nuisance.free_effects.emplace();
  both_ways_ = came_both_ways(logs);
  const auto recordings_of = [&](const std::vector<Stretch>& some, const VectorXd& widths) {
    auto made = searched_workspaces(some, robot_, plan, widths);
    for (Workspace& at : made) at.came_both_ways = both_ways_;
    return made;
  };
  const std::vector<Stretch> searched = stretches_of(logs, robot_, plan);
  left_out_ = words_of(searched, logs);
  const VectorXd resolved = resolved_sign_widths(logs, plan);
  std::vector<Workspace> recordings = recordings_of(searched, resolved);
  const VectorXd widths = settle_sign_widths(resolved, robot_, recordings);
  auto data = std::make_unique<Data>(std::move(recordings), robot_, nuisance);
  nuisance.ranges_moved = ranges_moved(data->recordings);
  std::unique_ptr<Data> held_out;
  if (!holdout.empty()) {
    held_out = std::make_unique<Data>(recordings_of(stretches_of(holdout, robot_, plan), widths),
                                      robot_, nuisance);
  }
  tell("preparing the candidates' regressors");
  setting_ = setting_of(std::move(nuisance), std::move(data), std::move(held_out),
                        {.bootstrap_draws = options_.bootstrap_draws,
                         .seed = options_.seed,
                         .threads = options_.threads});
}

Explanation Explainer::begun(std::vector<Push> pushes) const {
  Explanation result;
  result.pushes = std::move(pushes);
  if (!options_.robot_file.empty() && !is_stream(options_.robot_file))
    result.robot_file = shell_word(options_.robot_file);
  result.reading = options_.reading;
  result.at_rest = setting_.data->recordings[0].at_rest;
  result.holdout_is_apart = setting_.hold_out->is_apart();
  result.filter = plan_;
  result.excitation = excitation_of(setting_.data->recordings);
  result.changes_asked = given_.has_value();
  result.changes_between = given_ && !given_->begins();
  return result;
}

Explanation Explainer::run(bool search, std::vector<Push> pushes) {
  Explanation result = begun(std::move(pushes));
  FoundModel found = search_with_changes(search, result);
  const HoldOut& hold_out = *setting_.hold_out;
  result.over_variable =
      leave_out_stand_ins(*setting_.regression, hold_out, options_.threads, found);
  leave_out_links_in_disguise(setting_, robot_, options_.threads, found);
  Settled settled = settle(found, result);
  ImprovedRobot& improved = settled.improved;
  if (search) add_undecided(found, improved, result);
  for (std::size_t joint = 0; joint < found.unsure.size(); ++joint) {
    if (found.unsure[joint] != 0) result.unsure.push_back(static_cast<Index>(joint));
  }
  describe({robot_, *setting_.regression, *setting_.search, hold_out, found, improved,
            settled.sizes, changes_},
           result);
  result.held = improved.held;
  result.torque_constants = improved.constants;
  with_all_found_ = improved.robot;
  leave_out_undecided(found, result, improved);
  for (Shift& one : result.shifts) {
    one.came = improved.robot.effects[one.effect].parameters[one.parameter];
    if (one.file != 0) one.share = one.came / one.file - 1;
  }
  if (!result.at_rest) {
    tell("comparing the models before and after");
    tell_errors_of_files(judged_, improved, result);
  }
  result.improved = std::move(improved.robot);
  result.unwritable = std::move(improved.unwritable);
  result.unphysical = std::move(improved.unphysical);
  judge_whole(result);
  if (!result.found.empty()) {
    result.advice.insert(result.advice.end(), result.unphysical.begin(), result.unphysical.end());
  }
  return result;
}

Explainer::Settled Explainer::settle(FoundModel& found, Explanation& result) const {
  Settled settled;
  do {
    tell("looking for what else the effects could be");
    result.ambiguous = classes_of(setting_, result.excitation, found);
    result.or_links = could_be_links(setting_, robot_, found);
    for (const EffectAt& one : result.or_links) {
      if (!holds_in_any(result.ambiguous, one)) result.ambiguous.push_back({one});
    }
    result.shifts =
        contradicted_numbers(setting_, robot_, found, result.excitation, result.ambiguous);
    tell("fitting the numbers");
    do {
      settled.improved = fitted_robot(found, result);
    } while (leave_out_impossible(settled.improved.held, result.shifts) ||
             leave_out_undone(settled.improved.robot, result.shifts));
    settled.sizes = sizes_of(settled.improved);
  } while (gives_one_up(settled.sizes, found) ||
           takes_back_what_raises(judged_, settled.improved, setting_, options_.threads, found) ||
           takes_back_what_drives(settled.improved, setting_, options_.threads, found));
  return settled;
}

void Explainer::add_undecided(const FoundModel& found, const ImprovedRobot& improved,
                              Explanation& result) const {
  const VectorXd left = improved.last.data->layout.rms(improved.last.fit.residual);
  for (UndecidedClass& one : undecided(setting_, robot_, found, result.excitation, left)) {
    if (one.or_own_numbers) result.or_links.push_back(one.effects.front());
    result.ambiguous.push_back(std::move(one.effects));
  }
}

std::vector<Push> Explainer::pushes() const {
  std::vector<Push> all;
  // What has changed at a moment that is given is asked there.
  if (given_ || setting_.data->recordings[0].at_rest) return all;
  tell("looking for pushes");
  for (const Data* data : {setting_.data.get(), setting_.held_out.get()}) {
    if (data == nullptr) continue;
    std::vector<Push> own = pushes_in(*data, robot_, excitation_of(data->recordings));
    for (Push& one : own) {
      if (!is_among(one, all)) all.push_back(std::move(one));
    }
  }
  return all;
}

void Explainer::tell(const std::string& doing) const {
  if (on_progress_) on_progress_(doing);
}

FoundModel Explainer::find(bool search, const Explanation& result) const {
  return find_model(*setting_.search, *setting_.regression, *setting_.hold_out, result.excitation,
                    {.most_effects = search ? most_effects() : 0,
                     .room = room_for_effects(),
                     .replays = options_.replays},
                    on_progress_);
}

ImprovedRobot Explainer::robot_with(const std::vector<Term>& terms, const ModelFit& fit,
                                    const Explanation& result, bool keeps_links) const {
  FileFitOptions how{setting_.nuisance, {}, {}, options_.source, keeps_links};
  if (!options_.keep_effects) how.refitted = refitted_effects(file_, result.shifts);
  return improved_robot(file_, robot_, *setting_.data, how,
                        relinearise(robot_, *setting_.data, setting_.nuisance, terms, fit));
}

ImprovedRobot Explainer::fitted_robot(const FoundModel& found, const Explanation& result,
                                      bool keeps_links) const {
  return robot_with(found.terms(), found.fit, result, keeps_links);
}

ImprovedRobot Explainer::fitted_robot(const FoundModel& found, Explanation& result) const {
  result.links_kept_for.clear();
  ImprovedRobot improved = fitted_robot(found, result, false);
  // How far they are off is then the user's word, or what the whole recording says.
  if (result.at_rest || options_.link_share || result.link_share_judged) return improved;
  std::vector<char> changed(robot_.joints.size(), 0);
  for (const Accepted& one : found.accepted) {
    // By what it carries its own joint need not gain (doubts.cpp).
    if (!one.term.effect->is_mass()) changed[static_cast<std::size_t>(one.term.joint)] = 1;
  }
  for (const Shift& one : result.shifts) changed[static_cast<std::size_t>(one.joint)] = 1;
  std::vector<Index> raised = raised_by_links(judged_, improved, changed);
  if (raised.empty()) return improved;
  result.links_kept_for = std::move(raised);
  return fitted_robot(found, result, true);
}

FoundModel Explainer::sure_of(FoundModel found, const Explanation& result) const {
  Sizes sizes;
  do {
    sizes = sizes_of(fitted_robot(found, result, false));
  } while (gives_one_up(sizes, found));
  return found;
}

bool Explainer::gives_one_up(const Sizes& sizes, FoundModel& found) const {
  return replace_by_offset(setting_, sizes, options_.threads, found) ||
         leave_out_unsure(sizes, *setting_.regression, *setting_.hold_out, options_.threads, found);
}

FoundModel Explainer::search_model(bool search, Explanation& result) {
  result.link_share = setting_.nuisance.link_share;
  result.link_share_judged = false;
  FoundModel best = find(search, result);
  if (!search || options_.link_share || result.at_rest) return best;
  tell("asking how far the links' numbers are off");
  const NuisanceOptions usual = setting_.nuisance;
  const auto shares = wider_link_shares(robot_, *setting_.data, usual, options_.threads);
  FoundModel sure_best = shares.empty() ? FoundModel{} : sure_of(best, result);
  for (const double share : shares) {
    // What the fits point to has to stay where it is until one of them is chosen.
    SearchSetting of_best = set_beside(with_link_share(usual, share));
    FoundModel wide = find(search, result);
    FoundModel sure_wide = sure_of(wide, result);
    // What names of unsure size have taken is no gain of the one search over the other; that they
    // were needed is.
    const HoldOut& held = *setting_.hold_out;
    const bool judged = result.link_share_judged;
    if (is_clearly_better(held, wide, best, judged) ||
        is_clearly_better(held, sure_wide, sure_best, judged)) {
      result.link_share = share;
      result.link_share_judged = true;
      best = std::move(wide);
      sure_best = std::move(sure_wide);
    } else {
      setting_ = std::move(of_best);
    }
  }
  return best;
}

SearchSetting Explainer::set_beside(const NuisanceOptions& nuisance) {
  tell("preparing the candidates' regressors");
  SearchSetting before = std::exchange(setting_, {});
  setting_ = beside(before, robot_, nuisance);
  return before;
}

FoundModel Explainer::search_with_changes(bool search, Explanation& result) {
  const NuisanceOptions usual = setting_.nuisance;
  FoundModel without = search_model(search, result);
  if (!search || result.at_rest) return without;
  const bool judged = result.link_share_judged;
  const double share = result.link_share;
  auto changes = changes_in(without);
  if (changes.empty()) return without;
  SearchSetting of_without = std::exchange(setting_, {});
  // What is missing all the time and what changes are sought beside each other until both stay.
  constexpr int kTurns = 2;
  for (int turn = 0; turn < kTurns && !changes.empty(); ++turn) {
    NuisanceOptions changed = usual;
    changed.changes = terms_of(changes);
    tell("preparing the candidates' regressors");
    setting_ = beside(of_without, robot_, changed);
    FoundModel with = search_model(search, result);
    changes_ = changes_in(with);
    if (are_same(changes, changes_)) {
      if (!predicts_better(changes_, *setting_.regression, with, *of_without.regression, without)) {
        break;
      }
      return with;
    }
    changes = changes_;
  }
  changes_.clear();
  setting_ = std::move(of_without);
  result.link_share = share;
  result.link_share_judged = judged;
  return without;
}

std::vector<FoundChange> Explainer::changes_in(const FoundModel& found) const {
  tell(given_ ? "looking for what has changed" : "looking for what changes in the middle");
  NuisanceOptions unchanged = setting_.nuisance;
  if (unchanged.changes.empty()) {
    return changes_beside(*setting_.regression, found.terms(), setting_.search->options(), given_);
  }
  unchanged.changes.clear();
  const Data plain(*setting_.data, robot_, unchanged);
  return changes_beside(Regression(plain), found.terms(), setting_.search->options(), given_);
}

void Explainer::leave_out_undecided(const FoundModel& found, Explanation& result,
                                    ImprovedRobot& improved) const {
  const bool writes = changes_the_file(result);
  std::vector<char> touched(robot_.joints.size(), 0);
  std::vector<Term> kept;
  for (std::size_t i = 0; i < found.accepted.size(); ++i) {
    const Term& term = found.accepted[i].term;
    const EffectAt what{term.effect->kind(), term.joint};
    const std::size_t at = improved.added[i];
    const bool left_out =
        holds_in_any(result.ambiguous, what) || (writes && !is_written(result, what));
    if (at == kUnwritten || !left_out) {
      kept.push_back(term);
      continue;
    }
    touched[static_cast<std::size_t>(term.joint)] = 1;
    improved.robot.effects.erase(improved.robot.effects.begin() + static_cast<std::ptrdiff_t>(at));
    improved.added[i] = kUnwritten;
    for (std::size_t& other : improved.added) {
      if (other != kUnwritten && other > at) --other;
    }
  }
  if (writes && !result.at_rest && kept.size() < found.accepted.size()) {
    take_numbers_without(kept, touched, result, improved);
  }
}

void Explainer::take_numbers_without(const std::vector<Term>& kept, const std::vector<char>& joints,
                                     Explanation& result, ImprovedRobot& improved) const {
  tell("fitting the numbers without what is not written");
  const ImprovedRobot without =
      robot_with(kept, setting_.regression->fit(kept), result, !result.links_kept_for.empty());
  if (!without.unphysical.empty() || !without.unwritable.empty()) return;
  const std::vector<Index> better =
      take_better_numbers(judged_, without.robot, joints, improved.robot);
  if (better.empty()) return;
  result.advice.push_back(fmt::format(
      "the numbers of {} in the new file are not those above: they were fitted without what is "
      "not written of {}",
      list_of_joints(better), better.size() == 1 ? "it" : "them"));
}

int Explainer::most_effects() const {
  return setting_.data->recordings[0].at_rest ? std::max(1, room_for_effects())
                                              : options_.most_effects;
}

int Explainer::room_for_effects() const {
  const auto is_loaded = [](const Data* data) {
    return data != nullptr &&
           std::any_of(data->recordings.begin(), data->recordings.end(),
                       [](const Workspace& at) { return at.payload.has_value(); });
  };
  const bool loaded = is_loaded(setting_.data.get()) || is_loaded(setting_.held_out.get());
  const auto& fitted = setting_.data->nuisance.terms;
  const auto constants = std::count_if(fitted.begin(), fitted.end(), [](const auto& one) {
    return one.kind == NuisanceTerm::Kind::kConstant;
  });
  return kEffectsPerJoint * static_cast<int>(robot_.joints.size()) -
         static_cast<int>(robot_.effects.size()) - (loaded ? 1 : 0) - static_cast<int>(constants);
}

}  // namespace offnominal::desk
