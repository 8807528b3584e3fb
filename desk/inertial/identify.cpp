#include "inertial/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "identify/data.hpp"
#include "identify/file_errors.hpp"
#include "identify/link_masses.hpp"
#include "inertial/identified_numbers.hpp"
#include "inertial/inertial_fit.hpp"
#include "log/seen_by_sensor.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

class Identifier {
 public:
  Identifier(const RobotDescription& file, const IdentifyRequest& request,
             const std::vector<Log>& logs, const std::vector<Log>& holdout,
             const FilterRequest& filter, const OnProgress& on_progress)
      : file_(file),
        request_(request),
        logs_(logs),
        holdout_(holdout),
        plan_(plan_filter(logs, file, filter)),
        on_progress_(on_progress),
        fit_(std::make_unique<InertialFit>(file, request, logs, plan_, Rotors::kApartFromLinks,
                                           on_progress)) {}

  Identification run() {
    take_rotors_out_of_links();
    result_.robot = fit_->identified();
    result_.share = fit_->share();
    for (std::size_t joint = 0; joint < file_.joints.size(); ++joint) {
      if (!fit_->moves(joint)) result_.standing.push_back(joint);
    }
    put_numbers(*fit_, request_, result_);
    judge();
    object();
    doubt();
    note();
    return std::move(result_);
  }

 private:
  // The rotor behind a gear of a hundred turns as much as a heavy link does, and about a joint's
  // axis no motion tells the two apart. Where the links have to leave their file for it, rotors are
  // asked for by themselves, and are what they are if the links can then stay nearer.
  void take_rotors_out_of_links() {
    constexpr double kNear = 0.15;
    constexpr double kAsGood = 1.02;
    // Without parts that are held out nothing says whether it is as good.
    if (fit_->untold_rotors().empty() || fit_->share() <= kNear ||
        fit_->held_out_energy().size() == 0 || !file_is_whole() || request_.from_geometry) {
      return;
    }
    auto apart =
        std::make_unique<InertialFit>(file_, request_, logs_, plan_, Rotors::kAll, on_progress_);
    const VectorXd weights = fit_->joint_weights().cwiseAbs2();
    const bool as_good =
        weights.dot(apart->held_out_energy()) <= kAsGood * weights.dot(fit_->held_out_energy());
    if (!as_good || apart->share() >= fit_->share()) return;
    share_without_ = fit_->share();
    fit_ = std::move(apart);
  }

  // Whether the file can say any torque at all.
  [[nodiscard]] bool file_is_whole() const {
    for (std::size_t link = 0; link < file_.joints.size(); ++link) {
      if (!has_numbers(file_, link)) return false;
    }
    return true;
  }

  [[nodiscard]] BeforeAfter error_of(std::size_t joint, double torque, double before,
                                     double after) const {
    BeforeAfter error;
    error.joint = joint;
    error.unit = unit_of(Quantity::kEffort, file_.joints[joint].joint.type);
    error.before_rms = before;
    error.after_rms = after;
    error.before_percent = 100 * before / torque;
    error.after_percent = 100 * after / torque;
    return error;
  }

  [[nodiscard]] std::vector<BeforeAfter> errors_on(const std::vector<Log>& logs) const {
    const FileErrors after = file_errors(result_.robot, logs, plan_);
    const FileErrors before = file_is_whole() ? file_errors(file_, logs, plan_) : FileErrors{};
    std::vector<BeforeAfter> errors;
    for (std::size_t joint = 0; joint < file_.joints.size(); ++joint) {
      errors.push_back(error_of(
          joint, after.rms_torque[joint],
          file_is_whole() ? before.rms_error[joint] : std::numeric_limits<double>::quiet_NaN(),
          after.rms_error[joint]));
    }
    return errors;
  }

  // Parts of the recordings, each predicted by a fit of the others; before: by the file.
  [[nodiscard]] std::vector<BeforeAfter> parts_held_out() const {
    const Data& data = fit_->data();
    if (fit_->held_out_energy().size() == 0) return {};
    const VectorXd was =
        file_is_whole() ? errors_as_it_is(file_, data)
                        : VectorXd(VectorXd::Constant(data.layout.joint_count(),
                                                      std::numeric_limits<double>::quiet_NaN()));
    const VectorXd torque = data.layout.rms(data.torque);
    std::vector<BeforeAfter> errors;
    for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
      const auto at = static_cast<std::size_t>(joint);
      if (!fit_->moves(at)) continue;
      double samples = 0;
      for (std::size_t r = 0; r < data.layout.recording_count(); ++r) {
        samples += data.layout.moving_count(r, joint);
      }
      const double is = std::sqrt(fit_->held_out_energy()[joint] / std::max(1.0, samples));
      errors.push_back(error_of(at, torque[joint], was[joint], is));
    }
    return errors;
  }

  void judge() {
    result_.fitted = errors_on(logs_);
    result_.cross_validated = holdout_.empty();
    result_.held_out = holdout_.empty() ? parts_held_out() : errors_on(holdout_);
    const Measurement measured =
        measure(held_elsewhere(holdout_.empty() ? logs_.front() : holdout_.front()), file_, plan_);
    if (file_is_whole()) result_.before = compare(file_, measured);
    result_.after = compare(result_.robot, measured);
  }

  void object() {
    const bool drives =
        std::any_of(result_.drives.begin(), result_.drives.end(), [](const IdentifiedDrive& drive) {
          const auto& ci95 = drive.number.ci95;
          return ci95 && ((*ci95)[0] > 0 || (*ci95)[1] < 0);
        });
    if (result_.standing.size() == file_.joints.size()) {
      result_.objections.emplace_back("no joint moves in these recordings");
    } else if (result_.determined_count() == 0 && (request_.payload || !drives)) {
      result_.objections.emplace_back(
          "these recordings determine no base parameter and no friction");
    }
    if (request_.payload && result_.objections.empty() && !payload_shows()) {
      result_.objections.emplace_back(
          "these recordings determine nothing of what the last link carries");
    }
    // As whoever reads it will judge it.
    try {
      static_cast<void>(parse_robot(robot_text(result_.robot), "the identified robot"));
    } catch (const InputError& error) {
      result_.objections.emplace_back(error.what());
    }
  }

  [[nodiscard]] bool payload_shows() const {
    return std::any_of(result_.base.begin(), result_.base.end(),
                       [](const IdentifiedNumber& one) { return one.determined; });
  }

  // No link becomes ten times as heavy. On data that the fit has not seen no joint may lose more
  // than rises() allows.
  void doubt() {
    for (const BeforeAfter& error : result_.held_out) {
      if (!error.rises()) continue;
      result_.doubts.push_back(fmt::format(
          "on data not used for the fit the error of joint {} rises from {:.2f} % to {:.2f} %",
          error.joint + 1, error.before_percent, error.after_percent));
    }
    // Where the file's links are believed; a payload is as heavy as it is.
    if (!file_is_whole() || request_.from_geometry || request_.payload) return;
    for (const std::string& beyond : masses_beyond_belief(file_, result_.robot)) {
      result_.doubts.push_back(
          beyond + ", which --from-geometry does not believe where it is a placeholder");
    }
  }

  void note() {
    for (const std::size_t joint : result_.standing) {
      result_.notes.push_back(fmt::format(
          "joint {} stands in these recordings: its drive was left as it is, and its torque, which "
          "friction may hold, was not read",
          joint + 1));
    }
    const std::string left_out = words_of(fit_->stretches(), logs_);
    if (!left_out.empty()) result_.notes.push_back(left_out);
    if (!request_.payload) {
      note_motors();
      note_rotors();
    }
    if (result_.held_out.empty()) {
      result_.notes.emplace_back("the recordings are too short to hold a part of them out");
    }
    if (request_.payload) note_payload();
    for (const Log& log : logs_) {
      result_.notes.insert(result_.notes.end(), log.remarks.begin(), log.remarks.end());
    }
  }

  [[nodiscard]] bool has_motor_effect(std::size_t joint) const {
    return std::any_of(file_.effects.begin(), file_.effects.end(), [&](const RobotEffect& one) {
      return one.of_motor && acts_on_joint(file_, one, static_cast<Index>(joint));
    });
  }

  void note_motors() {
    std::vector<std::string> joints;
    for (std::size_t joint = 0; joint < file_.joints.size(); ++joint) {
      if (has_motor_effect(joint)) joints.push_back(std::to_string(joint + 1));
    }
    if (joints.empty() || request_.keep) return;
    result_.notes.push_back(fmt::format(
        "effects of the motors of joint {} were left as the file has them", list_of(joints)));
  }

  void note_rotors() {
    std::vector<std::string> joints;
    for (const IdentifiedDrive& drive : result_.drives) {
      const auto& untold = fit_->untold_rotors();
      if (drive.kind != EffectKind::kRotorInertia || !drive.written) continue;
      if (std::find(untold.begin(), untold.end(), drive.joint) == untold.end()) continue;
      joints.push_back(std::to_string(drive.joint + 1));
    }
    if (!joints.empty()) {
      result_.notes.push_back(fmt::format(
          "no motion tells the rotor's inertia of joint {} from the link's about the joint's axis: "
          "with rotors of their own the links are believed within {:.0f} % of their file, and "
          "{:.0f} "
          "% without",
          list_of(joints), 100 * fit_->share(), 100 * share_without_));
    }
    joints.clear();
    for (std::size_t joint = 0; joint < file_.joints.size(); ++joint) {
      const auto& rotors = fit_->base_request().rotors;
      if (!fit_->moves(joint) || request_.keep) continue;
      // Of a sensor behind the gear its remark speaks, and of motors the note before.
      if (logs_.front().of_sensor(joint) || has_motor_effect(joint)) continue;
      if (std::find(rotors.begin(), rotors.end(), joint) != rotors.end()) continue;
      joints.push_back(std::to_string(joint + 1));
    }
    if (joints.empty()) return;
    result_.notes.push_back(
        fmt::format("no motion tells the rotor's inertia of joint {} from the link's about the "
                    "joint's axis: the link has both",
                    list_of(joints)));
  }

  void note_payload() {
    const IdentifiedPayload& payload = *result_.payload;
    std::vector<std::string> open;
    if (!payload.mass.determined) open.emplace_back("its mass");
    for (const IdentifiedNumber& one : payload.place) {
      if (!one.determined) open.push_back("its place along " + one.name);
    }
    if (open.empty()) return;
    std::vector<std::string> told;
    for (const IdentifiedNumber& one : result_.base) {
      if (one.determined) {
        told.push_back(fmt::format("{} ({:+.4g} {})", one.name, one.after - one.before, one.unit));
      }
    }
    result_.notes.push_back(
        fmt::format("these recordings do not tell {} apart from the rest; what they do tell of the "
                    "last link: {}",
                    list_of(open), told.empty() ? "nothing" : list_of(told)));
  }

  const RobotDescription& file_;
  const IdentifyRequest& request_;
  const std::vector<Log>& logs_;
  const std::vector<Log>& holdout_;
  FilterPlan plan_;
  const OnProgress& on_progress_;
  std::unique_ptr<InertialFit> fit_;
  double share_without_ = 0;  // rotors that no motion tells from the links
  Identification result_;
};

}  // namespace

bool has_numbers(const RobotDescription& file, std::size_t link) {
  return std::none_of(file.blanks.begin(), file.blanks.end(),
                      [link](const Blank& blank) { return blank.joint == link; });
}

std::size_t Identification::determined_count() const {
  return static_cast<std::size_t>(std::count_if(
      base.begin(), base.end(), [](const IdentifiedNumber& one) { return one.determined; }));
}

Identification identify(const RobotDescription& robot, const IdentifyRequest& request,
                        const std::vector<Log>& logs, const std::vector<Log>& holdout,
                        const FilterRequest& filter, const OnProgress& on_progress) {
  for (const std::vector<Log>* recordings : {&logs, &holdout}) {
    for (const Log& log : *recordings) refuse_hidden_from_sensors(robot, log);
  }
  return Identifier(robot, request, logs, holdout, filter, on_progress).run();
}

}  // namespace offnominal::desk
