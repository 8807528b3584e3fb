// A recording that is none, of the format that OFFNOMINAL_EXTENSION names: read_log() refuses it
// with an InputError, or what comes back is whole.

#include <cstdlib>

#include "common/error.hpp"
#include "input_file.hpp"
#include "log/read_log.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace offnominal;
  const auto path = fuzz::input_file(data, size, OFFNOMINAL_EXTENSION);
  try {
    const desk::Log log = desk::read_log(path, 2, std::nullopt);
    const bool whole = log.q.rows() == log.sample_count() && log.dq.rows() == log.sample_count() &&
                       log.tau.rows() == log.sample_count() && log.joint_count() == 2 &&
                       log.q.allFinite() && log.dq.allFinite() && log.tau.allFinite();
    if (!whole) std::abort();
  } catch (const desk::InputError&) {
  }
  return 0;
}
