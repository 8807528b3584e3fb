// What every route of the API does with a request and its answer.
#pragma once

#include <charconv>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "studio/http.hpp"

namespace offnominal::desk::studio {

inline constexpr const char* kJson = "application/json; charset=utf-8";

template <typename Json>
void set_json(httplib::Response& response, const Json& value) {
  response.set_content(value.dump(-1, ' ', false, Json::error_handler_t::replace), kJson);
}

inline void refuse(httplib::Response& response, int status, const std::string& words,
                   bool confirm = false) {
  response.status = status;
  set_json(response, nlohmann::json{{"error", on_one_line(words)}, {"confirm", confirm}});
}

// What `make` gives, or why there is none.
template <typename Make>
void answer(httplib::Response& response, const Make& make) {
  try {
    set_json(response, make());
  } catch (const Refused& refused) {
    const bool bad = refused.why() == Refused::Why::kBadRequest;
    refuse(response, bad ? 400 : 409, refused.what(), refused.why() == Refused::Why::kMustConfirm);
  } catch (const nlohmann::json::exception&) {
    refuse(response, 400, "The request is not understood.");
  } catch (const InputError& error) {
    refuse(response, 422, error.what());
  } catch (const std::exception& error) {
    refuse(response, 500, error.what());
  }
}

template <typename Number>
Number number_of(const httplib::Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  Number value{};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (text.empty() || read.ec != std::errc{} || read.ptr != end) {
    throw Refused(Refused::Why::kBadRequest, std::string(name) + " has to be a number.");
  }
  return value;
}

inline nlohmann::json body_of(const httplib::Request& request) {
  if (!request.get_header_value("Content-Type").starts_with("application/json")) {
    throw Refused(Refused::Why::kBadRequest, "The body has to be JSON.");
  }
  return nlohmann::json::parse(request.body);
}

}  // namespace offnominal::desk::studio
