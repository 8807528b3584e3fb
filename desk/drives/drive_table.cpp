#include "drives/drive_table.hpp"

#include <array>

#include "drives/drive_protocols.hpp"

namespace offnominal::desk {
namespace {

template <typename Row>
DriveProtocol protocol_in() {
  using Protocol = typename Row::Protocol;
  return {.name = Protocol::kName,
          .header = Protocol::kHeader,
          .type = Protocol::kType,
          .keys = Protocol::kKeys,
          .joint_keys = Protocol::kJointKeys,
          .has_fd = Protocol::kHasFd,
          .has_positions_alone = Protocol::kHasPositionsAlone,
          .has_dbc = Protocol::kHasDbc,
          .fault_of = &Protocol::fault_of,
          .busy_share = &Protocol::busy_share,
          .reading_frame = &Protocol::reading_frame,
          .heartbeat_in = &Protocol::heartbeat_in,
          .from_drives = &Protocol::from_drives,
          .from_controller = &Protocol::from_controller,
          .emulate = [](const hal::DriveValues& values,
                        const sim::DriveSetup& setup) -> std::unique_ptr<sim::Drives> {
            return std::make_unique<typename Row::Emulated>(values, setup);
          }};
}

template <typename... Rows>
std::array<DriveProtocol, sizeof...(Rows)> table_of(std::tuple<Rows...>* /*rows*/) {
  return {protocol_in<Rows>()...};
}

using Filters = std::size_t (*)(const hal::DriveValues& values, std::span<hal::IdFilter> into);

std::vector<hal::IdFilter> filters_of(Filters filters, const DriveSettings& settings) {
  std::vector<hal::IdFilter> all(hal::kMostDriveFilters);
  all.resize(filters(values_of(settings), all));
  return all;
}

}  // namespace

std::span<const DriveProtocol> drive_protocols() {
  static const auto table = table_of(static_cast<DriveProtocols*>(nullptr));
  return table;
}

const DriveProtocol& protocol_of(const DriveSettings& settings) {
  return drive_protocols()[settings.protocol];
}

hal::DriveValues values_of(const DriveSettings& settings) {
  return {settings.shared, settings.of_joints};
}

std::vector<hal::IdFilter> from_drives(const DriveSettings& settings) {
  return filters_of(protocol_of(settings).from_drives, settings);
}

std::vector<hal::IdFilter> from_controller(const DriveSettings& settings) {
  return filters_of(protocol_of(settings).from_controller, settings);
}

std::unique_ptr<sim::Drives> emulated_drives(const DriveSettings& settings,
                                             const sim::DriveSetup& setup) {
  return protocol_of(settings).emulate(values_of(settings), setup);
}

}  // namespace offnominal::desk
