#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "identify/data.hpp"

namespace offnominal::desk {

// Root mean square of the noise per joint, N m or N: the density of the residual in the upper part
// of the filter's band, taken for white over the whole of it. Of hold maps: by how much two
// readings in a row differ, over root 2.
Eigen::VectorXd noise_floor_of(const Data& data, const Eigen::VectorXd& residual);

// How much of the residual of a joint follows a variable, judged on time that the smooth fit to it
// has not seen.
struct StructureShare {
  Eigen::Index joint = 0;
  std::string variable;  // "position", "velocity", "load", "position and velocity", "time"
  double share = 0;      // of the residual's energy, 0 to 1
};
// As above; empty for none.
const char* name_of(EffectVariable variable);
// Of one joint and variable; 0 where there is none.
double share_of(const std::vector<StructureShare>& shares, Eigen::Index joint,
                std::string_view variable);
std::vector<StructureShare> structure_of(const Data& data, const Eigen::VectorXd& residual);

// Mean of a joint's residual over equally filled bins of one of the variables "position",
// "velocity" and "load".
struct MapOver {
  std::vector<double> at, mean;
};
MapOver map_over(const Data& data, const Eigen::VectorXd& residual, Eigen::Index joint,
                 const std::string& variable);

// One column per bin of such a variable, stacked: 1 where the joint is in it, 0 elsewhere.
Eigen::MatrixXd bins_over(const Data& data, Eigen::Index joint, const std::string& variable);

// Where in time the energy of a joint's residual is concentrated: half-second windows, next to each
// other as one, of the loudest tenth and more than four times the median.
struct LoudWindow {
  std::size_t recording = 0;
  double from_s = 0;
  double to_s = 0;
};
std::vector<LoudWindow> loud_windows(const Data& data, const Eigen::VectorXd& residual,
                                     Eigen::Index joint);

}  // namespace offnominal::desk
