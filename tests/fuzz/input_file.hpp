#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace offnominal::fuzz {

// What libFuzzer hands over, as a file: the readers take paths. One per process, written anew.
inline std::filesystem::path input_file(const std::uint8_t* data, std::size_t size,
                                        const std::string& extension) {
  static const std::filesystem::path folder = [] {
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  }();
  const std::filesystem::path path =
      folder / ("offnominal-fuzz-" + std::to_string(getpid()) + extension);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  file.close();
  if (!file) std::abort();  // no room: nothing was tried
  return path;
}

}  // namespace offnominal::fuzz
