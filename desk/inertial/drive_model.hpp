#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identify/data.hpp"
#include "identify/regression.hpp"
#include "inertial/consistent_fit.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The standard drive: what every one has beside what moves.
inline constexpr std::array<EffectKind, 4> kStandardDrive{
    EffectKind::kViscousFriction, EffectKind::kCoulombFriction, EffectKind::kRotorInertia,
    EffectKind::kTorqueOffset};

// What is fitted of the drives: effects of the file, and those that the file lacks.
struct DriveModel {
  std::vector<std::size_t> refitted;  // effects of the file, as indices
  struct NewEffect {
    EffectKind kind;
    std::size_t joint = 0;
  };
  std::vector<NewEffect> added;
};

struct DriveRequest {
  std::vector<char> moves;          // per joint; the drive of one that stands is left alone
  std::vector<std::size_t> rotors;  // joints whose rotor is no part of a link
  bool keep = false;                // effects of the file stay as they are
  // Per joint: its torque is that of a sensor behind the gear; empty: of none.
  std::vector<char> of_sensor = {};
  bool payload = false;  // a recording has one: it takes the room of an effect

  // Whether the recordings can show such an effect of a joint.
  [[nodiscard]] bool shows(EffectKind kind, std::size_t joint) const {
    const bool hidden = joint < of_sensor.size() && of_sensor[joint] != 0;
    return !hidden || !info_of(kind)->traits.is_before_sensor;
  }
};

DriveModel drive_model(const RobotDescription& file, const DriveRequest& request);

// The new effects as terms; what they point into lives as long as the program.
std::vector<Term> terms_of(const DriveModel& drives, const Data& data);

// The linear numbers of a regression's design, with what is believed of them: friction takes energy
// out, a rotor's inertia is not far above what all of the joint's torque would turn, an offset not
// far above a tenth of the torque.
void add_linear_numbers(const RobotDescription& file, const Data& data,
                        const Regression::Design& design, const std::vector<Term>& terms,
                        ConsistentModel& model);

}  // namespace offnominal::desk
