#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "explain/data_fault.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What the doctor found, the same in the answers of every verb. Joints count from 1.
nlohmann::ordered_json to_json(const std::vector<DataFault>& faults);

// One line: "a.csv: the positions of joint 1 are in degrees: ...; to mend: ...".
std::string line_of(const DataFault& fault);

// Of one whose stretches are left out: "a.csv: the torque of joint 2 is stuck ...; of joint 2".
std::string left_out_line(const DataFault& fault);

// Those whose stretches are left out, a row for each stretch: file, joint, rows, time and reason.
report::Table table_of_left_out(const std::vector<DataFault>& faults);

// Puts them on top of a page; nothing where there are none.
void add_faults(const std::vector<DataFault>& faults, report::Page& page);

}  // namespace offnominal::desk
