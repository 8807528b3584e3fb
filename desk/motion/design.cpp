#include "motion/design.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "motion/plan_space.hpp"

namespace offnominal::desk::motion {
namespace {

using Eigen::Index;

// Sines of 2 Hz and the analysis' low-pass of 12 Hz need no more while designing.
constexpr double kDesignRateHz = 100;
// Where no motion gets an angle above this, the two torques are the same thing.
constexpr double kSameSine = 0.02;
constexpr double kNotExcited = 1;  // what a joint that stands out too little costs the score
constexpr std::size_t kImproved = 2;

using Mask = std::vector<std::vector<char>>;  // [truth][rival]: 1 where some motion separates them

class Designer {
 public:
  Designer(const RobotDescription& robot, const DesignRequest& request,
           const DesignProgress& progress)
      : robot_(robot),
        request_(request),
        progress_(progress),
        limits_(limits_of(robot, request.margin)),
        space_(robot.joints.size(), request.duration_s) {
    const FittedMotion reference = reference_motion();
    std::vector<Contender> contenders = request.effects;
    std::vector<Index> joints(robot.joints.size());
    std::iota(joints.begin(), joints.end(), 0);
    if (!request.effects.empty() && robot.joints.size() > 3) joints = joints_of(request.effects);
    for (const Contender& one : contenders_on(robot, joints)) {
      if (std::find(contenders.begin(), contenders.end(), one) == contenders.end()) {
        contenders.push_back(one);
      }
    }
    Expectation expectation = request.expectation;
    expectation.log_rate_hz = request.rate_hz;
    truths_ = request.effects.empty() ? contenders.size() : request.effects.size();
    judge_ = std::make_unique<MotionJudge>(robot, reference, kDesignRateHz, std::move(contenders),
                                           truths_, expectation);
  }

  Design run() {
    begin("trying motions");
    const std::size_t starts = start_count();
    std::vector<Tried> tried(starts);
    parallel_for(starts, request_.threads, [&](std::size_t i) {
      tried[i] = look_at(space_.random_point(request_.seed * 1'000'003U + i));
    });
    std::erase_if(tried, [](const Tried& one) { return !one.table; });
    if (tried.empty()) refuse_torque();
    set_mask(tried);
    for (Tried& one : tried) one.score = score_of(*one.table);
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Tried& a, const Tried& b) { return a.score > b.score; });
    if (tried.size() > kImproved) tried.resize(kImproved);
    begin("improving the best of them");
    for (Tried& one : tried) improve(one, starts);
    const auto best =
        std::max_element(tried.begin(), tried.end(),
                         [](const Tried& a, const Tried& b) { return a.score < b.score; });
    return report(*best);
  }

 private:
  struct Tried {
    std::vector<double> point;
    std::optional<SeparationTable> table;
    double score = -std::numeric_limits<double>::infinity();
  };

  static std::vector<Index> joints_of(const std::vector<Contender>& effects) {
    std::vector<Index> joints;
    for (const Contender& one : effects) joints.push_back(one.joint);
    std::sort(joints.begin(), joints.end());
    joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
    return joints;
  }

  void begin(const std::string& doing) {
    const std::lock_guard lock(progress_mutex_);
    if (progress_.begin) progress_.begin(doing);
  }

  [[noreturn]] void refuse_torque() const {
    throw InputError({robot_.name, "joint torque limits",
                      "no pose within the position limits that the model can hold with them",
                      "limits that the arm's own weight leaves something of",
                      "correct torque under [joint.limits], or lower --margin"});
  }

  // Fewer where each costs more: the columns grow with the joints, and so does every one of them.
  [[nodiscard]] std::size_t start_count() const {
    if (request_.starts > 0) return static_cast<std::size_t>(request_.starts);
    const double joints = std::max(1.0, static_cast<double>(robot_.joints.size()) / 2);
    return static_cast<std::size_t>(std::max(16.0, 64 / (joints * joints)));
  }

  std::optional<FittedMotion> fitted(const MotionPlan& plan, double rate_hz) const {
    return fit_into_limits(robot_, plan, limits_, request_.duration_s, rate_hz);
  }

  // The same for every seed and purpose, so that results compare.
  [[nodiscard]] FittedMotion reference_motion() const {
    constexpr std::uint64_t kTries = 32;
    for (std::uint64_t i = 0; i < kTries; ++i) {
      auto motion = fitted(space_.plan_at(space_.random_point(i)), kDesignRateHz);
      if (motion && motion->motion.dq.cwiseAbs().maxCoeff() > 0) return std::move(*motion);
    }
    refuse_torque();
  }

  Tried look_at(std::vector<double> point) {
    Tried tried;
    tried.point = std::move(point);
    const auto motion = fitted(space_.plan_at(tried.point), kDesignRateHz);
    if (motion) tried.table = judge_->judge(*motion);
    const std::lock_guard lock(progress_mutex_);
    ++count_;
    if (progress_.step) progress_.step();
    return tried;
  }

  void set_mask(const std::vector<Tried>& tried) {
    mask_.assign(truths_, std::vector<char>(judge_->contenders().size(), 0));
    for (const Tried& one : tried) {
      for (std::size_t i = 0; i < truths_; ++i) {
        for (std::size_t k = 0; k < mask_[i].size(); ++k) {
          if (one.table->of[i][k].sine > kSameSine) mask_[i][k] = 1;
        }
      }
    }
  }

  static double worth(const Separation& one) {
    constexpr double kLeast = 1e-3;
    return std::log(one.evidence > kLeast ? one.evidence : kLeast);
  }

  // What the worst of all rivals leaves of a true effect.
  [[nodiscard]] double worst_rival(const SeparationTable& table, std::size_t truth) const {
    double worst = worth(table.of[truth][truth]);
    for (std::size_t k = 0; k < mask_[truth].size(); ++k) {
      if (mask_[truth][k] != 0) worst = std::min(worst, worth(table.of[truth][k]));
    }
    return worst;
  }

  // Larger is better. What was asked for counts most: the worst of it, and a little its mean, so
  // that an optimiser sees more than one pair. That the effects can be told from everything else
  // counts too: the next recording is searched for all of them.
  [[nodiscard]] double score_of(const SeparationTable& table) const {
    constexpr double kMean = 0.3;
    constexpr double kOthers = 0.3;
    double score = 0;
    double worst = std::numeric_limits<double>::infinity();
    double sum = 0;
    double others = 0;
    int pairs = 0;
    for (std::size_t i = 0; i < truths_; ++i) {
      const double rival = worst_rival(table, i);
      others += rival / static_cast<double>(truths_);
      if (request_.effects.size() < 2) {
        worst = std::min(worst, rival);
        continue;
      }
      for (std::size_t k = 0; k < truths_; ++k) {
        if (i == k || mask_[i][k] == 0) continue;
        worst = std::min(worst, worth(table.of[i][k]));
        sum += worth(table.of[i][k]);
        ++pairs;
      }
    }
    if (std::isfinite(worst)) score += worst;
    if (pairs > 0) score += kMean * sum / pairs;
    score += (request_.effects.empty() ? 1 : kOthers) * others;
    for (const bool excited : table.excited) score -= excited ? 0 : kNotExcited;
    return score;
  }

  void improve(Tried& tried, std::size_t starts) {
    struct Context {
      Designer* designer;
      Tried* best;
      nlopt_opt optimiser;
      std::exception_ptr error;
    };
    const auto dimension = static_cast<unsigned>(space_.dimension());
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimiser(
        nlopt_create(NLOPT_LN_SBPLX, dimension), nlopt_destroy);
    Context context{this, &tried, optimiser.get(), nullptr};
    const auto loss = [](unsigned n, const double* x, double* /*gradient*/, void* data) {
      auto& at = *static_cast<Context*>(data);
      constexpr double kImpossible = 1e3;
      try {
        Tried here = at.designer->look_at(std::vector<double>(x, x + n));
        if (!here.table) return kImpossible;
        here.score = at.designer->score_of(*here.table);
        const double score = here.score;
        if (score > at.best->score) *at.best = std::move(here);
        return -score;
      } catch (...) {  // must not pass through C
        at.error = std::current_exception();
        nlopt_force_stop(at.optimiser);
        return kImpossible;
      }
    };
    constexpr double kStep = 0.2;
    std::vector<double> point = tried.point;
    double least = 0;
    nlopt_set_min_objective(optimiser.get(), loss, &context);
    nlopt_set_lower_bounds1(optimiser.get(), 0);
    nlopt_set_upper_bounds1(optimiser.get(), 1);
    nlopt_set_initial_step1(optimiser.get(), kStep);
    nlopt_set_maxeval(optimiser.get(), static_cast<int>(starts));
    {
      // NLopt does not promise that two searches may run at once: its trees share a global node.
      static std::mutex one_at_a_time;
      const std::lock_guard lock(one_at_a_time);
      nlopt_optimize(optimiser.get(), point.data(), &least);
    }
    if (context.error) std::rethrow_exception(context.error);
  }

  Design report(const Tried& best) {
    const MotionPlan plan = space_.plan_at(best.point);
    Design design;
    design.request = request_;
    design.limits = limits_;
    design.slow_from_s = (1 - plan.slow_share) * request_.duration_s;
    design.excited = best.table->excited;
    design.motions_tried = count_;
    auto motion = fitted(plan, request_.rate_hz);
    if (!motion) refuse_torque();
    design.fitted = std::move(*motion);
    const std::optional<SeparationTable> before = table_before();
    const auto add = [&](std::size_t i, std::size_t k) {
      PairReport pair;
      pair.truth = judge_->contenders()[i];
      if (i != k) pair.rival = judge_->contenders()[k];
      pair.after = best.table->of[i][k];
      if (before) pair.before = before->of[i][k];
      pair.possible = mask_[i][k] != 0;
      design.pairs.push_back(pair);
    };
    for (std::size_t i = 0; i < truths_; ++i) {
      if (request_.effects.size() > 1) {
        for (std::size_t k = 0; k < truths_; ++k) {
          if (i != k) add(i, k);
        }
      } else {
        add(i, worst_rival_of(*best.table, i));
      }
    }
    return design;
  }

  [[nodiscard]] std::size_t worst_rival_of(const SeparationTable& table, std::size_t truth) const {
    std::size_t worst = truth;
    for (std::size_t k = 0; k < mask_[truth].size(); ++k) {
      if (mask_[truth][k] == 0) continue;
      if (worth(table.of[truth][k]) < worth(table.of[truth][worst])) worst = k;
    }
    return worst;
  }

  [[nodiscard]] std::optional<SeparationTable> table_before() const {
    if (!request_.recordings.empty()) return judge_->judge(request_.recordings);
    const auto plain = fitted(plain_plan(robot_.joints.size(), request_.duration_s), kDesignRateHz);
    if (!plain) return std::nullopt;
    return judge_->judge(*plain);
  }

  const RobotDescription& robot_;
  const DesignRequest& request_;
  const DesignProgress& progress_;
  std::vector<JointLimits> limits_;
  PlanSpace space_;
  std::unique_ptr<MotionJudge> judge_;
  std::size_t truths_ = 0;
  Mask mask_;
  std::mutex progress_mutex_;
  int count_ = 0;
};

}  // namespace

const PairReport* Design::worst() const {
  const PairReport* worst = nullptr;
  for (const PairReport& pair : pairs) {
    if (!pair.possible) continue;
    if (worst == nullptr || pair.after.evidence < worst->after.evidence) worst = &pair;
  }
  return worst;
}

Design design_motion(const RobotDescription& robot, const DesignRequest& request,
                     const DesignProgress& progress) {
  return Designer(robot, request, progress).run();
}

}  // namespace offnominal::desk::motion
