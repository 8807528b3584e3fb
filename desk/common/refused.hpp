#pragma once

#include <stdexcept>
#include <string>

namespace offnominal::desk {

/// Why a request is not done, in words for the user.
class Refused : public std::runtime_error {
 public:
  enum class Why {
    kBadRequest,  // it says nothing that there is
    kNotNow,      // the session's state forbids it
    kMustConfirm  // it is done where the user says so once more
  };
  Refused(Why why, const std::string& words) : std::runtime_error(words), why_(why) {}
  [[nodiscard]] Why why() const { return why_; }

 private:
  Why why_;
};

}  // namespace offnominal::desk
