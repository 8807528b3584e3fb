#include "common/error.hpp"

#include <algorithm>
#include <utility>

namespace offnominal::desk {
namespace {

std::string message_of(const InputProblem& problem) {
  std::string message = problem.file;
  const auto append = [&message](const char* separator, const char* label,
                                 const std::string& part) {
    if (part.empty()) return;
    if (!message.empty()) message += separator;
    message += label + part;
  };
  append(": ", "", problem.place);
  append(": ", "found ", problem.found);
  append("; ", "allowed: ", problem.allowed);
  append("; ", "to mend: ", problem.mend);
  return on_one_line(message);
}

}  // namespace

InputError::InputError(InputProblem problem)
    : std::runtime_error(message_of(problem)), problem_(std::move(problem)) {}

std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  return text;
}

}  // namespace offnominal::desk
