#pragma once

#include <Eigen/Core>
#include <memory>

#include "compare/body_torque.hpp"
#include "compare/filter_plan.hpp"
#include "compare/motion.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A recording made ready for comparison and regression: everything that does not depend on the
// model's torque is filtered once.
struct Measurement {
  std::shared_ptr<const Log> log;
  FilterPlan plan;
  Motion motion;                  // full rate
  Eigen::VectorXd t_s;            // of the samples that are kept
  Eigen::MatrixXd torque;         // filtered; rows: kept samples, columns: joints
  Eigen::MatrixXd sensor_torque;  // the same of log.sensor_tau
  // Kept samples: 1, or 0 where the joint stands still and friction may hold it (standstill.hpp),
  // or where the recording is at fault (usable.hpp).
  Eigen::MatrixXd moving;
  Eigen::VectorXd at_fault;  // per joint: share of the kept samples in which the recording is, 0..1
};

// Throws InputError where a recording has another number of joints than the robot.
void require_joints(const Log& log, const RobotDescription& robot);

// A recording that somebody else holds for as long as any measurement of it.
std::shared_ptr<const Log> held_elsewhere(const Log& log);

// `plan`: of plan_filter() for this recording and those that it is analysed with. Throws InputError
// as plan_for(), and where the robot has another number of joints.
Measurement measure(std::shared_ptr<const Log> log, const RobotDescription& robot,
                    const FilterPlan& plan);
Measurement measure(Log log, const RobotDescription& robot, const FilterPlan& plan);
// With the plan of this recording alone.
Measurement measure(Log log, const RobotDescription& robot, const FilterRequest& request = {});

// model_torque() of a robot with the recording's payload and its transmission_torque(), without
// what the recording's torque sensors do not see, filtered as the measured torque is.
Eigen::MatrixXd filtered_model_torque(const RobotDescription& robot, const Measurement& measured);

// What is kept of a recording's model torque for the next robot: what both have in common.
class ModelTorqueMemory {
 public:
  // The same, to the bit; `measured`: the same at every call.
  Eigen::MatrixXd filtered(const RobotDescription& robot, const Measurement& measured);

 private:
  BodyTorque bodies_;
  Eigen::MatrixXd torque_;    // of the last robot
  Eigen::MatrixXd filtered_;  // the same, filtered
};

}  // namespace offnominal::desk
