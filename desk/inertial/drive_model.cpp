#include "inertial/drive_model.hpp"

#include <algorithm>
#include <cmath>

#include "compare/inverse_model.hpp"
#include "identify/add_setup.hpp"
#include "identify/physical_range.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

bool is_standard(EffectKind kind) {
  return std::find(kStandardDrive.begin(), kStandardDrive.end(), kind) != kStandardDrive.end();
}

// Carried masses are numbers of the links, and what scales the drive's torque is no torque.
// What the file says of a motor stays: the standard drive is of joints.
bool may_be_refitted(const RobotEffect& effect) {
  if (effect.of_motor) return false;
  if (is_path_effect(effect.kind)) return false;
  if (info_of(effect.kind)->action == EffectAction::kPointMass) return false;
  return is_standard(effect.kind) || effect.fitted;
}

bool has_effect(const RobotDescription& robot, EffectKind kind, std::size_t joint) {
  return std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& one) {
    return one.kind == kind && acts_on_joint(robot, one, static_cast<Index>(joint));
  });
}

// The candidate of every kind of effect, once.
const EffectCandidate* shared_candidate(EffectKind kind) {
  for (const auto& one : all_candidates()) {
    if (one->kind() == kind) return one.get();
  }
  return nullptr;
}

// What 1 rad/s^2 or m/s^2 of a joint asks of it, on average.
double mean_inertia(const Data& data, Index joint) {
  double sum = 0;
  double samples = 0;
  for (const Workspace& at : data.recordings) {
    const MatrixXd& mass = at.mass[static_cast<std::size_t>(joint)];
    sum += mass.col(joint).sum();
    samples += static_cast<double>(mass.rows());
  }
  return samples > 0 ? sum / samples : 0;
}

// The inertia to which the joint's torque would be due if it were due to nothing else. A rotor
// behind a gear of a hundred turns a wrist's link along with it: what the joint turns says little.
double inertia_of_all_torque(const Data& data, Index joint) {
  double squares = 0;
  double samples = 0;
  for (const Workspace& at : data.recordings) {
    squares += at.motion.ddq.col(joint).squaredNorm();
    samples += static_cast<double>(at.sample_count());
  }
  if (!(squares > 0)) return 0;
  return data.layout.rms(data.torque)[joint] / std::sqrt(squares / samples);
}

// `start`: what the number is counted from.
Prior believed(const Data& data, EffectKind kind, std::size_t parameter, Index joint,
               double start) {
  constexpr double kOffsetShare = 0.1;
  const PhysicalRange range = physical_range(kind, parameter);
  Prior prior;
  if (range.min > -effects::kAny) prior.low = range.min - start;
  if (range.max < effects::kAny) prior.high = range.max - start;
  if (kind == EffectKind::kRotorInertia) {
    const double inertia = std::max(mean_inertia(data, joint), inertia_of_all_torque(data, joint));
    if (inertia > 0) prior.deviation = std::max(inertia, std::abs(start));
  }
  if (kind == EffectKind::kTorqueOffset) {
    const double torque = kOffsetShare * data.layout.rms(data.torque)[joint];
    if (torque > 0) prior.deviation = std::max(torque, std::abs(start));
  }
  return prior;
}

}  // namespace

DriveModel drive_model(const RobotDescription& file, const DriveRequest& request) {
  DriveModel drives;
  for (std::size_t i = 0; i < file.effects.size() && !request.keep; ++i) {
    const RobotEffect& effect = file.effects[i];
    if (may_be_refitted(effect) && request.moves[effect.joint] != 0) drives.refitted.push_back(i);
  }
  const std::size_t room =
      static_cast<std::size_t>(kEffectsPerJoint) * file.joints.size() - (request.payload ? 1 : 0);
  for (std::size_t joint = 0; joint < file.joints.size(); ++joint) {
    if (request.moves[joint] == 0) continue;
    for (const EffectKind kind : kStandardDrive) {
      if (has_effect(file, kind, joint) || !request.shows(kind, joint)) continue;
      const auto& rotors = request.rotors;
      const bool is_rotor = kind == EffectKind::kRotorInertia;
      if (is_rotor && std::find(rotors.begin(), rotors.end(), joint) == rotors.end()) continue;
      if (file.effects.size() + drives.added.size() >= room) continue;
      drives.added.push_back({kind, joint});
    }
  }
  return drives;
}

std::vector<Term> terms_of(const DriveModel& drives, const Data& data) {
  std::vector<Term> terms;
  for (const DriveModel::NewEffect& one : drives.added) {
    const auto joint = static_cast<Index>(one.joint);
    const EffectCandidate* effect = shared_candidate(one.kind);
    Term term{effect, joint, {}, effect->shapes(data.recordings, joint), {}};
    for (ShapeRange& range : term.ranges) {
      range.kind = ShapeRange::Kind::kDiscrete;
      range.grid = {data.recordings[0].sign_width[joint]};
      term.shape.push_back(range.grid[0]);
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

void add_linear_numbers(const RobotDescription& file, const Data& data,
                        const Regression::Design& design, const std::vector<Term>& terms,
                        ConsistentModel& model) {
  for (std::size_t i = 0; i < design.kept.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[static_cast<std::size_t>(design.kept[i])];
    model.linear.push_back(static_cast<Index>(i));
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) {
      model.priors.push_back(design.priors[i]);
      continue;
    }
    const RobotEffect& effect = file.effects[term.effect];
    model.priors.push_back(
        believed(data, effect.kind, term.parameter, term.joint, effect.parameters[term.parameter]));
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (Index column = design.first[i]; column < design.first[i + 1]; ++column) {
      const std::size_t parameter = parameter_of_coefficient(
          *terms[i].effect, static_cast<std::size_t>(column - design.first[i]));
      model.linear.push_back(column);
      model.priors.push_back(believed(data, terms[i].effect->kind(), parameter, terms[i].joint, 0));
    }
  }
}

}  // namespace offnominal::desk
