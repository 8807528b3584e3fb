#include "explain/data_fault_report.hpp"

#include <nlohmann/json.hpp>

namespace offnominal::desk {

using nlohmann::ordered_json;

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
    all.push_back(std::move(one));
  }
  return all;
}

std::string line_of(const DataFault& fault) {
  return (fault.file.empty() ? "" : fault.file + ": ") + fault.words + "; to mend: " + fault.mend;
}

void add_faults(const std::vector<DataFault>& faults, report::Page& page) {
  if (faults.empty()) return;
  report::Section section;
  section.heading = "Faults of the recording";
  section.text = "What is below rests on the recording as it is.";
  for (const DataFault& fault : faults) {
    section.blocks.emplace_back(report::Note{line_of(fault), report::Level::kBad});
  }
  page.sections.insert(page.sections.begin(), std::move(section));
}

}  // namespace offnominal::desk
