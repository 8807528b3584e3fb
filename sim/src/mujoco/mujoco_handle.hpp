// MuJoCo's own types, for the sources of its plant alone.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <memory>

#include "offnominal/sim/plants/mujoco_plant.hpp"

namespace offnominal::sim {

struct MujocoFree {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModelPointer = std::unique_ptr<mjModel, MujocoFree>;
using MujocoDataPointer = std::unique_ptr<mjData, MujocoFree>;

// A body in its own frame: kg, m, kg m^2 about the centre of mass.
struct MujocoInertial {
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
};

struct MujocoModel::Handle {
  MujocoModelPointer model;
};

}  // namespace offnominal::sim
