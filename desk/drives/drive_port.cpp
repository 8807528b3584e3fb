#include "drives/drive_port.hpp"

#include <array>

#include "drives/drive_table.hpp"

namespace offnominal::desk {
namespace {

template <typename... Rows>
std::unique_ptr<DrivePort> port_of(const DriveSettings& settings, std::size_t joints,
                                   const hal::DriveLink& link, std::tuple<Rows...>* /*rows*/) {
  using Port = std::unique_ptr<DrivePort>;
  using Make =
      Port (*)(const hal::DriveValues& values, const hal::DriveLink& link, std::size_t joints);
  constexpr std::array<Make, sizeof...(Rows)> kMakers{
      [](const hal::DriveValues& values, const hal::DriveLink& of, std::size_t count) -> Port {
        using Protocol = typename Rows::Protocol;
        return std::make_unique<DrivePortOf<typename Protocol::template Drives<hal::kAnyJoints>>>(
            Protocol::template drives<hal::kAnyJoints>(values, of, count));
      }...};
  return kMakers.at(settings.protocol)(values_of(settings), link, joints);
}

}  // namespace

std::unique_ptr<DrivePort> make_drive_port(const DriveSettings& settings, std::size_t joints,
                                           const hal::DriveLink& link) {
  return port_of(settings, joints, link, static_cast<DriveProtocols*>(nullptr));
}

}  // namespace offnominal::desk
