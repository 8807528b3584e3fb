#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "identify/add.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// What add() fits.
struct AddSetup {
  struct NewEffect {
    std::unique_ptr<EffectCandidate> effect;
    // Values of the struct's parameters that are given, as --set says them.
    std::vector<std::optional<double>> given;
  };
  std::vector<NewEffect> added;
  std::vector<std::size_t> refitted;  // effects of the robot that are fitted again
};

// Throws InputError as add().
AddSetup set_up(const RobotDescription& robot, const AddRequest& request);

// The new effects as terms, their shapes still to be fitted.
std::vector<Term> terms_of(const AddSetup& setup, std::size_t joint, const Data& data);

// The parameter of the struct that a coefficient of the search is of.
std::size_t parameter_of_coefficient(const EffectCandidate& effect, std::size_t coefficient);

// Width of the smoothed sign per joint, where --set gives it; else 0.
Eigen::VectorXd given_widths(const AddSetup& setup, std::size_t joint, int joint_count);

}  // namespace offnominal::desk
