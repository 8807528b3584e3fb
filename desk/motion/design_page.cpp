#include <fmt/format.h>

#include "motion/design_report.hpp"
#include "report/numbers.hpp"

namespace offnominal::desk::motion {
namespace {

using namespace report;  // a page is written in its own words

Chart joint_chart(std::size_t joint, const std::string& what, const std::string& unit,
                  const Eigen::VectorXd& t_s, const Eigen::VectorXd& values, double low,
                  double high) {
  Chart chart;
  chart.title = fmt::format("Joint {}: {}", joint + 1, what);
  chart.x = {.name = "time", .unit = "s"};
  chart.y = {{.name = what, .unit = unit}};
  chart.series = {{.name = what, .x = numbers(t_s), .y = numbers(values), .tone = Tone::kModel}};
  chart.levels = {{low, "allowed"}, {high, "allowed"}};
  chart.zoom_group = "time";
  return chart;
}

Section joint_section(const RobotDescription& robot, const Design& design, std::size_t joint) {
  const auto j = static_cast<Eigen::Index>(joint);
  const Motion& motion = design.fitted.motion;
  const JointUse use = use_of(robot, design, joint);
  const JointLimits& limits = design.limits[joint];
  Section section{.heading = fmt::format("Joint {}", joint + 1), .text = "", .blocks = {}};
  section.blocks.emplace_back(joint_chart(joint, "position", use.position_unit, motion.t_s,
                                          motion.q.col(j), limits.low, limits.high));
  section.blocks.emplace_back(joint_chart(joint, "velocity", use.velocity_unit, motion.t_s,
                                          motion.dq.col(j), -limits.velocity, limits.velocity));
  section.blocks.emplace_back(joint_chart(joint, "torque of the model", use.torque_unit, motion.t_s,
                                          design.fitted.torque.col(j), -limits.torque,
                                          limits.torque));
  return section;
}

Table pair_table(const RobotDescription& robot, const Design& design) {
  Table table;
  table.caption = "What a recording of this motion is expected to tell apart";
  table.columns = {{"if it is", "", ""}, {"against", "", ""},       {"sine before", "1"},
                   {"sine after", "1"},  {"difference before", ""}, {"difference after", ""},
                   {"noise", ""},        {"unit", "", ""},          {"evidence", "1", ".1f"}};
  for (Column& column : table.columns) {
    if (column.format.empty()) column.format = kDefaultFormat;
  }
  for (const PairReport& pair : design.pairs) {
    const auto before = [&](double Separation::*part) {
      return pair.before ? Cell((*pair.before).*part) : Cell();
    };
    table.rows.push_back(
        {text_of(pair.truth), pair.rival ? text_of(*pair.rival) : "adapting numbers alone",
         before(&Separation::sine), pair.after.sine, before(&Separation::torque_rms),
         pair.after.torque_rms, pair.after.noise_rms,
         std::string(unit_of(Quantity::kEffort,
                             robot.joints[static_cast<std::size_t>(pair.truth.joint)].joint.type)),
         pair.after.evidence});
  }
  table.note =
      "Sine of the angle between the two torques, both without what every model may adapt: the "
      "worst shape of the true effect against the best of the other. Difference: rms torque on "
      "the true effect's joint that the other cannot explain. Evidence: standard deviations by "
      "which the true effect is expected to fit better; explain asks for 3.";
  return table;
}

}  // namespace

Page page_of(const RobotDescription& robot, const Design& design, const DesignNames& names) {
  Page page;
  page.title = "Motion for " + robot.name;
  page.subtitle =
      fmt::format("{} motions tried, seed {}", design.motions_tried, design.request.seed);
  const PairReport* worst = design.worst();
  const bool good = worst != nullptr && worst->after.evidence >= 3;
  page.verdict = {sentence_of(robot, design, names), good ? Level::kGood : Level::kWarn};
  page.command_line = names.command_line;
  Section separation{.heading = "Separation", .text = "", .blocks = {}};
  separation.blocks.emplace_back(pair_table(robot, design));
  page.sections.push_back(std::move(separation));
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    page.sections.push_back(joint_section(robot, design, j));
  }
  return page;
}

}  // namespace offnominal::desk::motion
