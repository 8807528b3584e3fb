#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "studio/intake.hpp"

namespace offnominal::test {

/// A page that is given files.
class Loading : public ::testing::Test {
 protected:
  nlohmann::ordered_json give(const std::string& name, const std::string& content) {
    return intake_.take(intake_.folder().put(name, content));
  }
  std::string refusal_of(const std::string& name, const std::string& content) {
    try {
      static_cast<void>(give(name, content));
    } catch (const desk::InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  desk::studio::Intake intake_{{.folder = folder_.path()}};
};

}  // namespace offnominal::test
