#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "desk/support/temporary_folder.hpp"
#include "exchange/export_robot.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// Recordings of arms whose torques are MuJoCo's: a plant that shares no formula with what is
// tested.

namespace offnominal::test {

// What a drive has beside what moves, per joint.
struct PlantDrive {
  double viscous = 0;
  double coulomb = 0;
  double rotor = 0;
  double offset = 0;
};

struct PlantMotion {
  double duration_s = 20;
  double rate_hz = 500;
  double amplitude = 1;
  double torque_noise = 0.1;
  std::uint64_t seed = 1;
  std::vector<std::size_t> standing = {};  // joints that do not move
};

class MujocoPlant {
 public:
  MujocoPlant(desk::RobotDescription robot, std::vector<PlantDrive> drives)
      : drives_(std::move(drives)), model_(nullptr, mj_deleteModel), data_(nullptr, mj_deleteData) {
    robot.effects.clear();
    const TemporaryFolder folder;
    put(folder / "robot.xml", desk::exchange::export_mjcf(robot, "robot.toml").text);
    char error[1000] = "";
    model_.reset(mj_loadXML((folder / "robot.xml").c_str(), nullptr, error, sizeof error));
    if (model_ == nullptr) throw std::runtime_error(error);
    model_->opt.disableflags |= mjDSBL_FRICTIONLOSS | mjDSBL_LIMIT | mjDSBL_CONTACT;
    data_.reset(mj_makeData(model_.get()));
  }

  // Torque that the motion takes, drives aside.
  [[nodiscard]] Eigen::VectorXd rigid(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                      const Eigen::VectorXd& ddq) {
    std::copy(q.begin(), q.end(), data_->qpos);
    std::copy(dq.begin(), dq.end(), data_->qvel);
    std::copy(ddq.begin(), ddq.end(), data_->qacc);
    mj_inverse(model_.get(), data_.get());
    return Eigen::Map<const Eigen::VectorXd>(data_->qfrc_inverse, model_->nv);
  }

  // Every joint moves in five sines of its own.
  [[nodiscard]] desk::Log record(const PlantMotion& motion) {
    const auto samples = static_cast<Eigen::Index>(motion.duration_s * motion.rate_hz) + 1;
    const auto joints = static_cast<Eigen::Index>(model_->nv);
    constexpr std::array<std::pair<double, double>, 5> kWaves{
        {{0.9, 0.11}, {0.5, 0.31}, {0.3, 0.47}, {0.25, 0.73}, {0.08, 1.7}}};
    std::mt19937_64 generator(motion.seed);
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    std::normal_distribution<double> noise(0, motion.torque_noise);
    desk::Log log;
    log.file = "mujoco arm";
    log.period_s = 1 / motion.rate_hz;
    log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, motion.duration_s);
    log.q = Eigen::MatrixXd::Zero(samples, joints);
    log.dq = log.q;
    log.tau = log.q;
    Eigen::MatrixXd ddq = log.q;
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      const bool stands = std::find(motion.standing.begin(), motion.standing.end(),
                                    static_cast<std::size_t>(joint)) != motion.standing.end();
      for (const auto& [size, frequency_hz] : kWaves) {
        const double w =
            2 * std::numbers::pi * frequency_hz * (1 + 0.07 * static_cast<double>(joint));
        const double begin = phase(generator);
        if (stands) continue;
        const double a = motion.amplitude * size;
        const Eigen::ArrayXd angle = w * log.t_s.array() + begin;
        log.q.col(joint).array() += a * angle.sin();
        log.dq.col(joint).array() += a * w * angle.cos();
        ddq.col(joint).array() -= a * w * w * angle.sin();
      }
    }
    for (Eigen::Index i = 0; i < samples; ++i) {
      const Eigen::VectorXd dq = log.dq.row(i).transpose();
      Eigen::VectorXd torque = rigid(log.q.row(i).transpose(), dq, ddq.row(i).transpose());
      for (Eigen::Index joint = 0; joint < joints; ++joint) {
        const PlantDrive& drive = drives_[static_cast<std::size_t>(joint)];
        constexpr double kWidth = 0.005;
        torque[joint] += drive.viscous * dq[joint] + drive.coulomb * std::tanh(dq[joint] / kWidth) +
                         drive.rotor * ddq(i, joint) + drive.offset + noise(generator);
      }
      log.tau.row(i) = torque.transpose();
    }
    log.dq_derived.assign(static_cast<std::size_t>(joints), false);
    return log;
  }

 private:
  std::vector<PlantDrive> drives_;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_;
};

// Revolute joints about z and y in turn; bodies with extent, off their axes. No effects.
inline desk::RobotDescription plain_arm(std::size_t joints) {
  desk::RobotDescription robot;
  robot.name = "plain arm";
  for (std::size_t i = 0; i < joints; ++i) {
    const double size = 1 / (1 + 0.3 * static_cast<double>(i));
    desk::RobotJoint one;
    one.name = "joint " + std::to_string(i + 1);
    if (i % 2 == 1) one.joint.axis = {0, 1, 0};
    if (i > 0) one.joint.origin_m = {0.3 * size, 0.02, 0.1};
    one.joint.mass_kg = 4 * size;
    one.joint.centre_of_mass_m = {0.12 * size, 0.02, 0.03};
    one.joint.inertia_kg_m2 = {0.02 * size, 0.025 * size, 0.03 * size, 0.002 * size, 0, -0.001};
    robot.joints.push_back(one);
  }
  return robot;
}

// Drives that differ from joint to joint.
inline std::vector<PlantDrive> plain_drives(std::size_t joints) {
  std::vector<PlantDrive> drives;
  for (std::size_t i = 0; i < joints; ++i) {
    const double size = 1 / (1 + 0.3 * static_cast<double>(i));
    drives.push_back({0.8 * size, 0.6 * size, i > 1 ? 0.05 * size : 0, 0.05 * size});
  }
  return drives;
}

// The same arm as a drawing has it that is off by so much: masses, extents, places.
inline desk::RobotDescription with_poor_cad(desk::RobotDescription robot, double share,
                                            std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> off(-share, share);
  for (desk::RobotJoint& one : robot.joints) {
    const double heavier = 1 + off(generator);
    one.joint.mass_kg *= heavier;
    for (double& inertia : one.joint.inertia_kg_m2) inertia *= heavier;
    for (double& place : one.joint.centre_of_mass_m) place += 0.1 * off(generator);
  }
  return robot;
}

}  // namespace offnominal::test
