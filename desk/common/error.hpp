#pragma once

#include <stdexcept>
#include <string>

namespace offnominal::desk {

/// What is wrong with an input, in the words of who has to mend it. An empty part is left out of
/// the message.
struct InputProblem {
  std::string file;     // the file as the user named it
  std::string place;    // where in it: "line 12, joint[2].link.mass_kg", "column tau1"
  std::string found;    // what stands there
  std::string allowed;  // what may stand there
  std::string mend;     // what to do
};

/// An input that cannot be used: a file, an option, a recording. what() is one line,
///   file: place: found ...; allowed: ...; to mend: ...
/// in which line breaks and other control characters of the input have become spaces.
class InputError : public std::runtime_error {
 public:
  explicit InputError(InputProblem problem);

  [[nodiscard]] const InputProblem& problem() const { return problem_; }

 private:
  InputProblem problem_;
};

/// `text` with every control character, line breaks among them, turned into a space.
[[nodiscard]] std::string on_one_line(std::string text);

}  // namespace offnominal::desk
