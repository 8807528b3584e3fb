#include "sil/open_recorder.hpp"

#include <cerrno>
#include <cstring>

#include "common/error.hpp"

namespace offnominal::desk::sil {

void open_recorder(const realtime::RecorderConfig& config, realtime::Recorder& recorder) {
  const int error = recorder.open(config);
  if (error == 0) return;
  throw InputError({recorder.failed_file(), "", std::strerror(error), "a file that can be made",
                    error == EEXIST ? "choose another name or give --force" : ""});
}

}  // namespace offnominal::desk::sil
