#include "discovery/explain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "common/error.hpp"
#include "discovery/alternatives.hpp"
#include "discovery/confirm.hpp"
#include "discovery/estimates.hpp"
#include "discovery/holdout.hpp"
#include "discovery/replay_null.hpp"
#include "discovery/search.hpp"
#include "discovery/verdict.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Below this share of a joint's residual energy an effect is not worth a name, on the recordings
// and on what was held out.
constexpr double kRelevantShare = 0.08;
constexpr double kRelevantHeldOut = 0.05;
// ... and below this share of the joint's rms torque.
constexpr double kRelevantTorque = 0.001;

class Explainer {
 public:
  Explainer(const RobotDescription& robot, const std::vector<Log>& logs,
            const std::vector<Log>& holdout, const ExplainOptions& options,
            const OnProgress& on_progress)
      : robot_(robot), options_(options), on_progress_(on_progress) {
    check_joints(logs);
    check_joints(holdout);
    const FilterPlan plan = discovery_filter(logs, robot_);
    constexpr Index kFewest = 200;
    check(logs, plan, kFewest);
    check(holdout, plan, kMinFilteredSamples);
    const VectorXd widths = set_sign_widths(robot_, logs, plan);
    const NuisanceOptions nuisance{options.link_share, 1.0};
    data_ = std::make_unique<Data>(workspaces(logs, plan, widths), robot_, nuisance);
    if (!holdout.empty()) {
      holdout_ = std::make_unique<Data>(workspaces(holdout, plan, widths), robot_, nuisance);
    }
    SearchOptions search;
    search.threads = options.threads;
    search.seed = options.seed;
    search.bootstrap_draws = options.bootstrap_draws;
    tell("preparing the candidates' regressors");
    search_ = std::make_unique<Search>(*data_, search);
  }

  Explanation run() {
    result_.holdout_is_apart = holdout_ != nullptr;
    result_.excitation = excitation_of(data_->recordings);
    baseline_ = search_->fit({});
    model_ = baseline_;
    held_out_ = {held_out({}, baseline_)};
    forward();
    backward();
    order_by_size();
    find_alternatives();
    report();
    judge_whole(result_);
    return std::move(result_);
  }

 private:
  void tell(const std::string& doing) const {
    if (on_progress_) on_progress_(doing);
  }

  void check_joints(const std::vector<Log>& logs) const {
    for (const Log& log : logs) {
      if (log.joint_count() != robot_.joint_count()) {
        throw InputError({log.file, "", fmt::format("{} joints", log.joint_count()),
                          fmt::format("{}, as the robot has", robot_.joint_count()),
                          "give the robot file that belongs to this recording, or [channels]"});
      }
    }
  }

  void check(const std::vector<Log>& logs, const FilterPlan& plan, Index fewest) const {
    Index whole = 0;
    for (const Log& log : logs) {
      const Index left = (log.sample_count() - 2 * plan.edge_samples) / plan.decimation;
      if (left < kMinFilteredSamples) {
        throw InputError(
            {log.file, "", fmt::format("{} samples", log.sample_count()),
             fmt::format("{} or more with this filter",
                         kMinFilteredSamples * plan.decimation + 2 * plan.edge_samples),
             "record for longer"});
      }
      whole += left;
    }
    if (!logs.empty() && whole < fewest) {
      throw InputError({logs[0].file, "", fmt::format("{} samples after the filter", whole),
                        fmt::format("{} or more, of all recordings together", fewest),
                        "record for longer, or give more recordings"});
    }
  }

  std::vector<Workspace> workspaces(const std::vector<Log>& logs, const FilterPlan& plan,
                                    const VectorXd& widths) const {
    std::vector<Workspace> made;
    for (const Log& log : logs) {
      FilterPlan own = plan;
      own.sample_rate_hz = log.sample_rate_hz();
      made.push_back(make_workspace(log, robot_, own, widths));
    }
    return made;
  }

  // Residual on what the fit has not seen.
  VectorXd held_out(const std::vector<Term>& terms, const ModelFit& fit) const {
    return holdout_ ? residual_on(*holdout_, terms, fit)
                    : cross_validated_residual(*search_, terms);
  }
  [[nodiscard]] const Data& held_out_data() const { return holdout_ ? *holdout_ : *data_; }
  [[nodiscard]] VectorXd held_out_rms(const VectorXd& residual) const {
    return held_out_data().layout.rms(residual);
  }

  // The joint on which `after` leaves less than `before`, and what share of the energy goes.
  static std::pair<Index, double> best_gain(const VectorXd& before, const VectorXd& after) {
    std::pair<Index, double> best{0, -1};
    for (Index joint = 0; joint < before.size(); ++joint) {
      if (!(before[joint] > 0)) continue;
      const double gain = 1 - std::pow(after[joint] / before[joint], 2);
      if (gain > best.second) best = {joint, gain};
    }
    return best;
  }

  [[nodiscard]] bool relevant(const ModelFit& before, const ModelFit& after) const {
    const RowLayout& layout = data_->layout;
    const VectorXd a = layout.rms(before.residual);
    const VectorXd b = layout.rms(after.residual);
    const auto [joint, gain] = best_gain(a, b);
    const double rms = std::sqrt(std::max(0.0, a[joint] * a[joint] - b[joint] * b[joint]));
    return gain >= kRelevantShare && rms >= kRelevantTorque * layout.rms(data_->torque)[joint];
  }

  void forward() {
    while (terms_.size() < static_cast<std::size_t>(options_.most_effects)) {
      tell(fmt::format("searching for effect {}", terms_.size() + 1));
      const Screening screening = search_->screen(terms_, model_);
      const std::vector<Proposal> proposals = search_->propose(terms_, model_, screening);
      if (terms_.empty()) first_screening_ = screening.candidates;
      if (proposals.empty() || !relevant(model_, proposals[0].fit)) return;
      const Proposal& best = proposals[0];
      const Term& term = best.terms.back();
      if (!shows(*data_, result_.excitation[static_cast<std::size_t>(term.joint)], term)) {
        unexcited_ = true;
        return;
      }
      const double p = search_->family_p(best, model_);
      if (p > search_->options().family_error) return;
      const VectorXd residual = held_out(best.terms, best.fit);
      if (best_gain(held_out_rms(held_out_.back()), held_out_rms(residual)).second <
          kRelevantHeldOut) {
        return;
      }
      if (term.effect->has_memory() && !simulates_better(best)) return;
      if (!survives_replay(best)) return;
      terms_ = best.terms;
      p_values_.push_back(p);
      model_ = best.fit;
      held_out_.push_back(residual);
    }
  }

  [[nodiscard]] bool survives_replay(const Proposal& proposal) {
    constexpr double kReplayError = 0.05;
    if (options_.replays == 0) {
      replay_p_.push_back(1);
      return true;
    }
    tell(fmt::format("playing the model without {}", proposal.terms.back().effect->name()));
    const double p = replay_p(*search_, model_, proposal.fit.residual, proposal.terms.back(),
                              options_.replays, options_.seed, options_.threads);
    if (p > kReplayError) return false;
    replay_p_.push_back(p);
    return true;
  }

  // An effect with a memory must bring the simulated motion closer too.
  [[nodiscard]] bool simulates_better(const Proposal& proposal) const {
    const Index joint = proposal.terms.back().joint;
    return simulated_position_error(*data_, proposal.fit.residual)[joint] <
           simulated_position_error(*data_, model_.residual)[joint];
  }

  // Every accepted effect must still be needed beside the later ones.
  void backward() {
    for (std::size_t i = 0; i + 1 < terms_.size();) {
      tell("trying to do without each effect again");
      std::vector<Term> without = terms_;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      const ModelFit fit = search_->fit(without);
      if (relevant(fit, model_)) {
        ++i;
        continue;
      }
      terms_ = without;
      model_ = fit;
      p_values_.erase(p_values_.begin() + static_cast<std::ptrdiff_t>(i));
      replay_p_.erase(replay_p_.begin() + static_cast<std::ptrdiff_t>(i));
      refill_held_out();
    }
  }

  // Largest first: of what is left each time, the effect that takes most away.
  void order_by_size() {
    std::vector<Term> ordered;
    std::vector<double> p;
    std::vector<double> replay;
    Remainder left = baseline_.remainder;
    std::vector<std::size_t> open(terms_.size());
    std::iota(open.begin(), open.end(), 0);
    while (!open.empty()) {
      std::size_t best = 0;
      double most = -1;
      for (std::size_t k = 0; k < open.size(); ++k) {
        const Evidence evidence = judge(left, Search::columns_of(*data_, terms_[open[k]]));
        if (evidence.usable && evidence.gain > most) {
          most = evidence.gain;
          best = k;
        }
      }
      const std::size_t next = open[best];
      ordered.push_back(terms_[next]);
      p.push_back(p_values_[next]);
      replay.push_back(replay_p_[next]);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(best));
      if (!open.empty()) left = search_->fit(ordered).remainder;
    }
    if (terms_.size() < 2) return;
    terms_ = std::move(ordered);
    p_values_ = std::move(p);
    replay_p_ = std::move(replay);
    model_ = search_->fit(terms_);
    refill_held_out();
  }

  void refill_held_out() {
    held_out_.resize(1);
    for (std::size_t n = 1; n <= terms_.size(); ++n) {
      const std::vector<Term> first(terms_.begin(),
                                    terms_.begin() + static_cast<std::ptrdiff_t>(n));
      held_out_.push_back(held_out(first, search_->fit(first)));
    }
  }

  void find_alternatives() {
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      tell(fmt::format("looking for what else could be effect {}", i + 1));
      std::vector<Term> others = terms_;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const ModelFit beside = search_->fit(others);
      const Screening screening = search_->screen(others, beside);
      std::vector<EffectAt> same{{terms_[i].effect->name(), terms_[i].joint}};
      for (const Proposal& other : search_->propose(others, beside, screening)) {
        const Term& term = other.terms.back();
        const EffectAt name{term.effect->name(), term.joint};
        if (name == same[0] || !as_good(*data_, model_, other.fit) ||
            is_nested(*data_, baseline_, terms_[i], term))
          continue;
        same.push_back(name);
      }
      if (same.size() > 1) result_.ambiguous.push_back(std::move(same));
    }
  }

  void report() {
    report_joints();
    report_findings();
    report_rejections();
    result_.where = structure_of(*data_, model_.residual);
    for (std::size_t i = 0; i < data_->nuisance.terms.size(); ++i) report_shift(i);
    for (const VectorXd& residual : held_out_) {
      result_.waterfall.push_back(held_out_rms(residual));
    }
    report_series();
    result_.unexcited = unexcited_;
  }

  void report_joints() {
    const RowLayout& layout = data_->layout;
    const VectorXd torque = layout.rms(data_->torque);
    const VectorXd before = layout.rms(data_->target);
    const VectorXd fitted = layout.rms(baseline_.residual);
    const VectorXd after = layout.rms(model_.residual);
    const VectorXd held_before = held_out_rms(held_out_.front());
    const VectorXd held_after = held_out_rms(held_out_.back());
    const VectorXd floor = noise_floor_of(*data_, model_.residual);
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const JointType type = robot_.joints[static_cast<std::size_t>(joint)].joint.type;
      result_.joints.push_back({joint, offnominal::unit_of(Quantity::kEffort, type), torque[joint],
                                before[joint], fitted[joint], after[joint], held_before[joint],
                                held_after[joint], floor[joint]});
    }
  }

  void report_findings() {
    const auto estimates = estimates_of(*search_, terms_, model_);
    const VectorXd simulated_after = simulated_position_error(*data_, model_.residual);
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      const Term& term = terms_[i];
      std::vector<Term> without = terms_;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      const ModelFit fit = search_->fit(without);
      const VectorXd before = held_out_rms(held_out(without, fit));
      const VectorXd after = held_out_rms(held_out_.back());
      Finding finding;
      finding.what = {term.effect->name(), term.joint};
      finding.words = term.effect->words();
      finding.parameters = estimates[i];
      finding.p_value = p_values_[i];
      finding.holdout_before = before[term.joint];
      finding.holdout_after = after[term.joint];
      finding.simulated_before = simulated_position_error(*data_, fit.residual)[term.joint];
      finding.simulated_after = simulated_after[term.joint];
      finding.p_replay = replay_p_[i];
      result_.found.push_back(std::move(finding));
    }
  }

  void report_rejections() {
    const Screening screening = search_->screen(terms_, model_);
    const RowLayout& layout = data_->layout;
    for (const Screened& one : screening.candidates) {
      Rejection rejection;
      rejection.what = {one.term.effect->name(), one.term.joint};
      rejection.p_value = std::min(
          1.0, std::pow(10.0, -one.log10_p) * static_cast<double>(screening.candidates.size()));
      rejection.smallest_detectable =
          std::sqrt(kRelevantShare) * layout.rms(model_.residual)[one.term.joint];
      rejection.unit = offnominal::unit_of(
          Quantity::kEffort, robot_.joints[static_cast<std::size_t>(one.term.joint)].joint.type);
      result_.rejected.push_back(std::move(rejection));
    }
  }

  void report_shift(std::size_t index) {
    constexpr double kShifted = 0.3;
    const NuisanceTerm& term = data_->nuisance.terms[index];
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) return;
    const RobotEffect& effect = robot_.effects[term.effect];
    const double file = effect.parameters[term.parameter];
    const double by = model_.nuisance[static_cast<Index>(index)];
    const double matters =
        std::abs(by) *
        data_->layout.rms(data_->nuisance.columns.col(static_cast<Index>(index)))[term.joint];
    const bool large = std::abs(by) > kShifted * std::abs(file) &&
                       matters > 0.02 * data_->layout.rms(data_->torque)[term.joint];
    if (large) result_.shifts.push_back({term.name, file != 0 ? by / file : 1.0});
  }

  void report_series() {
    const Workspace& at = data_->recordings[0];
    const RowLayout& layout = data_->layout;
    const Index n = layout.samples(0);
    Explanation::Series& series = result_.series;
    series.t_s = kept_samples(at.plan, at.motion.t_s);
    for (MatrixXd* matrix : {&series.measured, &series.model_before, &series.model_after, &series.q,
                             &series.dq, &series.load}) {
      matrix->resize(n, layout.joint_count());
    }
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const Index begin = layout.begin(0, joint);
      series.measured.col(joint) = data_->torque.segment(begin, n);
      series.model_before.col(joint) = series.measured.col(joint) - data_->target.segment(begin, n);
      series.model_after.col(joint) =
          series.measured.col(joint) - model_.residual.segment(begin, n);
      series.q.col(joint) = kept_samples(at.plan, at.motion.q.col(joint));
      series.dq.col(joint) = kept_samples(at.plan, at.motion.dq.col(joint));
      series.load.col(joint) = kept_samples(at.plan, at.load_torque.col(joint));
    }
  }

  RobotDescription robot_;
  ExplainOptions options_;
  const OnProgress& on_progress_;
  std::unique_ptr<Data> data_;
  std::unique_ptr<Data> holdout_;
  std::unique_ptr<Search> search_;
  std::vector<Term> terms_;
  std::vector<double> p_values_;
  std::vector<double> replay_p_;
  ModelFit baseline_;
  ModelFit model_;
  std::vector<VectorXd> held_out_;  // residuals with 0, 1, ... effects
  std::vector<Screened> first_screening_;
  bool unexcited_ = false;
  Explanation result_;
};

}  // namespace

Explanation explain(const RobotDescription& robot, const std::vector<Log>& logs,
                    const std::vector<Log>& holdout, const ExplainOptions& options,
                    const OnProgress& on_progress) {
  Explainer explainer(robot, logs, holdout, options, on_progress);
  if (on_progress) on_progress("examining the recordings");
  std::vector<DataFault> faults;
  for (const std::vector<Log>* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      for (DataFault& fault : examine(log, robot)) faults.push_back(std::move(fault));
    }
  }
  Explanation result = explainer.run();
  if (!faults.empty()) {
    result.data_faults = std::move(faults);
    judge_whole(result);
  }
  return result;
}

}  // namespace offnominal::tools::discovery
