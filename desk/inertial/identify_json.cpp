#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/compare_report.hpp"
#include "inertial/identify_report.hpp"

namespace offnominal::desk {
namespace {

using nlohmann::ordered_json;

ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json number_json(const IdentifiedNumber& number) {
  ordered_json json{{"name", number.name},
                    {"unit", number.unit},
                    {"before", number_or_null(number.before)},
                    {"value", number_or_null(number.after)},
                    {"ci95", nullptr},
                    {"determined", number.determined}};
  if (number.ci95) {
    json["ci95"] = {(*number.ci95)[0], (*number.ci95)[1]};
  } else {
    json["why_no_ci95"] = number.why_no_interval;
  }
  return json;
}

ordered_json body_json(const IdentifiedNumber& mass, const std::array<IdentifiedNumber, 3>& place,
                       const char* name) {
  ordered_json json{{"mass", number_json(mass)}, {name, ordered_json::array()}};
  for (const IdentifiedNumber& one : place) json[name].push_back(number_json(one));
  return json;
}

ordered_json error_json(double relative_percent, double rms) {
  return {{"relative_error_percent", number_or_null(relative_percent)},
          {"rms_error", number_or_null(rms)}};
}

const BeforeAfter* of_joint(const std::vector<BeforeAfter>& all, std::size_t joint) {
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const BeforeAfter& one) { return one.joint == joint; });
  return at == all.end() ? nullptr : &*at;
}

ordered_json joints_json(const Identification& result) {
  ordered_json joints = ordered_json::array();
  for (const BeforeAfter& fitted : result.fitted) {
    const BeforeAfter* held_out = of_joint(result.held_out, fitted.joint);
    const auto& standing = result.standing;
    const bool moves = std::find(standing.begin(), standing.end(), fitted.joint) == standing.end();
    ordered_json before{{"fit", error_json(fitted.before_percent, fitted.before_rms)},
                        {"holdout", nullptr}};
    ordered_json after{{"fit", error_json(fitted.after_percent, fitted.after_rms)},
                       {"holdout", nullptr}};
    if (held_out != nullptr) {
      before["holdout"] = error_json(held_out->before_percent, held_out->before_rms);
      after["holdout"] = error_json(held_out->after_percent, held_out->after_rms);
    }
    joints.push_back({{"joint", fitted.joint + 1},
                      {"unit", fitted.unit},
                      {"moves", moves},
                      {"before", before},
                      {"after", after}});
  }
  return joints;
}

ordered_json links_json(const Identification& result) {
  ordered_json links = ordered_json::array();
  for (const IdentifiedLink& link : result.links) {
    ordered_json json{{"link", link.link + 1}};
    json.update(body_json(link.mass, link.centre, "centre_of_mass"));
    const auto& [xx, yy, zz, xy, xz, yz] = result.robot.joints[link.link].joint.inertia_kg_m2;
    json["inertia_kg_m2"] = {{"xx", xx}, {"yy", yy}, {"zz", zz},
                             {"xy", xy}, {"xz", xz}, {"yz", yz}};
    links.push_back(std::move(json));
  }
  return links;
}

ordered_json drives_json(const Identification& result) {
  ordered_json drives = ordered_json::array();
  for (const IdentifiedDrive& drive : result.drives) {
    ordered_json json{{"joint", drive.joint + 1}, {"effect", info_of(drive.kind)->name}};
    json.update(number_json(drive.number));
    json["written"] = drive.written;
    drives.push_back(std::move(json));
  }
  return drives;
}

}  // namespace

ordered_json to_json(const Identification& result, const IdentifyNames& names) {
  ordered_json json{{"robot", names.robot_file}, {"logs", names.logs}};
  json["holdout"] = {{"kind", result.cross_validated ? "parts" : "recordings"},
                     {"logs", names.holdout}};
  json["joints"] = joints_json(result);
  json["links"] = links_json(result);
  json["drives"] = drives_json(result);
  json["base_parameters"] = ordered_json::array();
  for (const IdentifiedNumber& one : result.base) {
    json["base_parameters"].push_back(number_json(one));
  }
  json["determined"] = result.determined_count();
  json["condition_number"] = number_or_null(result.condition);
  json["link_share"] = result.share;
  json["payload"] = nullptr;
  if (result.payload) {
    json["payload"] = body_json(result.payload->mass, result.payload->place, "place");
  }
  json["standing"] = ordered_json::array();
  for (const std::size_t joint : result.standing) json["standing"].push_back(joint + 1);
  json["notes"] = result.notes;
  json["objections"] = result.objections;
  json["doubts"] = result.doubts;
  const bool written = !names.output_file.empty() && result.may_be_written(names.force);
  json["written"] = written ? ordered_json(names.output_file) : ordered_json();
  json["filter"] = to_json(result.after.plan);
  json["verdict"] = verdict_of(result, names);
  return json;
}

}  // namespace offnominal::desk
