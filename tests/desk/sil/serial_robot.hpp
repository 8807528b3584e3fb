// Robot files of arms with any number of joints.
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>

#include "robot/robot_file.hpp"

namespace offnominal::test {

/// An arm that reaches out along x, each link 0.2 m long and lighter than the one before, with
/// friction and rotors that its file knows.
inline std::string serial_robot_text(int joints) {
  constexpr std::array<const char*, 4> kAxes = {"[0.0, 1.0, 0.0]", "[0.0, 0.0, 1.0]",
                                                "[0.0, 1.0, 0.0]", "[1.0, 0.0, 0.0]"};
  std::string text =
      "format = 1\nname = \"serial\"\nsource = \"made up\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n";
  for (int i = 0; i < joints; ++i) {
    text += fmt::format(
        "[[joint]]\nname = \"joint{}\"\ntype = \"revolute\"\naxis = {}\norigin_m = [{}, 0.0, 0.0]\n"
        "[joint.link]\nmass_kg = {:.2f}\ncentre_of_mass_m = [0.1, 0.0, 0.01]\n"
        "inertia_kg_m2 = {{xx = 0.002, yy = 0.01, zz = 0.01}}\n"
        "[joint.limits]\nposition = [-2.8, 2.8]\nvelocity = 5.0\ntorque = 150.0\n"
        "[joint.control]\nkp_per_s2 = 100.0\nkd_per_s = 20.0\n",
        i + 1, kAxes[static_cast<std::size_t>(i) % kAxes.size()], i == 0 ? "0.0" : "0.2",
        3.0 / (1 + i));
  }
  for (int i = 1; i <= joints; ++i) {
    text += fmt::format(
        "[[effect]]\nkind = \"viscous_friction\"\njoint = {0}\ncoefficient = 0.3\n"
        "[[effect]]\nkind = \"coulomb_friction\"\njoint = {0}\nlevel = 0.4\n"
        "[[effect]]\nkind = \"rotor_inertia\"\njoint = {0}\ninertia = 0.05\n",
        i);
  }
  return text +
         "[estimator]\nperiod_s = 0.001\nhidden_units = 8\ntorque_signal = \"held\"\n"
         "[uncertainty_bound]\nkind = \"constant\"\nvalue = 2.0\n";
}

inline desk::RobotDescription serial_robot(int joints) {
  return desk::parse_robot(serial_robot_text(joints), "serial.toml");
}

/// The same with its monitor in torque space, and of every joint the same bound, N m.
inline std::string by_joint_robot_text(int joints, double bound_nm) {
  std::string text = serial_robot_text(joints);
  text.erase(text.find("[uncertainty_bound]"));
  text += "space = \"torque\"\n[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [";
  for (int i = 0; i < joints; ++i) text += fmt::format("{}{:.3f}", i == 0 ? "" : ", ", bound_nm);
  return text + "]\n";
}

inline desk::RobotDescription by_joint_robot(int joints, double bound_nm) {
  return desk::parse_robot(by_joint_robot_text(joints, bound_nm), "by_joint.toml");
}

/// The same behind ODrives that tell their torque, every second one turning against its joint; a
/// tick and a reading every period_ms.
inline std::string odrive_robot_text(int joints, int period_ms, const std::string& firmware) {
  std::string text = serial_robot_text(joints);
  const std::string period = "period_s = 0.001";
  const std::string wanted = fmt::format("{:.3f}", 1e-3 * period_ms);
  text.replace(text.find(period), period.size(), "period_s = " + wanted);
  std::string nodes;
  std::string turns;
  std::string constants;
  for (int i = 0; i < joints; ++i) {
    nodes += fmt::format("{}{}", i == 0 ? "" : ", ", 60 - 7 * i);
    turns += fmt::format("{}{}", i == 0 ? "" : ", ", i % 2 == 0 ? "0.62832" : "-0.31416");
    constants += fmt::format("{}{}", i == 0 ? "" : ", ", i % 2 == 0 ? "0.04" : "-0.08");
  }
  return text + fmt::format(
                    "[drives]\nprotocol = \"can_simple\"\nfirmware = \"{}\"\n"
                    "encoder_interval_s = {}\ntorque_interval_s = {}\nnode = [{}]\n"
                    "joint_per_turn = [{}]\nmotor_nm_per_ampere = [{}]\n",
                    firmware, wanted, wanted, nodes, turns, constants);
}

inline desk::RobotDescription odrive_robot(int joints, int period_ms, const std::string& firmware) {
  return desk::parse_robot(odrive_robot_text(joints, period_ms, firmware), "odrives.toml");
}

}  // namespace offnominal::test
