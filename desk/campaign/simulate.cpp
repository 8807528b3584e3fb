#include "campaign/simulate.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "log/observed_motion.hpp"
#include "log/sampling.hpp"
#include "offnominal/sim/encoder.hpp"
#include "offnominal/sim/hidden/arm_motion.hpp"
#include "robot/chain_of.hpp"

namespace offnominal::desk::campaign {
namespace {

using Eigen::Index;
using sim::JointVector;
using sim::hidden::ArmMotion;
using sim::hidden::Draws;
using sim::hidden::Stream;

// Numbers of draws: those of calibration runs are beyond all others'.
constexpr std::uint64_t kFirstOfCalibration = std::uint64_t{1} << 40U;

// Positions as an encoder gives them, and their velocities as the controller observes them.
class Sensors {
 public:
  Sensors(const Campaign& campaign, const sim::JointState& start)
      : config_(velocity_observer_config(campaign.plant.period_s)),
        step_rad_(sim::position_step_rad({.bits_per_turn = campaign.plant.encoder_bits})),
        q_(start.q) {
    for (Index j = 0; j < start.q.size(); ++j) {
      // Settled: the run starts on the move.
      constexpr std::uint32_t kSettled = 1U << 20U;
      observers_.push_back({kSettled, start.q[j], start.dq[j]});
    }
  }

  // `fault`: that is there now, or null.
  void read(const JointVector& q, const Fault* fault) {
    for (Index j = 0; j < q.size(); ++j) {
      const bool is_at_fault = fault != nullptr && fault->joint == j;
      double position = q[j];
      if (is_at_fault && fault->kind == FaultKind::kEncoderStuck) continue;
      if (is_at_fault && fault->kind == FaultKind::kEncoderJump) position += fault->size;
      q_[j] = sim::quantise(position, step_rad_);
    }
    for (Index j = 0; j < q.size(); ++j) {
      const Status status = update(config_, q_[j], observers_[static_cast<std::size_t>(j)]);
      if (status != Status::kOk) throw std::runtime_error("the motion has run away");
    }
  }

  [[nodiscard]] const JointVector& q() const { return q_; }
  [[nodiscard]] JointVector dq() const {
    JointVector dq(q_.size());
    for (Index j = 0; j < q_.size(); ++j) dq[j] = observers_[static_cast<std::size_t>(j)].velocity;
    return dq;
  }

 private:
  VelocityObserverConfig<double> config_;
  double step_rad_;
  JointVector q_;
  std::vector<VelocityObserverState<double>> observers_;
};

// Computed torque: the feedback is an acceleration, so that joints that carry each other are not
// moved by each other's.
class Controller {
 public:
  explicit Controller(const Campaign& campaign)
      : model_(make_model(chain_of<kRuntimeJoints, double>(campaign.model))) {
    const Index joints = campaign.model.joint_count();
    most_nm_.resize(joints);
    for (Index j = 0; j < joints; ++j) {
      most_nm_[j] = campaign.truth.joints[static_cast<std::size_t>(j)].joint.max_torque;
    }
  }

  // `beside`: N m, on top.
  [[nodiscard]] JointVector torque(const sim::DesiredMotion& wanted, const Sensors& is,
                                   const JointVector& beside, double t_s) const {
    constexpr double kBandwidth = 30;  // rad/s
    const JointVector ddq = wanted.ddq + kBandwidth * kBandwidth * (wanted.q - is.q()) +
                            2 * kBandwidth * (wanted.dq - is.dq());
    const JointVector torque =
        inverse_dynamics<kRuntimeJoints, double>(model_, wanted.q, wanted.dq, ddq, t_s) + beside;
    return torque.cwiseMin(most_nm_).cwiseMax(-most_nm_);
  }

 private:
  RigidBodyModel<kRuntimeJoints, double> model_;
  JointVector most_nm_;
};

// What the drives give of what they are told.
JointVector given_torque(JointVector told, const Fault* fault) {
  if (fault == nullptr) return told;
  if (fault->kind == FaultKind::kTorqueLost) told[fault->joint] *= 1 - fault->size;
  if (fault->kind == FaultKind::kOffset) told[fault->joint] += fault->size;
  return told;
}

struct Job {
  const Campaign& campaign;
  const Fault* fault = nullptr;
  double duration_s = 0;
  std::uint64_t draw = 0;
  Accommodation* loop = nullptr;
  JointVector loop_noise_nm{};  // of the torques that it is told
};

// What a recording has beside what is: the same for a monitor in the loop, row by row.
class Noise {
 public:
  explicit Noise(const Job& job)
      : plant_(job.campaign.plant), draws_(job.campaign.seed, Stream::kNoise, job.draw) {}

  template <typename Torques, typename Velocities>
  void add(const JointVector& sigma_nm, Torques&& tau, Velocities&& dq) {
    for (Index j = 0; j < sigma_nm.size(); ++j) {
      tau[j] += sigma_nm[j] * draws_.gaussian();
      if (plant_.velocity != VelocityKind::kSent || plant_.velocity_noise_rad_s == 0) continue;
      dq[j] += plant_.velocity_noise_rad_s * draws_.gaussian();
    }
  }

 private:
  const PlantSettings& plant_;
  Draws draws_;
};

// What is simulated beyond the end of a recording whose velocities are derived, and cut off then:
// derivatives at an end are another filter's.
double overhang_s(const Campaign& campaign) {
  return campaign.plant.velocity == VelocityKind::kDerived ? 0.1 : 0;
}

// One run on the test stand, tick by tick.
class Stand {
 public:
  Stand(const Job& job, const PlantMaker& plants)
      : job_(job),
        controller_(job.campaign),
        motion_(drawn_motion(job)),
        plant_(plants.make(sim::on_trajectory(motion_.at(0)))),
        sensors_(job.campaign, plant_->state()),
        beside_(JointVector::Zero(job.campaign.truth.joint_count())),
        loop_noise_(job),
        observer_(beside_.size(), job.campaign.plant.period_s) {
    const double period_s = job.campaign.plant.period_s;
    kept_ = static_cast<Index>(std::llround(job.duration_s / period_s));
    const Index ticks =
        kept_ + static_cast<Index>(std::llround(overhang_s(job.campaign) / period_s));
    t_s_ = Eigen::VectorXd::LinSpaced(ticks, 0, static_cast<double>(ticks - 1) * period_s);
    for (auto* columns : {&q_, &dq_, &tau_}) {
      columns->resize(ticks, job.campaign.truth.joint_count());
    }
  }

  RecordedRun take() {
    RecordedRun run;
    Index rows = 0;
    try {
      for (; rows < t_s_.size(); ++rows) tick(rows);
    } catch (const std::runtime_error&) {
      if (!has_begun(t_s_[rows])) throw;
      run.ran_away_s = t_s_[rows];
    }
    run.tracking_before_rad = before_.rms();
    run.tracking_after_rad = after_.rms();
    run.tracking_end_rad = run.ran_away_s ? std::nullopt : end_.rms();
    run.moves_after_s = moves_after_s_;
    recorded(rows, run);
    return run;
  }

 private:
  struct Squares {
    double sum = 0;
    double count = 0;
    void add(const JointVector& distance) {
      sum += distance.squaredNorm();
      count += static_cast<double>(distance.size());
    }
    [[nodiscard]] std::optional<double> rms() const {
      return count > 0 ? std::optional(std::sqrt(sum / count)) : std::nullopt;
    }
  };

  static ArmMotion drawn_motion(const Job& job) {
    Draws draws(job.campaign.seed, Stream::kMotion, job.draw);
    const std::vector<double>& middles = job.campaign.middles_rad;
    return sim::hidden::draw_arm_motion(middles, std::vector<bool>(middles.size(), false),
                                        job.duration_s, draws);
  }

  [[nodiscard]] bool is_observed() const {
    return job_.campaign.plant.velocity == VelocityKind::kObserved;
  }

  [[nodiscard]] bool has_begun(double t_s) const {
    return job_.fault != nullptr && t_s >= job_.campaign.runs.fault_s - 1e-9;
  }

  void tick(Index row) {
    const double t_s = t_s_[row];
    const Fault* const fault = has_begun(t_s) ? job_.fault : nullptr;
    if (fault != nullptr && !begun_) {
      plant_->begin(*fault);
      begun_ = true;
    }
    const bool is_over = fault != nullptr && fault->kind == FaultKind::kPush && !ended_ &&
                         t_s >= job_.campaign.runs.fault_s + fault->lasts_s - 1e-9;
    if (is_over) {
      plant_->end(*fault);
      ended_ = true;
    }
    const sim::DesiredMotion wanted = motion_.at(t_s);
    const sim::JointState is = plant_->state();
    sensors_.read(is.q, fault);
    const JointVector told = controller_.torque(wanted, sensors_, beside_, t_s);
    if (row == 0) before_told_ = told;
    const double share = plant_->share_of_last_torque();
    q_.row(row) = sensors_.q();
    dq_.row(row) = velocities(is.dq, fault);
    tau_.row(row) = share * before_told_ + (1 - share) * told;
    (fault == nullptr ? before_ : after_).add(wanted.q - is.q);
    follow_motion(t_s, wanted);
    if (is_at_end(t_s)) end_.add(wanted.q - is.q);
    if (job_.loop != nullptr) listen(row);
    before_told_ = told;
    plant_->step(t_s, given_torque(told, fault), job_.campaign.plant.period_s);
  }

  // When the joint at fault is to move.
  void follow_motion(double t_s, const sim::DesiredMotion& wanted) {
    constexpr double kMoves = 1.0 / 50;
    if (job_.fault == nullptr || !info_of(job_.fault->kind).of_joint || moves_after_s_) return;
    const double speed = std::abs(wanted.dq[job_.fault->joint]);
    if (!has_begun(t_s)) {
      fastest_ = std::max(fastest_, speed);
    } else if (speed > kMoves * fastest_) {
      moves_after_s_ = std::max(t_s - job_.campaign.runs.fault_s, 0.0);
    }
  }

  [[nodiscard]] bool is_at_end(double t_s) const {
    constexpr double kShare = 0.25;
    const double behind_s = job_.duration_s - job_.campaign.runs.fault_s;
    return job_.fault != nullptr && t_s >= job_.duration_s - kShare * behind_s;
  }

  void listen(Index row) {
    Watch::Sample sample{{q_.row(row), dq_.row(row), tau_.row(row)}, {}};
    loop_noise_.add(job_.loop_noise_nm, sample.joints.tau, sample.joints.dq);
    if (is_observed()) {
      const auto* const observed = observer_.take(sample.joints.q, sample.joints.tau);
      if (observed == nullptr) return;
      sample = {*observed, sample.joints.q};
    }
    beside_ = job_.loop->after(sample, t_s_[row]);
  }

  [[nodiscard]] JointVector velocities(JointVector dq, const Fault* fault) const {
    if (fault != nullptr && fault->kind == FaultKind::kEncoderStuck) dq[fault->joint] = 0;
    return dq;
  }

  static Log first_rows(Log log, Index rows) {
    log.t_s.conservativeResize(rows);
    for (auto* columns : {&log.q, &log.dq, &log.tau}) {
      columns->conservativeResize(rows, Eigen::NoChange);
    }
    return log;
  }

  // As an owner's software records.
  void recorded(Index rows, RecordedRun& run) {
    const PlantSettings& plant = job_.campaign.plant;
    const Index joints = q_.cols();
    Log log;
    log.period_s = plant.period_s;
    log.t_s = t_s_.head(rows);
    log.q = q_.topRows(rows);
    log.dq = dq_.topRows(rows);
    log.tau = tau_.topRows(rows);
    const Index healthy =
        std::lower_bound(log.t_s.begin(), log.t_s.end(),
                         job_.fault == nullptr ? std::numeric_limits<double>::max()
                                               : job_.campaign.runs.fault_s - 1e-9) -
        log.t_s.begin();
    run.torque_noise_nm =
        plant.torque_noise * log.tau.topRows(healthy).cwiseAbs().colwise().maxCoeff().transpose();
    Noise noise(job_);
    for (Index row = 0; row < rows; ++row) {
      noise.add(run.torque_noise_nm, log.tau.row(row), log.dq.row(row));
    }
    const bool derived = plant.velocity == VelocityKind::kDerived;
    log.dq_derived.assign(static_cast<std::size_t>(joints), derived);
    if (derived) derive_velocities(log);
    log = first_rows(std::move(log), std::min(rows, kept_));
    run.log = is_observed() ? as_observed(log) : std::move(log);
  }

  const Job& job_;
  Controller controller_;
  ArmMotion motion_;
  std::unique_ptr<CampaignPlant> plant_;
  Sensors sensors_;
  Eigen::VectorXd t_s_;
  Eigen::MatrixXd q_, dq_, tau_;
  Index kept_ = 0;  // of the ticks
  JointVector before_told_;
  Squares before_, after_, end_;
  double fastest_ = 0;  // of the joint at fault, before it
  std::optional<double> moves_after_s_;
  JointVector beside_;  // N m, that the monitor in the loop has the drives give
  Noise loop_noise_;
  MotionObserver observer_;  // of what the monitor in the loop is told
  bool begun_ = false;
  bool ended_ = false;
};

}  // namespace

namespace {

RecordedRun taken(const Job& job, const PlantMaker& plants, const std::string& name) {
  try {
    RecordedRun recorded = Stand(job, plants).take();
    recorded.log.file = name;
    return recorded;
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw InputError({.file = job.campaign.file,
                      .place = name,
                      .found = std::string("no motion of a healthy robot: ") + error.what(),
                      .allowed = "a plant that its model can move",
                      .mend = "lower [plant] cad_error, or take more encoder_bits or a shorter "
                              "period_s"});
  }
}

}  // namespace

Simulator::Simulator(const Campaign& campaign) : campaign_(campaign), plants_(campaign) {}

RecordedRun Simulator::run(const Run& run) const {
  const Job job{campaign_, run.fault, run.duration_s, static_cast<std::uint64_t>(run.number)};
  return taken(job, plants_, fmt::format("run {}", run.number));
}

RecordedRun Simulator::accommodated(const Run& run, const RecordedRun& without,
                                    Accommodation& loop) const {
  const Job job{campaign_,      run.fault,
                run.duration_s, static_cast<std::uint64_t>(run.number),
                &loop,          without.torque_noise_nm};
  return taken(job, plants_, fmt::format("run {}, accommodated", run.number));
}

Log Simulator::calibration_run(int number) const {
  const Job job{campaign_, nullptr, campaign_.calibration.duration_s,
                kFirstOfCalibration + static_cast<std::uint64_t>(number)};
  return taken(job, plants_, fmt::format("calibration run {}", number)).log;
}

}  // namespace offnominal::desk::campaign
