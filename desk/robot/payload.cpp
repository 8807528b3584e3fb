#include "robot/payload.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/number.hpp"
#include "robot/payload_check.hpp"

namespace offnominal::desk {
namespace {

bool is_same(const Payload& a, const Payload& b) {
  return a.mass_kg == b.mass_kg && a.place_m == b.place_m;
}

// Not of a number that is none.
bool can_be_carried(const Payload& payload) {
  return payload.mass_kg >= 0 && payload.mass_kg <= kMostPayloadKg &&
         std::all_of(payload.place_m.begin(), payload.place_m.end(),
                     [](double at) { return std::abs(at) <= kFurthestPayloadM; });
}

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || rest != end || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

RobotDescription carrying(RobotDescription robot, const std::optional<Payload>& payload) {
  if (!payload) return robot;
  const std::size_t most = kEffectsPerJoint * robot.joints.size();
  if (robot.effects.size() >= most) {
    throw InputError(
        {"robot " + robot.name, "effect",
         fmt::format("{} effects beside a payload of {}", robot.effects.size(), words_of(*payload)),
         fmt::format("at most {} where a recording has a payload", most - 1),
         "leave one of the effects out of a copy of the robot file for it"});
  }
  RobotEffect effect;
  effect.kind = EffectKind::kTipPayload;
  effect.joint = static_cast<std::uint8_t>(robot.joints.size() - 1);
  effect.parameters = {payload->mass_kg, payload->place_m[0], payload->place_m[1],
                       payload->place_m[2]};
  robot.effects.push_back(effect);
  return robot;
}

bool is_of(const RecordingPayload& payload, const std::string& recording) {
  if (payload.recording == recording) return true;
  const auto files = recording_files(recording);
  return std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& file) {
    return payload.recording == file.string() || payload.recording == file.filename().string();
  });
}

std::optional<Payload> payload_of(const std::vector<RecordingPayload>& payloads,
                                  const std::string& recording) {
  std::optional<Payload> found;
  for (const RecordingPayload& one : payloads) {
    if (!is_of(one, recording)) continue;
    if (found && !is_same(*found, one.payload)) {
      throw InputError({recording, "",
                        "two payloads: " + words_of(*found) + ", and " + words_of(one.payload),
                        "one payload per recording",
                        "where two recordings have one name, name them with their folders"});
    }
    found = one.payload;
  }
  return found;
}

std::optional<RecordingPayload> payload_of_text(std::string_view text) {
  // A file's name may hold either sign.
  const std::size_t at = text.rfind('@');
  const std::size_t equals = text.substr(0, at).rfind('=');
  if (at == std::string_view::npos || equals == std::string_view::npos || equals == 0) {
    return std::nullopt;
  }
  RecordingPayload payload{std::string(text.substr(0, equals)), {}};
  const auto mass = number_of(text.substr(equals + 1, at - equals - 1));
  if (!mass) return std::nullopt;
  payload.payload.mass_kg = *mass;
  std::string_view rest = text.substr(at + 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (i == 2)) return std::nullopt;
    const auto place = number_of(rest.substr(0, comma));
    if (!place) return std::nullopt;
    payload.payload.place_m[i] = *place;
    if (i < 2) rest.remove_prefix(comma + 1);
  }
  if (!can_be_carried(payload.payload)) return std::nullopt;
  return payload;
}

void check_payload(const RecordingPayload& payload) {
  if (can_be_carried(payload.payload)) return;
  throw InputError({payload.recording, "payload", words_of(payload.payload), kAllowedPayload,
                    mend_of_payload()});
}

std::string mend_of_payload() {
  return fmt::format("write a mass of 0 to {} kg, and numbers from -{} to {} m",
                     shortest(kMostPayloadKg), shortest(kFurthestPayloadM),
                     shortest(kFurthestPayloadM));
}

std::string text_of(const RecordingPayload& payload) {
  const auto& place = payload.payload.place_m;
  return fmt::format("{}={}@{},{},{}", payload.recording, shortest(payload.payload.mass_kg),
                     shortest(place[0]), shortest(place[1]), shortest(place[2]));
}

std::string words_of(const Payload& payload) {
  return fmt::format("{} kg at [{}, {}, {}] m of the last link", shortest(payload.mass_kg),
                     shortest(payload.place_m[0]), shortest(payload.place_m[1]),
                     shortest(payload.place_m[2]));
}

}  // namespace offnominal::desk
