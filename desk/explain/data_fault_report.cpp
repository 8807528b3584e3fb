#include "explain/data_fault_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace offnominal::desk {

using nlohmann::ordered_json;

namespace {

const char* name_of(FaultySignal signal) {
  switch (signal) {
    case FaultySignal::kPosition:
      return "position";
    case FaultySignal::kTorque:
      return "torque";
    default:
      return "all";
  }
}

std::string joints_of(const std::vector<Eigen::Index>& joints) {
  std::string words;
  for (const Eigen::Index joint : joints) {
    words += fmt::format("{}{}", words.empty() ? "" : ", ", joint + 1);
  }
  return words;
}

}  // namespace

ordered_json to_json(const std::vector<DataFault>& faults) {
  ordered_json all = ordered_json::array();
  for (const DataFault& fault : faults) {
    ordered_json one{{"fault", name_of(fault.kind)}, {"file", fault.file}, {"joint", nullptr}};
    if (fault.joint >= 0) one["joint"] = fault.joint + 1;
    one["at_s"] = fault.at_s ? ordered_json(*fault.at_s) : ordered_json(nullptr);
    one["size"] = fault.size;
    one["unit"] = fault.unit;
    one["words"] = fault.words;
    one["mend"] = fault.mend;
    one["channels"] = fault.channels;
    one["signal"] = name_of(fault.signal);
    one["left_out_of_joints"] = ordered_json::array();
    for (const Eigen::Index joint : fault.left_out_of)
      one["left_out_of_joints"].push_back(joint + 1);
    one["kept"] = fault.overruled;
    one["stretches"] = ordered_json::array();
    for (const FaultSpan& span : fault.spans) {
      one["stretches"].push_back({{"first_row", span.first_row},
                                  {"last_row", span.last_row},
                                  {"from_s", span.from_s},
                                  {"to_s", span.to_s}});
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::string line_of(const DataFault& fault) {
  return (fault.file.empty() ? "" : fault.file + ": ") + fault.words + "; to mend: " + fault.mend;
}

std::string left_out_line(const DataFault& fault) {
  return fmt::format("{}{}; not used of joint{} {}", fault.file.empty() ? "" : fault.file + ": ",
                     fault.words, fault.left_out_of.size() == 1 ? "" : "s",
                     joints_of(fault.left_out_of));
}

report::Table table_of_left_out(const std::vector<DataFault>& faults) {
  constexpr std::size_t kMostOfOne = 20;
  report::Table table;
  table.caption = "Left out";
  table.columns = {
      {"recording", "", ".4g"}, {"joint", "", ".4g"},   {"signal", "", ".4g"},
      {"reason", "", ".4g"},    {"first row", "", "d"}, {"last row", "", "d"},
      {"from", "s", ".6g"},     {"to", "s", ".6g"},     {"not used of joints", "", ".4g"}};
  std::size_t more = 0;
  for (const DataFault& fault : faults) {
    if (fault.left_out_of.empty()) continue;
    const std::string joint = fault.joint < 0 ? "all" : std::to_string(fault.joint + 1);
    for (std::size_t i = 0; i < std::min(kMostOfOne, fault.spans.size()); ++i) {
      const FaultSpan& span = fault.spans[i];
      table.rows.push_back({fault.file, joint, std::string(name_of(fault.signal)),
                            std::string(name_of(fault.kind)), static_cast<double>(span.first_row),
                            static_cast<double>(span.last_row), span.from_s, span.to_s,
                            joints_of(fault.left_out_of)});
    }
    more += fault.spans.size() - std::min(kMostOfOne, fault.spans.size());
  }
  table.note =
      "Rows count from 1 behind the header. What a filter spreads of them on either side is "
      "left out with them; --keep JOINT:REASON uses them all the same.";
  if (more > 0) table.note += fmt::format(" {} more stretches are in the answer of --json.", more);
  return table;
}

void add_faults(const std::vector<DataFault>& faults, report::Page& page) {
  if (faults.empty()) return;
  report::Section section;
  section.heading = "Faults of the recording";
  section.text = "What is below rests on the recording as it is, but for what was left out.";
  if (std::any_of(faults.begin(), faults.end(),
                  [](const DataFault& fault) { return !fault.left_out_of.empty(); })) {
    section.blocks.emplace_back(table_of_left_out(faults));
  }
  for (const DataFault& fault : faults) {
    if (!fault.left_out_of.empty()) continue;
    section.blocks.emplace_back(report::Note{line_of(fault), report::Level::kBad});
  }
  page.sections.insert(page.sections.begin(), std::move(section));
}

}  // namespace offnominal::desk
