#pragma once

#include <offnominal/realtime/recorder.hpp>

namespace offnominal::desk::sil {

/// Throws InputError where a file cannot be made.
void open_recorder(const realtime::RecorderConfig& config, realtime::Recorder& recorder);

}  // namespace offnominal::desk::sil
