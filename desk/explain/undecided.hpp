#pragma once

#include <Eigen/Core>
#include <vector>

#include "explain/excitation.hpp"
#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What could be missing on a joint.
struct UndecidedClass {
  std::vector<EffectAt> effects;  // the most likely one first
  bool or_own_numbers = false;    // or none of them, but the model's own numbers
};

// What could be missing on joints whose recordings show something that they do not tell from the
// model's own numbers, and whose error stands above their noise: per such joint every effect that
// explains a good part of what the best one does, best first, a wave in time only where nothing
// else does; one alone where that or the model's own numbers are all that is possible; the joint
// that stands out most first. Empty where no joint shows anything, or where no effect explains it.
// Joints on which something was found have their answer: `found` is asked of the others.
// `robot`: that the setting was made with. `left_in_the_end`: rms error per joint of the numbers
// that are written: where those leave hardly more than noise, links that are far off the file had
// only looked like something.
std::vector<UndecidedClass> undecided(const SearchSetting& setting, const RobotDescription& robot,
                                      const FoundModel& found,
                                      const std::vector<Excitation>& excitation,
                                      const Eigen::VectorXd& left_in_the_end);

}  // namespace offnominal::desk
