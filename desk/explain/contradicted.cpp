#include "explain/contradicted.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "explain/remainder.hpp"
#include "identify/physical_range.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kShifted = 0.2;  // of the smaller of both numbers
// A poor motion puts a part of another effect into a number.
constexpr double kShiftedIfPoor = 0.5;
constexpr double kMatters = 0.02;  // of the joint's rms torque
// So much of it that the number is to be mended however near it is.
constexpr double kMattersAnyway = 0.05;
// What is left beside a number and is no noise is of something else, that bends the number as well.
constexpr double kOfWhatIsLeft = 2;  // of its energy
// Friction this many times too large or too small only has to take more than what is left.
constexpr double kNoMeasurement = 3;
constexpr double kOfWhatIsLeftBesideNone = 1;

// Friction of a drive that is so far off was never measured; other numbers are about 0 as often.
bool was_measured(const Shift& one, const RobotDescription& robot) {
  if (!physical_range(robot.effects[one.effect].kind, one.parameter).is_friction) return true;
  return kNoMeasurement * one.came >= one.file && kNoMeasurement * one.file >= one.came;
}

// What one fit says of the file's numbers.
std::vector<Shift> far_off(const Data& data, const RobotDescription& robot, const ModelFit& fit,
                           const std::vector<Excitation>& excitation) {
  std::vector<Shift> shifts;
  const VectorXd torque = data.layout.rms(data.torque);
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    const NuisanceTerm& term = data.nuisance.terms[i];
    if (term.kind != NuisanceTerm::Kind::kKnownEffect) continue;
    // What is said of a joint that stands is what is believed of it.
    const Excitation& motion = excitation[static_cast<std::size_t>(term.joint)];
    if (!motion.moves) continue;
    const auto column = static_cast<Index>(i);
    const RobotEffect& effect = robot.effects[term.effect];
    const double file = effect.parameters[term.parameter];
    const double by = fit.nuisance[column];
    const double rms =
        std::abs(by) * data.layout.rms(data.nuisance.columns.col(column))[term.joint];
    const double smaller = std::min(std::abs(file), std::abs(file + by));
    const double shifted = motion.is_poor() ? kShiftedIfPoor : kShifted;
    const bool far = std::abs(by) > shifted * smaller && rms > kMatters * torque[term.joint];
    const bool large = !motion.is_poor() && rms > kMattersAnyway * torque[term.joint];
    if (!far && !large) continue;
    shifts.push_back({term.joint, term.effect, term.parameter, term.name,
                      file != 0 ? by / file : 1.0, file, file + by,
                      offnominal::unit_of(info_of(effect.kind)->parameters[term.parameter].quantity,
                                          robot.type_of(effect))});
  }
  return shifts;
}

// Held-out errors per joint with the numbers as the file has them and all else fitted.
VectorXd held_out_as_the_file(const SearchSetting& setting, const RobotDescription& robot,
                              const FoundModel& found, const std::vector<Shift>& shifts) {
  NuisanceOptions as_the_file = setting.nuisance;
  const Prior none = Prior::at(0);
  for (const Shift& one : shifts) {
    as_the_file.known.push_back({one.effect, one.parameter, none.low, none.high});
  }
  const Data data(*setting.data, robot, as_the_file);
  std::unique_ptr<Data> apart;
  if (setting.held_out) apart = std::make_unique<Data>(*setting.held_out, robot, as_the_file);
  const Regression regression(data);
  const HoldOut hold_out(regression, apart.get());
  const std::vector<Term> terms = found.terms();
  return hold_out.rms(hold_out.residual(terms, regression.fit(terms)));
}

}  // namespace

std::vector<Shift> contradicted_numbers(const SearchSetting& setting, const RobotDescription& robot,
                                        const FoundModel& found,
                                        const std::vector<Excitation>& excitation,
                                        const std::vector<std::vector<EffectAt>>& classes) {
  std::vector<Shift> shifts = far_off(*setting.data, robot, found.fit, excitation);
  std::erase_if(shifts, [&](const Shift& one) {
    return holds_in_any(classes, {EffectKind::kTorqueScale, one.joint});
  });
  if (shifts.empty()) return shifts;
  const HoldOut& hold_out = *setting.hold_out;
  const VectorXd moved = hold_out.rms(found.held_out_after).array().square();
  const VectorXd noise = noise_floor_of(hold_out.data(), found.held_out_after).array().square();
  const VectorXd as_the_file = held_out_as_the_file(setting, robot, found, shifts).array().square();
  std::erase_if(shifts, [&](const Shift& one) {
    const double taken = as_the_file[one.joint] - moved[one.joint];
    const double left = std::max(moved[one.joint] - noise[one.joint], 0.0);
    const double times = was_measured(one, robot) ? kOfWhatIsLeft : kOfWhatIsLeftBesideNone;
    return !(taken > kRelevantShare * as_the_file[one.joint] && taken > times * left);
  });
  return shifts;
}

bool leave_out_impossible(const std::vector<HeldNumber>& held, std::vector<Shift>& shifts) {
  return std::erase_if(shifts,
                       [&](const Shift& one) { return holds_what_cannot_be(held, one.joint); }) > 0;
}

bool leave_out_undone(const RobotDescription& fitted, std::vector<Shift>& shifts) {
  constexpr double kStays = 0.5;  // of the way from the file to what the search asked for
  return std::erase_if(shifts, [&](const Shift& one) {
           const RobotEffect& effect = fitted.effects[one.effect];
           const PhysicalRange range = physical_range(effect.kind, one.parameter);
           // What cannot be is held at the end of what can.
           const double asked = range.holds(one.came) ? one.came : range.nearest(one.came);
           const double came = effect.parameters[one.parameter];
           return asked == one.file || (came - one.file) / (asked - one.file) < kStays;
         }) > 0;
}

std::vector<std::size_t> refitted_effects(const RobotDescription& file,
                                          const std::vector<Shift>& shifts) {
  const std::vector<std::size_t> fitted = fitted_effects(file);
  std::set<std::size_t> all(fitted.begin(), fitted.end());
  for (const Shift& one : shifts) all.insert(one.effect);
  return {all.begin(), all.end()};
}

}  // namespace offnominal::desk
